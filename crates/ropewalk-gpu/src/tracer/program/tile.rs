//! A tile of a program's items: its buffers, its submissions, and reading its results back.

use super::{DISPATCHES, Tables};
use crate::scope::scoped;
use crate::shader::PROGRAM_GROUP;
use crate::tracer::GpuStructure;
use crate::tracer::exchange::{BatchUniform, Exchange, Pending, entry};
use crate::{Gpu, GpuError};
use std::time::Duration;

/// The buffers of a tile.
pub(super) struct Buffers {
    exchange: Exchange,
    program: wgpu::BindGroup,
}

impl Buffers {
    /// Buffers for so many bytes of items, of results and of scratch, with the layouts of a batch and of a program.
    pub(super) fn new(
        gpu: &Gpu,
        [batch_layout, program_layout]: [&wgpu::BindGroupLayout; 2],
        tables: &Tables,
        [item_bytes, result_bytes, scratch_bytes]: [u64; 3],
    ) -> Result<Self, GpuError> {
        let bytes = item_bytes + 2 * result_bytes + scratch_bytes;
        scoped(gpu.device(), "the buffers of a program", bytes, || {
            let exchange = Exchange::new(gpu, batch_layout, item_bytes, result_bytes);
            let scratch = gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some("ropewalk scratch"),
                size: scratch_bytes,
                usage: wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            });
            let [a, b] = tables.buffers();
            let program = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("ropewalk program"),
                layout: program_layout,
                entries: &[entry(0, a), entry(1, b), entry(2, &scratch)],
            });
            Self { exchange, program }
        })
    }

    /// Writes the items of a tile and its numbers.
    pub(super) fn load(&self, gpu: &Gpu, words: &[u32], uniform: BatchUniform) -> Result<(), GpuError> {
        scoped(gpu.device(), "the items of a program", size_of_val(words) as u64, || {
            self.exchange.load(gpu, words, uniform);
        })
    }
}

/// A tile under way.
pub(super) struct Tile {
    buffers: Buffers,
    pending: Pending,
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
        let pending = scoped(gpu.device(), "a program", result_bytes, || {
            buffers.exchange.submit(gpu, pipeline, structure, result_bytes, is_first, |pass| {
                pass.set_bind_group(PROGRAM_GROUP, &buffers.program, &[]);
                for _ in 0..DISPATCHES {
                    pass.dispatch_workgroups(groups, 1, 1);
                }
            })
        })?;
        Ok(Self { buffers, pending })
    }

    /// Waits for the dispatches, hands the words of the results to `read`, and gives back the buffers and the time that the
    /// kernel ran.
    pub(super) fn finish(
        self,
        gpu: &Gpu,
        read: impl FnOnce(&[u32]) -> Result<(), GpuError>,
    ) -> Result<(Option<Duration>, Buffers), GpuError> {
        let time = self.pending.finish(gpu, &self.buffers.exchange, read)?;
        Ok((time, self.buffers))
    }
}
