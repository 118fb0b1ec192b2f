//! AVX2 on vectors of eight lanes. What AVX-512 compresses, a table permutes: 256 rows of eight bytes.

use super::vectors::{few_triples, pushed, triples, vector_methods};
use super::{Level, Task};
use crate::bvh8::node::{Fan, Word};
use crate::bvh8::tree::WIDTH;
use crate::bvh8::walk::Stack;
use crate::processor::Avx2 as Processor;
use std::arch::x86_64::*;

/// Proof that the processor has the instructions.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Avx2(());

/// For every set of lanes, the lanes of the set, lowest first, as bytes.
static LANES: [u64; 256] = lanes();

const fn lanes() -> [u64; 256] {
    let mut table = [0; 256];
    let mut set = 0;
    while set < 256 {
        let (mut lane, mut place) = (0, 0);
        while lane < 8 {
            if set >> lane & 1 == 1 {
                table[set] |= (lane as u64) << (8 * place);
                place += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    table
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn run<T: Task>(level: Avx2, task: T) -> T::Output {
    task.run(level)
}

impl Avx2 {
    /// The permutation that moves the lanes of a set to the front.
    #[inline(always)]
    fn compression(self, set: u32) -> __m256i {
        // SAFETY: the token proves that the instructions are there.
        unsafe { _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(LANES[(set & 0xff) as usize] as i64)) }
    }
}

impl Level for Avx2 {
    type Floats = __m256;
    type Mask = __m256;

    #[inline(always)]
    fn detect() -> Option<Self> {
        // Which was asked for all that `run` below is compiled for.
        Processor::detect().map(|_| Self(()))
    }

    #[inline(always)]
    fn run<T: Task>(self, task: T) -> T::Output {
        // SAFETY: the token proves that the processor has every feature that `run` is compiled for.
        unsafe { run(self, task) }
    }

    vector_methods!();

    #[inline(always)]
    fn less(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: the token proves that the instructions are there.
        unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(a, b) }
    }

    #[inline(always)]
    fn at_most(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: the token proves that the instructions are there.
        unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(a, b) }
    }

    #[inline(always)]
    fn both(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: the token proves that the instructions are there.
        unsafe { _mm256_and_ps(a, b) }
    }

    #[inline(always)]
    fn either(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: the token proves that the instructions are there.
        unsafe { _mm256_or_ps(a, b) }
    }

    #[inline(always)]
    fn bits(self, mask: __m256) -> u32 {
        // SAFETY: the token proves that the instructions are there.
        unsafe { _mm256_movemask_ps(mask) as u32 }
    }

    #[inline(always)]
    fn filled(self, fan: &Fan, mask: __m256) -> __m256 {
        // SAFETY: the token proves that the instructions are there. The words are eight on a boundary of 32 bytes.
        unsafe {
            let words = _mm256_load_si256(fan.children.as_ptr().cast());
            let empty = _mm256_cmpeq_epi32(words, _mm256_setzero_si256());
            _mm256_andnot_ps(_mm256_castsi256_ps(empty), mask)
        }
    }

    #[inline(always)]
    fn select(self, mask: __m256, yes: __m256, no: __m256) -> __m256 {
        // SAFETY: the token proves that the instructions are there.
        unsafe { _mm256_blendv_ps(no, yes, mask) }
    }

    #[inline(always)]
    fn push_ordered(
        self,
        fan: &Fan,
        octant_shift: u32,
        entries: __m256,
        hit: __m256,
        stack: &mut Stack,
    ) -> Word {
        // SAFETY: the token proves that the instructions are there. The rows of a fan are eight words on a boundary of 32
        // bytes; `Stack::top` has room for eight.
        unsafe {
            let turns = _mm256_load_si256(fan.order.as_ptr().cast());
            let turns = _mm256_srl_epi32(turns, _mm_cvtsi32_si128(octant_shift as i32));
            let kept = _mm256_movemask_ps(_mm256_permutevar8x32_ps(hit, turns)) as u32;
            // One permutation behind the other is one permutation by the permuted.
            let turns = _mm256_permutevar8x32_epi32(turns, self.compression(kept));
            let words = _mm256_load_si256(fan.children.as_ptr().cast());
            let (word_top, entry_top) = stack.top();
            let words = _mm256_permutevar8x32_epi32(words, turns);
            _mm256_storeu_si256(word_top.cast(), words);
            _mm256_storeu_ps(entry_top, _mm256_permutevar8x32_ps(entries, turns));
            pushed(words, kept.count_ones(), stack)
        }
    }

    #[inline(always)]
    fn push_unordered(self, fan: &Fan, hit: __m256, stack: &mut Stack) -> Word {
        // SAFETY: as above.
        unsafe {
            let kept = self.bits(hit);
            let words = _mm256_load_si256(fan.children.as_ptr().cast());
            let (word_top, _) = stack.top();
            let words = _mm256_permutevar8x32_epi32(words, self.compression(kept));
            _mm256_storeu_si256(word_top.cast(), words);
            pushed(words, kept.count_ones(), stack)
        }
    }

    #[inline(always)]
    fn cull(self, stack: &mut Stack, t_max: f32) {
        // SAFETY: the token proves that the instructions are there. Loads and stores of eight begin below the stack's
        // length, and there are at least sixteen places above it; a store never reaches beyond what was loaded.
        unsafe {
            let (words, entries) = stack.bottom();
            let limit = _mm256_set1_ps(t_max);
            let (length, mut kept) = (stack.len(), 0);
            let mut from = 0;
            while from < length {
                let lanes = 0xff_u32 >> (8 - (length - from).min(8));
                let word = _mm256_loadu_si256(words.add(from).cast());
                let entry = _mm256_loadu_ps(entries.add(from));
                let keep = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(entry, limit)) as u32 & lanes;
                let turns = self.compression(keep);
                _mm256_storeu_si256(words.add(kept).cast(), _mm256_permutevar8x32_epi32(word, turns));
                _mm256_storeu_ps(entries.add(kept), _mm256_permutevar8x32_ps(entry, turns));
                kept += keep.count_ones() as usize;
                from += 8;
            }
            stack.shrink_to(kept);
        }
    }
}
