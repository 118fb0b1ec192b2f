//! The best ways to cut a treelet into leaves of neighbours, by dynamic programming.
//!
//! Every cut into 1 to 8 leaves is weighed: the least sum of areas of the first `j` triangles in `k` leaves is
//! ```text
//! least(j, k) = min over the length l of the last leaf of least(j - l, k - 1) + area(j - l .. j)
//! ```
//! One `k` after the other, for eight `j` at a time: none of these waits for another one. So how full leaves are, and where
//! they begin, is not left to the curve.

use crate::bvh::build::reference::Extent;
use crate::bvh8::tree::{LARGEST_LEAF, WIDTH};
use std::ops::Range;

/// The most triangles of a treelet: with full leaves of 4 they fit one wide node, and a mask has a bit for each.
pub(super) const MOST: usize = 32;

/// The best cuts of a treelet into leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cuts {
    /// With at most 1, 2, .. 8 leaves: the least sum of their areas. Infinite where so few cannot hold all.
    pub(super) least: [f32; WIDTH],
    /// A bit for each triangle that begins a leaf in the cut that has that sum.
    pub(super) begins: [u32; WIDTH],
    /// The boxes of the leaves of the last cut, to which most treelets come.
    pub(super) boxes: [Corners; WIDTH],
}

/// A box without padding.
pub(super) type Corners = [[f32; 3]; 2];

/// The leaves that begin where a mask says, of so many triangles.
#[inline(always)]
pub(super) fn leaves(mut begins: u32, count: usize) -> impl Iterator<Item = Range<usize>> {
    std::iter::from_fn(move || {
        let first = (begins != 0).then(|| begins.trailing_zeros() as usize)?;
        begins &= begins - 1;
        Some(first..if begins == 0 { count } else { begins.trailing_zeros() as usize })
    })
}

#[inline(always)]
pub(super) fn union(boxes: impl Iterator<Item = Extent>) -> Extent {
    boxes.fold(Extent::EMPTY, Extent::union)
}

/// Cuts one treelet after the other.
pub(super) struct Cutter {
    max_leaf: usize,
    /// The boxes of the triangles.
    boxes: [Extent; MOST],
    /// Smallest x, y, z, largest x, y, z of the same, behind a margin for vectors that begin before the first.
    rows: [[f32; WIDTH + MOST]; 6],
    /// Of each length the areas of the leaves that end with each triangle.
    areas: [[f32; MOST]; LARGEST_LEAF as usize],
    /// In 0 to 8 leaves the least sums of the first 0, 1, .. triangles, behind a margin: what would be cut of fewer than no triangles
    /// is infinite. So are no triangles in any leaf, and some in none.
    sums: [[f32; MARGIN + MOST + 1]; WIDTH + 1],
    /// The lengths of the last leaves.
    lengths: [[u32; MARGIN + MOST + 1]; WIDTH + 1],
}

/// So many sums lie before that of no triangles: then those of eight numbers of triangles begin on a boundary.
const MARGIN: usize = WIDTH - 1;

impl Cutter {
    pub(super) fn new(max_leaf: u32) -> Self {
        let mut sums = [[f32::INFINITY; MARGIN + MOST + 1]; WIDTH + 1];
        sums[0][MARGIN] = 0.0;
        Self {
            max_leaf: (max_leaf as usize).min(LARGEST_LEAF as usize),
            boxes: [Extent::EMPTY; MOST],
            rows: [[0.0; WIDTH + MOST]; 6],
            areas: [[0.0; MOST]; LARGEST_LEAF as usize],
            sums,
            lengths: [[1; MARGIN + MOST + 1]; WIDTH + 1],
        }
    }

    /// The box of a triangle, 0 to [`MOST`] less one.
    #[inline(always)]
    pub(super) fn set(&mut self, place: usize, bounds: Extent) {
        let place = place % MOST;
        self.boxes[place] = bounds;
        let ([low_x, low_y, low_z, _], [high_x, high_y, high_z, _]) =
            (bounds.low.to_array(), bounds.high.to_array());
        let corners = [low_x, low_y, low_z, high_x, high_y, high_z];
        for (row, corner) in self.rows.iter_mut().zip(corners) {
            row[WIDTH + place] = corner;
        }
    }

