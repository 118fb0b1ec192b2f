//! A structure in the buffers of a device.

use super::content::{Bytes, Content};
use super::shape::Shape;
use super::starts::Lists;
use crate::scope::scoped;
use crate::{Gpu, GpuError};
use ropewalk::Structure;
use std::sync::Arc;

/// Bytes that are handed to wgpu at a time: it keeps a copy of each piece until the device has it.
pub(super) const PIECE: usize = 64 << 20;

/// A structure that was uploaded. Clones share its buffers.
#[derive(Clone, Debug)]
pub struct GpuStructure {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    gpu: Gpu,
    bind_group: wgpu::BindGroup,
    bytes: u64,
    shape: Shape,
    lists: Option<Lists>,
}

/// The two buffers of a structure, and what kernels bind.
#[derive(Clone, Debug)]
pub(super) struct Buffers {
    pub(super) nodes: wgpu::Buffer,
    pub(super) triangles: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
}

impl Buffers {
    /// Buffers with room for a content, and some more where `spare` says how much, as far as the device allows it. Nothing
    /// is in them yet.
    pub(super) fn new(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        content: &Content<'_>,
        spare: impl Fn(u64) -> u64,
    ) -> Result<Self, GpuError> {
        let nodes = buffer(gpu, &content.nodes, &spare)?;
        let triangles = buffer(gpu, &content.triangles, &spare)?;
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
        Ok(Self { nodes, triangles, bind_group })
    }

    /// Whether a content fits.
    pub(super) fn hold(&self, content: &Content<'_>) -> bool {
        self.nodes.size() >= content.nodes.len() && self.triangles.size() >= content.triangles.len()
    }
}

impl GpuStructure {
    pub(super) fn upload(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        structure: &Structure,
    ) -> Result<Self, GpuError> {
        let content = Content::of(structure, room(gpu))?;
        let buffers = Buffers::new(gpu, layout, &content, |_| 0)?;
        fill(gpu, &buffers.nodes, &content.nodes)?;
        fill(gpu, &buffers.triangles, &content.triangles)?;
        Ok(Self::new(gpu, &buffers, content.shape, structure))
    }

    /// A structure that is in these buffers.
    pub(super) fn new(gpu: &Gpu, buffers: &Buffers, shape: Shape, structure: &Structure) -> Self {
        let lists = match structure {
            Structure::List(lists) => Some(Lists::of(lists)),
            _ => None,
        };
        let bytes = buffers.nodes.size() + buffers.triangles.size();
        let bind_group = buffers.bind_group.clone();
        Self { inner: Arc::new(Inner { gpu: gpu.clone(), bind_group, bytes, shape, lists }) }
    }

    /// Bytes of the two buffers that a structure needs on a device: of nodes or elements, and of triangles or vertices.
    ///
    /// # Errors
    /// When there is no walk of it on a graphics adapter.
    pub fn bytes_needed(structure: &Structure) -> Result<[u64; 2], GpuError> {
        let content = Content::of(structure, u64::MAX)?;
        Ok([content.nodes.len(), content.triangles.len()])
    }

    /// Whether this is the only handle.
    pub(super) fn is_unshared(&self) -> bool {
        Arc::strong_count(&self.inner) == 1
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

    pub(super) fn shape(&self) -> &Shape {
        &self.inner.shape
    }

    /// Where its lists begin, where it is any.
    pub(super) fn lists(&self) -> Option<&Lists> {
        self.inner.lists.as_ref()
    }
}

/// The most bytes that a storage buffer of the device may have.
pub(super) fn room(gpu: &Gpu) -> u64 {
    let limits = gpu.device().limits();
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
}

/// A storage buffer with room for these bytes, and some to spare.
fn buffer(gpu: &Gpu, bytes: &Bytes<'_>, spare: impl Fn(u64) -> u64) -> Result<wgpu::Buffer, GpuError> {
    let Bytes { what, way_out, most, .. } = *bytes;
    let needed = bytes.len();
    let limits = gpu.device().limits();
    let mut size = needed.saturating_add(spare(needed)).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
    for (limit_name, limit) in [
        ("max_storage_buffer_binding_size", limits.max_storage_buffer_binding_size),
        ("max_buffer_size", limits.max_buffer_size),
        ("words that 32 bits count", most),
    ] {
        if needed > limit {
            return Err(GpuError::TooLarge { what, needed, limit, limit_name, way_out });
        }
        if size > limit {
            size = needed;
        }
    }
    scoped(gpu.device(), what, size, || {
        gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some(what),
            size,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    })
}

/// Writes all of a buffer's content.
fn fill(gpu: &Gpu, buffer: &wgpu::Buffer, bytes: &Bytes<'_>) -> Result<(), GpuError> {
    scoped(gpu.device(), bytes.what, bytes.len(), || {
        let mut at = 0;
        for piece in bytes.pieces.iter().flat_map(|piece| piece.chunks(PIECE)) {
            gpu.queue().write_buffer(buffer, at, piece);
            at += piece.len() as u64;
            // Sends the piece off, so that its copy can be dropped.
            gpu.queue().submit([]);
        }
    })
}
