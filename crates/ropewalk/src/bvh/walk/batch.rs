//! Batches of rays, spread over threads where there are any.

use super::{BruteForce, Ordered, Postponed, Recursive, SkipPointers, StackOrder, restart_trail};
use crate::batch::{Batch, Traced, Traversal, answer_each, trace_entries};
use crate::bvh::Bvh;
use crate::{CatalogueError, Hit, Ray, TraceError, Walk};

trace_entries!(Bvh, Bvh);

impl Bvh {
    fn trace_batch(&self, walk: Walk, batch: Batch<'_>) -> Result<Traced, TraceError> {
        Ok(match walk {
            Walk::BruteForce => self.by(BruteForce).trace(batch),
            Walk::Recursive => self.by(Recursive).trace(batch),
            Walk::Stack(StackOrder::Unordered) => self.by(Postponed::<false, false>).trace(batch),
            Walk::Stack(StackOrder::Culled) => self.by(Postponed::<true, false>).trace(batch),
            Walk::Stack(StackOrder::Sorted) => self.by(Postponed::<true, true>).trace(batch),
            Walk::Stack(StackOrder::Ordered) => self.by(Ordered).trace(batch),
            Walk::RestartTrail(trail) => restart_trail::trace(self, trail, batch)?,
            Walk::List => self.by(SkipPointers(self.skips())).trace(batch),
            // The catalogue has refused them.
            _ => {
                let text = format!("the walk '{walk}' does not go through binary trees of boxes");
                return Err(CatalogueError(text).into());
            }
        })
    }

    /// The closest hits of many rays, into `hits`, by the best walk. Only the first
    /// `min(rays.len(), hits.len())` are traced.
    pub fn closest_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        answer_each(rays, hits, |ray| self.closest(ray));
    }

    /// Whether each of many rays hits anything, into `hits`, by the best walk. Only the first
    /// `min(rays.len(), hits.len())` are traced.
    pub fn any_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        answer_each(rays, hits, |ray| self.any(ray));
    }
}
