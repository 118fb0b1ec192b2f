//! What the renderer wants of a device: batches of rays answered.

use ropewalk::{Query, Ray, Structure, TraceOptions, Traced, Walk};
use ropewalk_gpu::Traceable;
use std::error::Error;

/// Something that traces batches of rays against one scene.
pub trait Trace: Sync {
    /// Traces a batch.
    ///
    /// # Errors
    /// When the walk does not answer the query here, or the device fails.
    fn trace_batch(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, Box<dyn Error + Send + Sync>>;
}

impl Trace for Structure {
    fn trace_batch(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, Box<dyn Error + Send + Sync>> {
        Ok(self.trace(walk, query, rays, options)?)
    }
}

impl Trace for Traceable {
    fn trace_batch(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, Box<dyn Error + Send + Sync>> {
        Ok(self.trace(walk, query, rays, options)?)
    }
}
