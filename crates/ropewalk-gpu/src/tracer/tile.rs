//! A tile of a batch: its buffers, its submission, and reading its results back.

use super::GpuStructure;
use crate::scope::scoped;
use crate::shader::{BATCH_GROUP, STRUCTURE_GROUP};
use crate::{Gpu, GpuError};
use bytemuck::{Pod, Zeroable};
use std::borrow::Cow;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Two timestamps, begin and end.
pub(super) const TIMESTAMP_BYTES: u64 = 16;

/// How long the news of a finished tile may take from one thread to another. It takes microseconds unless the
/// machine swaps; the bound only keeps a broken driver from hanging the program.
const NEWS_TIMEOUT: Duration = Duration::from_secs(30);

/// The numbers of a batch, `Batch` in `kernel/frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct BatchUniform {
    pub(super) count: u32,
    pub(super) node_count: u32,
    pub(super) step_budget: u32,
    pub(super) infinity: f32,
    pub(super) k: u32,
    pub(super) slack_share: f32,
}

/// What a tile is about: not empty, and within the device's limits.
#[derive(Clone, Debug)]
pub(super) struct Job<'a> {
    /// The rays' records.
    pub(super) rays: Cow<'a, [u32]>,
    pub(super) ray_count: u32,
    /// Words that the kernel writes for all of them.
    pub(super) result_words: usize,
}

/// The buffers of a tile. They grow to the largest tile they have seen and are used again.
#[derive(Debug, Default)]
pub(super) struct TileBuffers {
    made: Option<Made>,
}

#[derive(Debug)]
struct Made {
    ray_bytes: u64,
    result_bytes: u64,
    rays: wgpu::Buffer,
    results: wgpu::Buffer,
    /// The results, then the timestamps.
    readback: wgpu::Buffer,
    uniform: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    clock: Option<Clock>,
}

/// Measures the time between the beginning and the end of a pass.
#[derive(Debug)]
pub(super) struct Clock {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
}

impl Clock {
    /// A clock, where the device has any.
    pub(super) fn new(gpu: &Gpu) -> Option<Self> {
        gpu.has_timestamps().then(|| Self {
            queries: gpu.device().create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("ropewalk timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            }),
            resolved: gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some("ropewalk timestamps"),
                size: TIMESTAMP_BYTES,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
        })
    }

    /// What the pass must be told.
    pub(super) const fn writes(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Copies both times to a place of a buffer.
    pub(super) fn read_out(&self, encoder: &mut wgpu::CommandEncoder, buffer: &wgpu::Buffer, at: u64) {
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, buffer, at, TIMESTAMP_BYTES);
    }

    /// The time between both.
    pub(super) fn between(gpu: &Gpu, stamps: &[u8]) -> Duration {
        let [begin, end]: [u64; 2] = bytemuck::pod_read_unaligned(stamps);
        let ticks = end.saturating_sub(begin);
        Duration::from_nanos((ticks as f64 * f64::from(gpu.queue().get_timestamp_period())) as u64)
    }
}

impl TileBuffers {
    /// Bytes of results that they have room for.
    pub(super) fn result_bytes(&self) -> u64 {
        self.made.as_ref().map_or(0, |made| made.result_bytes)
    }
}

impl Made {
    fn new(gpu: &Gpu, layout: &wgpu::BindGroupLayout, ray_bytes: u64, result_bytes: u64) -> Self {
        let device = gpu.device();
        let buffer = |label, size, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        use wgpu::BufferUsages as Usage;
        let rays = buffer("ropewalk rays", ray_bytes, Usage::STORAGE | Usage::COPY_DST);
        let results =
            buffer("ropewalk results", result_bytes, Usage::STORAGE | Usage::COPY_DST | Usage::COPY_SRC);
        let readback =
            buffer("ropewalk readback", result_bytes + TIMESTAMP_BYTES, Usage::MAP_READ | Usage::COPY_DST);
        let uniform =
            buffer("ropewalk batch", size_of::<BatchUniform>() as u64, Usage::UNIFORM | Usage::COPY_DST);
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("ropewalk batch"),
            layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: rays.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: results.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: uniform.as_entire_binding() },
            ],
        });
        Self { ray_bytes, result_bytes, rays, results, readback, uniform, bind_group, clock: Clock::new(gpu) }
    }
}

/// A tile under way.
pub(super) struct Tile {
    made: Made,
    result_bytes: u64,
    submission: wgpu::SubmissionIndex,
    mapped: mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
}

