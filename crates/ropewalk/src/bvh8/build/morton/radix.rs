//! Sorts words by the code in their upper part: least significant digit first, three passes of 11 bits, stable.
//!
//! Words come with their indices ascending below the codes, so the result is that of any sort of whole words. Large lists
//! are counted and scattered by several threads: each has a range of the list and, of each digit, a range of the output.
//!
//! 8 bytes a word for the second list; on one core some 2 ns a word and pass.

use super::code::{CODE_BITS, INDEX_BITS};
use crate::memory::zeros;
use crate::parallel::{fill_chunks, map_chunks};
use std::slice::IterMut;

/// Bits of a digit: of as many places as a digit has values one cache line each fits the second level cache.
const DIGIT: u32 = 11;
const VALUES: usize = 1 << DIGIT;
/// Shorter lists are sorted by comparisons, which is faster than to count 2048 values three times.
const FEW: usize = 1024;
/// The words that make it worth to have one more thread count and scatter, which costs some 10 µs.
const CHUNK: usize = 1 << 16;
/// The most ranges of a list. What passes between caches grows with them.
const MOST_CHUNKS: usize = 16;

/// The words in order.
pub(super) fn sorted(mut words: Vec<u64>) -> Vec<u64> {
    if words.len() < FEW {
        words.sort_unstable();
        return words;
    }
    let chunks = (words.len() / CHUNK).clamp(1, MOST_CHUNKS);
    let mut other = zeros(words.len());
    for pass in 0..CODE_BITS / DIGIT {
        if scatter(&words, &mut other, INDEX_BITS + pass * DIGIT, words.len().div_ceil(chunks)) {
            std::mem::swap(&mut words, &mut other);
        }
    }
    words
}

#[inline(always)]
const fn digit(word: u64, shift: u32) -> usize {
    (word >> shift) as usize % VALUES
}

/// Of a range of the list: its words, and of each digit the places in the output that are its.
type Task<'a> = (&'a [u64], Vec<IterMut<'a, u64>>);

/// Puts words into the order of a digit; `false` where that changes nothing, and nothing was done.
fn scatter(words: &[u64], output: &mut [u64], shift: u32, chunk: usize) -> bool {
    let counts = map_chunks(words, chunk, |_, part| {
        let mut counts = vec![0_u32; VALUES];
        part.iter().for_each(|&word| counts[digit(word, shift)] += 1);
        counts
    });
    let first = words.first().map_or(0, |&word| digit(word, shift));
    if counts.iter().map(|counts| counts[first] as usize).sum::<usize>() == words.len() {
        return false;
    }
    let mut tasks: Vec<Task<'_>> =
        words.chunks(chunk).map(|part| (part, Vec::with_capacity(VALUES))).collect();
    let mut rest = output;
    for value in 0..VALUES {
        for ((_, places), counts) in tasks.iter_mut().zip(&counts) {
            let (places_of_value, behind) = rest.split_at_mut(counts[value] as usize);
            places.push(places_of_value.iter_mut());
            rest = behind;
        }
    }
    fill_chunks(&mut tasks, 1, |_, tasks| {
        for (part, places) in tasks {
            for &word in *part {
                if let Some(place) = places[digit(word, shift)].next() {
                    *place = word;
                }
            }
        }
    });
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(count: u64, spread: u32) -> Vec<u64> {
        let mut state = count;
        let word = |index| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> (64 - spread)) << INDEX_BITS | index
        };
        (0..count).map(word).collect()
    }

    #[test]
    fn words_come_out_in_order() {
        for count in [0, 1, 1000, 1024, 5000, 70_000, 300_000] {
            for spread in [1, 5, 12, 33] {
                let words = words(count, spread);
                let mut expected = words.clone();
                expected.sort_unstable();
                assert!(sorted(words) == expected, "{count} {spread}");
            }
        }
    }
}
