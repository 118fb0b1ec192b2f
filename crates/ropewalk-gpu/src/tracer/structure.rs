//! A structure in the buffers of a device.

use crate::scope::scoped;
use crate::shader::Tree;
use crate::{Gpu, GpuError};
use ropewalk::bvh::Node;
use ropewalk::{BuildReport, CatalogueError, Structure, Walk};
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
    bytes: u64,
    shape: Shape,
}

/// What kernels and budgets depend on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// How the nodes are laid out.
    pub(super) tree: Tree,
    /// Binary nodes, or wide ones.
    pub(super) node_count: u32,
    /// The depth of the deepest leaf, as the structure's report has it.
    pub(super) depth: u32,
    /// The most entries that the stack of a stack walk can hold.
    pub(super) stack_entries: u32,
    /// Whether a triangle may stand in several leaves.
    pub(super) has_repeats: bool,
    /// Nodes and leaves that a walk with a full stack can enter, each once.
    entered: u64,
    /// Leaves.
    leaves: u64,
}

impl Shape {
    fn new(tree: Tree, structure: &Structure, node_count: usize, stack_entries: u32) -> Self {
        let &BuildReport { nodes, leaves, depth, .. } = structure.report();
        Self {
            tree,
            // A tree has fewer than 2^32 nodes: links are 32 bits.
            node_count: node_count as u32,
            depth,
            stack_entries,
            has_repeats: structure.has_repeats(),
            entered: nodes as u64,
            leaves: leaves as u64,
        }
    }

    /// Steps that no ray uses up, a step being a node or leaf that is entered.
    ///
    /// A walk with a full stack enters each once. A restart trail goes down from the root or from an entry of its stack
    /// again and again. Each way down is no longer than the longest path, and ends with a leaf that the walk is done with
    /// for good: so there are no more ways down than leaves. With spatial splits a triangle may be hit in front of the
    /// leaf that it was found in, which then culls a node that the walk is in; in a binary tree the trail cannot tell,
    /// and leads through that node's sibling again, at worst once for each node above a leaf.
    ///
    /// Where that is more than a word holds, a ray would take minutes to count so far, and no driver waits so long.
    pub(super) fn step_budget(&self, walk: Walk) -> u32 {
        let path = u64::from(self.depth) + 1;
        let steps = match (walk, self.tree) {
            (Walk::RestartTrail(_), Tree::Binary) if self.has_repeats => {
                self.leaves.saturating_mul(path).saturating_mul(path)
            }
            (Walk::RestartTrail(_), _) => self.leaves.saturating_mul(path),
            _ => self.entered,
        };
        u32::try_from(steps).unwrap_or(u32::MAX)
    }
}

impl GpuStructure {
    pub(super) fn upload(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        structure: &Structure,
    ) -> Result<Self, GpuError> {
        let (nodes, shape): (&[Node], Shape) = match structure {
            Structure::Bvh(bvh) => {
                // One child a level is postponed.
                let stack_entries = bvh.report().depth;
                (bvh.nodes(), Shape::new(Tree::Binary, structure, bvh.nodes().len(), stack_entries))
            }
            Structure::WideBvh(bvh) => {
                let nodes = bvh.children().len() / bvh.width().children();
                let shape = Shape::new(Tree::Wide(bvh.width()), structure, nodes, bvh.stack_entries());
                (bvh.children(), shape)
            }
            _ => {
                let text = "this structure has no walk on a graphics adapter; trace it on the device cpu";
                return Err(GpuError::Catalogue(CatalogueError(text.into())));
            }
        };
        let nodes = storage(gpu, "nodes of the structure", bytemuck::cast_slice(nodes), 32)?;
        let triangles = structure.triangles();
        let triangles = storage(gpu, "triangles of the structure", bytemuck::cast_slice(&triangles), 48)?;
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
        Ok(Self { inner: Arc::new(Inner { gpu: gpu.clone(), bind_group, bytes, shape }) })
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

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::wide_bvh::Width;

    #[test]
    fn budgets_grow_with_the_tree_and_end_at_the_largest_word() {
        let shape = Shape {
            tree: Tree::Binary,
            node_count: 9,
            depth: 3,
            stack_entries: 3,
            has_repeats: false,
            entered: 9,
            leaves: 5,
        };
        let trail = "restart-trail".parse().unwrap();
        assert_eq!([shape.step_budget(Walk::default()), shape.step_budget(trail)], [9, 20]);
        let repeats = Shape { has_repeats: true, ..shape };
        assert_eq!([repeats.step_budget(Walk::default()), repeats.step_budget(trail)], [9, 80]);
        let wide = Shape { tree: Tree::Wide(Width::Four), ..repeats };
        assert_eq!(wide.step_budget(trail), 20);
        let large = Shape { leaves: 1 << 31, entered: (1 << 32) - 1, depth: 64, ..repeats };
        assert_eq!([large.step_budget(Walk::default()), large.step_budget(trail)], [u32::MAX; 2]);
        let empty = Shape { leaves: 0, entered: 0, node_count: 0, depth: 0, ..shape };
        assert_eq!(empty.step_budget(trail), 0, "there is nothing to enter");
    }
}
