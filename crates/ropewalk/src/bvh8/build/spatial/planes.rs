//! The best spatial split of a node: a plane at which references that straddle it become two, one on either side.
//!
//! A reference that reaches over several bins is cut at the planes between them and gives each its part, so a plane's
//! two boxes are those of what really lies on either side. References are counted where they enter and where they
//! leave. Of one that straddles the chosen plane it is asked once more whether it should rather go to one side whole,
//! which makes that side's box larger and the other side's count smaller (Stich et al. 2009, section 4.4).

use super::leaves::Leaves;
use crate::bvh::build::reference::{Extent, Reference};
use crate::parallel::map_chunks;
use glam::Vec4;

/// Bins an axis.
const BINS: usize = 16;
/// A node with more references is binned by several threads.
const PARALLEL: usize = 1 << 14;

/// A plane between bins.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneSplit {
    axis: usize,
    /// The first bin of the upper side.
    bin: usize,
    /// References that reach to the lower side, and to the upper one.
    pub(super) counts: [u32; 2],
    /// The sum over both sides of half area times leaves.
    pub(super) cost: f32,
}

/// The bins of a node: of equal width on each axis.
pub(super) struct Grid {
    origin: Vec4,
    width: Vec4,
    scale: Vec4,
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Extent,
    entries: u32,
    exits: u32,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Extent::EMPTY, entries: 0, exits: 0 };
}

/// The bins of the three axes.
struct Bins([[Bin; BINS]; 3]);

impl Bins {
    fn merge(mut self, other: Self) -> Self {
        for (a, b) in self.0.as_flattened_mut().iter_mut().zip(other.0.as_flattened()) {
            let (entries, exits) = (a.entries + b.entries, a.exits + b.exits);
            *a = Bin { bounds: a.bounds.union(b.bounds), entries, exits };
        }
        self
    }
}

/// Which references a split makes: room to work in, and afterwards those of the upper side.
#[derive(Default)]
pub(super) struct Sides {
    pub(super) high: Vec<Reference>,
    /// Those that straddle the plane: whole, below, above.
    straddling: Vec<[Reference; 3]>,
}

impl Grid {
    pub(super) fn new(bounds: &Extent) -> Self {
        let size = bounds.high - bounds.low;
        // An axis without extent, or one so short that the division overflows, gets the scale 0: one bin.
        let scale = (Vec4::splat(BINS as f32) / size).to_array();
        let scale = scale.map(|scale| if scale.is_finite() { scale } else { 0.0 });
        Self { origin: bounds.low, width: size / BINS as f32, scale: Vec4::from_array(scale) }
    }

    /// The plane below a bin.
    #[inline(always)]
    fn plane(&self, axis: usize, bin: usize) -> f32 {
        self.origin[axis] + self.width[axis] * bin as f32
    }

    /// The first and the last bin that a reference reaches to. What only touches a plane does not straddle it: of all
    /// planes between the two bins the reference has some on either side.
    #[inline(always)]
    fn range(&self, reference: &Reference, axis: usize) -> [usize; 2] {
        let [low, high] = reference.span(axis);
        // Negative numbers become 0 by the conversion.
        let place =
            |coordinate: f32| (((coordinate - self.origin[axis]) * self.scale[axis]) as usize).min(BINS - 1);
        let (mut first, mut last) = (place(low), place(high));
        while first < last && low >= self.plane(axis, first + 1) {
            first += 1;
        }
        while first < last && high <= self.plane(axis, last) {
            last -= 1;
        }
        [first, last]
    }

    /// The cheapest plane at which at most `room` references become two and both sides fit under the depth cap.
    pub(super) fn best_split(
        &self,
        references: &[Reference],
        room: usize,
        leaves: Leaves,
        levels: u32,
    ) -> Option<PlaneSplit> {
        let bins = if references.len() > PARALLEL {
            map_chunks(references, PARALLEL / 4, |_, chunk| self.fill(chunk))
                .into_iter()
                .reduce(Bins::merge)?
        } else {
            self.fill(references)
        };
        let mut best: Option<PlaneSplit> = None;
        for (axis, bins) in bins.0.iter().enumerate() {
            sweep(axis, bins, leaves, |split| {
                let added =
                    (split.counts[0] as usize + split.counts[1] as usize).saturating_sub(references.len());
                if added <= room
                    && leaves.fit(split.counts, levels)
                    && best.is_none_or(|best| split.cost < best.cost)
                {
                    best = Some(split);
                }
            });
        }
        best
    }

