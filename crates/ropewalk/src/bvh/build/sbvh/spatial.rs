//! The best spatial split of a node: binning, and the partition with reference unsplitting.
//!
//! A reference that reaches over several bins is cut at the planes between them and gives each its part, so a plane's
//! two boxes are those of what really lies on either side. References are counted where they enter and where they
//! leave.
//!
//! Of a reference that straddles the chosen plane it is asked once more whether it should rather go to one side whole,
//! which makes that side's box larger and the other side's count smaller.

use crate::bvh::BuildOptions;
use crate::bvh::build::limits::Limits;
use crate::bvh::build::part::Part;
use crate::bvh::build::reference::{Extent, Reference};
use crate::parallel::map_chunks;
use glam::Vec4;

/// A node with more references is binned by several threads.
const PARALLEL_BINNING: usize = 1 << 14;

/// A plane between bins.
pub(super) struct SpatialSplit {
    axis: usize,
    /// The first bin of the upper side.
    bin: usize,
    /// References that reach to the lower side, and to the upper one.
    pub(super) counts: [usize; 2],
    /// The sum over both sides of half area times count.
    pub(super) cost: f32,
}

/// The bins of a node: of equal width on each axis.
pub(super) struct Grid {
    bins: usize,
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
struct Bins([[Bin; BuildOptions::MAX_BINS]; 3]);

impl Bins {
    const EMPTY: Self = Self([[Bin::EMPTY; BuildOptions::MAX_BINS]; 3]);

    fn merge(mut self, other: Self) -> Self {
        for (a, b) in self.0.as_flattened_mut().iter_mut().zip(other.0.as_flattened()) {
            let (entries, exits) = (a.entries + b.entries, a.exits + b.exits);
            *a = Bin { bounds: a.bounds.union(b.bounds), entries, exits };
        }
        self
    }
}

impl Grid {
    /// At least two bins.
    pub(super) fn new(bounds: &Extent, bins: u32) -> Self {
        let size = bounds.high - bounds.low;
        // An axis without extent, or one so short that the division overflows, gets the scale 0: one bin.
        let scale = (Vec4::splat(bins as f32) / size).to_array();
        let scale = scale.map(|scale| if scale.is_finite() { scale } else { 0.0 });
        let width = size / bins as f32;
        Self { bins: bins as usize, origin: bounds.low, width, scale: Vec4::from_array(scale) }
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
        let place = |coordinate: f32| {
            (((coordinate - self.origin[axis]) * self.scale[axis]) as usize).min(self.bins - 1)
        };
        let (mut first, mut last) = (place(low), place(high));
        while first < last && low >= self.plane(axis, first + 1) {
            first += 1;
        }
        while first < last && high <= self.plane(axis, last) {
            last -= 1;
        }
        [first, last]
    }

    /// The cheapest plane at which at most `budget` references become two and both sides fit under the depth cap.
    pub(super) fn best_split(
        &self,
        references: &[Reference],
        budget: usize,
        limits: &Limits,
    ) -> Option<SpatialSplit> {
        let bins = if references.len() > PARALLEL_BINNING {
            map_chunks(references, PARALLEL_BINNING / 4, |_, chunk| self.fill(chunk))
                .into_iter()
                .reduce(Bins::merge)?
        } else {
            self.fill(references)
        };
        let mut best: Option<SpatialSplit> = None;
        for (axis, bins) in bins.0.iter().enumerate() {
            self.sweep(axis, &bins[..self.bins], |split| {
                let added = (split.counts[0] + split.counts[1]).saturating_sub(references.len());
                if added <= budget
                    && limits.fits(split.counts)
                    && best.as_ref().is_none_or(|best| split.cost < best.cost)
                {
                    best = Some(split);
                }
            });
        }
        best
    }

    fn fill(&self, references: &[Reference]) -> Bins {
        let mut bins = Bins::EMPTY;
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

    /// Shows every plane of one axis that has references on both sides.
    fn sweep(&self, axis: usize, bins: &[Bin], mut show: impl FnMut(SpatialSplit)) {
        let mut uppers = [(0.0, 0); BuildOptions::MAX_BINS];
        let (mut bounds, mut count) = (Extent::EMPTY, 0);
        for (bin, upper) in bins.iter().zip(&mut uppers).skip(1).rev() {
            bounds = bounds.union(bin.bounds);
            count += bin.exits as usize;
            *upper = (bounds.half_area() * count as f32, count);
        }
        let (mut bounds, mut low_count) = (Extent::EMPTY, 0);
        for (index, bin) in bins.iter().enumerate().take(bins.len() - 1) {
            bounds = bounds.union(bin.bounds);
            low_count += bin.entries as usize;
            let (upper_cost, high_count) = uppers[index + 1];
            if low_count > 0 && high_count > 0 {
                let cost = bounds.half_area() * low_count as f32 + upper_cost;
                show(SpatialSplit { axis, bin: index + 1, counts: [low_count, high_count], cost });
            }
        }
    }

    /// Fills the two sides and measures them. At most `budget` references become two, and no side has more than was
    /// counted.
    pub(super) fn partition(
        &self,
        references: &[Reference],
        split: &SpatialSplit,
        budget: usize,
        sides: &mut [Vec<Reference>; 2],
    ) -> [Part; 2] {
        let plane = self.plane(split.axis, split.bin);
        let mut sums = [Sum::EMPTY; 2];
        // Those that straddle the plane: whole, below, above.
        let mut straddling: Vec<[Reference; 3]> = Vec::new();
        for reference in references {
            let [first, last] = self.range(reference, split.axis);
            if first < split.bin && split.bin <= last {
                let [below, above] = reference.cut(split.axis, plane);
                sums[0].add(&below);
                sums[1].add(&above);
                straddling.push([*reference, below, above]);
            } else {
                let side = usize::from(first >= split.bin);
                sums[side].add(reference);
                sides[side].push(*reference);
            }
        }
        let mut added = 0;
        for [whole, below, above] in straddling {
            if let Some(side) = unsplit(&mut sums, &whole, added < budget) {
                sides[side].push(whole);
            } else {
                added += 1;
                sides[0].push(below);
                sides[1].push(above);
            }
        }
        sides.each_ref().map(|side| Part::measure(side))
    }
}

/// The box and the number of the references of a side.
#[derive(Clone, Copy)]
struct Sum {
    bounds: Extent,
    count: usize,
}

impl Sum {
    const EMPTY: Self = Self { bounds: Extent::EMPTY, count: 0 };

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Aabb;
    use glam::Vec3;

