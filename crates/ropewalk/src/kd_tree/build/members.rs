//! The triangles of a cell on their way down, and how a plane divides them.
//!
//! Which side a triangle goes to is decided by its own box, cut at the planes: [`sides`]. Whether it counts there for the
//! cost, by the part of it that lies in the cell: it is *active* where there is one, *passive* where there is none.

use super::clip::clip;
use super::events::{self, Event};
use super::sah::Plane;
use crate::{Aabb, FlatTriangle};

/// A triangle that counts for the cost.
#[derive(Clone, Copy)]
pub(super) struct Active {
    pub(super) triangle: u32,
    /// The box around its part in the cell.
    pub(super) bounds: Aabb,
}

/// The triangles of a cell.
#[derive(Default)]
pub(super) struct Members {
    pub(super) active: Vec<Active>,
    /// Those of which only the box meets the cell.
    pub(super) passive: Vec<u32>,
    /// The events of the active ones, by axis, sorted.
    pub(super) events: [Vec<Event>; 3],
}

impl Members {
    /// All triangles, in the cell that holds them all.
    pub(super) fn all(triangles: &[FlatTriangle]) -> Self {
        let mut members = Self::default();
        members.active.reserve_exact(triangles.len());
        members.events.iter_mut().for_each(|events| events.reserve_exact(2 * triangles.len()));
        for (triangle, it) in (0..).zip(triangles) {
            let bounds = it.triangle().bounds();
            members.active.push(Active { triangle, bounds });
            events::add(&mut members.events, &bounds, triangle);
        }
        let [x, y, z] = &mut members.events;
        crate::parallel::join(
            || x.sort_unstable(),
            || crate::parallel::join(|| y.sort_unstable(), || z.sort_unstable()),
        );
        members
    }

    pub(super) fn len(&self) -> usize {
        self.active.len() + self.passive.len()
    }

    /// The triangles, active ones first.
    pub(super) fn triangles(&self) -> impl Iterator<Item = u32> {
        self.active.iter().map(|it| it.triangle).chain(self.passive.iter().copied())
    }

    fn clear(&mut self) {
        self.active.clear();
        self.passive.clear();
        self.events.iter_mut().for_each(Vec::clear);
    }

    /// How many triangles a plane sends to each side.
    pub(super) fn counts(&self, triangles: &[FlatTriangle], plane: &Plane) -> [usize; 2] {
        self.triangles().fold([0, 0], |[low, high], triangle| {
            let [below, above] = sides(&triangles[triangle as usize], plane);
            [low + usize::from(below), high + usize::from(above)]
        })
    }

    /// Adds a triangle of which a part may lie in a cell.
    fn add_part(&mut self, triangle: u32, of: &FlatTriangle, cell: &Aabb, fresh: &mut [Vec<Event>; 3]) {
        match clip(&of.triangle(), cell) {
            None => self.passive.push(triangle),
            Some(bounds) => {
                events::add(fresh, &bounds, self.active.len() as u32);
                self.active.push(Active { triangle, bounds });
            }
        }
    }
}

/// The sides of a plane to which a triangle belongs: its box must reach beyond the plane, and one that lies in the plane goes
/// where all such do.
#[inline(always)]
fn sides(triangle: &FlatTriangle, plane: &Plane) -> [bool; 2] {
    let [a, b, c] = [triangle.v0[plane.axis], triangle.v1[plane.axis], triangle.v2[plane.axis]];
    let (from, to) = (a.min(b).min(c), a.max(b).max(c));
    let is_flat = from >= plane.split && to <= plane.split;
    [from < plane.split || (is_flat && plane.planar_low), to > plane.split || (is_flat && !plane.planar_low)]
}

/// No place on a side.
const NONE: u32 = u32::MAX;

/// Room to work in, for one cell after the other.
#[derive(Default)]
pub(super) struct Room {
    spare: Vec<Members>,
    /// The places of an active triangle on both sides, where its events stay as they are.
    places: Vec<[u32; 2]>,
    /// The events of triangles that were cut, by side and axis.
    fresh: [[Vec<Event>; 3]; 2],
}

impl Room {
    fn take(&mut self) -> Members {
        self.spare.pop().unwrap_or_default()
    }

    /// Keeps the room of a cell that is done.
    pub(super) fn give(&mut self, mut members: Members) {
        members.clear();
        self.spare.push(members);
    }
}

/// What a plane makes of a cell.
pub(super) fn cut(cell: &Aabb, plane: &Plane) -> [Aabb; 2] {
    let (mut low, mut high) = (*cell, *cell);
    low.max[plane.axis] = plane.split;
    high.min[plane.axis] = plane.split;
    [low, high]
}

/// Divides the triangles of a cell: those of the lower part, those of the upper one.
pub(super) fn divide(
    members: &Members,
    triangles: &[FlatTriangle],
    cells: &[Aabb; 2],
    plane: &Plane,
    room: &mut Room,
) -> [Members; 2] {
    let (mut low, mut high) = (room.take(), room.take());
    let Room { places, fresh, .. } = room;
    places.clear();
    fresh.iter_mut().flatten().for_each(Vec::clear);
    for &triangle in &members.passive {
        let [below, above] = sides(&triangles[triangle as usize], plane);
        if below {
            low.passive.push(triangle);
        }
        if above {
            high.passive.push(triangle);
        }
    }
    for active in &members.active {
        let triangle = &triangles[active.triangle as usize];
        let [below, above] = sides(triangle, plane);
        let [mut part_below, part_above] =
            [active.bounds.min[plane.axis] < plane.split, active.bounds.max[plane.axis] > plane.split];
        if !(part_below || part_above) {
            // The part lies in the plane, though the box may not.
            part_below = (plane.planar_low && below) || !above;
        }
        let mut place = [NONE; 2];
        if part_below && part_above {
            low.add_part(active.triangle, triangle, &cells[0], &mut fresh[0]);
            high.add_part(active.triangle, triangle, &cells[1], &mut fresh[1]);
        } else if part_below {
            place[0] = low.active.len() as u32;
            low.active.push(*active);
            if above {
                high.passive.push(active.triangle);
            }
        } else {
            place[1] = high.active.len() as u32;
            high.active.push(*active);
            if below {
                low.passive.push(active.triangle);
            }
        }
        places.push(place);
    }
    for axis in 0..3 {
        for &event in &members.events[axis] {
            let [below, above] = places[event.triangle()];
            if below != NONE {
                low.events[axis].push(event.of(below));
            }
            if above != NONE {
                high.events[axis].push(event.of(above));
            }
        }
        for (side, fresh) in [&mut low, &mut high].into_iter().zip(&mut *fresh) {
            fresh[axis].sort_unstable();
            events::merge(&mut side.events[axis], &fresh[axis]);
        }
    }
    [low, high]
}
