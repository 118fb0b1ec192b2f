//! One way to trace on either device: choose one, prepare a structure on it, trace.

mod lists;
mod moving;
mod points;

pub use moving::Moving;

use crate::adapter::{DeviceChoice, discover, select, summaries};
use crate::{Gpu, GpuError, GpuStructure, Tracer};
use ropewalk::{DeviceKind, Query, Ray, Structure, TraceOptions, Traced, Walk};
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

/// Where rays are traced.
#[derive(Clone, Debug)]
pub enum Device {
    /// The processor.
    Cpu,
    /// A graphics adapter.
    Gpu(Tracer),
}

/// A device, and what its user should know about it.
#[derive(Clone, Debug)]
pub struct OpenedDevice {
    /// The device.
    pub device: Device,
    /// A sentence for the user where the choice needs one: a software adapter, or a card that did not open.
    pub note: Option<String>,
}

impl Device {
    /// Opens what a choice means on this machine.
    ///
    /// `auto` takes a hardware adapter where one opens, else the CPU. `gpu` falls to a software adapter where
    /// there is nothing better. Whenever a software adapter is taken, the note says so.
    ///
    /// # Errors
    /// When the choice names an adapter that is not there or gives no device.
    pub fn open(choice: &DeviceChoice) -> Result<OpenedDevice, GpuError> {
        if *choice == DeviceChoice::Cpu {
            return Ok(OpenedDevice { device: Self::Cpu, note: None });
        }
        let adapters = discover();
        let there = summaries(&adapters);
        let Some(adapter) = select(choice, &there)?.and_then(|index| adapters.get(index)) else {
            return Ok(OpenedDevice { device: Self::Cpu, note: None });
        };
        match Gpu::from_adapter(adapter) {
            Ok(gpu) => {
                let note = gpu
                    .is_software()
                    .then(|| format!("{} is a software adapter: it runs on the processor", gpu.info().name));
                Ok(OpenedDevice { device: Self::Gpu(Tracer::new(gpu)), note })
            }
            Err(error) if *choice == DeviceChoice::Auto => {
                Ok(OpenedDevice { device: Self::Cpu, note: Some(format!("{error}; tracing on the CPU")) })
            }
            Err(error) => Err(error),
        }
    }

    /// Which kind of device it is, for the catalogue.
    #[must_use]
    pub const fn kind(&self) -> DeviceKind {
        match self {
            Self::Cpu => DeviceKind::Cpu,
            Self::Gpu(_) => DeviceKind::Gpu,
        }
    }

    /// Puts a structure where this device can trace it. A structure in an `Arc` can be prepared on several devices.
    ///
    /// # Errors
    /// When it does not fit the device.
    pub fn prepare(&self, structure: impl Into<Arc<Structure>>) -> Result<Traceable, GpuError> {
        let structure = structure.into();
        let uploaded = match self {
            Self::Cpu => None,
            Self::Gpu(tracer) => Some(tracer.upload(&structure)?),
        };
        Ok(Traceable { device: self.clone(), structure, uploaded })
    }
}

impl fmt::Display for Device {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cpu => formatter.pad("cpu"),
            Self::Gpu(tracer) => formatter.pad(&tracer.gpu().describe()),
        }
    }
}

/// A structure on a device, ready to be traced. Clones share it.
#[derive(Clone, Debug)]
pub struct Traceable {
    device: Device,
    structure: Arc<Structure>,
    uploaded: Option<GpuStructure>,
}

impl Traceable {
    /// The structure, as the CPU has it.
    #[must_use]
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// The device.
    #[must_use]
    pub const fn device(&self) -> &Device {
        &self.device
    }

    /// The tracer and the uploaded structure, where the device is a graphics adapter: for a
    /// [`Program`](crate::Program) over the same structure.
    #[must_use]
    pub const fn on_gpu(&self) -> Option<(&Tracer, &GpuStructure)> {
        match (&self.device, &self.uploaded) {
            (Device::Gpu(tracer), Some(uploaded)) => Some((tracer, uploaded)),
            _ => None,
        }
    }

    /// Traces a batch.
    ///
    /// # Errors
    /// When the catalogue has no such row for the device, or the device fails.
    pub fn trace(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, GpuError> {
        self.trace_timed(walk, query, rays, options).map(|(traced, _)| traced)
    }

    /// Traces a batch, and tells the time that a graphics device itself took, where it can measure it. The
    /// transfers are not in it.
    ///
    /// # Errors
    /// When the catalogue has no such row for the device, or the device fails.
    pub fn trace_timed(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<(Traced, Option<Duration>), GpuError> {
        match (&self.device, &self.uploaded) {
            (Device::Gpu(tracer), Some(uploaded)) => {
                let answer = tracer.trace(uploaded, walk, query, rays, options)?;
                Ok((answer.traced, answer.device_time))
            }
            _ => Ok((self.structure.trace(walk, query, rays, options)?, None)),
        }
    }
}
