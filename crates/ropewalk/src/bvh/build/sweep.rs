//! The sweep: weighs every plane between two centres of a list that is sorted along an axis. The sweep SAH builder
//! and the SBVH builder find their object splits by it.
//!
//! A plane between two equal centres is not tried: it would tell apart what the axis does not, and by the linearity
//! of the cost one of the two ends of a run of equal boxes is never worse. Among splits of the very same cost the more
//! balanced one is taken, so that areas that vanish in f32 do not make chains.

use super::reference::{Extent, Reference};
use crate::parallel::join;

/// A list with fewer references is sorted by one thread.
const SEQUENTIAL_SORT: usize = 1 << 15;

/// Where to cut a list sorted along `axis`.
#[derive(Clone, Copy, Debug)]
pub(super) struct SweepSplit {
    pub(super) axis: usize,
    /// References on the lower side and on the upper one.
    pub(super) counts: [usize; 2],
    /// The sum over both sides of half area times count.
    pub(super) cost: f32,
}

impl SweepSplit {
    /// The better one; the first where neither is.
    fn better(first: Self, second: Self) -> Self {
        let imbalance = |split: &Self| split.counts[0].abs_diff(split.counts[1]);
        let wins =
            second.cost < first.cost || second.cost == first.cost && imbalance(&second) < imbalance(&first);
        if wins { second } else { first }
    }

    pub(super) fn best(candidates: [Option<Self>; 3]) -> Option<Self> {
        candidates.into_iter().flatten().reduce(Self::better)
    }
}

/// Sorts along an axis; side by side where there are threads.
pub(super) fn sort(list: &mut [Reference], axis: usize) {
    if list.len() < SEQUENTIAL_SORT {
        list.sort_unstable_by_key(|reference| reference.key(axis));
        return;
    }
    let middle = list.len() / 2;
    list.select_nth_unstable_by_key(middle, |reference| reference.key(axis));
    let (low, high) = list.split_at_mut(middle);
    join(|| sort(low, axis), || sort(high, axis));
}

/// Weighs every plane of a list sorted along `axis`. `upper_costs` is room to work in.
pub(super) fn sweep(list: &[Reference], axis: usize, upper_costs: &mut Vec<f32>) -> Option<SweepSplit> {
    let count = list.len();
    upper_costs.clear();
    let mut upper = Extent::EMPTY;
    // Of the last reference alone, of the last two, ...: in reverse.
    upper_costs.extend(list.iter().rev().enumerate().map(|(before, reference)| {
        upper.add(reference);
        upper.half_area() * (before + 1) as f32
    }));
    let mut best: Option<SweepSplit> = None;
    let mut lower = Extent::EMPTY;
    let pairs = list.windows(2).zip(upper_costs.iter().rev().skip(1)).enumerate();
    for (before, (pair, upper_cost)) in pairs {
        lower.add(&pair[0]);
        if pair[0].doubled_center()[axis] == pair[1].doubled_center()[axis] {
            continue;
        }
        let low_count = before + 1;
        let cost = lower.half_area() * low_count as f32 + upper_cost;
        let split = SweepSplit { axis, counts: [low_count, count - low_count], cost };
        best = Some(best.map_or(split, |best| SweepSplit::better(best, split)));
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Aabb;
    use glam::Vec3;

    fn list(boxes: &[[f32; 2]]) -> Vec<Reference> {
        let reference = |(index, &[from, to]): (usize, &[f32; 2])| {
            Reference::new(&Aabb::new(Vec3::new(from, 0.0, 0.0), Vec3::new(to, 1.0, 1.0)), index as u32)
        };
        let mut list: Vec<_> = boxes.iter().enumerate().map(reference).collect();
        sort(&mut list, 0);
        list
    }

    #[test]
    fn the_widest_gap_is_found_and_its_cost_is_right() {
        let list = list(&[[9.0, 10.0], [0.0, 1.0], [2.0, 3.0], [1.0, 2.0]]);
        assert_eq!(list.iter().map(Reference::index).collect::<Vec<_>>(), [1, 3, 2, 0]);
        let split = sweep(&list, 0, &mut Vec::new()).unwrap();
        // Half areas: 1 + 2 * 3 of three boxes, 3 of one.
        assert_eq!((split.axis, split.counts, split.cost), (0, [3, 1], 3.0 * 7.0 + 3.0));
    }

    #[test]
    fn every_plane_is_weighed_as_if_it_were_alone() {
        let boxes: Vec<[f32; 2]> = (0..40u16)
            .map(|i| {
                let from = f32::from(i * 37 % 41);
                [from, from + f32::from(i % 5)]
            })
            .collect();
        let list = list(&boxes);
        let cost = |middle: usize| {
            let side = |part: &[Reference]| Extent::of(part).half_area() * part.len() as f32;
            side(&list[..middle]) + side(&list[middle..])
        };
        let apart = |&middle: &usize| list[middle - 1].doubled_center().x != list[middle].doubled_center().x;
        let cheapest = (1..list.len()).filter(apart).map(cost).fold(f32::INFINITY, f32::min);
        let split = sweep(&list, 0, &mut Vec::new()).unwrap();
        assert_eq!((split.cost, cost(split.counts[0])), (cheapest, cheapest));
    }

    #[test]
    fn equal_centres_stay_together_and_vanishing_areas_are_balanced() {
        assert!(sweep(&list(&[[0.0, 2.0], [0.0, 2.0], [0.5, 1.5]]), 0, &mut Vec::new()).is_none());
        assert!(sweep(&list(&[[0.0, 2.0]]), 0, &mut Vec::new()).is_none());
        let tiny: Vec<Reference> = (0..4u8)
            .map(|i| {
                let bounds = Aabb::new(Vec3::splat(f32::from(i)), Vec3::splat(f32::from(i) + 1.0));
                Reference::new(&Aabb::new(bounds.min * 1e-30, bounds.max * 1e-30), i.into())
            })
            .collect();
        assert_eq!(sweep(&tiny, 0, &mut Vec::new()).unwrap().counts, [2, 2]);
    }
}
