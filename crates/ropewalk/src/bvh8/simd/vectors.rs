//! What AVX2 and AVX-512 do alike on vectors of eight lanes: numbers in and out, arithmetic, and what is left on a stack.

use crate::bvh8::node::Word;
use crate::bvh8::tree::WIDTH;
use crate::bvh8::walk::Stack;
use std::arch::x86_64::*;

/// Takes `count` words that were written on top of a stack; tells what lies there then.
///
/// # Safety
/// The processor has AVX2.
#[inline(always)]
pub(super) unsafe fn pushed(words: __m256i, count: u32, stack: &mut Stack) -> Word {
    let below = stack.peek();
    stack.grow(count);
    // SAFETY: the caller's.
    let last = unsafe { _mm256_permutevar8x32_epi32(words, _mm256_set1_epi32(count as i32 - 1)) };
    // SAFETY: as above.
    let last = unsafe { _mm256_cvtsi256_si32(last) } as u32;
    Word(if count == 0 { below.0 } else { last })
}

/// See [`super::Level::triples`]: each place is read whole, and eight of them are transposed, which takes less than to gather numbers one by one.
///
/// # Safety
/// The processor has AVX2; the rest is that of [`super::Level::triples`].
#[inline(always)]
pub(super) unsafe fn triples(from: [*const f32; WIDTH], axes: [u8; 3]) -> [__m256; 3] {
    // SAFETY: the caller's.
    unsafe {
        let [x, y, z] = [i32::from(axes[0]), i32::from(axes[1]), i32::from(axes[2])];
        let turns = _mm256_setr_epi32(x, y, z, 3, x, y, z, 3);
        let first = _mm256_permutevar_ps(two(from[0], from[4]), turns);
        let second = _mm256_permutevar_ps(two(from[1], from[5]), turns);
        let third = _mm256_permutevar_ps(two(from[2], from[6]), turns);
        let fourth = _mm256_permutevar_ps(two(from[3], from[7]), turns);
        let (low, high) = (_mm256_unpacklo_ps(first, second), _mm256_unpacklo_ps(third, fourth));
        let (last_low, last_high) = (_mm256_unpackhi_ps(first, second), _mm256_unpackhi_ps(third, fourth));
        [
            _mm256_shuffle_ps::<0x44>(low, high),
            _mm256_shuffle_ps::<0xee>(low, high),
            _mm256_shuffle_ps::<0x44>(last_low, last_high),
        ]
    }
}

/// See [`super::Level::few_triples`].
///
/// # Safety
/// The processor has AVX2; the rest is that of [`super::Level::few_triples`].
#[inline(always)]
pub(super) unsafe fn few_triples(from: [*const f32; WIDTH / 2], axes: [u8; 3]) -> [__m256; 3] {
    // SAFETY: the caller's.
    unsafe {
        let turns = _mm_setr_epi32(i32::from(axes[0]), i32::from(axes[1]), i32::from(axes[2]), 3);
        let first = _mm_permutevar_ps(_mm_loadu_ps(from[0]), turns);
        let second = _mm_permutevar_ps(_mm_loadu_ps(from[1]), turns);
        let third = _mm_permutevar_ps(_mm_loadu_ps(from[2]), turns);
        let fourth = _mm_permutevar_ps(_mm_loadu_ps(from[3]), turns);
        let (low, high) = (_mm_unpacklo_ps(first, second), _mm_unpacklo_ps(third, fourth));
        let (last_low, last_high) = (_mm_unpackhi_ps(first, second), _mm_unpackhi_ps(third, fourth));
        [
            _mm256_zextps128_ps256(_mm_movelh_ps(low, high)),
            _mm256_zextps128_ps256(_mm_movehl_ps(high, low)),
            _mm256_zextps128_ps256(_mm_movelh_ps(last_low, last_high)),
        ]
    }
}

/// Four numbers from each of two places.
///
/// # Safety
/// The processor has AVX2, and they can be read.
#[inline(always)]
unsafe fn two(low: *const f32, high: *const f32) -> __m256 {
    // SAFETY: the caller's.
    unsafe { _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(_mm_loadu_ps(low)), _mm_loadu_ps(high)) }
}

/// Gives a level the methods that need no mask. The level's token must prove that the processor has AVX2.
macro_rules! vector_methods {
    () => {
        #[inline(always)]
        fn splat(self, number: f32) -> __m256 {
            // SAFETY: the token proves that the instructions are there.
            unsafe { _mm256_set1_ps(number) }
        }

        #[inline(always)]
        fn row(self, row: &[f32; WIDTH]) -> __m256 {
            // SAFETY: the token proves that the instructions are there; eight numbers are read from an array of eight.
            unsafe { _mm256_loadu_ps(row.as_ptr()) }
        }

        #[inline(always)]
        unsafe fn read(self, from: *const f32) -> __m256 {
            // SAFETY: the token proves that the instructions are there; the rest is the caller's.
            unsafe { _mm256_loadu_ps(from) }
        }

        #[inline(always)]
        fn bytes(self, row: &[u8; WIDTH]) -> __m256 {
            // SAFETY: the token proves that the instructions are there; eight bytes are read from an array of eight.
            unsafe { _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(row.as_ptr().cast()))) }
        }

        #[inline(always)]
        unsafe fn triples(self, from: [*const f32; WIDTH], axes: [u8; 3]) -> [__m256; 3] {
            // SAFETY: the token proves that the instructions are there; the rest is the caller's.
            unsafe { triples(from, axes) }
        }

        #[inline(always)]
        unsafe fn few_triples(self, from: [*const f32; WIDTH / 2], axes: [u8; 3]) -> [__m256; 3] {
            // SAFETY: the token proves that the instructions are there; the rest is the caller's.
            unsafe { few_triples(from, axes) }
        }

        #[inline(always)]
        fn numbers(self, floats: __m256) -> [f32; WIDTH] {
            let mut numbers = [0.0; WIDTH];
            // SAFETY: the token proves that the instructions are there; eight numbers are written to an array of eight.
            unsafe { _mm256_storeu_ps(numbers.as_mut_ptr(), floats) };
            numbers
        }

        #[inline(always)]
        fn add(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: the token proves that the instructions are there.
            unsafe { _mm256_add_ps(a, b) }
        }

        #[inline(always)]
        fn sub(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: the token proves that the instructions are there.
            unsafe { _mm256_sub_ps(a, b) }
        }

        #[inline(always)]
        fn mul(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: the token proves that the instructions are there.
            unsafe { _mm256_mul_ps(a, b) }
        }

        #[inline(always)]
        fn div(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: the token proves that the instructions are there.
            unsafe { _mm256_div_ps(a, b) }
        }

        #[inline(always)]
        fn smaller(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: the token proves that the instructions are there.
            unsafe { _mm256_min_ps(a, b) }
        }

        #[inline(always)]
        fn larger(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: the token proves that the instructions are there.
            unsafe { _mm256_max_ps(a, b) }
        }
    };
}
pub(super) use vector_methods;
