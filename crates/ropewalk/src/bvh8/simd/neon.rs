//! NEON: two vectors of four lanes for eight boxes or triangles. There is no compression, so the hit children are pushed one by
//! one.

use super::{Level, Task};
use crate::bvh8::node::{Fan, Word};
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

/// Three numbers from each of four places, the same number of all of them together.
///
/// # Safety
/// The processor has NEON; four numbers can be read from each place.
#[inline(always)]
unsafe fn columns(from: [*const f32; 4]) -> [float32x4_t; 3] {
    // SAFETY: the caller's.
    unsafe {
        let (first, second) = (vld1q_f32(from[0]), vld1q_f32(from[1]));
        let (third, fourth) = (vld1q_f32(from[2]), vld1q_f32(from[3]));
        let (low, high) = (vzip1q_f32(first, second), vzip1q_f32(third, fourth));
        let (last_low, last_high) = (vzip2q_f32(first, second), vzip2q_f32(third, fourth));
        [
            vcombine_f32(vget_low_f32(low), vget_low_f32(high)),
            vcombine_f32(vget_high_f32(low), vget_high_f32(high)),
            vcombine_f32(vget_low_f32(last_low), vget_low_f32(last_high)),
        ]
    }
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
    fn bytes(self, row: &[u8; WIDTH]) -> Floats {
        // SAFETY: the token proves that the instructions are there; eight bytes are read from an array of eight.
        unsafe {
            let words = vmovl_u8(vld1_u8(row.as_ptr()));
            [vcvtq_f32_u32(vmovl_u16(vget_low_u16(words))), vcvtq_f32_u32(vmovl_u16(vget_high_u16(words)))]
        }
    }

    #[inline(always)]
    unsafe fn triples(self, from: [*const f32; WIDTH], axes: [u8; 3]) -> [Floats; 3] {
        // SAFETY: the caller's.
        let (low, high) = unsafe {
            (columns([from[0], from[1], from[2], from[3]]), columns([from[4], from[5], from[6], from[7]]))
        };
        let [x, y, z] = [usize::from(axes[0]) % 3, usize::from(axes[1]) % 3, usize::from(axes[2]) % 3];
        [[low[x], high[x]], [low[y], high[y]], [low[z], high[z]]]
    }

    #[inline(always)]
    unsafe fn few_triples(self, from: [*const f32; WIDTH / 2], axes: [u8; 3]) -> [Floats; 3] {
        // SAFETY: the caller's.
        let low = unsafe { columns(from) };
        let [x, y, z] = [usize::from(axes[0]) % 3, usize::from(axes[1]) % 3, usize::from(axes[2]) % 3];
        [[low[x]; 2], [low[y]; 2], [low[z]; 2]]
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
    fn filled(self, fan: &Fan, mask: Mask) -> Mask {
        // SAFETY: the token proves that the instructions are there; eight words are read from an array of eight.
        unsafe {
            let (low, high) = (vld1q_u32(fan.children.as_ptr()), vld1q_u32(fan.children.as_ptr().add(4)));
            [vandq_u32(mask[0], vtstq_u32(low, low)), vandq_u32(mask[1], vtstq_u32(high, high))]
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
        fan: &Fan,
        octant_shift: u32,
        entries: Floats,
        hit: Mask,
        stack: &mut Stack,
    ) -> Word {
        let (entries, hit) = (self.numbers(entries), self.bits(hit));
        for turn in fan.order {
            let place = (turn >> octant_shift) as usize % WIDTH;
            if hit >> place & 1 != 0 {
                stack.push(fan.children[place], entries[place]);
            }
        }
        stack.peek()
    }

    #[inline(always)]
    fn push_unordered(self, fan: &Fan, hit: Mask, stack: &mut Stack) -> Word {
        let mut hit = self.bits(hit);
        while hit != 0 {
            let place = hit.trailing_zeros() as usize % WIDTH;
            hit &= hit - 1;
            stack.push(fan.children[place], f32::NEG_INFINITY);
        }
        stack.peek()
    }

    #[inline(always)]
    fn cull(self, stack: &mut Stack, t_max: f32) {
        stack.keep(|entry| entry <= t_max);
    }
}
