//! A setting on a device, and what its rays did.

use super::batches::Batch;
use super::depths::Depths;
use super::node_cost::NodeCost;
use super::setting::Setting;
use super::work::{self, RayWork};
use ropewalk::{Structure, TraceError, TraceOptions};
use ropewalk_gpu::{GpuError, Traceable};
use std::time::Instant;

/// What the rays of a batch did, the same on every device.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Counted {
    pub(super) rays: usize,
    pub(super) hits: usize,
    /// Objects entered, by all rays.
    pub(super) entered: u64,
    /// Objects entered, by those that hit something.
    pub(super) entered_by_hits: u64,
    /// Objects whose boxes were tested.
    pub(super) tested: u64,
    pub(super) top: Depths,
    pub(super) bottom: Depths,
    /// The most bytes of any ray's ring.
    pub(super) stack_bytes: u32,
    /// Entries that left a ring of the paper's size.
    pub(super) swaps: u64,
    /// By the model, a ray.
    pub(super) cost: f64,
    pub(super) top_visits: u64,
    pub(super) bottom_visits: u64,
    pub(super) primitive_tests: u64,
    /// Objects entered by each ray.
    pub(super) entered_each: Vec<u32>,
}

impl Counted {
    /// Counts a batch in a structure.
    pub(super) fn new(setting: &Setting, structure: &Structure, batch: &Batch) -> Result<Self, TraceError> {
        let works = work::count(structure, batch.query(), &batch.rays)?;
        Ok(Self::of(&works, NodeCost::of(&setting.structure)))
    }

    fn of(works: &[RayWork], cost: NodeCost) -> Self {
        let sum = |of: fn(&RayWork) -> u32| works.iter().map(|work| u64::from(of(work))).sum();
        let hits = || works.iter().filter(|work| work.is_hit);
        Self {
            rays: works.len(),
            hits: hits().count(),
            entered: sum(|work| work.objects_entered),
            entered_by_hits: hits().map(|work| u64::from(work.objects_entered)).sum(),
            tested: sum(|work| work.objects_tested),
            top: Depths::of(works.iter().map(|work| work.top_depth)),
            bottom: Depths::of(works.iter().map(|work| work.bottom_depth)),
            stack_bytes: works.iter().map(|work| work.stack_bytes).max().unwrap_or(0),
            swaps: sum(|work| work.swaps),
            cost: cost.mean(works),
            top_visits: sum(|work| work.top_visits),
            bottom_visits: sum(|work| work.bottom_visits),
            primitive_tests: sum(|work| work.primitive_tests),
            entered_each: works.iter().map(|work| work.objects_entered).collect(),
        }
    }

    /// A mean over all rays.
    pub(super) fn mean(&self, sum: u64) -> f64 {
        sum as f64 / self.rays.max(1) as f64
    }
}

/// A setting on a device.
pub(super) struct Lane<'a> {
    pub(super) setting: &'a Setting,
    pub(super) traceable: Traceable,
    /// A batch each.
    pub(super) counted: &'a [Counted],
    /// Of each batch the rays with another answer that is right too.
    pub(super) differing: Vec<usize>,
    /// Of each batch the seconds of each round.
    pub(super) times: Vec<Vec<f64>>,
}

impl Lane<'_> {
    /// Traces a batch and keeps the time.
    pub(super) fn time(&mut self, index: usize, batch: &Batch) -> Result<(), GpuError> {
        let start = Instant::now();
        self.traceable.trace(self.setting.walk, batch.query(), &batch.rays, TraceOptions::default())?;
        let seconds = start.elapsed().as_secs_f64();
        if let Some(times) = self.times.get_mut(index) {
            times.push(seconds);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_over_the_rays() {
        let works = [
            RayWork {
                objects_entered: 3,
                objects_tested: 4,
                is_hit: true,
                stack_bytes: 40,
                ..Default::default()
            },
            RayWork {
                objects_entered: 2,
                objects_tested: 2,
                swaps: 1,
                stack_bytes: 24,
                ..Default::default()
            },
            RayWork::default(),
        ];
        let counted = Counted::of(&works, NodeCost::of(&"two-level".parse().unwrap()));
        assert_eq!((counted.rays, counted.hits, counted.entered, counted.entered_by_hits), (3, 1, 5, 3));
        assert_eq!((counted.tested, counted.stack_bytes, counted.swaps), (6, 40, 1));
        assert_eq!((counted.cost, counted.mean(counted.tested)), (6.0, 2.0));
        assert_eq!(counted.entered_each, [3, 2, 0]);
    }
}
