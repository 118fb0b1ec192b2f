//! The tree that builders make and [`super::layout`] packs: plain nodes of eight children over a list of triangles.
//!
//! 256 bytes a node, and 4 a reference. **Invariants**: node 0 is the root, children come after their parents, and an empty
//! scene has no node; a place holds a leaf (`count` references from `link` on), or an inner node (`count` 0, `link` its index), or
//! nothing, and places that hold nothing come last; a leaf has 1 to [`LARGEST_LEAF`] triangles, none of them twice; a box
//! contains those below it, and of each triangle the part that the leaf stands for; no path has more than [`MAX_LEVELS`] nodes.

use crate::Aabb;

/// The children of a node.
pub(crate) const WIDTH: usize = 8;
/// The most triangles in a leaf: one SIMD test takes them all.
pub(crate) const LARGEST_LEAF: u32 = 8;
/// The most nodes on a path from the root.
pub(crate) const MAX_LEVELS: u32 = 64;

/// Nodes, and the triangles of the leaves.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    pub(crate) nodes: Vec<TreeNode>,
    /// Indices of triangles, leaf after leaf.
    pub(crate) order: Vec<u32>,
}

/// A node: eight boxes, the same side of all of them beside each other, and what is in them.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub(crate) struct TreeNode {
    /// Smallest x, y, z and largest x, y, z of the eight boxes.
    pub(crate) bounds: [[f32; WIDTH]; 6],
    pub(crate) children: [Child; WIDTH],
}

/// What is in a place.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Child {
    /// Leaf: its first reference. Inner node: its index.
    pub(crate) link: u32,
    /// Leaf: its triangles. Inner node and nothing: 0.
    pub(crate) count: u32,
}

impl Child {
    pub(crate) const NOTHING: Self = Self { link: 0, count: 0 };

    pub(crate) const fn leaf(first: u32, count: u32) -> Self {
        Self { link: first, count }
    }

    pub(crate) const fn inner(node: u32) -> Self {
        Self { link: node, count: 0 }
    }

    /// No child leads to the root, so that link 0 is free to mean nothing.
    pub(crate) const fn is_nothing(self) -> bool {
        self.count == 0 && self.link == 0
    }

    pub(crate) const fn is_leaf(self) -> bool {
        self.count > 0
    }
}

impl TreeNode {
    /// Eight places that hold nothing: their boxes are hit by no ray.
    pub(crate) const EMPTY: Self = Self {
        bounds: [
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [Child::NOTHING; WIDTH],
    };

    pub(crate) fn set(&mut self, place: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.bounds[axis][place] = bounds.min[axis];
            self.bounds[axis + 3][place] = bounds.max[axis];
        }
        self.children[place] = child;
    }

    pub(crate) fn child_bounds(&self, place: usize) -> Aabb {
        let corner =
            |row: usize| glam::Vec3::from_array(std::array::from_fn(|axis| self.bounds[row + axis][place]));
        Aabb::new(corner(0), corner(3))
    }

    /// How many places hold something.
    pub(crate) fn len(&self) -> usize {
        self.children.iter().take_while(|child| !child.is_nothing()).count()
    }
}
