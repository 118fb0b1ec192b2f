//! Eight lanes, in one register where the processor has such.
//!
//! Whatever the registers, the same operations are done in the same order: not one bit of a tree depends on them. Left to
//! itself, the compiler turns "store the smaller of the two" into masked stores, which no load can overtake: twice the time
//! of a binning.
//!
//! **Why the unsafe code is sound**: an instruction must only run on a processor that has it, and nothing else is asked.
//! Every function here that uses one takes an [`Avx2`](crate::processor::Avx2), which only a processor that was asked gives.
#![allow(unsafe_code, reason = "instructions of a processor that was asked for them")]

use glam::Vec4;

/// What works on eight lanes.
pub(super) trait Lanes: Copy {
    /// Eight numbers.
    type Eight: Copy;

    fn load(self, from: &[f32; 8]) -> Self::Eight;
    fn store(self, eight: Self::Eight, to: &mut [f32; 8]);
    fn splat(self, number: f32) -> Self::Eight;
    /// The lane-wise minimum of numbers that are none of them NaN.
    fn min(self, a: Self::Eight, b: Self::Eight) -> Self::Eight;
    fn add(self, a: Self::Eight, b: Self::Eight) -> Self::Eight;
    fn sub(self, a: Self::Eight, b: Self::Eight) -> Self::Eight;
    /// The upper four lanes first.
    fn swap_halves(self, eight: Self::Eight) -> Self::Eight;
    fn halves(self, eight: Self::Eight) -> [Vec4; 2];
}

/// Twice four lanes: on any processor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Portable;

impl Lanes for Portable {
    type Eight = [Vec4; 2];

    #[inline(always)]
    fn load(self, &[a, b, c, d, e, f, g, h]: &[f32; 8]) -> [Vec4; 2] {
        [Vec4::new(a, b, c, d), Vec4::new(e, f, g, h)]
    }

    #[inline(always)]
    fn store(self, [low, high]: [Vec4; 2], to: &mut [f32; 8]) {
        let ([a, b, c, d], [e, f, g, h]) = (low.to_array(), high.to_array());
        *to = [a, b, c, d, e, f, g, h];
    }

    #[inline(always)]
    fn splat(self, number: f32) -> [Vec4; 2] {
        [Vec4::splat(number); 2]
    }

    #[inline(always)]
    fn min(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0].min(b[0]), a[1].min(b[1])]
    }

    #[inline(always)]
    fn add(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0] + b[0], a[1] + b[1]]
    }

    #[inline(always)]
    fn sub(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0] - b[0], a[1] - b[1]]
    }

    #[inline(always)]
    fn swap_halves(self, [low, high]: [Vec4; 2]) -> [Vec4; 2] {
        [high, low]
    }

    #[inline(always)]
    fn halves(self, eight: [Vec4; 2]) -> [Vec4; 2] {
        eight
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::Lanes;
    use crate::processor::Avx2;
    use glam::Vec4;
    use std::arch::x86_64::{
        __m256, _mm256_add_ps, _mm256_castps256_ps128, _mm256_extractf128_ps, _mm256_loadu_ps, _mm256_min_ps,
        _mm256_permute2f128_ps, _mm256_set1_ps, _mm256_storeu_ps, _mm256_sub_ps,
    };

    // SAFETY of all below: the processor was asked for AVX2, which includes AVX. Loads and stores are of eight lanes that are
    // there, and need no alignment.
    impl Lanes for Avx2 {
        type Eight = __m256;

        #[inline(always)]
        fn load(self, from: &[f32; 8]) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_loadu_ps(from.as_ptr()) }
        }

        #[inline(always)]
        fn store(self, eight: __m256, to: &mut [f32; 8]) {
            // SAFETY: see above.
            unsafe { _mm256_storeu_ps(to.as_mut_ptr(), eight) }
        }

        #[inline(always)]
        fn splat(self, number: f32) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_set1_ps(number) }
        }

        #[inline(always)]
        fn min(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_min_ps(a, b) }
        }

        #[inline(always)]
        fn add(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_add_ps(a, b) }
        }

        #[inline(always)]
        fn sub(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_sub_ps(a, b) }
        }

        #[inline(always)]
        fn swap_halves(self, eight: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_permute2f128_ps::<1>(eight, eight) }
        }

        #[inline(always)]
        fn halves(self, eight: __m256) -> [Vec4; 2] {
            // SAFETY: see above.
            let [low, high] = unsafe { [_mm256_castps256_ps128(eight), _mm256_extractf128_ps::<1>(eight)] };
            [low.into(), high.into()]
        }
    }
}
