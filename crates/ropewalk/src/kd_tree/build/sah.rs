//! The surface area heuristic: what a split is expected to cost, and the sweep that finds the cheapest one.
//!
//! A random ray that enters a cell enters a part of it with the probability of their areas' ratio (MacDonald and Booth
//! 1990). So with `n` triangles on a side a split costs `traversal + intersection * (p_low * n_low + p_high * n_high)`, and
//! less where one side is empty; a leaf costs `intersection * n`.
//!
//! All in f64: areas of cells of size 1e-30 are no zero, and those of 1e12 no infinity.

use super::events::{END, Event, PLANAR};
use crate::Aabb;
use crate::kd_tree::KdOptions;
use crate::parallel::join;

/// A plane keeps this part of the largest coordinate away from the faces of its cell, some eight floats. Where a wall's triangles
/// are apart by rounding alone, cells as thin would come of it, in which the walks by `t` alone cannot tell what comes first: without
/// this they gave 2 to 10 percent of the rays over in Sibenik and Dabrovic's Sponza, with it 0.2 at most. Visits fall by 1
/// percent, primitive tests grow by 1 to 5.
const THINNEST: f64 = 1e-6;

/// The weights of the heuristic.
#[derive(Clone, Copy)]
pub(super) struct Costs {
    traversal: f64,
    intersection: f64,
    /// By what a split with an empty side is multiplied.
    empty: f64,
}

impl Costs {
    pub(super) fn of(options: &KdOptions) -> Self {
        Self {
            traversal: f64::from(options.traversal_cost),
            intersection: f64::from(options.intersection_cost),
            empty: 1.0 - f64::from(options.empty_bonus) / 100.0,
        }
    }

    pub(super) fn leaf(&self, count: usize) -> f64 {
        self.intersection * count as f64
    }

    /// What a split costs that leaves so many triangles on its sides.
    pub(super) fn of_plane(&self, plane: &Plane, cell: &Aabb, counts: [usize; 2]) -> f64 {
        self.split(Parts::along(cell, plane.axis).of(f64::from(plane.split)), counts)
    }

    #[inline(always)]
    fn split(&self, probabilities: [f64; 2], counts: [usize; 2]) -> f64 {
        let [low, high] = [0, 1].map(|side| probabilities[side] * counts[side] as f64);
        let cost = self.traversal + self.intersection * (low + high);
        if counts[0] == 0 || counts[1] == 0 { cost * self.empty } else { cost }
    }
}

/// A plane that splits a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub(super) axis: usize,
    pub(super) split: f32,
    /// Whether what lies in the plane goes below it.
    pub(super) planar_low: bool,
    pub(super) cost: f64,
}

/// How likely a ray that enters a cell enters a part of it that a plane across an axis cuts off.
struct Parts {
    min: f64,
    max: f64,
    /// How far from both a plane must be.
    margin: f64,
    /// Of a part without thickness.
    flat: f64,
    /// More for each unit of thickness.
    slope: f64,
}

impl Parts {
    fn along(cell: &Aabb, axis: usize) -> Self {
        let size = cell.max.as_dvec3() - cell.min.as_dvec3();
        let (thick, a, b) = (size[axis], size[(axis + 1) % 3], size[(axis + 2) % 3]);
        let area = thick * a + thick * b + a * b;
        let [min, max] = [cell.min, cell.max].map(|corner| f64::from(corner[axis]));
        let margin = THINNEST * min.abs().max(max.abs());
        if area > 0.0 {
            return Self { min, max, margin, flat: a * b / area, slope: (a + b) / area };
        }
        // A cell without area is a line at most: its length counts.
        Self { min, max, margin, flat: 0.0, slope: if thick > 0.0 { 1.0 / thick } else { 0.0 } }
    }

    #[inline(always)]
    fn of(&self, split: f64) -> [f64; 2] {
        [self.flat + (split - self.min) * self.slope, self.flat + (self.max - split) * self.slope]
    }
}

/// The cheapest plane within a cell of `count` triangles with these events; of equal ones the one that comes first, by
/// axis, place, and low before high. `None` where there is no plane.
pub(super) fn best_plane(
    events: &[Vec<Event>; 3],
    count: usize,
    cell: &Aabb,
    costs: &Costs,
    side_by_side: bool,
) -> Option<Plane> {
    let [x, y, z] = events.each_ref().map(Vec::as_slice);
    let along = |axis, events| sweep(events, count, cell, axis, costs);
    let candidates = if side_by_side {
        let (x, (y, z)) = join(|| along(0, x), || join(|| along(1, y), || along(2, z)));
        [x, y, z]
    } else {
        [along(0, x), along(1, y), along(2, z)]
    };
    candidates.into_iter().flatten().reduce(|best, plane| if plane.cost < best.cost { plane } else { best })
}