    /// The best cuts of the first `count` boxes, 1 to [`MOST`].
    #[inline(always)]
    pub(super) fn cuts(&mut self, count: usize) -> Cuts {
        let count = count.min(MOST);
        self.measure(count);
        for leaves in 1..=WIDTH {
            self.add_leaf(leaves, count);
        }
        let mut cuts =
            Cuts { least: [f32::INFINITY; WIDTH], begins: [0; WIDTH], boxes: [[[0.0; 3]; 2]; WIDTH] };
        let (mut least, mut begins) = (f32::INFINITY, 0);
        for leaves in 1..=WIDTH {
            let sum = self.sums[leaves][MARGIN + count];
            if sum < least {
                (least, begins) = (sum, self.begins(count, leaves));
            }
            (cuts.least[leaves - 1], cuts.begins[leaves - 1]) = (least, begins);
        }
        for (corners, leaf) in cuts.boxes.iter_mut().zip(leaves(begins, count)) {
            let bounds = union(self.boxes[leaf].iter().copied()).bounds();
            *corners = [bounds.min.to_array(), bounds.max.to_array()];
        }
        cuts
    }

    /// Finds the areas of all leaves that the first `count` triangles may make, eight at a time.
    #[inline(always)]
    fn measure(&mut self, count: usize) {
        for first in (0..count.min(MOST)).step_by(WIDTH) {
            let mut corners = [[f32::INFINITY; WIDTH]; 6];
            corners[3..].fill([f32::NEG_INFINITY; WIDTH]);
            for (before, areas) in self.areas.iter_mut().enumerate().take(self.max_leaf) {
                // Of leaves that would begin before the first triangle there comes anything, and nobody asks for it.
                let from = WIDTH + first - before;
                for (row, corners) in corners.iter_mut().enumerate() {
                    let more = &self.rows[row][from..from + WIDTH];
                    for (corner, &more) in corners.iter_mut().zip(more) {
                        let is_beyond = if row < 3 { more < *corner } else { more > *corner };
                        *corner = if is_beyond { more } else { *corner };
                    }
                }
                for (lane, area) in areas[first..first + WIDTH].iter_mut().enumerate() {
                    let [x, y, z] = [0, 1, 2].map(|axis| corners[3 + axis][lane] - corners[axis][lane]);
                    *area = x * y + y * z + z * x;
                }
            }
        }
    }

    /// Finds the least sums of up to `count` triangles in so many leaves from those in one fewer.
    #[inline(always)]
    fn add_leaf(&mut self, leaves: usize, count: usize) {
        let (before, after) = self.sums.split_at_mut(leaves);
        let (Some(before), Some(after)) = (before.last(), after.first_mut()) else { return };
        for first in (0..count).step_by(WIDTH) {
            let mut sums = [f32::INFINITY; WIDTH];
            let mut lengths = [1; WIDTH];
            for (one_less, areas) in self.areas.iter().enumerate().take(self.max_leaf) {
                let from = MARGIN + first - one_less;
                let (before, areas) = (&before[from..from + WIDTH], &areas[first..first + WIDTH]);
                for lane in 0..WIDTH {
                    let through = before[lane] + areas[lane];
                    let better = through < sums[lane];
                    sums[lane] = if better { through } else { sums[lane] };
                    lengths[lane] = if better { one_less as u32 + 1 } else { lengths[lane] };
                }
            }
            let to = MARGIN + 1 + first;
            after[to..to + WIDTH].copy_from_slice(&sums);
            self.lengths[leaves][to..to + WIDTH].copy_from_slice(&lengths);
        }
    }

