//! Tracing batches on a device.
//!
//! A structure is uploaded once. A batch is cut into tiles; each tile is one submission that uploads its rays,
//! zeroes its results, runs the kernel, and copies the results to where the CPU can read them. Two tiles are
//! under way at a time, so that the CPU reads one while the device traces the next. A batch that asks for all hits
//! runs twice: to count them, and to write them.
//!
//! **Invariants.** Nothing is sent to wgpu that it would refuse: sizes are compared with the device's limits
//! first, and what is left is caught by error scopes. Every ray's answer is known to have been written.

mod all_hits;
mod changes;
mod content;
mod exchange;
mod heads;
mod levels;
mod limits;
mod pipelines;
mod points;
mod program;
mod records;
mod results;
mod shape;
mod starts;
mod structure;
mod tile;
mod versions;

pub use points::GpuPoints;
pub use program::{Program, ProgramAnswer, ProgramOptions, Table, Tables};
pub use structure::GpuStructure;
pub use versions::{StructureVersions, UploadReport};

use crate::{Gpu, GpuError};
use all_hits::{Lists, Plan, counting_job};
use exchange::BatchUniform;
use limits::{HIT_BYTES, TileLimits};
use pipelines::Pipelines;
use records::Records;
use results::Results;
use ropewalk::{Answer, DeviceKind, Query, Ray, Structure, TraceOptions, Traced, Walk, catalogue};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tile::{Job, Tile, TileBuffers};

use crate::shader::{AnyKernel, Kernel, ShaderLibrary};

/// Tiles under way at a time: one that the device traces, one that the CPU reads or writes.
const TILES_UNDER_WAY: usize = 2;

/// How a tracer works. The default is right for tracing; the rest is for tests and for experiments.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct TracerOptions {
    /// Whether shaders carry wgpu's index and loop checks. They change no answer.
    pub checked: bool,
    /// Steps a ray may take; by default so many that no walk uses them up.
    pub step_budget: Option<u32>,
    /// Entries of each ray's stack; by default enough for the structure's depth. A short stack is as short as its walk
    /// says.
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

    fn structure_layout(&self) -> &wgpu::BindGroupLayout {
        self.inner.pipelines.structure_layout()
    }

    /// Traces a batch.
    ///
    /// # Errors
    /// When the catalogue has no such row for a graphics adapter, the structure is too deep for the walk, or the device
    /// fails.
    pub fn trace(
        &self,
        structure: &GpuStructure,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<GpuTraced, GpuError> {
        catalogue::check(structure.shape().tree.kind(), walk, query, DeviceKind::Gpu)?;
        self.with_own(structure, || self.trace_batch(structure, walk, query, Records::plain(rays), options))
    }

    /// Works with a structure, which must be on this device, and explains what fails.
    fn with_own<T>(
        &self,
        structure: &GpuStructure,
        work: impl FnOnce() -> Result<T, GpuError>,
    ) -> Result<T, GpuError> {
        let gpu = &self.inner.gpu;
        if !gpu.is_same(structure.gpu()) {
            return Err(GpuError::OtherDevice);
        }
        work().map_err(|error| gpu.explain(error))
    }

    fn trace_batch(
        &self,
        structure: &GpuStructure,
        walk: Walk,
        query: Query,
        rays: Records<'_>,
        options: TraceOptions,
    ) -> Result<GpuTraced, GpuError> {
        let shape = structure.shape();
        shape.check_places(walk)?;
        // Repeats can be told only when the hits are there.
        let has_repeats = shape.has_repeats || shows_again(walk);
        let through_lists = query == Query::All || (query == Query::Count && has_repeats);
        let kernel = Kernel {
            tree: shape.tree,
            walk: shape.tree.resolve(walk, shape.depth)?,
            query: if through_lists { Query::All } else { query },
            counters: options.counters,
            stack_entries: self.stack_entries(structure, walk),
            starts: rays.starts(),
        };
        let record_words = kernel.ray_words().max(kernel.result_words());
        let run = Run::new(&self.inner, structure, AnyKernel::Rays(kernel), record_words)?;
        let mut results = Results::new(kernel, rays.len());
        let parts = rays.parts(run.limits.rays);
        if !through_lists {
            let jobs = parts.map(|part| Job {
                ray_count: part.len() as u32,
                result_words: part.len() * kernel.result_words(),
                rays: rays.of(part),
            });
            let device_time = run.trace(jobs, |words| results.append(words))?;
            return Ok(GpuTraced { traced: results.into_traced(None), device_time });
        }
        let jobs = parts.map(|part| counting_job(kernel, rays, part));
        let counting_time = run.trace(jobs, |words| results.append(words))?;
        let plan = Plan::new(kernel, results.words(), run.limits)?;
        let mut lists = Lists::new(has_repeats);
        let writing_time = run.trace(plan.jobs(rays), |words| plan.read(&mut lists, words))?;
        let lists = lists.into_lists(rays.len());
        let answer = if query == Query::All {
            Answer::All(lists)
        } else {
            Answer::Count(lists.offsets.windows(2).map(|pair| (pair[1] - pair[0]) as u32).collect())
        };
        let device_time = counting_time.zip(writing_time).map(|(counting, writing)| counting + writing);
        Ok(GpuTraced { traced: results.into_traced(Some(answer)), device_time })
    }

    /// Entries of each ray's stack, in the sizes for which there are kernels; none where the walk brings its own.
    fn stack_entries(&self, structure: &GpuStructure, walk: Walk) -> u32 {
        if !matches!(walk, Walk::Stack(_) | Walk::SmartStack { .. }) {
            return 0;
        }
        let needed = || Kernel::stack_entries_for(structure.shape().stack_entries);
        self.inner.options.stack_entries.unwrap_or_else(needed).max(1)
    }
}

