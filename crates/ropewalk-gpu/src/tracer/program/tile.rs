//! A tile of a program's items: its buffers, its submissions, and reading its results back.

use super::{DISPATCHES, Tables};
use crate::scope::scoped;
use crate::shader::{BATCH_GROUP, PROGRAM_GROUP, STRUCTURE_GROUP};
use crate::tracer::GpuStructure;
use crate::tracer::tile::{BatchUniform, Clock, TIMESTAMP_BYTES, await_mapped};
use crate::{Gpu, GpuError};
use std::sync::mpsc;
use std::time::Duration;

/// The buffers of a tile.
pub(super) struct Buffers {
    items: wgpu::Buffer,
    results: wgpu::Buffer,
    /// The results, then the timestamps.
    readback: wgpu::Buffer,
    uniform: wgpu::Buffer,
    batch: wgpu::BindGroup,
    program: wgpu::BindGroup,
    clock: Option<Clock>,
}

impl Buffers {
    /// Buffers for so many bytes of items, of results and of scratch, with the layouts of a batch and of a program.
    pub(super) fn new(
        gpu: &Gpu,
        [batch_layout, program_layout]: [&wgpu::BindGroupLayout; 2],
        tables: &Tables,
        [item_bytes, result_bytes, scratch_bytes]: [u64; 3],
    ) -> Result<Self, GpuError> {
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
        let bytes = item_bytes + 2 * result_bytes + scratch_bytes;
        scoped(device, "the buffers of a program", bytes, || {
            let items = buffer("ropewalk items", item_bytes, Usage::STORAGE | Usage::COPY_DST);
            let results =
                buffer("ropewalk results", result_bytes, Usage::STORAGE | Usage::COPY_DST | Usage::COPY_SRC);
            let scratch = buffer("ropewalk scratch", scratch_bytes, Usage::STORAGE);
            let readback = buffer(
                "ropewalk readback",
                result_bytes + TIMESTAMP_BYTES,
                Usage::MAP_READ | Usage::COPY_DST,
            );
            let uniform =
                buffer("ropewalk batch", size_of::<BatchUniform>() as u64, Usage::UNIFORM | Usage::COPY_DST);
            let batch = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("ropewalk batch"),
                layout: batch_layout,
                entries: &[entry(0, &items), entry(1, &results), entry(2, &uniform)],
            });
            let [a, b] = tables.buffers();
            let program = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("ropewalk program"),
                layout: program_layout,
                entries: &[entry(0, a), entry(1, b), entry(2, &scratch)],
            });
            Self { items, results, readback, uniform, batch, program, clock: Clock::new(gpu) }
        })
    }

    /// Writes the items of a tile and its numbers.
    pub(super) fn load(&self, gpu: &Gpu, words: &[u32], uniform: BatchUniform) -> Result<(), GpuError> {
        scoped(gpu.device(), "the items of a program", size_of_val(words) as u64, || {
            gpu.queue().write_buffer(&self.items, 0, bytemuck::cast_slice(words));
            gpu.queue().write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        })
    }
}

/// A tile under way.
pub(super) struct Tile {
    buffers: Buffers,
    result_bytes: u64,
    submission: wgpu::SubmissionIndex,
    mapped: mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
}

impl Tile {
    /// Sends some dispatches to the device: the first of a tile, whose results are zeroed before, or further ones.
    pub(super) fn submit(
        gpu: &Gpu,
        buffers: Buffers,
        pipeline: &wgpu::ComputePipeline,
        structure: &GpuStructure,
        count: usize,
        stored_words: usize,
        is_first: bool,
    ) -> Result<Self, GpuError> {
        let result_bytes = (count * stored_words * size_of::<u32>()) as u64;
        let groups = (count as u32).div_ceil(crate::gpu::WORKGROUP_SIZE);
        let (sender, mapped) = mpsc::channel();
        let submission = scoped(gpu.device(), "a program", result_bytes, || {
            let label = Some("ropewalk program");
            let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
            if is_first {
                encoder.clear_buffer(&buffers.results, 0, Some(result_bytes));
            }
            {
                let timestamp_writes = buffers.clock.as_ref().map(Clock::writes);
                let mut pass =
                    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label, timestamp_writes });
                pass.set_pipeline(pipeline);
                pass.set_bind_group(STRUCTURE_GROUP, structure.bind_group(), &[]);
                pass.set_bind_group(BATCH_GROUP, &buffers.batch, &[]);
                pass.set_bind_group(PROGRAM_GROUP, &buffers.program, &[]);
                for _ in 0..DISPATCHES {
                    pass.dispatch_workgroups(groups, 1, 1);
                }
            }
            encoder.copy_buffer_to_buffer(&buffers.results, 0, &buffers.readback, 0, result_bytes);
            if let Some(clock) = &buffers.clock {
                clock.read_out(&mut encoder, &buffers.readback, result_bytes);
            }
            let submission = gpu.queue().submit([encoder.finish()]);
            let range = buffers.readback.slice(..result_bytes + TIMESTAMP_BYTES);
            range.map_async(wgpu::MapMode::Read, move |mapped| {
                // Nobody listens any more when the tile was dropped.
                let _ = sender.send(mapped);
            });
            submission
        })?;
        Ok(Self { buffers, result_bytes, submission, mapped })
    }

    /// Waits for the dispatches, hands the words of the results to `read`, and gives back the buffers and the time that the
    /// kernel ran.
    pub(super) fn finish(
        self,
        gpu: &Gpu,
        read: impl FnOnce(&[u32]) -> Result<(), GpuError>,
    ) -> Result<(Option<Duration>, Buffers), GpuError> {
        await_mapped(gpu, &self.submission, &self.mapped)?;
        let range = self.buffers.readback.slice(..self.result_bytes + TIMESTAMP_BYTES);
        let time = {
            let view = range.get_mapped_range().map_err(|error| GpuError::Refused {
                what: "reading results back",
                reason: error.to_string(),
            })?;
            let (results, stamps) = view.split_at(self.result_bytes as usize);
            read(bytemuck::cast_slice(results))?;
            self.buffers.clock.as_ref().map(|_| Clock::between(gpu, stamps))
        };
        self.buffers.readback.unmap();
        Ok((time, self.buffers))
    }
}

/// A whole buffer, bound.
fn entry(binding: u32, buffer: &wgpu::Buffer) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }
}
