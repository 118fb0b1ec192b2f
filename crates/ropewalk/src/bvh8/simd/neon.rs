//! NEON: two vectors of four lanes for eight boxes or triangles. There is no compression, so the hit children are pushed one by
//! one.

use super::{Level, Task};
use crate::bvh8::node::{PackedNode, Word};
use crate::bvh8::tree::WIDTH;
use crate::bvh8::walk::Stack;
use std::arch::aarch64::*;
use std::arch::is_aarch64_feature_detected;

/// Proof that the processor has the instructions.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Neon(());

type Floats = [float32x4_t; 2];
/// All bits of a lane set, or none.
type Mask = [uint32x4_t; 2];

#[target_feature(enable = "neon")]
fn run<T: Task>(level: Neon, task: T) -> T::Output {
    task.run(level)
}

impl Level for Neon {
    type Floats = Floats;
    type Mask = Mask;

    #[inline(always)]
    fn detect() -> Option<Self> {
        is_aarch64_feature_detected!("neon").then_some(Self(()))
    }

    #[inline(always)]
    fn run<T: Task>(self, task: T) -> T::Output {
        // SAFETY: the token proves that the processor has the instructions.
        unsafe { run(self, task) }
    }

    #[inline(always)]
    fn splat(self, number: f32) -> Floats {
        // SAFETY: the token proves that the instructions are there.
        unsafe { [vdupq_n_f32(number); 2] }
    }

    #[inline(always)]
    fn row(self, row: &[f32; WIDTH]) -> Floats {
        // SAFETY: an array of eight has eight numbers.
        unsafe { self.read(row.as_ptr()) }
    }

    #[inline(always)]
    unsafe fn read(self, from: *const f32) -> Floats {
        // SAFETY: the token proves that the instructions are there; the rest is the caller's.
        unsafe { [vld1q_f32(from), vld1q_f32(from.add(4))] }
    }

    #[inline(always)]
    fn numbers(self, floats: Floats) -> [f32; WIDTH] {
        let mut numbers = [0.0; WIDTH];
        // SAFETY: the token proves that the instructions are there; eight numbers are written to an array of eight.
        unsafe {
            vst1q_f32(numbers.as_mut_ptr(), floats[0]);
            vst1q_f32(numbers.as_mut_ptr().add(4), floats[1]);
        }
        numbers
    }

    #[inline(always)]
    fn add(self, a: Floats, b: Floats) -> Floats {
        // SAFETY: the token proves that the instructions are there.
        unsafe { [vaddq_f32(a[0], b[0]), vaddq_f32(a[1], b[1])] }
    }

    #[inline(always)]
    fn sub(self, a: Floats, b: Floats) -> Floats {
        // SAFETY: the token proves that the instructions are there.
        unsafe { [vsubq_f32(a[0], b[0]), vsubq_f32(a[1], b[1])] }
    }

    #[inline(always)]
    fn mul(self, a: Floats, b: Floats) -> Floats {
        // SAFETY: the token proves that the instructions are there.
        unsafe { [vmulq_f32(a[0], b[0]), vmulq_f32(a[1], b[1])] }
    }

    #[inline(always)]
    fn div(self, a: Floats, b: Floats) -> Floats {
        // SAFETY: the token proves that the instructions are there.
        unsafe { [vdivq_f32(a[0], b[0]), vdivq_f32(a[1], b[1])] }
    }

    #[inline(always)]
    fn smaller(self, a: Floats, b: Floats) -> Floats {
        // SAFETY: the token proves that the instructions are there.
        unsafe {
            [vbslq_f32(vcltq_f32(a[0], b[0]), a[0], b[0]), vbslq_f32(vcltq_f32(a[1], b[1]), a[1], b[1])]
        }
    }

    #[inline(always)]
    fn larger(self, a: Floats, b: Floats) -> Floats {
        // SAFETY: the token proves that the instructions are there.
        unsafe {
            [vbslq_f32(vcgtq_f32(a[0], b[0]), a[0], b[0]), vbslq_f32(vcgtq_f32(a[1], b[1]), a[1], b[1])]
        }
    }

    #[inline(always)]
    fn less(self, a: Floats, b: Floats) -> Mask {
        // SAFETY: the token proves that the instructions are there.
        unsafe { [vcltq_f32(a[0], b[0]), vcltq_f32(a[1], b[1])] }
    }

    #[inline(always)]
    fn at_most(self, a: Floats, b: Floats) -> Mask {
        // SAFETY: the token proves that the instructions are there.
        unsafe { [vcleq_f32(a[0], b[0]), vcleq_f32(a[1], b[1])] }
    }

    #[inline(always)]
    fn both(self, a: Mask, b: Mask) -> Mask {
        // SAFETY: the token proves that the instructions are there.
        unsafe { [vandq_u32(a[0], b[0]), vandq_u32(a[1], b[1])] }
    }

    #[inline(always)]
    fn either(self, a: Mask, b: Mask) -> Mask {
        // SAFETY: the token proves that the instructions are there.
        unsafe { [vorrq_u32(a[0], b[0]), vorrq_u32(a[1], b[1])] }
    }

    #[inline(always)]
    fn bits(self, mask: Mask) -> u32 {
        const WEIGHTS: [[u32; 4]; 2] = [[1, 2, 4, 8], [16, 32, 64, 128]];
        // SAFETY: the token proves that the instructions are there; four words are read from arrays of four.
        unsafe {
            let low = vandq_u32(mask[0], vld1q_u32(WEIGHTS[0].as_ptr()));
            let high = vandq_u32(mask[1], vld1q_u32(WEIGHTS[1].as_ptr()));
            vaddvq_u32(vorrq_u32(low, high))
        }
    }

    #[inline(always)]
    fn select(self, mask: Mask, yes: Floats, no: Floats) -> Floats {
        // SAFETY: the token proves that the instructions are there.
        unsafe { [vbslq_f32(mask[0], yes[0], no[0]), vbslq_f32(mask[1], yes[1], no[1])] }
    }

    #[inline(always)]
    fn push_ordered(
        self,
        node: &PackedNode,
        octant_shift: u32,
        entries: Floats,
        hit: Mask,
        stack: &mut Stack,
    ) -> Word {
        let (entries, hit) = (self.numbers(entries), self.bits(hit));
        for turn in node.order {
            let place = (turn >> octant_shift) as usize % WIDTH;
            if hit >> place & 1 != 0 {
                stack.push(node.children[place], entries[place]);
            }
        }
        stack.peek()
    }

    #[inline(always)]
    fn push_unordered(self, node: &PackedNode, hit: Mask, stack: &mut Stack) -> Word {
        let mut hit = self.bits(hit);
        while hit != 0 {
            let place = hit.trailing_zeros() as usize % WIDTH;
            hit &= hit - 1;
            stack.push(node.children[place], f32::NEG_INFINITY);
        }
        stack.peek()
    }

    #[inline(always)]
    fn cull(self, stack: &mut Stack, t_max: f32) {
        stack.keep(|entry| entry <= t_max);
    }
}
