//! The packed node: 256 bytes, four cache lines, everything that a visit needs. (That of compact trees has 128: [`super::compact`].)
//!
//! Six rows of eight numbers, the sides of the boxes; a row of eight words, what is in the places; and a row of eight words
//! with the order in which the places are pushed, for each of the eight octants of directions.
//!
//! **A word** tells a leaf (its top bit) or a node, and where it begins in the arena, in units of [`UNIT`] bytes; a leaf's word also
//! has the number of its triangles, less one, in three bits. The word [`DONE`] lies under every stack.
//!
//! **The order** (Dietrich, Günther, Slusallek 2007; as a table in tinybvh): bits `3 * octant..` of the word `k` are the place
//! that is pushed as the `k`-th, farthest first, by the middles of the boxes along the diagonal of the octant ([`super::order`]).

use super::tree::WIDTH;
use crate::Aabb;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// The bytes in which words count.
pub(super) const UNIT: usize = 16;
/// The bit of a leaf.
const LEAF: u32 = 1 << 31;
const COUNT_SHIFT: u32 = 28;
const PLACE: u32 = (1 << COUNT_SHIFT) - 1;
/// The most bytes of an arena: 4 GiB.
pub(super) const LARGEST_ARENA: usize = (PLACE as usize) * UNIT;
/// The word of nothing more: a leaf where none can be.
pub(super) const DONE: u32 = u32::MAX;

/// A node as walks read it.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct PackedNode {
    /// Smallest x, y, z and largest x, y, z.
    pub(super) bounds: [[f32; WIDTH]; 6],
    /// What is in the places.
    pub(super) children: [u32; WIDTH],
    /// In which order they are pushed.
    pub(super) order: [u32; WIDTH],
}

/// What is in the places of a node, whatever its boxes are made of, and in which order they are pushed: a cache line.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct Fan {
    /// What is in the places.
    pub(super) children: [u32; WIDTH],
    /// In which order they are pushed.
    pub(super) order: [u32; WIDTH],
}

impl PackedNode {
    /// The last line.
    #[inline(always)]
    pub(super) fn fan(&self) -> &Fan {
        let lines: &[Fan; 4] = bytemuck::cast_ref(self);
        &lines[3]
    }

    /// The box of a place.
    pub(super) fn child_bounds(&self, place: usize) -> Aabb {
        let corner = |row: usize| Vec3::from_array([0, 1, 2].map(|axis| self.bounds[row + axis][place]));
        Aabb::new(corner(0), corner(3))
    }

    /// A row by its number, 0 to 5; there are eight rows, so that no check is needed.
    #[inline(always)]
    pub(super) fn row(&self, row: u32) -> &[f32; WIDTH] {
        let rows: &[[f32; WIDTH]; 8] = bytemuck::cast_ref(self);
        &rows[row as usize & 7]
    }
}

/// Where a child begins and what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Word(pub(super) u32);

impl Word {
    /// `place` counts [`UNIT`]s.
    pub(super) const fn node(place: u32) -> Self {
        Self(place)
    }

    /// `place` counts [`UNIT`]s; `count` is 1 to 8.
    pub(super) const fn leaf(place: u32, count: u32) -> Self {
        Self(LEAF | (count - 1) << COUNT_SHIFT | place)
    }

    #[inline(always)]
    pub(super) const fn is_leaf(self) -> bool {
        self.0 & LEAF != 0
    }

    /// The triangles of a leaf.
    #[inline(always)]
    pub(super) const fn count(self) -> u32 {
        (self.0 >> COUNT_SHIFT & 7) + 1
    }

    /// The first byte.
    #[inline(always)]
    pub(super) const fn offset(self) -> usize {
        (self.0 & PLACE) as usize * UNIT
    }
}
