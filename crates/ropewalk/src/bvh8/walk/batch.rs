//! Batches of rays, spread over threads where there are any.

use super::brute_force::EveryLeaf;
use super::interleave::{AnyGoal, ClosestGoal, FEW, Goal, Interleaved, MANY};
use super::one_by_one::OneByOne;
use super::packet::{self, Packets};
use super::single::{ByForm, Place};
use crate::batch::{Answer, Batch, Keep, TraceOptions, Traced, Traversal};
use crate::bvh::StackOrder;
use crate::bvh8::Bvh8;
use crate::bvh8::arena::Reader;
use crate::bvh8::simd::dispatch;
use crate::catalogue::{self, StructureKind};
use crate::parallel::fill_chunks;
use crate::{CatalogueError, DeviceKind, Hit, Query, Ray, TraceError, Walk};

/// Rays that a thread takes at a time. At the end of each the slots run empty one by one, which costs about as much as
/// two rays.
const CHUNK: usize = packet::CHUNK;

impl Bvh8 {
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
        self.trace_batch(walk, Batch { query, rays, options, keep: None })
    }

    /// Traces a batch by any walk of the catalogue, as if the hits that `keep` does not keep were not there.
    ///
    /// # Errors
    /// As [`Self::trace`].
    pub fn trace_filtered(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
        keep: Keep<'_>,
    ) -> Result<Traced, TraceError> {
        self.trace_batch(walk, Batch { query, rays, options, keep: Some(keep) })
    }

    fn trace_batch(&self, walk: Walk, batch: Batch<'_>) -> Result<Traced, TraceError> {
        catalogue::check(StructureKind::Bvh8, walk, batch.query, DeviceKind::Cpu)?;
        let interleaved = batch.keep.is_none() && !batch.options.counters;
        match (walk, batch.query) {
            (Walk::BruteForce, _) => Ok(EveryLeaf(self).trace(batch)),
            (Walk::Stack(StackOrder::Ordered), Query::Closest) if interleaved => {
                let mut hits = vec![Hit::MISS; batch.rays.len()];
                self.closest_batch(batch.rays, &mut hits);
                Ok(Traced::uncounted(Answer::Closest(hits), batch.rays))
            }
            (Walk::Stack(StackOrder::Ordered), Query::Any) if interleaved => {
                let mut hits = vec![false; batch.rays.len()];
                self.any_batch(batch.rays, &mut hits);
                Ok(Traced::uncounted(Answer::Any(hits), batch.rays))
            }
            (Walk::Stack(StackOrder::Ordered), Query::Closest) => Ok(self.walked::<true>().trace(batch)),
            (Walk::Stack(StackOrder::Ordered), _) => Ok(self.walked::<false>().trace(batch)),
            // The catalogue has refused them.
            _ => Err(CatalogueError(format!("the walk '{walk}' does not go through packed trees")).into()),
        }
    }

    /// The closest hits of many rays, into `hits`, several rays in turn. Only the first
    /// `min(rays.len(), hits.len())` are traced.
    pub fn closest_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.batch::<ClosestGoal>(rays, hits);
    }

    /// Whether each of many rays hits anything, into `hits`, several rays in turn. Only the first
    /// `min(rays.len(), hits.len())` are traced.
    pub fn any_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        self.batch::<AnyGoal>(rays, hits);
    }

    fn batch<G: Goal>(&self, rays: &[Ray], answers: &mut [G::Answer])
    where
        G::Answer: Send,
    {
        let count = rays.len().min(answers.len());
        let answers = &mut answers[..count];
        if self.is_empty() {
            answers.fill(G::answer(None, &self.names));
            return;
        }
        match self.place() {
            ByForm::Full(place) => self.batch_in::<_, G>(place, rays, answers),
            ByForm::Compact(place) => self.batch_in::<_, G>(place, rays, answers),
        }
    }

    /// As many rays as answers, through a tree that is not empty.
    fn batch_in<'a, R: Reader<'a> + Sync, G: Goal>(
        &self,
        place: Place<'a, R>,
        rays: &[Ray],
        answers: &mut [G::Answer],
    ) where
        G::Answer: Send,
    {
        fill_chunks(answers, CHUNK, |first, answers| {
            let rays = &rays[first..][..answers.len()];
            let left = dispatch(self.level, Packets::<'_, '_, R, G> { place, rays, answers: &mut *answers });
            let runs = left.runs.as_slice();
            if self.arena.len() > R::LARGE {
                dispatch(self.level, Interleaved::<'_, '_, R, G, MANY> { place, rays, runs, answers });
            } else if left.run_alike {
                dispatch(self.level, OneByOne::<'_, '_, R, G> { place, rays, runs, answers });
            } else {
                dispatch(self.level, Interleaved::<'_, '_, R, G, FEW> { place, rays, runs, answers });
            }
        });
    }
}
