//! Bins: where the surface area heuristic looks for planes.
//!
//! A range's references are sorted into bins along all three axes at once, by the centres of their boxes. The planes between
//! bins are then weighed in two sweeps, of all axes at once. A reference costs three loads, minima and stores of eight lanes;
//! two references are in flight in two sets of bins, so that neighbours that fall into the same bin do not wait for each
//! other.

use super::lanes::Lanes;
use crate::bvh8::build::extent::Extent;
use crate::bvh8::build::reference::{Part, Reference};
use glam::Vec4;

/// The most bins an axis.
pub(super) const MAX_BINS: usize = 32;
/// Adding this to a small number, negative or not, leaves the number, rounded to the nearest and to even, in the low bits of
/// the sum.
const ROUND_TO_BITS: f32 = 12_582_912.0;
/// Below so many pairs of references, clearing and merging a second set of bins costs more than it saves.
const FEW_PAIRS: usize = 32;

/// Which planes are tried, and how they are weighed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planes {
    /// The most bins an axis.
    bins: u32,
    /// A leaf's visit costs the same however many triangles it has. So a side's references are counted in full leaves, of two
    /// to the power of this: against the plain number that makes a tenth fewer nodes of the same expected cost.
    full_leaf: u32,
}

impl Planes {
    pub(super) const fn new(bins: u32, max_leaf: u32) -> Self {
        Self { bins, full_leaf: max_leaf.ilog2() }
    }
}

/// How centres map to bins, on all axes at once. The fourth lanes mean nothing.
#[derive(Clone, Copy)]
pub(super) struct Binning {
    pub(super) bins: usize,
    /// References are counted in leaves of two to the power of this.
    full_leaf: u32,
    origin: Vec4,
    scale: Vec4,
}

/// A plane between bins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    pub(super) axis: usize,
    /// The first bin of the upper side.
    pub(super) bin: usize,
    /// The sum over both sides of half area times the number of full leaves.
    pub(super) cost: f32,
    /// References on the lower side.
    pub(super) low: usize,
    /// The boxes of both sides.
    pub(super) bounds: [Extent; 2],
}

impl Binning {
    /// All bins, or fewer for few references: most ranges are small, and the sweep dominates them. (Between 4 and 6 and an
    /// eighth of the references, and a quarter, the expected cost of a bunny and of a kitchen differs by half a percent.)
    #[inline(always)]
    pub(super) fn new(part: &Part, count: usize, planes: Planes) -> Self {
        let bins = (planes.bins as usize).min(4 + count / 8);
        let [x, y, z, rest, to_x, to_y, to_z, _] = part.centers.0;
        let origin = Vec4::new(x, y, z, rest);
        // A little less than the bins, so that rounding takes no centre beyond the last one.
        let scale = Vec4::splat(bins as f32 * (1.0 - 1e-6)) / -(origin + Vec4::new(to_x, to_y, to_z, rest));
        // An axis without extent, or one so short that the division overflows, gets the scale 0: one bin.
        let scale = Vec4::select(scale.cmplt(Vec4::INFINITY), scale, Vec4::ZERO);
        Self { bins, full_leaf: planes.full_leaf, origin, scale }
    }

    /// The bins of a doubled centre on the three axes.
    #[inline(always)]
    fn place(&self, center: Vec4) -> [usize; 3] {
        // Not below -1/2, which rounds to the even 0, and below the number of bins less 1/2: nothing to clamp.
        let rounded = (center - self.origin) * self.scale - 0.5 + ROUND_TO_BITS;
        let [x, y, z, _] = rounded.to_array();
        [x, y, z].map(|lane| lane.to_bits() as usize % MAX_BINS)
    }

    /// Tells the references below a plane from those above it.
    #[inline(always)]
    pub(super) fn side(&self, axis: usize, bin: usize) -> Side {
        Side { axis, origin: self.origin[axis], scale: self.scale[axis], limit: ROUND_TO_BITS + bin as f32 }
    }
}

/// One side of a plane between bins.
#[derive(Clone, Copy)]
pub(super) struct Side {
    axis: usize,
    origin: f32,
    scale: f32,
    limit: f32,
}

impl Side {
    /// Whether a reference is below: exactly when its bin is, because the same operations find it.
    #[inline(always)]
    pub(super) fn is_below(&self, reference: &Reference) -> bool {
        // The mask only spares the check of the index.
        let axis = self.axis & 3;
        let center = reference.0[axis] - reference.0[axis + 4];
        (center - self.origin) * self.scale - 0.5 + ROUND_TO_BITS < self.limit
    }
}

/// The bins of the three axes, 3.5 kB.
#[derive(Clone)]
pub(super) struct Bins {
    bounds: [[Extent; 3]; MAX_BINS],
    counts: [[i32; 4]; MAX_BINS],
}

impl Bins {
    pub(super) const EMPTY: Self =
        Self { bounds: [[Extent::EMPTY; 3]; MAX_BINS], counts: [[0; 4]; MAX_BINS] };

    #[inline(always)]
    fn clear<L: Lanes>(&mut self, lanes: L, bins: usize) {
        let empty = lanes.splat(f32::INFINITY);
        for (bounds, counts) in self.bounds.iter_mut().zip(&mut self.counts).take(bins) {
            for bounds in bounds {
                lanes.store(empty, &mut bounds.0);
            }
            *counts = [0; 4];
        }
    }

