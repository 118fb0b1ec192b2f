//! What traversal lists have beside other structures: rays that begin with heads.

use super::{Device, Traceable};
use crate::GpuError;
use ropewalk::traversal_list::Starts;
use ropewalk::{Query, Ray, TraceOptions, Traced};
use std::time::Duration;

impl Traceable {
    /// Traces a batch by the walk of lists, each ray from its heads on.
    ///
    /// # Errors
    /// When the structure is no lists, the heads are of others, there is not a row for each ray, or the device fails.
    pub fn trace_from(
        &self,
        query: Query,
        rays: &[Ray],
        starts: Starts<'_>,
        options: TraceOptions,
    ) -> Result<Traced, GpuError> {
        self.trace_from_timed(query, rays, starts, options).map(|(traced, _)| traced)
    }

    /// Traces a batch from heads on, and tells the time that a graphics device itself took, where it can measure it.
    ///
    /// # Errors
    /// When the structure is no lists, the heads are of others, there is not a row for each ray, or the device fails.
    pub fn trace_from_timed(
        &self,
        query: Query,
        rays: &[Ray],
        starts: Starts<'_>,
        options: TraceOptions,
    ) -> Result<(Traced, Option<Duration>), GpuError> {
        if let (Device::Gpu(tracer), Some(uploaded)) = (&self.device, &self.uploaded) {
            let answer = tracer.trace_from(uploaded, query, rays, starts, options)?;
            return Ok((answer.traced, answer.device_time));
        }
        Ok((self.structure.trace_from(query, rays, starts, options)?, None))
    }
}