    /// Finds the choices again: who begins a leaf in the best cut of the first `end` into so many leaves.
    #[inline(always)]
    fn begins(&self, mut end: usize, leaves: usize) -> u32 {
        let mut begins = 0;
        for leaves in (1..=leaves).rev() {
            end = end.saturating_sub(self.lengths[leaves][MARGIN + end] as usize);
            begins |= 1 << end;
        }
        begins
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn extent(low: [f32; 3], high: [f32; 3]) -> Extent {
        Extent { low: Vec3::from(low).extend(0.0), high: Vec3::from(high).extend(0.0) }
    }

    fn cuts(boxes: &[Extent], max_leaf: u32) -> Cuts {
        let mut cutter = Cutter::new(max_leaf);
        // What was there before must not matter.
        cutter.cuts(MOST);
        boxes.iter().enumerate().for_each(|(place, one)| cutter.set(place, *one));
        cutter.cuts(boxes.len())
    }

    /// The least sum over all cuts into at most `leaves` leaves.
    fn brute(boxes: &[Extent], max_leaf: usize, leaves: usize) -> f32 {
        if boxes.is_empty() {
            return 0.0;
        }
        if leaves == 0 {
            return f32::INFINITY;
        }
        (1..=max_leaf.min(boxes.len()))
            .map(|length| {
                let (leaf, rest) = boxes.split_at(length);
                let bounds = leaf.iter().fold(Extent::EMPTY, |bounds, one| bounds.union(*one));
                bounds.half_area() + brute(rest, max_leaf, leaves - 1)
            })
            .fold(f32::INFINITY, f32::min)
    }

    #[test]
    fn no_cut_costs_less() {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f32::from((state >> 24) as u8)
        };
        for count in 1..=12 {
            let boxes: Vec<Extent> = (0..count)
                .map(|_| {
                    let low = [random(), random(), random()];
                    extent(low, low.map(|low| low + random()))
                })
                .collect();
            for max_leaf in [1, 3, 4, 8] {
                let Cuts { least, begins, boxes: leaf_boxes } = cuts(&boxes, max_leaf as u32);
                let last = begins[WIDTH - 1];
                for leaves in 1..=WIDTH {
                    let expected = brute(&boxes, max_leaf, leaves);
                    // Integers, so sums are exact in any order.
                    assert_eq!(least[leaves - 1], expected, "{count} {max_leaf} {leaves}");
                    let begins = begins[leaves - 1];
                    if expected == f32::INFINITY {
                        assert_eq!(begins, 0);
                        continue;
                    }
                    let mut starts: Vec<usize> = (0..count).filter(|&i| begins >> i & 1 == 1).collect();
                    assert!(starts[0] == 0 && starts.len() <= leaves);
                    starts.push(count);
                    let sum: f32 = starts
                        .windows(2)
                        .map(|pair| {
                            assert!(pair[1] - pair[0] <= max_leaf);
                            let leaf = &boxes[pair[0]..pair[1]];
                            leaf.iter().fold(Extent::EMPTY, |bounds, one| bounds.union(*one)).half_area()
                        })
                        .sum();
                    assert_eq!(sum, expected);
                    if begins == last {
                        let of = |&[low, high]: &Corners| Extent {
                            low: Vec3::from(low).extend(0.0),
                            high: Vec3::from(high).extend(0.0),
                        };
                        let stored: f32 =
                            leaf_boxes[..starts.len() - 1].iter().map(|one| of(one).half_area()).sum();
                        assert_eq!(stored, expected);
                    }
                }
            }
        }
    }

    #[test]
    fn a_full_treelet_has_eight_full_leaves() {
        let boxes: Vec<Extent> = (0..MOST as u8)
            .map(|i| extent([f32::from(i), 0.0, 0.0], [f32::from(i) + 1.0, 1.0, 1.0]))
            .collect();
        let Cuts { least, begins, .. } = cuts(&boxes, 4);
        assert_eq!(least[..WIDTH - 1], [f32::INFINITY; WIDTH - 1]);
        assert_eq!((least[WIDTH - 1], begins[WIDTH - 1]), (8.0 * 9.0, 0x1111_1111));
    }
}
