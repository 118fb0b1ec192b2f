//! Leaves: one to eight triangles, coordinate beside coordinate, 40 bytes a triangle.
//!
//! Nine rows of `n` numbers, first vertex x, y, z and so on, and a row of `n` words, the triangles' numbers ([`super::names`]).
//! The rows lie without gaps, `4 * n` bytes each, so that a leaf of two has no room for eight; a vector that reads a row reads on into the
//! next, and what is there is masked out.

use super::tree::{LARGEST_LEAF, WIDTH};

/// Rows of numbers, before that of the names.
pub(super) const ROWS: usize = 9;
/// Bytes a triangle.
pub(super) const BYTES: usize = 4 * (ROWS + 1);
/// Bytes behind the last leaf that a vector may read.
pub(super) const MARGIN: usize = 4 * WIDTH;

/// A leaf in its arena.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf<'a> {
    /// The leaf's words and [`MARGIN`] bytes of whatever follows.
    words: &'a [u32],
    count: usize,
}

impl<'a> Leaf<'a> {
    /// `words` begin with the leaf and go on for [`Leaf::span`] words at least.
    #[inline(always)]
    pub(super) const fn new(words: &'a [u32], count: u32) -> Self {
        Self { words, count: count as usize }
    }

    /// The words that a leaf of `count` triangles lets a vector read.
    #[inline(always)]
    pub(super) const fn span(count: u32) -> usize {
        (BYTES * count as usize + MARGIN) / 4
    }

    #[inline(always)]
    pub(super) const fn len(self) -> usize {
        self.count
    }

    /// A bit a triangle.
    #[inline(always)]
    pub(super) const fn lanes(self) -> u32 {
        0xff >> (LARGEST_LEAF as usize - self.count)
    }

    /// The row of a coordinate, 0 to 8: eight numbers can be read from there.
    #[inline(always)]
    pub(super) fn row(self, row: usize) -> *const f32 {
        self.words.as_ptr().wrapping_add(row * self.count).cast()
    }

    #[inline(always)]
    pub(super) fn vertices(self, triangle: usize) -> [[f32; 3]; 3] {
        // Written out: closures are not always put into the code that is compiled for a level of vector instructions.
        [
            [self.number(0, triangle), self.number(1, triangle), self.number(2, triangle)],
            [self.number(3, triangle), self.number(4, triangle), self.number(5, triangle)],
            [self.number(6, triangle), self.number(7, triangle), self.number(8, triangle)],
        ]
    }

    /// The triangle's number.
    #[inline(always)]
    pub(super) fn name(self, triangle: usize) -> u32 {
        self.word(ROWS, triangle)
    }

    /// A coordinate of a triangle, 0 to 8.
    #[inline(always)]
    pub(super) fn number(self, row: usize, triangle: usize) -> f32 {
        f32::from_bits(self.word(row, triangle))
    }

    #[inline(always)]
    fn word(self, row: usize, triangle: usize) -> u32 {
        debug_assert!(row <= ROWS && triangle < self.count);
        // SAFETY: rows and triangles are those of the leaf: the levels' masks have a bit for each triangle and no others. The words
        // hold all rows.
        unsafe { *self.words.get_unchecked(row * self.count + triangle) }
    }
}

/// Writes a leaf.
pub(super) fn write(words: &mut [u32], triangles: &[([[f32; 3]; 3], u32)]) {
    let count = triangles.len();
    for (place, (vertices, name)) in triangles.iter().enumerate() {
        for (row, number) in vertices.as_flattened().iter().enumerate() {
            words[row * count + place] = number.to_bits();
        }
        words[ROWS * count + place] = *name;
    }
}
