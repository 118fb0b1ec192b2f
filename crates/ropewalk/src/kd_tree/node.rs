//! The node of a kd-tree: 8 bytes, two little-endian words, the same on the CPU, the GPU and in a file (Wald 2004).
//!
//! Nodes lie in depth-first order. The lower child is the next node; the upper one is named.
//!
//! | | word 0 | word 1, low 2 bits | word 1, 30 bits above |
//! |---|---|---|---|
//! | inner | the split, bits of a f32 | the axis: 0, 1, 2 | index of the upper child |
//! | leaf | index of the first reference | 3 | number of references |

use bytemuck::{Pod, Zeroable};

/// An inner node or a leaf.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct KdNode {
    /// Inner: the bits of the split. Leaf: the index of the first reference.
    pub split_or_first: u32,
    /// The axis, or [`KdNode::LEAF`], in the low two bits. Above them the index of the upper child, or the number of
    /// references.
    pub axis_and_link: u32,
}

impl KdNode {
    /// The axis of a leaf.
    pub const LEAF: u32 = 3;
    /// What 30 bits count: nodes, and references of one leaf, are fewer.
    pub const LIMIT: usize = 1 << 30;

    /// A leaf over `count` references, fewer than [`KdNode::LIMIT`], from `first` on.
    #[must_use]
    pub const fn leaf(first: u32, count: u32) -> Self {
        Self { split_or_first: first, axis_and_link: count << 2 | Self::LEAF }
    }

    /// A node that a plane across `axis` splits, stored just before its lower child, with its upper child at `upper`,
    /// less than [`KdNode::LIMIT`].
    #[must_use]
    pub const fn inner(axis: usize, split: f32, upper: u32) -> Self {
        Self { split_or_first: split.to_bits(), axis_and_link: upper << 2 | (axis as u32 & 3) }
    }

    /// Whether the node has references and no children.
    #[inline(always)]
    #[must_use]
    pub const fn is_leaf(&self) -> bool {
        self.axis_and_link & 3 == Self::LEAF
    }

    /// The axis of the plane of an inner node; 3 for a leaf.
    #[inline(always)]
    #[must_use]
    pub const fn axis(&self) -> usize {
        (self.axis_and_link & 3) as usize
    }

    /// Where the plane of an inner node lies.
    #[inline(always)]
    #[must_use]
    pub const fn split(&self) -> f32 {
        f32::from_bits(self.split_or_first)
    }

    /// The index of the upper child of an inner node.
    #[inline(always)]
    #[must_use]
    pub const fn upper(&self) -> u32 {
        self.axis_and_link >> 2
    }

    /// The index of the first reference of a leaf.
    #[inline(always)]
    #[must_use]
    pub const fn first(&self) -> u32 {
        self.split_or_first
    }

    /// The number of references of a leaf; it may be none.
    #[inline(always)]
    #[must_use]
    pub const fn count(&self) -> u32 {
        self.axis_and_link >> 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_is_8_bytes() {
        assert_eq!(size_of::<KdNode>(), 8);
        let words: [u32; 2] = bytemuck::cast(KdNode::inner(2, 1.0, 7));
        assert_eq!(words, [0x3f80_0000, 7 << 2 | 2]);
        let inner = KdNode::inner(1, -0.5, (1 << 30) - 1);
        assert_eq!((inner.axis(), inner.split(), inner.upper()), (1, -0.5, (1 << 30) - 1));
        let leaf = KdNode::leaf(9, 0);
        assert_eq!((leaf.is_leaf(), leaf.first(), leaf.count(), leaf.axis()), (true, 9, 0, 3));
        assert!(!inner.is_leaf());
    }
}
