//! Leaves of compact trees: one to eight triangles of 16 bytes that name their vertices.
//!
//! Four words a triangle: where each of its vertices begins in the arena, in words, and the triangle's number
//! ([`crate::bvh8::names`]). Vertices are three numbers each and lie in a section of their own, each place once
//! ([`crate::bvh8::compact`]). To read four triangles takes 12 loads of four numbers and three transpositions, more take twice as
//! much.

use super::Triangles;
use crate::bvh8::simd::Level;
use crate::bvh8::tree::WIDTH;

/// Words a triangle.
const WORDS: usize = 4;
/// Where among them is its number.
const NAME: usize = 3;

/// A leaf in its arena.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct IndexedLeaf<'a> {
    /// Those of the arena.
    words: &'a [u32],
    /// The first word of the leaf.
    first: usize,
    count: usize,
}

impl<'a> IndexedLeaf<'a> {
    /// Bytes a triangle.
    pub(in super::super) const BYTES: usize = 4 * WORDS;
    /// Bytes behind the last vertex that a vector may read.
    pub(in super::super) const MARGIN: usize = 4;

    /// # Safety
    /// A leaf of `count` triangles begins at the word `first`. Its vertices lie inside of the words, and a word more behind each.
    #[inline(always)]
    pub(in super::super) unsafe fn new(words: &'a [u32], first: usize, count: u32) -> Self {
        debug_assert!(first + WORDS * count as usize <= words.len());
        Self { words, first, count: count as usize }
    }

    /// Where a vertex begins in the arena, in words.
    #[inline(always)]
    pub(in super::super) fn vertex(self, corner: usize, triangle: usize) -> usize {
        debug_assert!(corner < NAME);
        self.word(triangle, corner) as usize
    }

    /// A lane's triangle. What lies behind the last one is none, so that the last is taken again.
    #[inline(always)]
    fn or_last(self, lane: usize) -> usize {
        if lane < self.count { lane } else { self.count - 1 }
    }

    #[inline(always)]
    fn word(self, triangle: usize, word: usize) -> u32 {
        debug_assert!(triangle < self.count && word < WORDS);
        // SAFETY: the maker's: the triangle is one of the leaf, as the levels' masks have a bit for each of them and no others.
        unsafe { *self.words.get_unchecked(self.first + WORDS * triangle + word) }
    }
}

impl Triangles for IndexedLeaf<'_> {
    #[inline(always)]
    fn len(self) -> usize {
        self.count
    }

    #[inline(always)]
    fn name(self, triangle: usize) -> u32 {
        self.word(triangle, NAME)
    }

    #[inline(always)]
    fn number(self, row: usize, triangle: usize) -> f32 {
        let vertex = self.vertex(row / 3, triangle);
        debug_assert!(vertex + 3 < self.words.len());
        // SAFETY: the maker's: the vertex has three numbers.
        f32::from_bits(unsafe { *self.words.get_unchecked(vertex + row % 3) })
    }

    #[inline(always)]
    unsafe fn corners<L: Level>(self, level: L, axes: [u8; 3]) -> [[L::Floats; 3]; 3] {
        const FEW: usize = WIDTH / 2;
        let mut corners = [[level.splat(0.0); 3]; 3];
        // Trees whose leaves have four triangles at most never take the other way, and that is foreseen.
        if self.count <= FEW {
            for (corner, triple) in corners.iter_mut().enumerate() {
                let mut from = [self.words.as_ptr().cast::<f32>(); FEW];
                for (lane, from) in from.iter_mut().enumerate() {
                    *from = from.wrapping_add(self.vertex(corner, self.or_last(lane)));
                }
                // SAFETY: the maker's: the vertices lie inside with a word more behind each. The axes are the caller's.
                *triple = unsafe { level.few_triples(from, axes) };
            }
        } else {
            for (corner, triple) in corners.iter_mut().enumerate() {
                let mut from = [self.words.as_ptr().cast::<f32>(); WIDTH];
                for (lane, from) in from.iter_mut().enumerate() {
                    *from = from.wrapping_add(self.vertex(corner, self.or_last(lane)));
                }
                // SAFETY: as above.
                *triple = unsafe { level.triples(from, axes) };
            }
        }
        corners
    }
}
