//! The node of a binary BVH: 32 bytes, eight little-endian words, the same on the CPU, the GPU and in a file.
//!
//! Nodes lie in depth-first order. A node's first child is the next node; its second child is `link`.

use crate::Aabb;
use bytemuck::{Pod, Zeroable};
use glam::Vec4;

/// An inner node or a leaf.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Node {
    /// The smallest corner of the box.
    pub min: [f32; 3],
    /// Inner: the index of the second child. Leaf: the index of the first triangle.
    pub link: u32,
    /// The largest corner of the box.
    pub max: [f32; 3],
    /// Inner: 0. Leaf: the number of triangles.
    pub count: u32,
}

impl Node {
    /// A leaf over `count` triangles from `first` on.
    #[must_use]
    pub fn leaf(bounds: &Aabb, first: u32, count: u32) -> Self {
        debug_assert!(count > 0);
        Self { min: bounds.min.into(), link: first, max: bounds.max.into(), count }
    }

    /// An inner node, stored just before its first child, with its second child at `second`.
    #[must_use]
    pub fn inner(bounds: &Aabb, second: u32) -> Self {
        Self { min: bounds.min.into(), link: second, max: bounds.max.into(), count: 0 }
    }

    /// Whether the node has triangles and no children.
    #[inline(always)]
    #[must_use]
    pub const fn is_leaf(&self) -> bool {
        self.count != 0
    }

    /// The box.
    #[inline]
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::new(self.min.into(), self.max.into())
    }

    /// The corners as vectors, in two loads of 16 bytes. The fourth lanes are `link` and `count`.
    #[inline(always)]
    #[must_use]
    pub fn corners(&self) -> [Vec4; 2] {
        bytemuck::cast(*self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_node_is_32_bytes() {
        assert_eq!((size_of::<Node>(), align_of::<Node>()), (32, 16));
        let node = Node::inner(&Aabb::new(Vec3::ZERO, Vec3::ONE), 7);
        let words: [u32; 8] = bytemuck::cast(node);
        assert_eq!(words, [0, 0, 0, 7, 0x3f80_0000, 0x3f80_0000, 0x3f80_0000, 0]);
        assert_eq!(node.corners().map(Vec4::truncate), [Vec3::ZERO, Vec3::ONE]);
    }
}
