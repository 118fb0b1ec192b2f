//! The test of a node's eight boxes, at any level.
//!
//! The scalar test's operations but one: the pads are part of the inverses ([`super::ray`]), which makes it a little wider, never
//! narrower, and two products shorter. Where sides come from is a matter of the node ([`Boxes`]); the operations on them are not.

use super::ray::{Octant, Slabs};
use crate::bvh8::node::{Fan, PackedNode};
use crate::bvh8::simd::Level;

/// A node as walks read it, whatever its boxes are made of.
pub(in super::super) trait Boxes {
    /// What the sides of all boxes are made with.
    type Frame<L: Level>: Copy;

    fn frame<L: Level>(&self, level: L) -> Self::Frame<L>;

    /// A side of all boxes across an axis, by the byte of an octant ([`Octant`]).
    fn sides<L: Level>(&self, level: L, frame: &Self::Frame<L>, axis: usize, byte: u32) -> L::Floats;

    /// The same of one box, 0 to 7.
    fn side(&self, axis: usize, byte: u32, place: usize) -> f32;

    /// The mask without the places that hold nothing, where their boxes do not see to that.
    fn filled<L: Level>(&self, level: L, hit: L::Mask) -> L::Mask;

    fn fan(&self) -> &Fan;
}

impl Boxes for PackedNode {
    type Frame<L: Level> = ();

    #[inline(always)]
    fn frame<L: Level>(&self, _: L) {}

    #[inline(always)]
    fn sides<L: Level>(&self, level: L, (): &(), _: usize, byte: u32) -> L::Floats {
        level.row(row(self, byte))
    }

    #[inline(always)]
    fn side(&self, _: usize, byte: u32, place: usize) -> f32 {
        self.row(byte / 32)[place % 8]
    }

    #[inline(always)]
    fn filled<L: Level>(&self, _: L, hit: L::Mask) -> L::Mask {
        hit
    }

    #[inline(always)]
    fn fan(&self) -> &Fan {
        Self::fan(self)
    }
}

/// A ray's slabs in lanes.
#[derive(Clone, Copy)]
pub(super) struct Lanes<L: Level> {
    near: [L::Floats; 3],
    far: [L::Floats; 3],
    near_inverse: [L::Floats; 3],
    far_inverse: [L::Floats; 3],
    t_min: L::Floats,
}

impl<L: Level> Lanes<L> {
    #[inline(always)]
    pub(super) fn new(level: L, slabs: &Slabs) -> Self {
        Self {
            near: splat_first(level, &slabs.near),
            far: splat_first(level, &slabs.far),
            near_inverse: splat_first(level, &slabs.near_inverse),
            far_inverse: splat_first(level, &slabs.far_inverse),
            t_min: level.splat(slabs.t_min),
        }
    }
}

/// Three numbers, each in all lanes.
#[inline(always)]
pub(super) fn splat<L: Level>(level: L, numbers: &[f32; 3]) -> [L::Floats; 3] {
    [level.splat(numbers[0]), level.splat(numbers[1]), level.splat(numbers[2])]
}

/// The first three of four.
#[inline(always)]
fn splat_first<L: Level>(level: L, numbers: &[f32; 4]) -> [L::Floats; 3] {
    [level.splat(numbers[0]), level.splat(numbers[1]), level.splat(numbers[2])]
}

/// Where a ray enters each of eight boxes, and which it hits up to `t_max`, closed.
#[inline(always)]
pub(super) fn children<L: Level, N: Boxes>(
    level: L,
    node: &N,
    slabs: &Slabs,
    ray: &Lanes<L>,
    t_max: f32,
) -> (L::Floats, L::Mask) {
    let Octant { near_rows: [near_x, near_y, near_z], far_rows: [far_x, far_y, far_z], .. } = slabs.octant;
    let frame = node.frame(level);
    let entry = level.larger(
        level.larger(
            meet(level, node.sides(level, &frame, 0, near_x), ray.near[0], ray.near_inverse[0]),
            meet(level, node.sides(level, &frame, 1, near_y), ray.near[1], ray.near_inverse[1]),
        ),
        level.larger(
            meet(level, node.sides(level, &frame, 2, near_z), ray.near[2], ray.near_inverse[2]),
            ray.t_min,
        ),
    );
    let exit = level.smaller(
        level.smaller(
            meet(level, node.sides(level, &frame, 0, far_x), ray.far[0], ray.far_inverse[0]),
            meet(level, node.sides(level, &frame, 1, far_y), ray.far[1], ray.far_inverse[1]),
        ),
        level.smaller(
            meet(level, node.sides(level, &frame, 2, far_z), ray.far[2], ray.far_inverse[2]),
            level.splat(t_max),
        ),
    );
    (entry, node.filled(level, level.at_most(entry, exit)))
}

/// The row that begins at a byte.
#[inline(always)]
fn row(node: &PackedNode, byte: u32) -> &[f32; 8] {
    debug_assert!(byte.is_multiple_of(32) && byte < 192);
    // SAFETY: the byte is an octant's, of which there are no others than those of the table: the first of one of six rows.
    unsafe { &*std::ptr::from_ref(node).byte_add(byte as usize).cast() }
}

/// Where a ray meets a side of each of eight boxes.
#[inline(always)]
fn meet<L: Level>(level: L, sides: L::Floats, origin: L::Floats, inverse: L::Floats) -> L::Floats {
    level.mul(level.sub(sides, origin), inverse)
}