/// Whether a walk may enter a leaf twice: those of kd-trees that go from leaf to leaf, when they give a ray over to the trail.
const fn shows_again(walk: Walk) -> bool {
    matches!(walk, Walk::KdRestart | Walk::KdBacktrack | Walk::ShortStack { .. } | Walk::Ropes)
}

/// One kernel on its way through the tiles of a batch.
struct Run<'a> {
    inner: &'a Inner,
    structure: &'a GpuStructure,
    pipeline: wgpu::ComputePipeline,
    uniform: BatchUniform,
    limits: TileLimits,
}

impl<'a> Run<'a> {
    /// Of a kernel for which a record has at most so many words, whether it is read or written.
    fn new(
        inner: &'a Inner,
        structure: &'a GpuStructure,
        kernel: AnyKernel,
        record_words: usize,
    ) -> Result<Self, GpuError> {
        let Inner { gpu, options, pipelines, .. } = inner;
        let shape = structure.shape();
        let uniform = BatchUniform {
            count: 0,
            node_count: shape.node_count,
            step_budget: options.step_budget.unwrap_or_else(|| shape.step_budget(kernel.walk())),
            infinity: f32::INFINITY,
            k: 0,
            slack_share: 0.0,
        };
        Ok(Self {
            inner,
            structure,
            pipeline: pipelines.get(gpu, kernel)?,
            uniform,
            limits: TileLimits::new(gpu, record_words, options.tile_rays)?,
        })
    }

    /// Traces tiles and reads what each answers, in their order. The time that the kernel ran, where there is a clock.
    fn trace<'j>(
        &self,
        mut jobs: impl Iterator<Item = Job<'j>>,
        mut read: impl FnMut(&[u32]) -> Result<(), GpuError>,
    ) -> Result<Option<Duration>, GpuError> {
        let Inner { gpu, pipelines, .. } = self.inner;
        let mut device_time = gpu.has_timestamps().then_some(Duration::ZERO);
        let mut under_way: VecDeque<Tile> = VecDeque::with_capacity(TILES_UNDER_WAY);
        loop {
            let next = if under_way.len() < TILES_UNDER_WAY { jobs.next() } else { None };
            if let Some(job) = next {
                let buffers = self.inner.take_buffers();
                let uniform = BatchUniform { count: job.ray_count, ..self.uniform };
                let layout = pipelines.batch_layout();
                under_way.push_back(Tile::submit(
                    gpu,
                    layout,
                    buffers,
                    &self.pipeline,
                    self.structure,
                    uniform,
                    &job,
                )?);
            } else if let Some(tile) = under_way.pop_front() {
                let (time, buffers) = tile.finish(gpu, &mut read)?;
                if let (Some(sum), Some(time)) = (&mut device_time, time) {
                    *sum += time;
                }
                self.inner.give_buffers(buffers);
            } else {
                return Ok(device_time);
            }
        }
    }
}

impl Inner {
    fn take_buffers(&self) -> TileBuffers {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default()
    }

    fn give_buffers(&self, buffers: TileBuffers) {
        // A ray with more hits than a tile should have must not hold its memory for ever.
        if buffers.result_bytes() <= HIT_BYTES {
            self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(buffers);
        }
    }
}
