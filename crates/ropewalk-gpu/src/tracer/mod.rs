//! Tracing batches on a device.
//!
//! A structure is uploaded once. A batch is cut into tiles; each tile is one submission that uploads its rays,
//! zeroes its results, runs the kernel, and copies the results to where the CPU can read them. Two tiles are
//! under way at a time, so that the CPU reads one while the device traces the next.
//!
//! **Invariants.** Nothing is sent to wgpu that it would refuse: sizes are compared with the device's limits
//! first, and what is left is caught by error scopes. Every ray's answer is known to have been written.

mod pipelines;
mod results;
mod structure;
mod tile;

pub use structure::GpuStructure;

use crate::{Gpu, GpuError};
use pipelines::Pipelines;
use results::Results;
use ropewalk::{DeviceKind, Query, Ray, Structure, TraceOptions, Traced, Walk, catalogue};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tile::{BatchUniform, Tile, TileBuffers};

use crate::shader::{Kernel, ShaderLibrary};

/// Tiles under way at a time: one that the device traces, one that the CPU reads or writes.
const TILES_UNDER_WAY: usize = 2;

/// How a tracer works. The default is right for tracing; the rest is for tests and for experiments.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct TracerOptions {
    /// Whether shaders carry wgpu's index and loop checks. They change no answer.
    pub checked: bool,
    /// Steps a ray may take; by default as many as the structure has nodes, which no walk uses up.
    pub step_budget: Option<u32>,
    /// Entries of each ray's stack; by default enough for the structure's depth.
    pub stack_entries: Option<u32>,
    /// Rays a submission; by default 262,144 on a graphics card and 32,768 on a software adapter, some
    /// milliseconds each, and fewer where a limit of the device wants it.
    pub tile_rays: Option<u32>,
}

/// What a batch answers, and the time the device took.
#[derive(Clone, Debug, PartialEq)]
pub struct GpuTraced {
    /// The answers.
    pub traced: Traced,
    /// The time that the kernel ran, without transfers, where the device has timestamps.
    pub device_time: Option<Duration>,
}

/// Traces batches on one device. Clones share its pipelines and buffers; threads may trace at the same time.
#[derive(Clone, Debug)]
pub struct Tracer {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    gpu: Gpu,
    options: TracerOptions,
    pipelines: Pipelines,
    /// Buffers of tiles that are not under way.
    idle: Mutex<Vec<TileBuffers>>,
}

impl Tracer {
    /// A tracer on a device.
    #[must_use]
    pub fn new(gpu: Gpu) -> Self {
        Self::with_options(gpu, TracerOptions::default())
    }

    /// A tracer on a device, working in another way than usual.
    #[must_use]
    pub fn with_options(gpu: Gpu, options: TracerOptions) -> Self {
        Self::assembled(gpu, options, ShaderLibrary::shipped())
    }

    /// A tracer whose kernels are assembled from another library: one that adds to the shipped shaders, or
    /// replaces some. Its shaders are checked by wgpu whatever the options say, since nothing is known of them.
    #[must_use]
    pub fn with_library(gpu: Gpu, options: TracerOptions, library: ShaderLibrary) -> Self {
        Self::assembled(gpu, TracerOptions { checked: true, ..options }, library)
    }

    fn assembled(gpu: Gpu, options: TracerOptions, library: ShaderLibrary) -> Self {
        let pipelines = Pipelines::new(&gpu, library, options.checked);
        Self { inner: Arc::new(Inner { gpu, options, pipelines, idle: Mutex::default() }) }
    }

    /// The device.
    #[must_use]
    pub fn gpu(&self) -> &Gpu {
        &self.inner.gpu
    }

    /// How it works.
    #[must_use]
    pub fn options(&self) -> &TracerOptions {
        &self.inner.options
    }

    /// Copies a structure to the device.
    ///
    /// # Errors
    /// When it exceeds a limit or the memory of the device.
    pub fn upload(&self, structure: &Structure) -> Result<GpuStructure, GpuError> {
        let Inner { gpu, pipelines, .. } = &*self.inner;
        GpuStructure::upload(gpu, pipelines.structure_layout(), structure).map_err(|error| gpu.explain(error))
    }

