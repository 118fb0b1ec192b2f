//! Vectors of eight numbers, at every level of what processors have, and the stack operations that profit from more than that.
//!
//! **Levels.** [`portable`] is plain Rust; `avx2`, `avx512` and `neon` do the same with vectors of eight (twice four) lanes. The
//! tests of boxes and triangles are written once, over [`Level`], in [`super::walk`]: so every level computes the same numbers, bit
//! for bit, and visits the same nodes. No level fuses a product and a sum.
//!
//! **Soundness.** A level's token can only be made by [`Level::detect`], which asks the processor: whoever has one may use its
//! instructions. Tokens travel by value, and the code that uses one is compiled for its instructions because it is inlined into
//! [`Level::run`]. Code of walks uses functions and not closures, which the compiler does not always put there; outside of it each
//! instruction is a call.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "aarch64")]
mod neon;
mod portable;
#[cfg(target_arch = "x86_64")]
mod vectors;

use super::node::{Fan, Word};
use super::tree::WIDTH;
use super::walk::Stack;
use std::fmt;

/// A level of vector instructions. Lanes are numbered as the places of a node.
pub(super) trait Level: Copy {
    /// Eight numbers.
    type Floats: Copy;
    /// Eight answers.
    type Mask: Copy;

    /// The token, where the processor has the instructions.
    fn detect() -> Option<Self>;

    /// Runs a task that is compiled for the instructions.
    fn run<T: Task>(self, task: T) -> T::Output;

    fn splat(self, number: f32) -> Self::Floats;

    /// A row of a node.
    fn row(self, row: &[f32; WIDTH]) -> Self::Floats;

    /// Eight numbers from anywhere.
    ///
    /// # Safety
    /// Eight numbers can be read from there; it lies on a boundary of four bytes.
    unsafe fn read(self, from: *const f32) -> Self::Floats;

    /// Eight small numbers.
    fn bytes(self, row: &[u8; WIDTH]) -> Self::Floats;

    /// Three numbers from each of eight places, the same number of all of them together, in an order of axes.
    ///
    /// # Safety
    /// Four numbers can be read from each place; the axes are 0, 1 and 2, in any order.
    unsafe fn triples(self, from: [*const f32; WIDTH], axes: [u8; 3]) -> [Self::Floats; 3];

    /// The same from four places. The other four lanes mean nothing.
    ///
    /// # Safety
    /// As [`Self::triples`].
    unsafe fn few_triples(self, from: [*const f32; WIDTH / 2], axes: [u8; 3]) -> [Self::Floats; 3];

    fn numbers(self, floats: Self::Floats) -> [f32; WIDTH];

