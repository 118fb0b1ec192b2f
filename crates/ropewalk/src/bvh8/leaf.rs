//! Leaves: one to eight triangles, coordinate beside coordinate, 40 bytes a triangle.
//!
//! Nine rows of `n` numbers, first vertex x, y, z and so on, and a row of `n` words, the triangles' numbers ([`super::names`]).
//! The rows lie without gaps, `4 * n` bytes each, so that a leaf of two has no room for eight; a vector that reads a row reads on
//! into the next, and what is there is masked out.

mod indexed;

use super::simd::Level;
use super::tree::{LARGEST_LEAF, WIDTH};
use crate::FlatTriangle;
pub(super) use indexed::IndexedLeaf;

/// A leaf as walks read it, wherever its vertices are.
pub(super) trait Triangles: Copy {
    fn len(self) -> usize;

    /// A bit a triangle.
    #[inline(always)]
    fn lanes(self) -> u32 {
        0xff >> (LARGEST_LEAF as usize - self.len())
    }

    /// The triangle's number.
    fn name(self, triangle: usize) -> u32;

    /// A coordinate of a triangle, 0 to 8: first vertex x, y, z and so on.
    fn number(self, row: usize, triangle: usize) -> f32;

    /// The vertices of all triangles, a lane a triangle, their axes in some order. Lanes behind the last triangle mean nothing.
    ///
    /// # Safety
    /// The leaf is one of an arena; the axes are 0, 1 and 2, in any order.
    unsafe fn corners<L: Level>(self, level: L, axes: [u8; 3]) -> [[L::Floats; 3]; 3];

    #[inline(always)]
    fn vertices(self, triangle: usize) -> [[f32; 3]; 3] {
        // Written out: closures are not always put into the code that is compiled for a level of vector instructions.
        [
            [self.number(0, triangle), self.number(1, triangle), self.number(2, triangle)],
            [self.number(3, triangle), self.number(4, triangle), self.number(5, triangle)],
            [self.number(6, triangle), self.number(7, triangle), self.number(8, triangle)],
        ]
    }
}

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

    /// The row of a coordinate, 0 to 8: eight numbers can be read from there.
    #[inline(always)]
    fn row(self, row: usize) -> *const f32 {
        self.words.as_ptr().wrapping_add(row * self.count).cast()
    }

    #[inline(always)]
    fn word(self, row: usize, triangle: usize) -> u32 {
        debug_assert!(row <= ROWS && triangle < self.count);
        // SAFETY: rows and triangles are those of the leaf: the levels' masks have a bit for each triangle and no others. The words
        // hold all rows.
        unsafe { *self.words.get_unchecked(row * self.count + triangle) }
    }
}

impl Triangles for Leaf<'_> {
    #[inline(always)]
    fn len(self) -> usize {
        self.count
    }

    #[inline(always)]
    fn name(self, triangle: usize) -> u32 {
        self.word(ROWS, triangle)
    }

    #[inline(always)]
    fn number(self, row: usize, triangle: usize) -> f32 {
        f32::from_bits(self.word(row, triangle))
    }

    #[inline(always)]
    unsafe fn corners<L: Level>(self, level: L, axes: [u8; 3]) -> [[L::Floats; 3]; 3] {
        let [x, y, z] = axes;
        let (x, y, z) = (self.row(usize::from(x)), self.row(usize::from(y)), self.row(usize::from(z)));
        let vertex = 3 * self.count;
        // SAFETY: the caller's: eight numbers can be read from the beginning of any row. Axes are 0, 1 and 2, and a vertex has
        // three rows, so that all nine are those of the leaf.
        unsafe {
            [
                [level.read(x), level.read(y), level.read(z)],
                [level.read(x.add(vertex)), level.read(y.add(vertex)), level.read(z.add(vertex))],
                [level.read(x.add(2 * vertex)), level.read(y.add(2 * vertex)), level.read(z.add(2 * vertex))],
            ]
        }
    }
}

/// Writes a leaf of triangles and their numbers.
#[inline(always)]
pub(super) fn write<const COUNT: usize>(
    words: &mut [u32],
    triangles: [&FlatTriangle; COUNT],
    numbers: [u32; COUNT],
) {
    // Rows of a length that the compiler knows: none of the stores below is checked.
    let (rows, _) = words.as_chunks_mut::<COUNT>();
    let Some(rows) = rows.first_chunk_mut::<{ ROWS + 1 }>() else { return };
    for (place, triangle) in triangles.iter().enumerate() {
        for axis in 0..3 {
            rows[axis][place] = triangle.v0[axis].to_bits();
            rows[3 + axis][place] = triangle.v1[axis].to_bits();
            rows[6 + axis][place] = triangle.v2[axis].to_bits();
        }
    }
    rows[ROWS] = numbers;
}
