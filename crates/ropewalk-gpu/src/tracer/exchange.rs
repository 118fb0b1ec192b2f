//! The buffers through which a kernel gets its records and gives its results, and one submission under way: what batches
//! ([`super::tile`]) and callers' programs ([`super::program`]) share.

use super::GpuStructure;
use crate::shader::{BATCH_GROUP, STRUCTURE_GROUP};
use crate::{Gpu, GpuError};
use bytemuck::{Pod, Zeroable};
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

/// Records in, results out. The results can be read back with the timestamps behind them.
#[derive(Debug)]
pub(super) struct Exchange {
    records: wgpu::Buffer,
    results: wgpu::Buffer,
    /// The results, then the timestamps.
    readback: wgpu::Buffer,
    uniform: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    clock: Option<Clock>,
}

impl Exchange {
    /// Buffers for so many bytes of records and of results. To be called in a scope that catches what the device refuses.
    pub(super) fn new(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        record_bytes: u64,
        result_bytes: u64,
    ) -> Self {
        use wgpu::BufferUsages as Usage;
        let device = gpu.device();
        let buffer = |label, size, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let records = buffer("ropewalk records", record_bytes, Usage::STORAGE | Usage::COPY_DST);
        let results =
            buffer("ropewalk results", result_bytes, Usage::STORAGE | Usage::COPY_DST | Usage::COPY_SRC);
        let readback =
            buffer("ropewalk readback", result_bytes + TIMESTAMP_BYTES, Usage::MAP_READ | Usage::COPY_DST);
        let uniform =
            buffer("ropewalk batch", size_of::<BatchUniform>() as u64, Usage::UNIFORM | Usage::COPY_DST);
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("ropewalk batch"),
            layout,
            entries: &[entry(0, &records), entry(1, &results), entry(2, &uniform)],
        });
        Self { records, results, readback, uniform, bind_group, clock: Clock::new(gpu) }
    }

    /// Writes the records and numbers of what is submitted next. In a scope, as [`Exchange::new`].
    pub(super) fn load(&self, gpu: &Gpu, records: &[u32], uniform: BatchUniform) {
        gpu.queue().write_buffer(&self.records, 0, bytemuck::cast_slice(records));
        gpu.queue().write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
    }

    /// Sends one pass of a kernel to the device. With `clears` the results are zeroed before. In a scope, as
    /// [`Exchange::new`].
    pub(super) fn submit(
        &self,
        gpu: &Gpu,
        pipeline: &wgpu::ComputePipeline,
        structure: &GpuStructure,
        result_bytes: u64,
        clears: bool,
        dispatch: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) -> Pending {
        let (sender, mapped) = mpsc::channel();
        let label = Some("ropewalk batch");
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        if clears {
            encoder.clear_buffer(&self.results, 0, Some(result_bytes));
        }
        {
            let timestamp_writes = self.clock.as_ref().map(Clock::writes);
            let mut pass =
                encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label, timestamp_writes });
            pass.set_pipeline(pipeline);
            pass.set_bind_group(STRUCTURE_GROUP, structure.bind_group(), &[]);
            pass.set_bind_group(BATCH_GROUP, &self.bind_group, &[]);
            dispatch(&mut pass);
        }
        encoder.copy_buffer_to_buffer(&self.results, 0, &self.readback, 0, result_bytes);
        if let Some(clock) = &self.clock {
            clock.read_out(&mut encoder, &self.readback, result_bytes);
        }
        let submission = gpu.queue().submit([encoder.finish()]);
        let range = self.readback.slice(..result_bytes + TIMESTAMP_BYTES);
        range.map_async(wgpu::MapMode::Read, move |mapped| {
            // Nobody listens any more when what was submitted has been dropped.
            let _ = sender.send(mapped);
        });
        Pending { result_bytes, submission, mapped }
    }
}

/// A submission under way.
pub(super) struct Pending {
    result_bytes: u64,
    submission: wgpu::SubmissionIndex,
    mapped: mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
}

impl Pending {
    /// Waits for it, hands the words of its results to `read`, and gives back the time that the kernel ran. The exchange is the
    /// one that it was submitted through.
    pub(super) fn finish(
        self,
        gpu: &Gpu,
        exchange: &Exchange,
        read: impl FnOnce(&[u32]) -> Result<(), GpuError>,
    ) -> Result<Option<Duration>, GpuError> {
        await_mapped(gpu, &self.submission, &self.mapped)?;
        let range = exchange.readback.slice(..self.result_bytes + TIMESTAMP_BYTES);
        let time = {
            let view = range.get_mapped_range().map_err(|error| GpuError::Refused {
                what: "reading results back",
                reason: error.to_string(),
            })?;
            let (results, stamps) = view.split_at(self.result_bytes as usize);
            read(bytemuck::cast_slice(results))?;
            exchange.clock.as_ref().map(|_| Clock::between(gpu, stamps))
        };
        exchange.readback.unmap();
        Ok(time)
    }
}

/// A whole buffer, bound.
pub(super) fn entry(binding: u32, buffer: &wgpu::Buffer) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }
}

/// Measures the time between the beginning and the end of a pass.
#[derive(Debug)]
struct Clock {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
}

impl Clock {
    /// A clock, where the device has any.
    fn new(gpu: &Gpu) -> Option<Self> {
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
    const fn writes(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Copies both times to a place of a buffer.
    fn read_out(&self, encoder: &mut wgpu::CommandEncoder, buffer: &wgpu::Buffer, at: u64) {
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, buffer, at, TIMESTAMP_BYTES);
    }

    /// The time between both.
    fn between(gpu: &Gpu, stamps: &[u8]) -> Duration {
        let [begin, end]: [u64; 2] = bytemuck::pod_read_unaligned(stamps);
        let ticks = end.saturating_sub(begin);
        Duration::from_nanos((ticks as f64 * f64::from(gpu.queue().get_timestamp_period())) as u64)
    }
}

/// Waits for a submission and for the news that its results can be read.
fn await_mapped(
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
