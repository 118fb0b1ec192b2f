//! The level without vectors: plain Rust over arrays of eight, and the twin that the others are held against.

use super::{Level, Task};
use crate::aabb::{larger, smaller};
use crate::bvh8::node::{Fan, Word};
use crate::bvh8::tree::WIDTH;
use crate::bvh8::walk::Stack;

/// The token: no instructions are needed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Portable;

type Floats = [f32; WIDTH];
/// All bits of a lane set, or none: what compilers turn into vectors.
type Mask = [u32; WIDTH];

const fn mask(yes: bool) -> u32 {
    if yes { u32::MAX } else { 0 }
}

/// See [`Level::triples`]; zeros in the lanes for which there is no place.
///
/// # Safety
/// That of [`Level::triples`].
#[inline(always)]
unsafe fn triples(from: &[*const f32], axes: [u8; 3]) -> [Floats; 3] {
    let mut triples = [[0.0; WIDTH]; 3];
    for (numbers, axis) in triples.iter_mut().zip(axes) {
        for (number, from) in numbers.iter_mut().zip(from) {
            // SAFETY: the caller's.
            *number = unsafe { *from.add(usize::from(axis)) };
        }
    }
    triples
}

impl Level for Portable {
    type Floats = Floats;
    type Mask = Mask;

    fn detect() -> Option<Self> {
        Some(Self)
    }

    #[inline(always)]
    fn run<T: Task>(self, task: T) -> T::Output {
        task.run(self)
    }

    #[inline(always)]
    fn splat(self, number: f32) -> Floats {
        [number; WIDTH]
    }

    #[inline(always)]
    fn row(self, row: &Floats) -> Floats {
        *row
    }

    #[inline(always)]
    unsafe fn read(self, from: *const f32) -> Floats {
        // SAFETY: the caller's; an array lies on the boundary of its numbers.
        unsafe { *from.cast() }
    }

    #[inline(always)]
    fn bytes(self, row: &[u8; WIDTH]) -> Floats {
        std::array::from_fn(|lane| f32::from(row[lane]))
    }

    #[inline(always)]
    unsafe fn triples(self, from: [*const f32; WIDTH], axes: [u8; 3]) -> [Floats; 3] {
        // SAFETY: the caller's.
        unsafe { triples(&from, axes) }
    }

    #[inline(always)]
    unsafe fn few_triples(self, from: [*const f32; WIDTH / 2], axes: [u8; 3]) -> [Floats; 3] {
        // SAFETY: the caller's.
        unsafe { triples(&from, axes) }
    }

    #[inline(always)]
    fn numbers(self, floats: Floats) -> Floats {
        floats
    }

    #[inline(always)]
    fn add(self, a: Floats, b: Floats) -> Floats {
        std::array::from_fn(|lane| a[lane] + b[lane])
    }

    #[inline(always)]
    fn sub(self, a: Floats, b: Floats) -> Floats {
        std::array::from_fn(|lane| a[lane] - b[lane])
    }

    #[inline(always)]
    fn mul(self, a: Floats, b: Floats) -> Floats {
        std::array::from_fn(|lane| a[lane] * b[lane])
    }

    #[inline(always)]
    fn div(self, a: Floats, b: Floats) -> Floats {
        std::array::from_fn(|lane| a[lane] / b[lane])
    }

    #[inline(always)]
    fn smaller(self, a: Floats, b: Floats) -> Floats {
        std::array::from_fn(|lane| smaller(a[lane], b[lane]))
    }

    #[inline(always)]
    fn larger(self, a: Floats, b: Floats) -> Floats {
        std::array::from_fn(|lane| larger(a[lane], b[lane]))
    }

    #[inline(always)]
    fn less(self, a: Floats, b: Floats) -> Mask {
        std::array::from_fn(|lane| mask(a[lane] < b[lane]))
    }

    #[inline(always)]
    fn at_most(self, a: Floats, b: Floats) -> Mask {
        std::array::from_fn(|lane| mask(a[lane] <= b[lane]))
    }

    #[inline(always)]
    fn both(self, a: Mask, b: Mask) -> Mask {
        std::array::from_fn(|lane| a[lane] & b[lane])
    }

    #[inline(always)]
    fn either(self, a: Mask, b: Mask) -> Mask {
        std::array::from_fn(|lane| a[lane] | b[lane])
    }

    #[inline(always)]
    fn bits(self, mask: Mask) -> u32 {
        (0..WIDTH).fold(0, |bits, lane| bits | (mask[lane] & 1) << lane)
    }

    #[inline(always)]
    fn filled(self, fan: &Fan, mut mask: Mask) -> Mask {
        for (lane, &word) in mask.iter_mut().zip(&fan.children) {
            *lane &= self::mask(word != 0);
        }
        mask
    }

    #[inline(always)]
    fn select(self, mask: Mask, yes: Floats, no: Floats) -> Floats {
        std::array::from_fn(|lane| if mask[lane] != 0 { yes[lane] } else { no[lane] })
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
        for turn in fan.order {
            let place = (turn >> octant_shift) as usize % WIDTH;
            if hit[place] != 0 {
                stack.push(fan.children[place], entries[place]);
            }
        }
        stack.peek()
    }

    #[inline(always)]
    fn push_unordered(self, fan: &Fan, hit: Mask, stack: &mut Stack) -> Word {
        for (&word, hit) in fan.children.iter().zip(hit) {
            if hit != 0 {
                stack.push(word, f32::NEG_INFINITY);
            }
        }
        stack.peek()
    }

    #[inline(always)]
    fn cull(self, stack: &mut Stack, t_max: f32) {
        stack.keep(|entry| entry <= t_max);
    }
}
