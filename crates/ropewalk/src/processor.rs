//! Loops of builders, compiled once more for the processor that runs them.
//!
//! A build for any processor of a family may use only what all of them have: of x86-64 that is the instructions of 2003. A loop
//! needs no vector type of its own to be faster with later ones, which do not overwrite what they work on and have more registers:
//! the library built for the processor as a whole made the trees of the preset `high` in 0.82 of the time of a plain build, those of
//! `fast` in 0.94. Both are 1.00 with these loops; without [`Processor::Avx512`], `fast` is 0.95 (2026-11-23, AMD EPYC of
//! family 25, one thread, kitchen of 56,935 triangles).
//!
//! No product and sum are fused, so whatever the processor the same operations are done in the same order: not one bit of a tree
//! depends on it.
//!
//! **Why the unsafe code is sound**: an instruction must only run on a processor that has it, and nothing else is asked. Code
//! compiled for more than the family has is reached by way of an [`Avx2`] or an [`Avx512`], and the one way to get either is its
//! `detect`, which asks the processor first.
#![allow(unsafe_code, reason = "instructions of a processor that was asked for them")]

/// What the processor can do.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Processor {
    /// What any of its family can.
    Any,
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
}

impl Processor {
    /// All that this processor can do, the best last.
    #[cfg(test)]
    pub(crate) fn all() -> Vec<Self> {
        let mut all = vec![Self::Any];
        #[cfg(target_arch = "x86_64")]
        {
            all.extend(Avx2::detect().map(Self::Avx2));
            all.extend(Avx512::detect().map(Self::Avx512));
        }
        all
    }

    /// The best that this processor can do.
    pub(crate) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(avx512) = Avx512::detect() {
                return Self::Avx512(avx512);
            }
            if let Some(avx2) = Avx2::detect() {
                return Self::Avx2(avx2);
            }
        }
        Self::Any
    }

    /// Runs something that is compiled for the processor as far as it is inlined: functions in it must be `#[inline(always)]`.
    #[inline(always)]
    pub(crate) fn run<R>(self, work: impl FnOnce() -> R) -> R {
        match self {
            Self::Any => work(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(avx2) => avx2.run(work),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(avx512) => avx512.run(work),
        }
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) use x86::{Avx2, Avx512};

#[cfg(target_arch = "x86_64")]
mod x86 {
    /// A processor that was asked for AVX2, and for what came with it.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Avx2(());

    /// A processor that was asked for AVX-512 on vectors of any length, besides.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Avx512(Avx2);

    impl Avx2 {
        pub(crate) fn detect() -> Option<Self> {
            let there = is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
                && is_x86_feature_detected!("lzcnt")
                && is_x86_feature_detected!("popcnt");
            there.then_some(Self(()))
        }

        /// Runs something that is compiled for these instructions as far as it is inlined.
        #[inline(always)]
        pub(crate) fn run<R>(self, work: impl FnOnce() -> R) -> R {
            #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
            #[inline]
            fn compiled<R>(work: impl FnOnce() -> R) -> R {
                work()
            }
            // SAFETY: the processor was asked for every one of them.
            unsafe { compiled(work) }
        }
    }

    impl Avx512 {
        pub(crate) fn detect() -> Option<Self> {
            let there = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512dq");
            Avx2::detect().filter(|_| there).map(Self)
        }

        /// It has AVX2 too.
        pub(crate) const fn avx2(self) -> Avx2 {
            self.0
        }

        /// Runs something that is compiled for these instructions as far as it is inlined.
        #[inline(always)]
        pub(crate) fn run<R>(self, work: impl FnOnce() -> R) -> R {
            #[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
            #[inline]
            fn compiled<R>(work: impl FnOnce() -> R) -> R {
                work()
            }
            // SAFETY: the processor was asked for every one of them.
            unsafe { compiled(work) }
        }
    }
}
