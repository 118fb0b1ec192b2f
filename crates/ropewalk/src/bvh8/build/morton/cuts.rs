//! The best ways to cut a treelet into leaves of neighbours, by dynamic programming.
//!
//! Every cut into 1 to 8 leaves is weighed: the least sum of areas of the first `j` triangles in `k` leaves is
//! ```text
//! least(j, k) = min over the length l of the last leaf of least(j - l, k - 1) + area(j - l .. j)
//! ```
//! which is eight lanes at a time, and at most `max_leaf` areas a triangle: some 15 ns. So how full leaves are, and where
//! they begin, is not left to the curve.

use crate::bvh::build::reference::Extent;
use crate::bvh8::tree::WIDTH;
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
#[inline]
pub(super) fn leaves(mut begins: u32, count: usize) -> impl Iterator<Item = Range<usize>> {
    std::iter::from_fn(move || {
        let first = (begins != 0).then(|| begins.trailing_zeros() as usize)?;
        begins &= begins - 1;
        Some(first..if begins == 0 { count } else { begins.trailing_zeros() as usize })
    })
}

#[inline]
pub(super) fn union(boxes: impl Iterator<Item = Extent>) -> Extent {
    boxes.fold(Extent::EMPTY, Extent::union)
}

/// Cuts one treelet after the other.
pub(super) struct Cutter {
    max_leaf: usize,
    /// The boxes of the triangles.
    pub(super) boxes: [Extent; MOST],
    /// The least sums of the first 0, 1, .. triangles in 1 to 8 leaves, from lane 8 on. Lane 7 is for no leaf at all: 0 of
    /// no triangles, else infinite. What stands in the rows from the treelet before is written before it is read.
    sums: [[f32; 2 * WIDTH]; MOST + 1],
    /// The lengths of the last leaves.
    lengths: [[u32; WIDTH]; MOST + 1],
}

impl Cutter {
    pub(super) fn new(max_leaf: u32) -> Self {
        let mut sums = [[f32::INFINITY; 2 * WIDTH]; MOST + 1];
        sums[0][WIDTH - 1] = 0.0;
        let lengths = [[1; WIDTH]; MOST + 1];
        Self { max_leaf: max_leaf as usize, boxes: [Extent::EMPTY; MOST], sums, lengths }
    }

    /// The best cuts of the first `count` boxes, 1 to [`MOST`].
    #[inline]
    pub(super) fn cuts(&mut self, count: usize) -> Cuts {
        for end in 1..=count {
            let mut sums = [f32::INFINITY; WIDTH];
            let mut lengths = [1; WIDTH];
            let mut bounds = Extent::EMPTY;
            for (length, first) in (1..=self.max_leaf).zip((0..end).rev()) {
                bounds = bounds.union(self.boxes[first]);
                let area = bounds.half_area();
                let before = &self.sums[first][WIDTH - 1..2 * WIDTH - 1];
                for ((sum, chosen), before) in sums.iter_mut().zip(&mut lengths).zip(before) {
                    let through = before + area;
                    let better = through < *sum;
                    *sum = if better { through } else { *sum };
                    *chosen = if better { length as u32 } else { *chosen };
                }
            }
            self.sums[end][WIDTH..].copy_from_slice(&sums);
            self.lengths[end] = lengths;
        }
        let mut cuts =
            Cuts { least: [f32::INFINITY; WIDTH], begins: [0; WIDTH], boxes: [[[0.0; 3]; 2]; WIDTH] };
        let (mut least, mut begins) = (f32::INFINITY, 0);
        for (more, &sum) in self.sums[count][WIDTH..].iter().enumerate() {
            if sum < least {
                (least, begins) = (sum, self.begins(count, more));
            }
            (cuts.least[more], cuts.begins[more]) = (least, begins);
        }
        for (corners, leaf) in cuts.boxes.iter_mut().zip(leaves(begins, count)) {
            let bounds = union(self.boxes[leaf].iter().copied()).bounds();
            *corners = [bounds.min.to_array(), bounds.max.to_array()];
        }
        cuts
    }

    /// Finds the choices again: who begins a leaf in the best cut of the first `end` into `more` leaves and one.
    #[inline]
    fn begins(&self, mut end: usize, more: usize) -> u32 {
        let mut begins = 0;
        for left in (0..=more).rev() {
            end = end.saturating_sub(self.lengths[end][left] as usize);
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
        cutter.boxes[..boxes.len()].copy_from_slice(boxes);
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
