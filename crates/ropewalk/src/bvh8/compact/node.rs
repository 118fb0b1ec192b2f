//! The compact node: 128 bytes, two cache lines. The first has the boxes, the second what is in the places and their order.
//!
//! Three corners, a word with three steps of 10 bits, and six rows of eight bytes, the sides of the boxes: smallest x, y, z and
//! largest x, y, z ([`super::frame`]). A place that holds nothing is told by its word, not by its box: an inside-out box of a few
//! steps may be hit for rounding.

use super::frame::{Ruler, Sides, Step};
use crate::bvh8::node::{Fan, PackedNode};
use crate::bvh8::simd::Level;
use crate::bvh8::tree::WIDTH;
use crate::bvh8::walk::Boxes;
use bytemuck::{Pod, Zeroable};

/// A node as walks read it.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(in super::super) struct CompactNode {
    corner: [f32; 3],
    /// Of x, y and z, from the lowest bits on.
    steps: u32,
    sides: [[u8; WIDTH]; 6],
    fan: Fan,
}

impl CompactNode {
    pub(super) fn new(axes: &[(Ruler, Sides); 3], fan: Fan) -> Self {
        let mut node = Self { corner: [0.0; 3], steps: 0, sides: [[0; WIDTH]; 6], fan };
        for (axis, (ruler, [low, high])) in axes.iter().enumerate() {
            node.corner[axis] = ruler.corner;
            node.steps |= ruler.step.bits() << (Step::BITS * axis as u32);
            (node.sides[axis], node.sides[3 + axis]) = (*low, *high);
        }
        node
    }

    #[inline(always)]
    fn ruler(&self, axis: usize) -> Ruler {
        Ruler {
            corner: self.corner[axis % 3],
            step: Step::from_bits(self.steps >> (Step::BITS * (axis % 3) as u32)),
        }
    }

    /// The row of an octant's byte: of eight bytes, where a full node has eight numbers. The line has eight rows, of which the
    /// first two are something else, so that no check is needed.
    #[inline(always)]
    fn row(&self, byte: u32) -> &[u8; WIDTH] {
        let rows: &[[u8; WIDTH]; 16] = bytemuck::cast_ref(self);
        &rows[(byte / 32 + 2) as usize & 7]
    }

    /// The same node with boxes in full.
    pub(in super::super) fn full(&self) -> PackedNode {
        let mut bounds = [[0.0; WIDTH]; 6];
        for (row, (sides, numbers)) in bounds.iter_mut().zip(self.sides).enumerate() {
            let ruler = self.ruler(row % 3);
            for (place, side) in sides.iter_mut().enumerate() {
                *side = match self.fan.children[place] {
                    0 if row < 3 => f32::INFINITY,
                    0 => f32::NEG_INFINITY,
                    _ => ruler.place(numbers[place]),
                };
            }
        }
        PackedNode { bounds, children: self.fan.children, order: self.fan.order }
    }
}

impl Boxes for CompactNode {
    /// Corners and steps.
    type Frame<L: Level> = [[L::Floats; 3]; 2];

    #[inline(always)]
    fn frame<L: Level>(&self, level: L) -> [[L::Floats; 3]; 2] {
        let (x, y, z) = (self.ruler(0), self.ruler(1), self.ruler(2));
        [
            [level.splat(x.corner), level.splat(y.corner), level.splat(z.corner)],
            [level.splat(x.step.length()), level.splat(y.step.length()), level.splat(z.step.length())],
        ]
    }

    #[inline(always)]
    fn sides<L: Level>(
        &self,
        level: L,
        [corners, steps]: &[[L::Floats; 3]; 2],
        axis: usize,
        byte: u32,
    ) -> L::Floats {
        // As [`Ruler::place`].
        level.add(corners[axis], level.mul(level.bytes(self.row(byte)), steps[axis]))
    }

    #[inline(always)]
    fn side(&self, axis: usize, byte: u32, place: usize) -> f32 {
        self.ruler(axis).place(self.row(byte)[place % WIDTH])
    }

    #[inline(always)]
    fn filled<L: Level>(&self, level: L, hit: L::Mask) -> L::Mask {
        level.filled(&self.fan, hit)
    }

    #[inline(always)]
    fn fan(&self) -> &Fan {
        &self.fan
    }
}
