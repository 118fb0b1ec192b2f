//! A tile of a batch: its buffers, its submission, and reading its results back.

use super::GpuStructure;
use super::exchange::{BatchUniform, Exchange, Pending};
use crate::scope::scoped;
use crate::{Gpu, GpuError};
use std::borrow::Cow;
use std::time::Duration;

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
    exchange: Exchange,
}

impl TileBuffers {
    /// Bytes of results that they have room for.
    pub(super) fn result_bytes(&self) -> u64 {
        self.made.as_ref().map_or(0, |made| made.result_bytes)
    }
}

/// A tile under way.
pub(super) struct Tile {
    made: Made,
    pending: Pending,
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
                    let exchange = Exchange::new(gpu, layout, ray_bytes, result_bytes);
                    Made { ray_bytes, result_bytes, exchange }
                })?
            }
        };
        let groups = job.ray_count.div_ceil(crate::gpu::WORKGROUP_SIZE);
        let pending = scoped(gpu.device(), "a batch", bytes, || {
            made.exchange.load(gpu, &job.rays, uniform);
            made.exchange.submit(gpu, pipeline, structure, result_bytes, true, |pass| {
                pass.dispatch_workgroups(groups, 1, 1);
            })
        })?;
        Ok(Self { made, pending })
    }

    /// Waits for the tile, hands its words to `read`, and gives back its buffers and the time the kernel ran.
    pub(super) fn finish(
        self,
        gpu: &Gpu,
        read: impl FnOnce(&[u32]) -> Result<(), GpuError>,
    ) -> Result<(Option<Duration>, TileBuffers), GpuError> {
        let time = self.pending.finish(gpu, &self.made.exchange, read)?;
        Ok((time, TileBuffers { made: Some(self.made) }))
    }
}