    #[inline(always)]
    fn add<L: Lanes>(&mut self, lanes: L, reference: L::Eight, place: [usize; 3]) {
        for (axis, bin) in place.into_iter().enumerate() {
            let bounds = &mut self.bounds[bin % MAX_BINS][axis].0;
            lanes.store(lanes.min(lanes.load(bounds), reference), bounds);
            self.counts[bin % MAX_BINS][axis] += 1;
        }
    }

    #[inline(always)]
    pub(super) fn merge<L: Lanes>(&mut self, lanes: L, other: &Self, bins: usize) {
        for (bounds, other) in self.bounds.iter_mut().zip(&other.bounds).take(bins) {
            for (bounds, other) in bounds.iter_mut().zip(other) {
                lanes.store(lanes.min(lanes.load(&bounds.0), lanes.load(&other.0)), &mut bounds.0);
            }
        }
        for (counts, other) in self.counts.iter_mut().zip(&other.counts).take(bins) {
            for (count, other) in counts.iter_mut().zip(other) {
                *count += other;
            }
        }
    }

    /// Sorts references into bins. The second set is room to work in.
    #[inline(always)]
    pub(super) fn fill<L: Lanes>(
        lanes: L,
        sets: &mut [Self; 2],
        binning: &Binning,
        references: &[Reference],
    ) {
        let [even, odd] = sets;
        even.clear(lanes, binning.bins);
        let place = |reference: L::Eight| {
            let [low, high] = lanes.halves(reference);
            binning.place(low - high)
        };
        let (pairs, rest) = references.as_chunks::<2>();
        if pairs.len() < FEW_PAIRS {
            for reference in references {
                let reference = lanes.load(&reference.0);
                even.add(lanes, reference, place(reference));
            }
            return;
        }
        odd.clear(lanes, binning.bins);
        for pair in pairs {
            let [first, second] = pair.map(|reference| lanes.load(&reference.0));
            let places = [place(first), place(second)];
            even.add(lanes, first, places[0]);
            odd.add(lanes, second, places[1]);
        }
        for reference in rest {
            let reference = lanes.load(&reference.0);
            even.add(lanes, reference, place(reference));
        }
        even.merge(lanes, odd, binning.bins);
    }

    /// The cheapest plane, the first of equals; none where all centres are one point.
    #[inline(always)]
    pub(super) fn best_split<L: Lanes>(&self, lanes: L, binning: &Binning) -> Option<Split> {
        let bins = binning.bins.min(MAX_BINS);
        let empty = lanes.splat(f32::INFINITY);
        let mut uppers = [Vec4::ZERO; MAX_BINS];
        let (mut run, mut count) = ([empty; 3], [0; 4]);
        let (round_up, shift) = ((1 << binning.full_leaf) - 1, binning.full_leaf);
        let leaves = |count: i32| ((count + round_up) >> shift) as f32;
        let add = |run: &mut [L::Eight; 3], count: &mut [i32; 4], bin: (&[Extent; 3], &[i32; 4])| {
            for (run, bounds) in run.iter_mut().zip(bin.0) {
                *run = lanes.min(*run, lanes.load(&bounds.0));
            }
            for (count, more) in count.iter_mut().zip(bin.1) {
                *count += more;
            }
            half_areas(lanes, *run) * Vec4::from_array(count.map(leaves))
        };
        let filled = || self.bounds[..bins].iter().zip(&self.counts[..bins]);
        for (bin, upper) in filled().zip(&mut uppers).skip(1).rev() {
            *upper = add(&mut run, &mut count, bin);
        }
        (run, count) = ([empty; 3], [0; 4]);
        let (mut costs, mut planes) = (Vec4::INFINITY, Vec4::ZERO);
        let mut plane = Vec4::ZERO;
        for (bin, upper) in filled().zip(&uppers[1..bins.max(1)]) {
            plane += 1.0;
            // Where a side has no reference, its cost is infinity times zero, and no comparison holds.
            let cost = add(&mut run, &mut count, bin) + *upper;
            let better = cost.cmplt(costs);
            costs = Vec4::select(better, cost, costs);
            planes = Vec4::select(better, plane, planes);
        }
        let axis = if costs.y < costs.x { 1 } else { 0 };
        let axis = if costs.z < costs[axis] { 2 } else { axis };
        let plane = planes[axis] as usize;
        if plane == 0 {
            return None;
        }
        let (low, high) = self.bounds[..bins].split_at(plane);
        let union = |side: &[[Extent; 3]]| {
            let mut extent = Extent::EMPTY;
            let all = side.iter().fold(empty, |union, bounds| lanes.min(union, lanes.load(&bounds[axis].0)));
            lanes.store(all, &mut extent.0);
            extent
        };
        let count = self.counts[..plane].iter().map(|counts| counts[axis] as usize).sum();
        Some(Split { axis, bin: plane, cost: costs[axis], low: count, bounds: [union(low), union(high)] })
    }
}

/// Half the surface areas of three boxes.
#[inline(always)]
fn half_areas<L: Lanes>(lanes: L, boxes: [L::Eight; 3]) -> Vec4 {
    // Sizes, negated: the signs cancel in the products.
    let [a, b, c] = boxes.map(|lane| {
        let [low, high] = lanes.halves(lane);
        low + high
    });
    let [x, y, z] =
        [Vec4::new(a.x, b.x, c.x, 0.0), Vec4::new(a.y, b.y, c.y, 0.0), Vec4::new(a.z, b.z, c.z, 0.0)];
    x * y + y * z + z * x
}
