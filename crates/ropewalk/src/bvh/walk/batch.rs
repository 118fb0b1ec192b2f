//! Batches of rays, spread over threads where there are any.

use super::single::sort;
use super::{
    AllHits, AnyHit, BruteForce, BvhWalk, ClosestHit, HitCount, Ordered, Postponed, Recursive, StackOrder,
    Summary,
};
use crate::batch::{Answer, HitLists, TraceOptions, Traced};
use crate::bvh::Bvh;
use crate::catalogue;
use crate::parallel::{fill_chunks, map_chunks};
use crate::{Counters, DeviceKind, Hit, NoProbe, PreparedRay, Probe, Query, Ray, Status, TraceError, Walk};

/// Rays that a thread takes at a time: long enough to hide the hand-over, short enough to share the work.
const CHUNK: usize = 1024;

impl Bvh {
    /// Traces a batch by any walk of the catalogue.
    ///
    /// # Errors
    /// When the walk does not answer the query.
    pub fn trace(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, TraceError> {
        catalogue::check(walk, query, DeviceKind::Cpu)?;
        Ok(match walk {
            Walk::BruteForce => self.by_walk::<BruteForce>(query, rays, options),
            Walk::Recursive => self.by_walk::<Recursive>(query, rays, options),
            Walk::Stack(StackOrder::Unordered) => {
                self.by_walk::<Postponed<false, false>>(query, rays, options)
            }
            Walk::Stack(StackOrder::Culled) => self.by_walk::<Postponed<true, false>>(query, rays, options),
            Walk::Stack(StackOrder::Sorted) => self.by_walk::<Postponed<true, true>>(query, rays, options),
            Walk::Stack(StackOrder::Ordered) => self.by_walk::<Ordered>(query, rays, options),
        })
    }

    /// The closest hits of many rays, into `hits`, by the best walk. Only the first
    /// `min(rays.len(), hits.len())` are traced.
    pub fn closest_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        let len = rays.len().min(hits.len());
        fill_chunks(&mut hits[..len], CHUNK, |first, part| {
            for (hit, ray) in part.iter_mut().zip(&rays[first..]) {
                *hit = self.closest(ray);
            }
        });
    }

    /// Whether each of many rays hits anything, into `hits`, by the best walk. Only the first
    /// `min(rays.len(), hits.len())` are traced.
    pub fn any_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        let len = rays.len().min(hits.len());
        fill_chunks(&mut hits[..len], CHUNK, |first, part| {
            for (hit, ray) in part.iter_mut().zip(&rays[first..]) {
                *hit = self.any(ray);
            }
        });
    }

    fn by_walk<W: BvhWalk>(&self, query: Query, rays: &[Ray], options: TraceOptions) -> Traced {
        if options.counters {
            let (answer, counters) = self.by_probe::<W, Counters>(query, rays);
            Traced { answer, status: statuses(rays), counters: Some(counters) }
        } else {
            let (answer, _) = self.by_probe::<W, NoProbe>(query, rays);
            Traced { answer, status: statuses(rays), counters: None }
        }
    }

    fn by_probe<W: BvhWalk, P: Probe + Copy + Default + Send>(
        &self,
        query: Query,
        rays: &[Ray],
    ) -> (Answer, Vec<P>) {
        match query {
            Query::Closest => {
                let (hits, probes) = self.each::<W, ClosestHit, P>(rays);
                (Answer::Closest(hits), probes)
            }
            Query::Any => {
                let (hits, probes) = self.each::<W, AnyHit, P>(rays);
                (Answer::Any(hits), probes)
            }
            Query::Count => {
                let (counts, probes) = self.each::<W, HitCount, P>(rays);
                (Answer::Count(counts), probes)
            }
            Query::All => {
                let (lists, probes) = self.all_by_probe::<W, P>(rays);
                (Answer::All(lists), probes)
            }
        }
    }

    fn each<W: BvhWalk, S: Summary, P: Probe + Copy + Default + Send>(
        &self,
        rays: &[Ray],
    ) -> (Vec<S::Answer>, Vec<P>) {
        let mut records = vec![(S::Answer::default(), P::default()); rays.len()];
        fill_chunks(&mut records, CHUNK, |first, part| {
            for (record, ray) in part.iter_mut().zip(&rays[first..]) {
                *record = self.summary::<W, S, P>(ray);
            }
        });
        records.into_iter().unzip()
    }

    fn all_by_probe<W: BvhWalk, P: Probe + Copy + Default + Send>(&self, rays: &[Ray]) -> (HitLists, Vec<P>) {
        let parts = map_chunks(rays, CHUNK, |_, rays| {
            let (mut all, mut lens, mut probes) = (Vec::new(), Vec::new(), Vec::new());
            for ray in rays {
                let first = all.len();
                let probe = PreparedRay::new(ray).map_or_else(P::default, |ray| {
                    self.visit::<W, _, _>(&ray, AllHits::new(&ray, &mut all), P::default()).1
                });
                sort(&mut all[first..]);
                lens.push(all.len() - first);
                probes.push(probe);
            }
            (all, lens, probes)
        });
        let mut lists = HitLists { offsets: vec![0], hits: Vec::new() };
        let mut probes = Vec::with_capacity(rays.len());
        let mut end = 0;
        for (hits, lens, counted) in parts {
            lists.hits.extend(hits);
            lists.offsets.extend(lens.into_iter().map(|len| {
                end += len as u64;
                end
            }));
            probes.extend(counted);
        }
        (lists, probes)
    }
}

fn statuses(rays: &[Ray]) -> Vec<Status> {
    let status = |ray: &Ray| if ray.is_valid() { Status::COMPLETE } else { Status::INVALID_RAY };
    rays.iter().map(status).collect()
}
