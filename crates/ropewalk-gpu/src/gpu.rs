//! A wgpu device that kernels run on: opened here, or brought by the caller.
//!
//! **Invariants.** Every [`Gpu`] has what every kernel needs ([`Gpu::from_device`] refuses others). A
//! caller's device is only used: its callbacks, its queue and its other resources are left alone.

use crate::adapter::{discover, summaries};
use crate::{AdapterSummary, GpuError};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, OnceLock};

/// Storage buffers that the batch kernel binds: nodes, triangles, rays, results.
pub(crate) const STORAGE_BUFFERS: u32 = 4;
/// Invocations a workgroup: two warps or one wave, and small enough for every device.
pub(crate) const WORKGROUP_SIZE: u32 = 64;

/// Workgroup memory of the largest short stack: two words an entry. WebGPU promises 16 KiB.
const WORKGROUP_BYTES: u32 = WORKGROUP_SIZE * ropewalk::catalogue::TrailOptions::MAX_SHORT_STACK * 8;

/// A device with its queue and what is known about it. Clones share all of it.
#[derive(Clone, Debug)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    /// Tells devices apart: wgpu's own identifiers repeat between instances.
    identity: Arc<OnceLock<String>>,
}

impl Gpu {
    /// Opens the adapter of a number from [`adapters`](crate::adapters).
    ///
    /// # Errors
    /// When it is not there, or gives no device.
    pub fn open(index: usize) -> Result<Self, GpuError> {
        let adapters = discover();
        match adapters.get(index) {
            Some(adapter) => Self::from_adapter(adapter),
            None if adapters.is_empty() => Err(GpuError::NoAdapter),
            None => Err(GpuError::NoSuchAdapter { wanted: index.to_string(), there: summaries(&adapters) }),
        }
    }

    /// Opens a device on an adapter, with all the limits that the adapter has.
    ///
    /// # Errors
    /// When it gives no device.
    pub fn from_adapter(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        let info = adapter.get_info();
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("ropewalk"),
            required_features: Self::required_features(adapter.features()),
            required_limits: Self::required_limits(&adapter.limits()),
            ..wgpu::DeviceDescriptor::default()
        });
        let (device, queue) = pollster::block_on(request)
            .map_err(|error| GpuError::NoDevice { adapter: info.name.clone(), reason: error.to_string() })?;
        let gpu = Self::from_device(device, queue, info)?;
        // Only on a device that is ours: a caller's callback would be replaced.
        let lost = Arc::clone(&gpu.identity);
        gpu.device.set_device_lost_callback(move |reason, message| {
            let _ = lost.set(if message.is_empty() { format!("{reason:?}") } else { message });
        });
        Ok(gpu)
    }

    /// Takes a device and a queue of the caller's. [`Gpu::required_features`] and [`Gpu::required_limits`]
    /// say what is best asked for when such a device is made.
    ///
    /// # Errors
    /// When a limit of the device is below what the kernels need.
    pub fn from_device(
        device: wgpu::Device,
        queue: wgpu::Queue,
        info: wgpu::AdapterInfo,
    ) -> Result<Self, GpuError> {
        let limits = device.limits();
        let needs = [
            ("max_bind_groups", 2, limits.max_bind_groups),
            (
                "max_storage_buffers_per_shader_stage",
                STORAGE_BUFFERS,
                limits.max_storage_buffers_per_shader_stage,
            ),
            ("max_uniform_buffers_per_shader_stage", 1, limits.max_uniform_buffers_per_shader_stage),
            ("max_compute_workgroup_size_x", WORKGROUP_SIZE, limits.max_compute_workgroup_size_x),
            (
                "max_compute_invocations_per_workgroup",
                WORKGROUP_SIZE,
                limits.max_compute_invocations_per_workgroup,
            ),
            (
                "max_compute_workgroup_storage_size",
                WORKGROUP_BYTES,
                limits.max_compute_workgroup_storage_size,
            ),
            ("max_compute_workgroups_per_dimension", 1, limits.max_compute_workgroups_per_dimension),
        ];
        for (limit, needed, there) in needs {
            if there < needed {
                return Err(GpuError::LimitTooLow { limit, needed: needed.into(), there: there.into() });
            }
        }
        Ok(Self { device, queue, info, identity: Arc::default() })
    }

    /// The features to ask a device for. None is needed; timestamps are used where the adapter has them.
    #[must_use]
    pub fn required_features(available: wgpu::Features) -> wgpu::Features {
        available & wgpu::Features::TIMESTAMP_QUERY
    }

    /// The limits to ask a device for: all that the adapter has, since a scene's size is bounded by them.
    #[must_use]
    pub fn required_limits(available: &wgpu::Limits) -> wgpu::Limits {
        available.clone()
    }

    /// The device.
    #[must_use]
    pub const fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// Its queue.
    #[must_use]
    pub const fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// What the driver says about the adapter.
    #[must_use]
    pub const fn info(&self) -> &wgpu::AdapterInfo {
        &self.info
    }

    /// The adapter in words: its name, interface and driver.
    #[must_use]
    pub fn describe(&self) -> String {
        AdapterSummary::new(0, &self.info).describe()
    }

    /// Whether it runs on the processor.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// Whether the device time of a batch can be measured.
    #[must_use]
    pub fn has_timestamps(&self) -> bool {
        self.device.features().contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// Whether two of them are the same device.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.identity, &other.identity)
    }

    /// Lets wgpu look after its submissions.
    pub(crate) fn poll(&self, how: wgpu::PollType) -> Result<(), GpuError> {
        // A device that is lost while it is waited for makes wgpu panic; that must not end the caller's program.
        match catch_unwind(AssertUnwindSafe(|| self.device.poll(how))) {
            Ok(Ok(_)) => Ok(()),
            Ok(Err(error)) => Err(GpuError::DeviceLost(error.to_string())),
            Err(_) => Err(GpuError::DeviceLost("it stopped answering".into())),
        }
    }

    /// What is behind an error. On a lost device any call may fail in any way, and the loss is what there is to
    /// say; it is known where the device is ours.
    pub(crate) fn explain(&self, error: GpuError) -> GpuError {
        // wgpu tells of a loss when it is asked next.
        let _ = self.poll(wgpu::PollType::Poll);
        self.identity.get().cloned().map_or(error, GpuError::DeviceLost)
    }
}
