//! Programs: kernels of a caller's own, which trace as many rays as they like, one after the other.
//!
//! A program is a function of an item, such as the tree of rays behind a sample of a picture. It takes turns: one dispatch runs
//! a few turns of every item of a tile, and what an item keeps between them lies in the scratch. Dispatches follow until all
//! items of the tile are done. So no dispatch is long, whatever an item does: software drivers that end loops after so many
//! iterations, and watchdogs of graphics cards, have nothing to object to.
//!
//! **Invariants.** Nothing is sent to wgpu that it would refuse: sizes are compared with the device's limits first, and what is
//! left is caught by error scopes. Shaders of programs are checked by wgpu, since nothing is known of them. Every item is known
//! to be done, or there is an error.
//!
//! **Cost.** Items that are done cost a word to read a dispatch. Two tiles are under way at a time. A tile's buffers live as
//! long as the run.

mod tables;
mod tile;

pub use tables::{Table, Tables};

use super::exchange::BatchUniform;
use super::limits::TileLimits;
use super::results::written;
use super::{GpuStructure, TILES_UNDER_WAY, Tracer};
use crate::scope::scoped;
use crate::shader::{Kernel, ProgramSource, STATUS_UNFINISHED};
use crate::trusted::shader_module;
use crate::{Gpu, GpuError};
use ropewalk::{Counters, DeviceKind, Query, Status, TraceOptions, Walk, catalogue};
use std::collections::{HashMap, VecDeque};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tile::{Buffers, Tile};

/// Dispatches a submission: on a software adapter some tenths of a second, on a graphics card some milliseconds, after which it
/// is seen whether all items are done.
const DISPATCHES: u32 = 16;

/// Bytes of scratch that a tile has at most, unless one item needs more; two tiles are under way.
const SCRATCH_BYTES: usize = 128 << 20;

/// How programs run.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ProgramOptions {
    /// Items a tile; by default 131,072 on a graphics card and 8,192 on a software adapter, and fewer where a limit of the
    /// device wants it.
    pub tile_items: Option<u32>,
    /// Turns a dispatch; by default 8 on a graphics card, and 1 on a software adapter, whose driver may end the loops of a
    /// dispatch.
    pub turns: Option<u32>,
    /// The most turns of an item, after which it is an error that it is not done.
    pub most_turns: u64,
}

impl Default for ProgramOptions {
    /// A million turns: more than any item needs that does a bounded piece of work.
    fn default() -> Self {
        Self { tile_items: None, turns: None, most_turns: 1 << 20 }
    }
}

/// What a program answers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProgramAnswer {
    /// The words of all items, as many each as [`ProgramSource::result_words`] says.
    pub words: Vec<u32>,
    /// What went wrong with each item.
    pub status: Vec<Status>,
    /// What the walks of each item counted, where that was asked for.
    pub counters: Option<Vec<Counters>>,
    /// The time that the kernels ran, without transfers, where the device has timestamps.
    pub device_time: Option<Duration>,
    /// How many dispatches there were.
    pub dispatches: u64,
}

/// A program on a device. Clones share its pipelines; threads may run it at the same time.
///
/// ```no_run
/// use ropewalk::{Scene, Structure, TraceOptions, Walk};
/// use ropewalk_gpu::shader::{ProgramSource, ShaderLibrary};
/// use ropewalk_gpu::{Gpu, Program, ProgramOptions, Tracer};
///
/// // How far it is to the nearest surface along one direction, from each of many places.
/// let text = "
///     fn begin(index: u32) {}
///     fn turn(index: u32) -> bool {
///         let at = 3u * index;
///         let place = bitcast<vec3<f32>>(vec3<u32>(records[at], records[at + 1u], records[at + 2u]));
///         let dir = bitcast<vec3<f32>>(vec3<u32>(table_a[0], table_a[1], table_a[2]));
///         var collect = new_collect(batch.infinity);
///         trace_ray(Ray(place, 0.0, dir, batch.infinity, 0xffu), &collect);
///         results[result_at(index, 0u)] = bitcast<u32>(collect.hit.t);
///         return false;
///     }";
/// let library = ShaderLibrary::shipped().with("distances", text);
/// let source = ProgramSource::new(library, "distances").with_words(3, 1, 1);
/// let tracer = Tracer::new(Gpu::open(0)?);
/// let structure = tracer.upload(&Structure::Bvh(Scene::default().build(&Default::default())?))?;
/// let program = Program::new(&tracer, source, ProgramOptions::default())?;
/// let down = program.tables(&[0.0_f32, -1.0, 0.0].map(f32::to_bits), &[])?;
/// let places = [1.0_f32, 2.0, 3.0].map(f32::to_bits);
/// let answer = program.run(&structure, Walk::default(), &down, &places, TraceOptions::default())?;
/// assert_eq!(f32::from_bits(answer.words[0]), f32::INFINITY);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Program {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    tracer: Tracer,
    source: ProgramSource,
    options: ProgramOptions,
    group_layout: wgpu::BindGroupLayout,
    batch_layout: wgpu::BindGroupLayout,
    layout: wgpu::PipelineLayout,
    pipelines: Mutex<HashMap<Kernel, wgpu::ComputePipeline>>,
}

