//! Batches of rays, spread over threads where there are any.

use super::brute_force::EveryLeaf;
use super::interleave::{AnyGoal, ClosestGoal, FEW, Goal, Interleaved, MANY};
use super::one_by_one::OneByOne;
use super::packet::{self, Packets};
use super::single::{ByForm, Place};
use crate::batch::{Batch, Traced, Traversal, trace_entries};
use crate::bvh::StackOrder;
use crate::bvh8::Bvh8;
use crate::bvh8::arena::Reader;
use crate::bvh8::simd::dispatch;
use crate::parallel::fill_chunks;
use crate::{CatalogueError, Hit, Query, Ray, TraceError, Walk};

/// Rays that a thread takes at a time. At the end of each the slots run empty one by one, which costs about as much as
/// two rays.
const CHUNK: usize = packet::CHUNK;

trace_entries!(Bvh8, Bvh8);

impl Bvh8 {
    fn trace_batch(&self, walk: Walk, batch: Batch<'_>) -> Result<Traced, TraceError> {
        match walk {
            Walk::BruteForce => Ok(EveryLeaf(self).trace(batch)),
            Walk::Stack(StackOrder::Ordered) => {
                let in_turn = batch.answered_at_once(
                    |rays, hits| self.closest_batch(rays, hits),
                    |rays, hits| self.any_batch(rays, hits),
                );
                Ok(in_turn.unwrap_or_else(|| match batch.query {
                    Query::Closest => self.walked::<true>().trace(batch),
                    _ => self.walked::<false>().trace(batch),
                }))
            }
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
