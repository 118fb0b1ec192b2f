//! A structure in the buffers of a device.

use crate::scope::scoped;
use crate::{Gpu, GpuError};
use ropewalk::{CatalogueError, Structure};
use std::sync::Arc;

/// Bytes that are handed to wgpu at a time: it keeps a copy of each piece until the device has it.
const PIECE: usize = 64 << 20;

/// A structure that was uploaded. Clones share its buffers.
#[derive(Clone, Debug)]
pub struct GpuStructure {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    gpu: Gpu,
    bind_group: wgpu::BindGroup,
    node_count: u32,
    depth: u32,
    bytes: u64,
}

impl GpuStructure {
    pub(super) fn upload(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        structure: &Structure,
    ) -> Result<Self, GpuError> {
        let Structure::Bvh(bvh) = structure else {
            let text = "this structure has no walk on a graphics adapter; trace it on the device cpu";
            return Err(GpuError::Catalogue(CatalogueError(text.into())));
        };
        let nodes = storage(gpu, "nodes of the structure", bytemuck::cast_slice(bvh.nodes()), 32)?;
        let triangles =
            storage(gpu, "triangles of the structure", bytemuck::cast_slice(bvh.triangles()), 48)?;
        let bytes = nodes.size() + triangles.size();
        let bind_group = scoped(gpu.device(), "the bindings of a structure", 0, || {
            gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("ropewalk structure"),
                layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: nodes.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: triangles.as_entire_binding() },
                ],
            })
        })?;
        // A tree has fewer than 2^32 nodes: links are 32 bits.
        let node_count = bvh.nodes().len() as u32;
        let depth = bvh.report().depth;
        Ok(Self { inner: Arc::new(Inner { gpu: gpu.clone(), bind_group, node_count, depth, bytes }) })
    }

    /// Bytes on the device.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.inner.bytes
    }

    pub(super) fn gpu(&self) -> &Gpu {
        &self.inner.gpu
    }

    pub(super) fn bind_group(&self) -> &wgpu::BindGroup {
        &self.inner.bind_group
    }

    pub(super) fn node_count(&self) -> u32 {
        self.inner.node_count
    }

    pub(super) fn depth(&self) -> u32 {
        self.inner.depth
    }
}

/// A storage buffer with these bytes. No buffer may be empty, so one for nothing holds one zero record.
fn storage(gpu: &Gpu, what: &'static str, content: &[u8], record: u64) -> Result<wgpu::Buffer, GpuError> {
    let needed = (content.len() as u64).max(record);
    let limits = gpu.device().limits();
    for (limit_name, limit) in [
        ("max_storage_buffer_binding_size", limits.max_storage_buffer_binding_size),
        ("max_buffer_size", limits.max_buffer_size),
    ] {
        if needed > limit {
            let way_out = "trace on the CPU, build with larger leaves (bvh:max-leaf=8), or split the scene";
            return Err(GpuError::TooLarge { what, needed, limit, limit_name, way_out });
        }
    }
    scoped(gpu.device(), what, needed, || {
        gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some(what),
            size: needed,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    })
    .and_then(|buffer| {
        scoped(gpu.device(), what, needed, || {
            for (index, piece) in content.chunks(PIECE).enumerate() {
                gpu.queue().write_buffer(&buffer, (index * PIECE) as u64, piece);
                // Sends the piece off, so that its copy can be dropped.
                gpu.queue().submit([]);
            }
            buffer
        })
    })
}