    fn reference(index: u32, from: f32, to: f32) -> Reference {
        Reference::new(&Aabb::new(Vec3::new(from, 0.0, 0.0), Vec3::new(to, 1.0, 1.0)), index)
    }

    fn grid(references: &[Reference], bins: u32) -> Grid {
        Grid::new(&Extent::of(references), bins)
    }

    fn no_limits() -> Limits {
        Limits::at(&BuildOptions::default(), 0)
    }

    #[test]
    fn what_touches_a_plane_does_not_straddle_it() {
        let all = [reference(0, 0.0, 8.0)];
        let grid = grid(&all, 8);
        for (from, to, expected) in [
            (0.0, 8.0, [0, 7]),
            (2.0, 3.0, [2, 2]),
            (2.0, 4.0, [2, 3]),
            (1.5, 2.0, [1, 1]),
            (3.0, 3.0, [3, 3]),
            (8.0, 8.0, [7, 7]),
            (1.0, 6.5, [1, 6]),
        ] {
            assert_eq!(grid.range(&reference(0, from, to), 0), expected, "{from} {to}");
        }
        assert_eq!(grid.range(&all[0], 1), [0, 7]);
    }

    #[test]
    fn a_long_box_is_cut_where_that_is_cheapest() {
        // Two crowds far apart, and one box over all of it.
        let mut all: Vec<Reference> = (0..8).map(|i| reference(i, 0.0, 1.0)).collect();
        all.extend((8..16).map(|i| reference(i, 15.0, 16.0)));
        all.push(reference(16, 0.0, 16.0));
        let grid = grid(&all, 16);
        let split = grid.best_split(&all, 1, &no_limits()).unwrap();
        assert_eq!((split.axis, split.counts), (0, [9, 9]));
        assert!(grid.best_split(&all, 0, &no_limits()).is_none(), "every plane needs one reference more");
        let mut sides = [Vec::new(), Vec::new()];
        grid.partition(&all, &split, 1, &mut sides);
        assert_eq!(sides.each_ref().map(Vec::len), [9, 9]);
        let parts = sides.map(|side| side.last().unwrap().span(0));
        assert_eq!((parts[0][0], parts[1][1]), (0.0, 16.0));
        assert_eq!(parts[0][1], parts[1][0], "both parts have the plane in common");
        // Without the means the straddling box goes to one side whole.
        let mut sides = [Vec::new(), Vec::new()];
        grid.partition(&all, &split, 0, &mut sides);
        let mut lens = sides.each_ref().map(Vec::len);
        lens.sort_unstable();
        assert_eq!(lens, [8, 9]);
    }

    #[test]
    fn what_barely_straddles_goes_to_one_side_whole() {
        let mut all: Vec<Reference> = (0..20).map(|i| reference(i, 0.0, 3.9)).collect();
        all.extend((20..40).map(|i| reference(i, 4.1, 8.0)));
        all.push(reference(40, 0.0, 4.05));
        let grid = grid(&all, 2);
        let split = grid.best_split(&all, 9, &no_limits()).unwrap();
        assert_eq!(split.counts, [21, 21]);
        let mut sides = [Vec::new(), Vec::new()];
        let parts = grid.partition(&all, &split, 9, &mut sides);
        assert_eq!(sides.each_ref().map(Vec::len), [21, 20]);
        assert_eq!(parts.map(|part| [part.bounds.low.x, part.bounds.high.x]), [[0.0, 4.05], [4.1, 8.0]]);
    }

    #[test]
    fn no_side_is_left_empty() {
        let all = [reference(0, 0.0, 8.0), reference(1, 0.0, 8.0)];
        let grid = grid(&all, 4);
        for budget in [0, 1, 2] {
            let split = SpatialSplit { axis: 0, bin: 2, counts: [2, 2], cost: 0.0 };
            let mut sides = [Vec::new(), Vec::new()];
            grid.partition(&all, &split, budget, &mut sides);
            let lens = sides.each_ref().map(Vec::len);
            assert!(lens[0] > 0 && lens[1] > 0 && lens[0] + lens[1] <= 2 + budget, "{budget}: {lens:?}");
        }
    }
}
