//! Batches of rays, spread over threads where there are any.

use super::{BruteForce, Ordered, restart_trail};
use crate::batch::{Batch, Traced, Traversal, answer_each, trace_entries};
use crate::bvh::StackOrder;
use crate::wide_bvh::WideBvh;
use crate::{CatalogueError, Hit, Ray, TraceError, Walk};

trace_entries!(WideBvh, WideBvh);

impl WideBvh {
    fn trace_batch(&self, walk: Walk, batch: Batch<'_>) -> Result<Traced, TraceError> {
        match walk {
            Walk::BruteForce => Ok(self.by(BruteForce).trace(batch)),
            Walk::Stack(StackOrder::Ordered) => Ok(self.by(Ordered).trace(batch)),
            Walk::RestartTrail(trail) => restart_trail::trace(self, trail, batch),
            // The catalogue has refused them.
            _ => Err(CatalogueError(format!("the walk '{walk}' does not go through wide trees")).into()),
        }
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
