//! What the renderer wants of a device: batches of rays answered.

use crate::begin::{self, Begin};
use crate::filtered;
use ropewalk::{Keep, Query, Ray, Structure, TraceOptions, Traced, Walk};
use ropewalk_gpu::{Device, Gpu, Traceable};
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

    /// Traces a batch as if the hits that `keep` does not keep were not there: holes in leaves.
    ///
    /// # Errors
    /// When the walk does not answer the query here, or the device fails.
    fn trace_filtered(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        begin: &Begin<'_>,
        keep: Keep<'_>,
        options: TraceOptions,
    ) -> Result<Traced, Box<dyn Error + Send + Sync>> {
        filtered::trace(self, walk, query, rays, begin, keep, options)
    }

    /// The structure on its device, for kernels of other kinds than batches.
    fn traceable(&self) -> Option<&Traceable> {
        None
    }

    /// The structure that is traced, where its triangles can be had: without it nothing can be rasterised.
    fn structure(&self) -> Option<&Structure> {
        None
    }

    /// The graphics adapter that traces, where one does.
    fn gpu(&self) -> Option<&Gpu> {
        None
    }
}

impl Trace for Structure {
    fn structure(&self) -> Option<&Structure> {
        Some(self)
    }

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

    fn trace_filtered(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        _begin: &Begin<'_>,
        keep: Keep<'_>,
        options: TraceOptions,
    ) -> Result<Traced, Box<dyn Error + Send + Sync>> {
        // A structure's own filter: holes are known within the walk.
        Ok(Self::trace_filtered(self, walk, query, rays, options, keep)?)
    }
}

impl Trace for Traceable {
    fn traceable(&self) -> Option<&Traceable> {
        Some(self)
    }

    fn structure(&self) -> Option<&Structure> {
        Some(self.structure())
    }

    fn gpu(&self) -> Option<&Gpu> {
        match self.device() {
            Device::Gpu(tracer) => Some(tracer.gpu()),
            Device::Cpu => None,
        }
    }

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

    fn trace_filtered(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        begin: &Begin<'_>,
        keep: Keep<'_>,
        options: TraceOptions,
    ) -> Result<Traced, Box<dyn Error + Send + Sync>> {
        match self.on_gpu() {
            None => Trace::trace_filtered(self.structure(), walk, query, rays, begin, keep, options),
            Some(_) => filtered::trace(self, walk, query, rays, begin, keep, options),
        }
    }
}
