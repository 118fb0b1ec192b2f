//! The test of a node's eight boxes, at any level.
//!
//! The scalar test's operations but one: the pads are part of the inverses ([`super::ray`]), which makes it a little wider, never
//! narrower, and two products shorter.

use super::ray::{Octant, Slabs};
use crate::bvh8::node::PackedNode;
use crate::bvh8::simd::Level;

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
pub(super) fn children<L: Level>(
    level: L,
    node: &PackedNode,
    slabs: &Slabs,
    ray: &Lanes<L>,
    t_max: f32,
) -> (L::Floats, L::Mask) {
    let Octant { near_rows: [near_x, near_y, near_z], far_rows: [far_x, far_y, far_z], .. } = slabs.octant;
    let entry = level.larger(
        level.larger(
            meet(level, row(node, near_x), ray.near[0], ray.near_inverse[0]),
            meet(level, row(node, near_y), ray.near[1], ray.near_inverse[1]),
        ),
        level.larger(meet(level, row(node, near_z), ray.near[2], ray.near_inverse[2]), ray.t_min),
    );
    let exit = level.smaller(
        level.smaller(
            meet(level, row(node, far_x), ray.far[0], ray.far_inverse[0]),
            meet(level, row(node, far_y), ray.far[1], ray.far_inverse[1]),
        ),
        level.smaller(meet(level, row(node, far_z), ray.far[2], ray.far_inverse[2]), level.splat(t_max)),
    );
    (entry, level.at_most(entry, exit))
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
fn meet<L: Level>(level: L, row: &[f32; 8], origin: L::Floats, inverse: L::Floats) -> L::Floats {
    level.mul(level.sub(level.row(row), origin), inverse)
}
