//! The best object split of a node: swept where there are few references, binned where there are many.

use crate::bvh::BuildOptions;
use crate::bvh::build::binned_sah::{Binning, Bins};
use crate::bvh::build::limits::Limits;
use crate::bvh::build::part::Part;
use crate::bvh::build::reference::Reference;
use crate::bvh::build::sweep::{SweepSplit, sort, sweep};

/// A node with more references is binned: references change on the way down, so that a sweep must sort anew. Sweeping
/// every node takes half as long again and more and gives no fewer visits (kitchen, bunny, two Sponzas); binning every
/// node costs up to 3 percent more of them.
const SWEEP: usize = 4096;

/// Room to work in; one node after the other uses it.
#[derive(Default)]
pub(super) struct ObjectScratch {
    sorted: [Vec<Reference>; 3],
    upper_costs: Vec<f32>,
    bins: Bins,
}

/// A node whose references are put in two.
pub(super) struct ObjectSplit {
    /// References on the lower side, which comes first.
    pub(super) middle: usize,
    pub(super) parts: [Part; 2],
    /// The sum over both sides of half area times count.
    pub(super) cost: f32,
}

impl ObjectSplit {
    /// Partitions the references by the cheapest split; `None` where no axis tells them apart.
    pub(super) fn make(
        references: &mut [Reference],
        part: &Part,
        options: &BuildOptions,
        scratch: &mut ObjectScratch,
    ) -> Option<Self> {
        if references.len() > SWEEP {
            let binning = Binning::new(part, references.len(), options.bins);
            let split = binning.best_split(references, &mut scratch.bins)?;
            let (middle, parts) = binning.partition(references, &split);
            return Some(Self { middle, parts, cost: split.cost });
        }
        let mut candidates = [None; 3];
        for (axis, (candidate, sorted)) in candidates.iter_mut().zip(&mut scratch.sorted).enumerate() {
            sorted.clear();
            sorted.extend_from_slice(references);
            sort(sorted, axis);
            *candidate = sweep(sorted, axis, &mut scratch.upper_costs);
        }
        let split = SweepSplit::best(candidates)?;
        references.copy_from_slice(&scratch.sorted[split.axis]);
        let middle = split.counts[0];
        let (low, high) = references.split_at(middle);
        Some(Self { middle, parts: [Part::measure(low), Part::measure(high)], cost: split.cost })
    }

    /// What [`Limits::choose`] asks of the best split of `count` references.
    pub(super) fn weighed(&self, count: usize) -> (f32, [usize; 2]) {
        (self.cost, [self.middle, count - self.middle])
    }

    /// Whether both sides fit under the depth cap.
    pub(super) fn fits(&self, count: usize, limits: &Limits) -> bool {
        limits.fits(self.weighed(count).1)
    }

    /// Half the surface area of what the boxes of both sides have in common; 0 where that is nothing.
    pub(super) fn overlap(&self) -> f32 {
        let common = self.parts[0].bounds.intersection(self.parts[1].bounds);
        if common.is_empty() { 0.0 } else { common.half_area() }
    }
}