/// Storage buffers of a program: those of a batch, both tables, and the scratch.
const STORAGE_BUFFERS: u32 = crate::gpu::STORAGE_BUFFERS + 3;

impl Program {
    /// A program for structures that a tracer uploads, which also says how walks are run.
    ///
    /// # Errors
    /// When the device has not as many bindings as programs need.
    pub fn new(tracer: &Tracer, source: ProgramSource, options: ProgramOptions) -> Result<Self, GpuError> {
        let limits = tracer.gpu().device().limits();
        for (limit, needed, there) in [
            ("max_bind_groups", 3, limits.max_bind_groups),
            (
                "max_storage_buffers_per_shader_stage",
                STORAGE_BUFFERS,
                limits.max_storage_buffers_per_shader_stage,
            ),
        ] {
            if there < needed {
                return Err(GpuError::LimitTooLow { limit, needed: needed.into(), there: there.into() });
            }
        }
        let device = tracer.gpu().device();
        let buffer = |binding: u32, read_only: bool| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let (group_layout, layout) = scoped(device, "the bindings of a program", 0, || {
            let group_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("ropewalk program"),
                entries: &[buffer(0, true), buffer(1, true), buffer(2, false)],
            });
            let batch_layout = tracer.inner.pipelines.batch_layout();
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("ropewalk program"),
                bind_group_layouts: &[
                    Some(tracer.structure_layout()),
                    Some(batch_layout),
                    Some(&group_layout),
                ],
                immediate_size: 0,
            });
            (group_layout, layout)
        })?;
        let batch_layout = tracer.inner.pipelines.batch_layout().clone();
        let tracer = tracer.clone();
        let pipelines = Mutex::default();
        let inner = Inner { tracer, source, options, group_layout, batch_layout, layout, pipelines };
        Ok(Self { inner: Arc::new(inner) })
    }

    /// The program's text.
    #[must_use]
    pub fn source(&self) -> &ProgramSource {
        &self.inner.source
    }

    /// Two tables of words that all items read, on the program's device.
    ///
    /// # Errors
    /// When one exceeds a limit or the memory of the device.
    pub fn tables(&self, a: &[u32], b: &[u32]) -> Result<Tables, GpuError> {
        let gpu = self.inner.tracer.gpu();
        Tables::new(gpu, a, b).map_err(|error| gpu.explain(error))
    }

    /// Runs the program for items, whose words stand one after the other. Counters are those of the item's walks together.
    ///
    /// # Errors
    /// When the words are no whole items, the catalogue has no such walk of closest hits for a graphics adapter, the structure
    /// or the tables lie on another device, an item is not done in time, or the device fails.
    pub fn run(
        &self,
        structure: &GpuStructure,
        walk: Walk,
        tables: &Tables,
        items: &[u32],
        options: TraceOptions,
    ) -> Result<ProgramAnswer, GpuError> {
        let Inner { tracer, source, .. } = &*self.inner;
        let shape = structure.shape();
        catalogue::check(shape.tree.kind(), walk, Query::Closest, DeviceKind::Gpu)?;
        if !items.len().is_multiple_of(source.item_words()) {
            return Err(GpuError::BrokenItems { words: items.len(), item_words: source.item_words() });
        }
        if !tracer.gpu().is_same(tables.gpu()) {
            return Err(GpuError::OtherDevice);
        }
        tracer.with_own(structure, || {
            shape.check_places(walk)?;
            let kernel = Kernel {
                tree: shape.tree,
                walk: shape.tree.resolve(walk, shape.depth)?,
                query: Query::Closest,
                counters: options.counters,
                stack_entries: tracer.stack_entries(structure, walk),
                starts: 0,
            };
            self.run_tiles(structure, walk, kernel, tables, items)
        })
    }

    fn run_tiles(
        &self,
        structure: &GpuStructure,
        walk: Walk,
        kernel: Kernel,
        tables: &Tables,
        items: &[u32],
    ) -> Result<ProgramAnswer, GpuError> {
        let Inner { tracer, source, options, .. } = &*self.inner;
        let gpu = tracer.gpu();
        let pipeline = self.pipeline(kernel)?;
        let stored_words = source.stored_words(kernel.counters);
        let item_words = source.item_words();
        let record_words = stored_words.max(item_words).max(source.scratch_words());
        let wanted = options.tile_items.unwrap_or(if gpu.is_software() { 1 << 13 } else { 1 << 17 });
        let by_scratch = SCRATCH_BYTES / (source.scratch_words() * size_of::<u32>());
        let tile_items = TileLimits::new(gpu, record_words, Some(wanted))?.rays.min(by_scratch.max(1));
        let turns = options.turns.unwrap_or(if gpu.is_software() { 1 } else { 8 }).max(1);
        let shape = structure.shape();
        let uniform = BatchUniform {
            count: 0,
            node_count: shape.node_count,
            step_budget: tracer.options().step_budget.unwrap_or_else(|| shape.step_budget(walk)),
            infinity: f32::INFINITY,
            k: turns,
            slack_share: 0.0,
        };
        let count = items.len() / item_words;
        let mut answer = ProgramAnswer {
            words: vec![0; count * source.result_words()],
            status: vec![Status::COMPLETE; count],
            counters: kernel.counters.then(|| vec![Counters::default(); count]),
            device_time: gpu.has_timestamps().then_some(Duration::ZERO),
            dispatches: 0,
        };
        let mut parts = (0..count).step_by(tile_items).map(|first| first..count.min(first + tile_items));
        let mut idle: Vec<Buffers> = Vec::new();
        let mut under_way: VecDeque<(Range<usize>, u64, Tile)> = VecDeque::with_capacity(TILES_UNDER_WAY);
        loop {
            let next = if under_way.len() < TILES_UNDER_WAY { parts.next() } else { None };
            if let Some(part) = next {
                let size = tile_items.min(count);
                let bytes = |words: usize| (size * words * size_of::<u32>()) as u64;
                let buffers = match idle.pop() {
                    Some(buffers) => buffers,
                    None => Buffers::new(
                        gpu,
                        [&self.inner.batch_layout, &self.inner.group_layout],
                        tables,
                        [bytes(item_words), bytes(stored_words), bytes(source.scratch_words())],
                    )?,
                };
                let words = &items[part.start * item_words..part.end * item_words];
                buffers.load(gpu, words, BatchUniform { count: part.len() as u32, ..uniform })?;
                let tile = Tile::submit(gpu, buffers, &pipeline, structure, part.len(), stored_words, true)?;
                under_way.push_back((part, 1, tile));
            } else if let Some((part, submissions, tile)) = under_way.pop_front() {
                let mut unfinished = None;
                let (time, buffers) = tile.finish(gpu, |words| {
                    unfinished = self.read(&mut answer, part.clone(), words, stored_words)?;
                    Ok(())
                })?;
                answer.dispatches += u64::from(DISPATCHES);
                if let (Some(sum), Some(time)) = (&mut answer.device_time, time) {
                    *sum += time;
                }
                match unfinished {
                    None => idle.push(buffers),
                    Some(item) => {
                        let taken = submissions * u64::from(DISPATCHES) * u64::from(turns);
                        if taken >= options.most_turns {
                            return Err(GpuError::Unfinished { item, turns: taken });
                        }
                        let again = Tile::submit(
                            gpu,
                            buffers,
                            &pipeline,
                            structure,
                            part.len(),
                            stored_words,
                            false,
                        )?;
                        under_way.push_back((part, submissions + 1, again));
                    }
                }
            } else {
                return Ok(answer);
            }
        }
    }

    /// Takes the answers of a tile. The first item that is not done.
    fn read(
        &self,
        answer: &mut ProgramAnswer,
        part: Range<usize>,
        words: &[u32],
        stored_words: usize,
    ) -> Result<Option<usize>, GpuError> {
        let result_words = self.inner.source.result_words();
        let mut unfinished = None;
        for (item, stored) in part.zip(words.chunks_exact(stored_words)) {
            let (own, rest) = stored.split_at(result_words);
            let Some(status) = rest.last().copied().and_then(written) else {
                return Err(GpuError::Unanswered { ray: item });
            };
            if status.0 & STATUS_UNFINISHED != 0 {
                unfinished = unfinished.or(Some(item));
            }
            answer.status[item] = Status(status.0 & !STATUS_UNFINISHED);
            answer.words[item * result_words..][..result_words].copy_from_slice(own);
            if let (Some(all), Some(counted)) = (&mut answer.counters, rest.first_chunk::<6>()) {
                all[item] = bytemuck::cast(*counted);
            }
        }
        Ok(unfinished)
    }

    /// The pipeline for the tree and the walk of a kernel.
    fn pipeline(&self, kernel: Kernel) -> Result<wgpu::ComputePipeline, GpuError> {
        let Inner { tracer, source, layout, pipelines, .. } = &*self.inner;
        // Held while a pipeline is made: a second thread that wants it waits instead of making it again.
        let mut made = pipelines.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = made.get(&kernel) {
            return Ok(pipeline.clone());
        }
        let text = source.source(kernel)?;
        let label = format!("{} through {}", source.root(), kernel.label());
        let device = tracer.gpu().device();
        let pipeline = scoped(device, "a program", 0, || {
            let module = shader_module(device, &label, text, true);
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(&label),
                layout: Some(layout),
                module: &module,
                entry_point: Some("trace"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        })?;
        made.insert(kernel, pipeline.clone());
        Ok(pipeline)
    }

    /// The device.
    #[must_use]
    pub fn gpu(&self) -> &Gpu {
        self.inner.tracer.gpu()
    }
}
