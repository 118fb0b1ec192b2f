//! Batches of rays, spread over threads where there are any.

use super::{BruteForce, Ordered, restart_trail};
use crate::batch::{Batch, Keep, TraceOptions, Traced, Traversal, answer_each};
use crate::bvh::StackOrder;
use crate::catalogue::{self, StructureKind};
use crate::wide_bvh::WideBvh;
use crate::{CatalogueError, DeviceKind, Hit, Query, Ray, TraceError, Walk};

impl WideBvh {
    /// Traces a batch by any walk of the catalogue.
    ///
    /// # Errors
    /// When the walk does not answer the query, or the tree is too deep for it.
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
        catalogue::check(StructureKind::WideBvh, walk, batch.query, DeviceKind::Cpu)?;
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
