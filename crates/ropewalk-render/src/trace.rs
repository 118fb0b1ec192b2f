//! What the renderer wants of a device: batches of rays answered.

use crate::begin::{self, Begin};
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

    /// Traces a batch of which it is known where its rays begin. The answers are the same; a structure that can make use
    /// of it finds them sooner.
    ///
    /// # Errors
    /// When the walk does not answer the query here, or the device fails.
    fn trace_begun(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        _begin: &Begin<'_>,
        options: TraceOptions,
    ) -> Result<Traced, Box<dyn Error + Send + Sync>> {
        self.trace_batch(walk, query, rays, options)
    }
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

    fn trace_begun(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        begin: &Begin<'_>,
        options: TraceOptions,
    ) -> Result<Traced, Box<dyn Error + Send + Sync>> {
        match begin::heads(self, walk, rays, begin) {
            Some(heads) => Ok(self.trace_from(query, rays, heads.starts(), options)?),
            None => self.trace_batch(walk, query, rays, options),
        }
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

    fn trace_begun(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        begin: &Begin<'_>,
        options: TraceOptions,
    ) -> Result<Traced, Box<dyn Error + Send + Sync>> {
        match begin::heads(self.structure(), walk, rays, begin) {
            Some(heads) => Ok(self.trace_from(query, rays, heads.starts(), options)?),
            None => self.trace_batch(walk, query, rays, options),
        }
    }
}
