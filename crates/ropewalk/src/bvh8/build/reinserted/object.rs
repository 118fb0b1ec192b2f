//! The best object split of a node: references are binned by their centres, along all three axes at once, and go to
//! one side of a plane between bins.

use super::leaves::Leaves;
use crate::bvh::build::reference::{Extent, Reference};
use crate::parallel::map_chunks;
use crate::processor::Processor;
use glam::Vec4;

/// The most bins an axis.
pub(super) const MAX_BINS: usize = 16;
/// A node with more references is binned by several threads.
const PARALLEL: usize = 1 << 16;
/// Adding this to a small number leaves the number, rounded, in the low bits of the sum.
const ROUND_TO_BITS: f32 = 8_388_608.0;

/// A plane between bins.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectSplit {
    axis: usize,
    /// The first bin of the upper side.
    bin: u32,
    /// The boxes of both sides.
    pub(super) bounds: [Extent; 2],
    /// The sum over both sides of half area times leaves.
    pub(super) cost: f32,
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Extent,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Extent::EMPTY, count: 0 };

    #[inline(always)]
    fn merge(&mut self, other: &Self) {
        self.bounds = self.bounds.union(other.bounds);
        self.count += other.count;
    }
}

/// The bins of the three axes, bin by bin. Several nodes use them one after the other; each clears what it needs.
pub(super) struct Bins([[Bin; 3]; MAX_BINS]);

impl Default for Bins {
    fn default() -> Self {
        Self([[Bin::EMPTY; 3]; MAX_BINS])
    }
}

impl Bins {
    fn merge(mut self, other: Self) -> Self {
        for (a, b) in self.0.as_flattened_mut().iter_mut().zip(other.0.as_flattened()) {
            a.merge(b);
        }
        self
    }
}

/// How centres map to bins, on all axes at once.
pub(super) struct Grid {
    bins: usize,
    origin: Vec4,
    scale: Vec4,
}

impl Grid {
    /// For references whose doubled centres lie in `centers`.
    #[inline(always)]
    pub(super) fn new(centers: &Extent, count: usize) -> Self {
        // Few references do not need many planes; most nodes are small, and the sweep over bins dominates them.
        let bins = MAX_BINS.min(4 + count / 4);
        let size = centers.high - centers.low;
        // An axis without extent, or one so short that the division overflows, gets the scale 0: one bin.
        let scale = (Vec4::splat(bins as f32) / size).to_array();
        let scale = scale.map(|scale| if scale.is_finite() { scale } else { 0.0 });
        Self { bins, origin: centers.low, scale: Vec4::from_array(scale) }
    }

    /// The bins of a reference on the three axes, in the low bits.
    #[inline(always)]
    fn place(&self, reference: &Reference) -> Vec4 {
        let position = (reference.doubled_center() - self.origin) * self.scale;
        let position = position.min(Vec4::splat(self.bins as f32 - 0.75)) - 0.5;
        position.max(Vec4::ZERO) + ROUND_TO_BITS
    }

    /// Whether a reference goes to the lower side.
    #[inline(always)]
    pub(super) fn is_low(&self, reference: &Reference, split: &ObjectSplit) -> bool {
        let below = self.place(reference).cmplt(Vec4::splat(ROUND_TO_BITS + split.bin as f32));
        below.bitmask() >> split.axis & 1 != 0
    }

    #[inline(always)]
    fn fill(&self, references: &[Reference], bins: &mut Bins) {
        bins.0[..self.bins].fill([Bin::EMPTY; 3]);
        for reference in references {
            let places = self.place(reference).to_array();
            for (axis, place) in places[..3].iter().enumerate() {
                let bin = &mut bins.0[place.to_bits() as usize % MAX_BINS][axis];
                bin.bounds.add(reference);
                bin.count += 1;
            }
        }
    }

    /// The cheapest plane at which both sides fit under the depth cap.
    #[inline(always)]
    pub(super) fn best_split(
        &self,
        processor: Processor,
        references: &[Reference],
        leaves: Leaves,
        levels: u32,
        bins: &mut Bins,
    ) -> Option<ObjectSplit> {
        if references.len() > PARALLEL {
            let parts = map_chunks(references, PARALLEL / 4, |_, chunk| {
                let mut bins = Bins::default();
                processor.run(
                    #[inline(always)]
                    || self.fill(chunk, &mut bins),
                );
                bins
            });
            *bins = parts.into_iter().reduce(Bins::merge)?;
        } else {
            self.fill(references, bins);
        }
        self.sweep(&bins.0[..self.bins], references.len() as u32, leaves, levels)
    }

    /// Weighs every plane.
    #[inline(always)]
    fn sweep(&self, bins: &[[Bin; 3]], total: u32, leaves: Leaves, levels: u32) -> Option<ObjectSplit> {
        let mut upper_costs = [[0.0; 3]; MAX_BINS];
        let mut upper = [Bin::EMPTY; 3];
        for (bins, costs) in bins.iter().zip(&mut upper_costs).skip(1).rev() {
            for ((upper, bin), cost) in upper.iter_mut().zip(bins).zip(costs) {
                upper.merge(bin);
                *cost = upper.bounds.half_area() * leaves.of(upper.count);
            }
        }
        let mut best: Option<(usize, usize, f32)> = None;
        let mut lower = [Bin::EMPTY; 3];
        for (plane, bins) in bins.iter().enumerate().take(bins.len() - 1) {
            for (axis, (lower, bin)) in lower.iter_mut().zip(bins).enumerate() {
                lower.merge(bin);
                let counts = [lower.count, total - lower.count];
                let cost = lower.bounds.half_area() * leaves.of(lower.count) + upper_costs[plane + 1][axis];
                // An empty side has no area to speak of: what comes out of it is not a number, or is not taken.
                if best.is_none_or(|best| cost < best.2)
                    && counts[0] > 0
                    && counts[1] > 0
                    && leaves.fit(counts, levels)
                {
                    best = Some((axis, plane + 1, cost));
                }
            }
        }
        let (axis, bin, cost) = best?;
        let side =
            |bins: &[[Bin; 3]]| bins.iter().fold(Extent::EMPTY, |bounds, bin| bounds.union(bin[axis].bounds));
        Some(ObjectSplit { axis, bin: bin as u32, bounds: [side(&bins[..bin]), side(&bins[bin..])], cost })
    }
}