    /// Traces a batch.
    ///
    /// # Errors
    /// When the catalogue has no such row for a graphics adapter, or the device fails.
    pub fn trace(
        &self,
        structure: &GpuStructure,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<GpuTraced, GpuError> {
        catalogue::check(walk, query, DeviceKind::Gpu)?;
        let gpu = &self.inner.gpu;
        if !gpu.is_same(structure.gpu()) {
            return Err(GpuError::OtherDevice);
        }
        self.trace_tiles(structure, walk, query, rays, options).map_err(|error| gpu.explain(error))
    }

    fn trace_tiles(
        &self,
        structure: &GpuStructure,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<GpuTraced, GpuError> {
        let Inner { gpu, options: how, pipelines, .. } = &*self.inner;
        let stack_entries = how.stack_entries.unwrap_or_else(|| Kernel::stack_entries_for(structure.depth()));
        let kernel = Kernel { walk, query, counters: options.counters, stack_entries: stack_entries.max(1) };
        let pipeline = pipelines.get(gpu, kernel)?;
        let uniform = BatchUniform {
            ray_count: 0,
            node_count: structure.node_count(),
            step_budget: how.step_budget.unwrap_or_else(|| structure.node_count()),
            infinity: f32::INFINITY,
        };

        let mut results = Results::new(kernel, rays.len());
        let mut device_time = gpu.has_timestamps().then_some(Duration::ZERO);
        let mut under_way: VecDeque<Tile> = VecDeque::with_capacity(TILES_UNDER_WAY);
        let mut tiles = rays.chunks(self.tile_rays(kernel)?);
        loop {
            let next = if under_way.len() < TILES_UNDER_WAY { tiles.next() } else { None };
            if let Some(part) = next {
                let buffers = self.take_buffers();
                let uniform = BatchUniform { ray_count: part.len() as u32, ..uniform };
                let layout = pipelines.batch_layout();
                under_way.push_back(Tile::submit(
                    gpu, layout, buffers, &pipeline, structure, uniform, part, kernel,
                )?);
            } else if let Some(tile) = under_way.pop_front() {
                let (time, buffers) = tile.finish(gpu, |words| results.append(words))?;
                if let (Some(sum), Some(time)) = (&mut device_time, time) {
                    *sum += time;
                }
                self.give_buffers(buffers);
            } else {
                return Ok(GpuTraced { traced: results.into_traced(), device_time });
            }
        }
    }

    /// Rays a tile: what the options or the kind of device say, and what every limit of the device allows.
    fn tile_rays(&self, kernel: Kernel) -> Result<usize, GpuError> {
        let gpu = &self.inner.gpu;
        let limits = gpu.device().limits();
        let wanted = match self.inner.options.tile_rays {
            Some(wanted) => u64::from(wanted.max(1)),
            None if gpu.is_software() => 1 << 15,
            None => 1 << 18,
        };
        let ray_bytes = size_of::<Ray>() as u64;
        let result_bytes = (kernel.result_words() * size_of::<u32>()) as u64;
        let bytes = ray_bytes.max(result_bytes);
        let by_binding = limits.max_storage_buffer_binding_size / bytes;
        let by_buffer = limits.max_buffer_size.saturating_sub(tile::TIMESTAMP_BYTES) / bytes;
        let by_groups =
            u64::from(limits.max_compute_workgroups_per_dimension) * u64::from(crate::gpu::WORKGROUP_SIZE);
        match wanted.min(by_binding).min(by_buffer).min(by_groups) {
            0 => Err(GpuError::TooLarge {
                what: "rays of the smallest batch",
                needed: bytes + tile::TIMESTAMP_BYTES,
                limit: limits.max_storage_buffer_binding_size.min(limits.max_buffer_size),
                limit_name: "max_storage_buffer_binding_size and max_buffer_size",
                way_out: "ask for a device with higher limits",
            }),
            rays => Ok(rays as usize),
        }
    }

    fn take_buffers(&self) -> TileBuffers {
        self.inner.idle.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default()
    }

    fn give_buffers(&self, buffers: TileBuffers) {
        self.inner.idle.lock().unwrap_or_else(PoisonError::into_inner).push(buffers);
    }
}