impl Tile {
    /// Sends a tile to the device.
    pub(super) fn submit(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        buffers: TileBuffers,
        pipeline: &wgpu::ComputePipeline,
        structure: &GpuStructure,
        uniform: BatchUniform,
        job: &Job<'_>,
    ) -> Result<Self, GpuError> {
        let ray_bytes = size_of_val(&*job.rays) as u64;
        let result_bytes = (job.result_words * size_of::<u32>()) as u64;
        let bytes = ray_bytes + 2 * result_bytes;
        let made = match buffers.made {
            Some(made) if made.ray_bytes >= ray_bytes && made.result_bytes >= result_bytes => made,
            smaller => {
                let seen = smaller.map_or((0, 0), |made| (made.ray_bytes, made.result_bytes));
                let (ray_bytes, result_bytes) = (seen.0.max(ray_bytes), seen.1.max(result_bytes));
                scoped(gpu.device(), "the buffers of a batch", bytes, || {
                    Made::new(gpu, layout, ray_bytes, result_bytes)
                })?
            }
        };
        let (sender, mapped) = mpsc::channel();
        let submission = scoped(gpu.device(), "a batch", bytes, || {
            gpu.queue().write_buffer(&made.rays, 0, bytemuck::cast_slice(&job.rays));
            gpu.queue().write_buffer(&made.uniform, 0, bytemuck::bytes_of(&uniform));
            let label = Some("ropewalk batch");
            let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
            encoder.clear_buffer(&made.results, 0, Some(result_bytes));
            {
                let timestamp_writes = made.clock.as_ref().map(Clock::writes);
                let mut pass =
                    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label, timestamp_writes });
                pass.set_pipeline(pipeline);
                pass.set_bind_group(STRUCTURE_GROUP, structure.bind_group(), &[]);
                pass.set_bind_group(BATCH_GROUP, &made.bind_group, &[]);
                pass.dispatch_workgroups(job.ray_count.div_ceil(crate::gpu::WORKGROUP_SIZE), 1, 1);
            }
            encoder.copy_buffer_to_buffer(&made.results, 0, &made.readback, 0, result_bytes);
            if let Some(clock) = &made.clock {
                clock.read_out(&mut encoder, &made.readback, result_bytes);
            }
            let submission = gpu.queue().submit([encoder.finish()]);
            made.readback.slice(..result_bytes + TIMESTAMP_BYTES).map_async(
                wgpu::MapMode::Read,
                move |mapped| {
                    // Nobody listens any more when the tile was dropped.
                    let _ = sender.send(mapped);
                },
            );
            submission
        })?;
        Ok(Self { made, result_bytes, submission, mapped })
    }

    /// Waits for the tile, hands its words to `read`, and gives back its buffers and the time the kernel ran.
    pub(super) fn finish(
        self,
        gpu: &Gpu,
        read: impl FnOnce(&[u32]) -> Result<(), GpuError>,
    ) -> Result<(Option<Duration>, TileBuffers), GpuError> {
        await_mapped(gpu, &self.submission, &self.mapped)?;
        let range = self.made.readback.slice(..self.result_bytes + TIMESTAMP_BYTES);
        let time = {
            let view = range.get_mapped_range().map_err(|error| GpuError::Refused {
                what: "reading results back",
                reason: error.to_string(),
            })?;
            let (results, stamps) = view.split_at(self.result_bytes as usize);
            read(bytemuck::cast_slice(results))?;
            self.made.clock.as_ref().map(|_| Clock::between(gpu, stamps))
        };
        self.made.readback.unmap();
        Ok((time, TileBuffers { made: Some(self.made) }))
    }
}

/// Waits for a submission and for the news that its results can be read.
pub(super) fn await_mapped(
    gpu: &Gpu,
    submission: &wgpu::SubmissionIndex,
    mapped: &mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
) -> Result<(), GpuError> {
    gpu.poll(wgpu::PollType::Wait { submission_index: Some(submission.clone()), timeout: None })?;
    // The tile is done. Where another thread polls the same device at the same time, it may have taken the
    // news of it along and be about to deliver it.
    let done = Instant::now();
    loop {
        match mapped.recv_timeout(Duration::from_millis(1)) {
            Ok(Ok(())) => return Ok(()),
            Err(RecvTimeoutError::Timeout) if done.elapsed() < NEWS_TIMEOUT => {
                gpu.poll(wgpu::PollType::Poll)?;
            }
            Ok(Err(_)) | Err(_) => {
                return Err(GpuError::DeviceLost("its results cannot be read back".into()));
            }
        }
    }
}
