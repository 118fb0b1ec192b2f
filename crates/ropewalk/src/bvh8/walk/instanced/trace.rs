//! One ray or many through two levels.

use super::alone::{Each, One};
use super::find::{Find, FindAny, FindClosest, FindFor, Goal};
use super::levels::Levels;
use super::many::Many;
use crate::batch::{Batch, Traced, Traversal, trace_entries};
use crate::bvh::StackOrder;
use crate::bvh::walk::Collect;
use crate::bvh8::Instanced;
use crate::bvh8::arena::Reader;
use crate::bvh8::simd::dispatch;
use crate::bvh8::walk::brute_force::EveryLeaf;
use crate::bvh8::walk::single::ByForm;
use crate::bvh8::walk::sink::tell;
use crate::parallel::fill_chunks;
use crate::two_level::{Moved, Moving};
use crate::{CatalogueError, Counters, Hit, NoProbe, PreparedRay, Probe, Query, Ray, TraceError, Walk};
use std::marker::PhantomData;

/// Rays that a thread takes at a time.
const CHUNK: usize = 4096;
/// Beyond so many bytes of both levels rays are led in turn: what they wait for comes from memory.
const LARGE: usize = 24 << 20;
/// Rays in turn.
const SLOTS: usize = 8;

trace_entries!(Instanced, Instanced);

impl Instanced {
    /// The closest hit of a ray; [`Hit::MISS`] where there is none or the ray is not valid.
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Hit {
        self.one::<FindClosest<'_>>(ray)
    }

    /// Whether a ray hits anything in its window; false where the ray is not valid.
    #[must_use]
    pub fn any(&self, ray: &Ray) -> bool {
        self.one::<FindAny>(ray)
    }

    /// How many hits a ray has in its window; 0 where the ray is not valid.
    #[must_use]
    pub fn count(&self, ray: &Ray) -> u32 {
        Both::<false>(self).count(ray)
    }

    /// Replaces `hits` by every hit of a ray in its window, sorted by `t`, ties by id. None is left out: there is no most.
    pub fn all(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        Both::<false>(self).append_all(ray, hits, NoProbe);
    }

    /// The closest hits of many rays, into `hits`, several rays in turn. Only the first `min(rays.len(), hits.len())` are traced.
    pub fn closest_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.many::<FindClosest<'_>>(rays, hits);
    }

    /// Whether each of many rays hits anything, into `hits`, several rays in turn. Only the first `min(rays.len(), hits.len())`
    /// are traced.
    pub fn any_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        self.many::<FindAny>(rays, hits);
    }

    fn trace_batch(&self, walk: Walk, batch: Batch<'_>) -> Result<Traced, TraceError> {
        match walk {
            Walk::BruteForce => Ok(Everything(self).trace(batch)),
            Walk::Stack(StackOrder::Ordered) => {
                let in_turn = batch.answered_at_once(
                    |rays, hits| self.closest_batch(rays, hits),
                    |rays, hits| self.any_batch(rays, hits),
                );
                Ok(in_turn.unwrap_or_else(|| match batch.query {
                    Query::Closest => Both::<true>(self).trace(batch),
                    _ => Both::<false>(self).trace(batch),
                }))
            }
            // The catalogue has refused them.
            _ => Err(CatalogueError(format!("the walk '{walk}' does not go through instances")).into()),
        }
    }

    fn one<'a, G: Goal<'a>>(&'a self, ray: &Ray) -> G::Answer {
        match PreparedRay::new(ray) {
            Some(prepared) if !self.top().is_empty() => {
                self.lead(ray, &prepared, G::new(&prepared), NoProbe).0.answer()
            }
            _ => G::NOTHING,
        }
    }

    /// Leads a ray through both levels. The top one must not be empty.
    fn lead<'a, F: Find<'a>, P: Probe>(
        &'a self,
        question: &Ray,
        ray: &PreparedRay,
        find: F,
        probe: P,
    ) -> (F, P) {
        match self.levels() {
            ByForm::Full(levels) => dispatch(self.level, One { levels, question, ray, find, probe }),
            ByForm::Compact(levels) => dispatch(self.level, One { levels, question, ray, find, probe }),
        }
    }

    fn many<'a, G: Goal<'a>>(&'a self, rays: &[Ray], answers: &mut [G::Answer]) {
        let count = rays.len().min(answers.len());
        let answers = &mut answers[..count];
        if self.top().is_empty() {
            answers.fill(G::NOTHING);
            return;
        }
        match self.levels() {
            ByForm::Full(levels) => self.many_in::<_, G>(levels, rays, answers),
            ByForm::Compact(levels) => self.many_in::<_, G>(levels, rays, answers),
        }
    }

    /// As many rays as answers, through a top level that is not empty.
    fn many_in<'a, R: Reader<'a> + Sync, G: Goal<'a>>(
        &self,
        levels: Levels<'a, R>,
        rays: &[Ray],
        answers: &mut [G::Answer],
    ) {
        fill_chunks(answers, CHUNK, |first, answers| {
            let rays = &rays[first..][..answers.len()];
            if self.report().bytes > LARGE {
                dispatch(
                    self.level,
                    Many::<'a, '_, R, G, SLOTS> { levels, rays, answers, goal: PhantomData },
                );
            } else {
                dispatch(self.level, Each::<'a, '_, R, G> { levels, rays, answers, goal: PhantomData });
            }
        });
    }
}

/// The walk, for what all structures share; children nearest first or in the order of their places.
#[derive(Clone, Copy)]
struct Both<'a, const ORDERED: bool>(&'a Instanced);

impl<const ORDERED: bool> Traversal for Both<'_, ORDERED> {
    fn visit<C: Collect, P: Probe>(
        &self,
        question: &Ray,
        ray: &PreparedRay,
        mut collect: C,
        mut probe: P,
    ) -> (C, P) {
        if !self.0.top().is_empty() {
            let find = FindFor::<ORDERED>::new(&mut collect);
            let counted = self.0.lead(question, ray, find, Counters::default()).1;
            tell(&counted, &mut probe);
            (0..counted.objects_entered).for_each(|_| probe.object_entered());
        }
        (collect, probe)
    }

    fn has_repeats(&self) -> bool {
        self.0.has_repeats()
    }
}

/// Every triangle of every instance in whose box the ray is.
#[derive(Clone, Copy)]
struct Everything<'a>(&'a Instanced);

impl Traversal for Everything<'_> {
    fn visit<C: Collect, P: Probe>(
        &self,
        question: &Ray,
        ray: &PreparedRay,
        mut collect: C,
        mut probe: P,
    ) -> (C, P) {
        for placed in self.0.placed() {
            probe.object_tested();
            let (Some(span), Some(local)) = (placed.span(ray), placed.local(question)) else { continue };
            probe.object_entered();
            let moving = Moving::new(placed, span, &local);
            let bvh = &*self.0.objects()[placed.object as usize];
            let moved = Moved { collect: &mut collect, moving, ended: false };
            let (moved, counted) = EveryLeaf(bvh).visit(question, &local.ray, moved, Counters::default());
            let ended = moved.ended;
            tell(&counted, &mut probe);
            if ended {
                break;
            }
        }
        (collect, probe)
    }

    fn has_repeats(&self) -> bool {
        self.0.has_repeats()
    }
}