    fn add(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn sub(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn mul(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn div(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;

    /// As [`crate::aabb::smaller`]: `a` where it is smaller, `b` otherwise, also where one is no number.
    fn smaller(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// As [`crate::aabb::larger`].
    fn larger(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;

    /// `a < b`, false where one is no number.
    fn less(self, a: Self::Floats, b: Self::Floats) -> Self::Mask;
    /// `a <= b`, false where one is no number.
    fn at_most(self, a: Self::Floats, b: Self::Floats) -> Self::Mask;

    fn both(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn either(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// A bit a lane.
    fn bits(self, mask: Self::Mask) -> u32;
    /// The mask without the lanes in which a fan's places hold nothing.
    fn filled(self, fan: &Fan, mask: Self::Mask) -> Self::Mask;
    /// `yes` where the mask is set, `no` elsewhere.
    fn select(self, mask: Self::Mask, yes: Self::Floats, no: Self::Floats) -> Self::Floats;

    /// Pushes the hit children so that the nearest, by the order of the octant, lies on top; tells what lies there then. It comes
    /// from registers: who reads it from memory waits until the vector has got there.
    fn push_ordered(
        self,
        fan: &Fan,
        octant_shift: u32,
        entries: Self::Floats,
        hit: Self::Mask,
        stack: &mut Stack,
    ) -> Word;

    /// Pushes the hit children in the order of their places, without where the ray enters them; tells what lies on top then.
    fn push_unordered(self, fan: &Fan, hit: Self::Mask, stack: &mut Stack) -> Word;

    /// Leaves out what lies beyond `t_max`.
    fn cull(self, stack: &mut Stack, t_max: f32);
}

/// What runs at some level.
pub(super) trait Task {
    type Output;
    /// Must be `#[inline(always)]`, as everything in it that uses the level.
    fn run<L: Level>(self, level: L) -> Self::Output;
}

/// The vector instructions that a structure is walked with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SimdLevel {
    /// No vectors but what the compiler makes of plain Rust.
    Portable,
    /// ARM's vectors of four lanes.
    Neon,
    /// x86's vectors of eight lanes, with AVX2, BMI and POPCNT.
    Avx2,
    /// x86's vectors with masks and compression: AVX-512 F and VL.
    Avx512,
}

impl SimdLevel {
    /// Every level there is, on any machine.
    pub const EVERY: [Self; 4] = [Self::Portable, Self::Neon, Self::Avx2, Self::Avx512];

    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] =
        &[("portable", Self::Portable), ("neon", Self::Neon), ("avx2", Self::Avx2), ("avx512", Self::Avx512)];

    /// The name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Neon => "neon",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Whether this machine has it.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => avx2::Avx2::detect().is_some(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => avx512::Avx512::detect().is_some(),
            #[cfg(target_arch = "aarch64")]
            Self::Neon => neon::Neon::detect().is_some(),
            #[allow(unreachable_patterns, reason = "which levels there can be depends on the machine")]
            _ => false,
        }
    }

    /// The best that this machine has.
    #[must_use]
    pub fn best() -> Self {
        Self::EVERY.into_iter().rev().find(|level| level.is_available()).unwrap_or(Self::Portable)
    }
}

impl fmt::Display for SimdLevel {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

/// A level that this machine has, with its proof: whoever walks need not ask the processor again, which for a single ray took as long as
/// a node.
#[derive(Clone, Copy, Debug)]
pub(super) enum Detected {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(avx512::Avx512),
    #[cfg(target_arch = "aarch64")]
    Neon(neon::Neon),
}

impl Detected {
    /// The level, where the machine has it, and otherwise the best that it has.
    pub(super) fn or_best(level: Option<SimdLevel>) -> Self {
        let wanted = level.filter(|level| level.is_available()).unwrap_or_else(SimdLevel::best);
        let found = match wanted {
            #[cfg(target_arch = "x86_64")]
            SimdLevel::Avx512 => avx512::Avx512::detect().map(Self::Avx512),
            #[cfg(target_arch = "x86_64")]
            SimdLevel::Avx2 => avx2::Avx2::detect().map(Self::Avx2),
            #[cfg(target_arch = "aarch64")]
            SimdLevel::Neon => neon::Neon::detect().map(Self::Neon),
            _ => None,
        };
        found.unwrap_or(Self::Portable)
    }

    pub(super) const fn level(self) -> SimdLevel {
        match self {
            Self::Portable => SimdLevel::Portable,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_) => SimdLevel::Avx2,
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(_) => SimdLevel::Avx512,
            #[cfg(target_arch = "aarch64")]
            Self::Neon(_) => SimdLevel::Neon,
        }
    }
}

/// Runs a task at a level.
#[inline(always)]
pub(super) fn dispatch<T: Task>(level: Detected, task: T) -> T::Output {
    match level {
        Detected::Portable => portable::Portable.run(task),
        #[cfg(target_arch = "x86_64")]
        Detected::Avx2(level) => level.run(task),
        #[cfg(target_arch = "x86_64")]
        Detected::Avx512(level) => level.run(task),
        #[cfg(target_arch = "aarch64")]
        Detected::Neon(level) => level.run(task),
    }
}