/// The cheapest plane across an axis.
fn sweep(events: &[Event], count: usize, cell: &Aabb, axis: usize, costs: &Costs) -> Option<Plane> {
    let parts = Parts::along(cell, axis);
    let (mut best, mut best_cost) = (None, f64::INFINITY);
    let (mut low, mut high) = (0, count);
    let mut next = 0;
    while let Some(event) = events.get(next) {
        let place = event.place_key();
        let (mut ends, mut planars, mut starts) = (0, 0, 0);
        while let Some(event) = events.get(next)
            && event.place_key() == place
        {
            match event.kind() {
                END => ends += 1,
                PLANAR => planars += 1,
                _ => starts += 1,
            }
            next += 1;
        }
        high -= (ends + planars).min(high);
        let split = event.place();
        let at = f64::from(split);
        if at - parts.min > parts.margin && parts.max - at > parts.margin {
            let probabilities = parts.of(at);
            let mut try_out = |planar_low: bool, counts| {
                let cost = costs.split(probabilities, counts);
                if cost < best_cost {
                    best_cost = cost;
                    best = Some(Plane { axis, split, planar_low, cost });
                }
            };
            try_out(true, [low + planars, high]);
            if planars > 0 {
                try_out(false, [low, high + planars]);
            }
        }
        low += starts + planars;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::super::events::add;
    use super::*;
    use crate::glam::Vec3;

    fn best(boxes: &[[[f32; 3]; 2]], cell: [[f32; 3]; 2]) -> Option<Plane> {
        let mut events = [const { Vec::new() }; 3];
        for (index, [min, max]) in boxes.iter().enumerate() {
            add(&mut events, &Aabb::new((*min).into(), (*max).into()), index as u32);
        }
        events.iter_mut().for_each(|events| events.sort_unstable());
        let cell = Aabb::new(cell[0].into(), cell[1].into());
        best_plane(&events, boxes.len(), &cell, &Costs::of(&KdOptions::default()), false)
    }

    #[test]
    fn empty_space_is_cut_off() {
        let boxes = [[[6.0, 0.0, 0.0], [7.0, 1.0, 1.0]]; 4];
        let plane = best(&boxes, [[0.0; 3], [8.0, 1.0, 1.0]]).unwrap();
        assert_eq!((plane.axis, plane.split), (0, 6.0));
        let [low, high] = Parts::along(&Aabb::new(Vec3::ZERO, Vec3::new(8.0, 1.0, 1.0)), 0).of(6.0);
        assert_eq!((low, high), ((6.0 + 6.0 + 1.0) / 17.0, (2.0 + 2.0 + 1.0) / 17.0));
        let cell = Aabb::new(Vec3::ZERO, Vec3::new(8.0, 1.0, 1.0));
        assert_eq!(plane.cost, Costs::of(&KdOptions::default()).of_plane(&plane, &cell, [0, 4]));
        assert!((plane.cost - 0.9 * (100.0 + 150.0 * 4.0 * high)).abs() < 1e-9, "{plane:?}");
    }

    /// The brute force over all planes and both sides.
    #[test]
    fn the_sweep_finds_the_cheapest() {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 29) as f32
        };
        for round in 0..200 {
            let boxes: Vec<[[f32; 3]; 2]> = (0..1 + round % 9)
                .map(|_| {
                    let (a, b): ([f32; 3], [f32; 3]) =
                        ([(); 3].map(|()| random()), [(); 3].map(|()| random()));
                    [[0, 1, 2].map(|k| a[k].min(b[k])), [0, 1, 2].map(|k| a[k].max(b[k]))]
                })
                .collect();
            let cell = Aabb::new(Vec3::ZERO, Vec3::new(7.0, 7.0, 6.5));
            let costs = Costs::of(&KdOptions::default());
            let mut least = f64::INFINITY;
            for axis in 0..3 {
                for split in boxes.iter().flatten().map(|corner| corner[axis]) {
                    if split <= cell.min[axis] || split >= cell.max[axis] {
                        continue;
                    }
                    for planar_low in [true, false] {
                        let is_flat =
                            |it: &&[[f32; 3]; 2]| it[0][axis] == it[1][axis] && it[0][axis] == split;
                        let flat = boxes.iter().filter(is_flat).count();
                        let low = boxes.iter().filter(|it| it[0][axis] < split).count();
                        let high = boxes.iter().filter(|it| it[1][axis] > split).count();
                        let counts = if planar_low { [low + flat, high] } else { [low, high + flat] };
                        let parts = Parts::along(&cell, axis).of(f64::from(split));
                        least = least.min(costs.split(parts, counts));
                    }
                }
            }
            let found = best(&boxes, [cell.min.into(), cell.max.into()]);
            assert_eq!(found.map_or(f64::INFINITY, |plane| plane.cost), least, "{boxes:?}");
        }
    }

    #[test]
    fn no_cell_is_cut_thinner_than_coordinates_are() {
        let wall = |x: f32| [[x, 0.0, 0.0], [x, 9.0, 9.0]];
        let at = |x: f32| best(&[wall(x), wall(100.0), wall(x)], [[1000.0, 0.0, 0.0], [1009.0, 9.0, 9.0]]);
        assert_eq!((at(1000.0), at(1000.0005)), (None, None));
        assert_eq!(at(1000.01).unwrap().split, 1000.01);
        assert_eq!((at(1008.9995), at(1008.0).unwrap().split), (None, 1008.0));
    }

    #[test]
    fn a_line_is_split_by_length() {
        let boxes = [[[0.0; 3], [1.0, 0.0, 0.0]], [[7.0, 0.0, 0.0], [8.0, 0.0, 0.0]]];
        let plane = best(&boxes, [[0.0; 3], [8.0, 0.0, 0.0]]).unwrap();
        assert_eq!((plane.axis, plane.split), (0, 1.0));
        assert_eq!(best(&[[[0.0; 3]; 2]; 3], [[0.0; 3]; 2]), None, "a point is not");
    }
}
