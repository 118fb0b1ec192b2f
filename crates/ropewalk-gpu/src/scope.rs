//! wgpu's error scopes as a `Result`: without them an error that wgpu finds ends the program.

use crate::{Gpu, GpuError};

/// Does some work on a device and catches what wgpu has against it. `what` and `bytes` name the work in errors.
///
/// A loss of the device is not among these errors: wgpu reports it where results are mapped.
pub(crate) fn scoped<T>(
    device: &wgpu::Device,
    what: &'static str,
    bytes: u64,
    work: impl FnOnce() -> T,
) -> Result<T, GpuError> {
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let value = work();
    // Each one is popped before any is awaited: scopes nest.
    let validation = pollster::block_on(validation.pop());
    let internal = pollster::block_on(internal.pop());
    let memory = pollster::block_on(memory.pop());
    match memory.or(validation).or(internal) {
        None => Ok(value),
        Some(wgpu::Error::OutOfMemory { .. }) => Err(GpuError::OutOfMemory { what, needed: bytes }),
        Some(error) => Err(GpuError::Refused { what, reason: error.to_string().trim().replace('\n', "; ") }),
    }
}

impl Gpu {
    /// Does some work of the caller's on the device, and catches what wgpu has against it. `what` and `bytes` name the work
    /// in errors.
    ///
    /// # Errors
    /// When wgpu refuses something, or there is no memory for it.
    pub fn scoped<T>(&self, what: &'static str, bytes: u64, work: impl FnOnce() -> T) -> Result<T, GpuError> {
        scoped(self.device(), what, bytes, work).map_err(|error| self.explain(error))
    }

    /// Waits until the device has done all that was submitted, and calls back whoever waits for a buffer.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| self.explain(error))
    }
}
