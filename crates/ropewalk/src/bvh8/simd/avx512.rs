//! AVX-512 F and VL on vectors of eight lanes: masks instead of branches, and compression in registers.
//!
//! Compression goes to a register and is then stored whole: the form that stores while it compresses is microcoded on Zen 4
//! (142 cycles a store). What is stored beyond the top of the stack is overwritten by the next push.

use super::vectors::{few_triples, pushed, triples, vector_methods};
use super::{Level, Task};
use crate::bvh8::node::{Fan, Word};
use crate::bvh8::tree::WIDTH;
use crate::bvh8::walk::Stack;
use crate::processor::Avx512 as Processor;
use std::arch::x86_64::*;

/// Proof that the processor has the instructions.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Avx512(());

#[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn run<T: Task>(level: Avx512, task: T) -> T::Output {
    task.run(level)
}

impl Level for Avx512 {
    type Floats = __m256;
    type Mask = __mmask8;

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
    fn less(self, a: __m256, b: __m256) -> __mmask8 {
        // SAFETY: the token proves that the instructions are there.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LT_OQ>(a, b) }
    }

    #[inline(always)]
    fn at_most(self, a: __m256, b: __m256) -> __mmask8 {
        // SAFETY: the token proves that the instructions are there.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b) }
    }

    #[inline(always)]
    fn both(self, a: __mmask8, b: __mmask8) -> __mmask8 {
        a & b
    }

    #[inline(always)]
    fn either(self, a: __mmask8, b: __mmask8) -> __mmask8 {
        a | b
    }

    #[inline(always)]
    fn bits(self, mask: __mmask8) -> u32 {
        u32::from(mask)
    }

    #[inline(always)]
    fn filled(self, fan: &Fan, mask: __mmask8) -> __mmask8 {
        // SAFETY: the token proves that the instructions are there. The words are eight on a boundary of 32 bytes.
        unsafe {
            let words = _mm256_load_si256(fan.children.as_ptr().cast());
            _mm256_mask_test_epi32_mask(mask, words, words)
        }
    }

    #[inline(always)]
    fn select(self, mask: __mmask8, yes: __m256, no: __m256) -> __m256 {
        // SAFETY: the token proves that the instructions are there.
        unsafe { _mm256_mask_mov_ps(no, mask, yes) }
    }

    #[inline(always)]
    fn push_ordered(
        self,
        fan: &Fan,
        octant_shift: u32,
        entries: __m256,
        hit: __mmask8,
        stack: &mut Stack,
    ) -> Word {
        // SAFETY: the token proves that the instructions are there. The rows of a fan are eight words on a boundary of 32
        // bytes; `Stack::top` has room for eight.
        unsafe {
            let turns = _mm256_load_si256(fan.order.as_ptr().cast());
            let turns = _mm256_srl_epi32(turns, _mm_cvtsi32_si128(octant_shift as i32));
            // What is missed gets an entry that no box has, so that one comparison behind the permutation tells.
            let missed = _mm256_set1_ps(f32::INFINITY);
            let near = _mm256_permutexvar_ps(turns, _mm256_mask_mov_ps(missed, hit, entries));
            let words = _mm256_permutexvar_epi32(turns, _mm256_load_si256(fan.children.as_ptr().cast()));
            let kept = _mm256_cmp_ps_mask::<_CMP_LT_OQ>(near, missed);
            let (word_top, entry_top) = stack.top();
            let words = _mm256_maskz_compress_epi32(kept, words);
            _mm256_storeu_si256(word_top.cast(), words);
            _mm256_storeu_ps(entry_top, _mm256_maskz_compress_ps(kept, near));
            pushed(words, hit.count_ones(), stack)
        }
    }

    #[inline(always)]
    fn push_unordered(self, fan: &Fan, hit: __mmask8, stack: &mut Stack) -> Word {
        // SAFETY: as above.
        unsafe {
            let words = _mm256_load_si256(fan.children.as_ptr().cast());
            let (word_top, _) = stack.top();
            let words = _mm256_maskz_compress_epi32(hit, words);
            _mm256_storeu_si256(word_top.cast(), words);
            pushed(words, hit.count_ones(), stack)
        }
    }

    #[inline(always)]
    fn cull(self, stack: &mut Stack, t_max: f32) {
        // SAFETY: the token proves that the instructions are there. Loads and stores of sixteen begin below the stack's
        // length, and there are at least sixteen places above it; a store never reaches beyond what was loaded.
        unsafe {
            let (words, entries) = stack.bottom();
            let limit = _mm512_set1_ps(t_max);
            let (length, mut kept) = (stack.len(), 0);
            let mut from = 0;
            while from < length {
                let here = (length - from).min(16);
                let lanes = (0xffff_u32 >> (16 - here)) as __mmask16;
                let word = _mm512_maskz_loadu_epi32(lanes, words.add(from).cast());
                let entry = _mm512_maskz_loadu_ps(lanes, entries.add(from));
                let keep = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(lanes, entry, limit);
                _mm512_storeu_si512(words.add(kept).cast(), _mm512_maskz_compress_epi32(keep, word));
                _mm512_storeu_ps(entries.add(kept), _mm512_maskz_compress_ps(keep, entry));
                kept += keep.count_ones() as usize;
                from += 16;
            }
            stack.shrink_to(kept);
        }
    }
}