    fn fill(&self, references: &[Reference]) -> Bins {
        let mut bins = Bins([[Bin::EMPTY; BINS]; 3]);
        for reference in references {
            for (axis, bins) in bins.0.iter_mut().enumerate() {
                let [first, last] = self.range(reference, axis);
                bins[first].entries += 1;
                bins[last].exits += 1;
                let mut rest = *reference;
                for (bin, next) in bins[first..last].iter_mut().zip(first + 1..) {
                    let [part, above] = rest.cut(axis, self.plane(axis, next));
                    bin.bounds.add(&part);
                    rest = above;
                }
                bins[last].bounds.add(&rest);
            }
        }
        bins
    }

    /// Leaves the lower side in `references`, as many as it tells, and the upper side in `sides.high`. At most `room`
    /// references become two, and no side has more than was counted.
    pub(super) fn partition(
        &self,
        references: &mut [Reference],
        split: &PlaneSplit,
        room: usize,
        sides: &mut Sides,
    ) -> usize {
        let plane = self.plane(split.axis, split.bin);
        let mut sums = [Sum::EMPTY; 2];
        let mut low = 0;
        sides.high.clear();
        sides.straddling.clear();
        for place in 0..references.len() {
            let reference = references[place];
            let [first, last] = self.range(&reference, split.axis);
            if first < split.bin && split.bin <= last {
                let [below, above] = reference.cut(split.axis, plane);
                sums[0].add(&below);
                sums[1].add(&above);
                sides.straddling.push([reference, below, above]);
            } else if last < split.bin {
                sums[0].add(&reference);
                references[low] = reference;
                low += 1;
            } else {
                sums[1].add(&reference);
                sides.high.push(reference);
            }
        }
        let mut added = 0;
        for [whole, below, above] in &sides.straddling {
            let side = unsplit(&mut sums, whole, added < room);
            if side != Some(1) {
                references[low] = if side.is_some() { *whole } else { *below };
                low += 1;
            }
            if side != Some(0) {
                sides.high.push(if side.is_some() { *whole } else { *above });
            }
            added += usize::from(side.is_none());
        }
        low
    }
}

/// Shows every plane of one axis that has references on both sides.
fn sweep(axis: usize, bins: &[Bin; BINS], leaves: Leaves, mut show: impl FnMut(PlaneSplit)) {
    let mut uppers = [(0.0, 0); BINS];
    let (mut bounds, mut count) = (Extent::EMPTY, 0);
    for (bin, upper) in bins.iter().zip(&mut uppers).skip(1).rev() {
        bounds = bounds.union(bin.bounds);
        count += bin.exits;
        *upper = (bounds.half_area() * leaves.of(count), count);
    }
    let (mut bounds, mut low_count) = (Extent::EMPTY, 0);
    for (index, bin) in bins.iter().enumerate().take(BINS - 1) {
        bounds = bounds.union(bin.bounds);
        low_count += bin.entries;
        let (upper_cost, high_count) = uppers[index + 1];
        if low_count > 0 && high_count > 0 {
            let cost = bounds.half_area() * leaves.of(low_count) + upper_cost;
            show(PlaneSplit { axis, bin: index + 1, counts: [low_count, high_count], cost });
        }
    }
}

/// The box and the number of the references of a side.
#[derive(Clone, Copy)]
struct Sum {
    bounds: Extent,
    count: u32,
}

impl Sum {
    const EMPTY: Self = Self { bounds: Extent::EMPTY, count: 0 };

    #[inline(always)]
    fn add(&mut self, reference: &Reference) {
        self.bounds.add(reference);
        self.count += 1;
    }

    /// The same count, and the box with all of a reference of which it had a part.
    fn with_all_of(mut self, whole: &Reference) -> Self {
        self.bounds.add(whole);
        self
    }

    /// The same box, and one reference fewer. As in the paper the box does not shrink, which would take a look at
    /// all others.
    fn without_one(self) -> Self {
        Self { count: self.count.saturating_sub(1), ..self }
    }

    fn cost(&self) -> f32 {
        self.bounds.half_area() * self.count as f32
    }
}

/// Whether a reference that was counted on both sides rather goes to one of them whole, and to which. The sums follow.
/// A side is never left empty.
fn unsplit(sums: &mut [Sum; 2], whole: &Reference, may_split: bool) -> Option<usize> {
    let [low, high] = *sums;
    let mut cheapest = if may_split { low.cost() + high.cost() } else { f32::INFINITY };
    let mut choice = None;
    let choices =
        [[low.with_all_of(whole), high.without_one()], [low.without_one(), high.with_all_of(whole)]];
    for (side, after) in choices.into_iter().enumerate() {
        let cost = after[0].cost() + after[1].cost();
        if after[1 - side].count > 0 && cost <= cheapest {
            (cheapest, choice) = (cost, Some(side));
            *sums = after;
        }
    }
    choice
}
