//! Polygons into triangles.
//!
//! A polygon of n corners becomes n - 2 triangles, always, in the order and with the winding of the polygon. A convex
//! one becomes a fan about its first corner, which is what nearly every other loader makes of it, so that the numbers
//! of primitives agree. A concave one is cut within its outline, ear by ear, in the plane along its Newell normal; the
//! result is checked, since outlines that cross themselves have no right answer. These become fans too, and are said to
//! be so.
//!
//! All arithmetic is in f64 relative to the first corner, so that a polygon far from the origin is cut like one near it.
//! The cost is linear for convex polygons and quadratic for most concave ones.

mod ears;

use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// A corner counts as reflex when the outline turns back by more than this angle, in radians. Files give six or seven
/// digits: corners meant to lie on a straight edge are off by about 1e-6 either way.
const STRAIGHT: f64 = 1e-5;

/// How much of its area a polygon may gain or lose when it is cut.
const AREA_TOLERANCE: f64 = 1e-6;

/// How often the corners of a file's concave polygons may be looked at while ears are sought. A look takes about a
/// nanosecond. A million polygons of 30 corners, or one of 40,000, are within it.
const BUDGET: u64 = 2_000_000_000;

/// What a polygon was cut into.
#[derive(Debug)]
pub(crate) struct Pieces<'a> {
    /// Three numbers of corners each.
    pub(crate) triangles: &'a [[u32; 3]],
    /// Whether it became a fan though it is concave: its outline crosses itself, or the budget is spent.
    pub(crate) is_guess: bool,
}

/// Cuts the polygons of a file, keeping its memory from one to the next.
pub(crate) struct Cutter {
    budget: u64,
    outline: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
}

impl Cutter {
    pub(crate) fn new() -> Self {
        Self { budget: BUDGET, outline: Vec::new(), triangles: Vec::new() }
    }

    /// Cuts a polygon; one of fewer than three corners into nothing.
    pub(crate) fn cut(&mut self, polygon: &[DVec3]) -> Pieces<'_> {
        self.triangles.clear();
        let is_guess = !self.cut_within_outline(polygon);
        if is_guess {
            self.fan(polygon.len());
        }
        Pieces { triangles: &self.triangles, is_guess }
    }

    fn fan(&mut self, corners: usize) {
        self.triangles.clear();
        self.triangles.extend((2..corners as u32).map(|corner| [0, corner - 1, corner]));
    }

    /// Whether the triangles are right.
    fn cut_within_outline(&mut self, polygon: &[DVec3]) -> bool {
        let corners = polygon.len();
        if corners <= 3 {
            self.fan(corners);
            return true;
        }
        let normal = newell_normal(polygon);
        // Corners on a line, or that are not numbers: every cut is as good. What cannot be hit is counted later.
        // Two equal loops the opposite way round have no normal either, but an area.
        if !normal.is_finite() || normal == DVec3::ZERO {
            self.fan(corners);
            return !normal.is_finite() || is_straight(polygon);
        }
        self.project(polygon, normal);
        if is_convex(&self.outline) {
            self.fan(corners);
            return true;
        }
        if let [a, b, c, d] = *self.outline.as_slice() {
            return self.cut_concave_quad([a, b, c, d]);
        }
        ears::cut(&self.outline, &mut self.triangles, &mut self.budget) && self.keeps_the_area()
    }

    /// Cuts along the diagonal from the reflex corner, if there is just one.
    fn cut_concave_quad(&mut self, [a, b, c, d]: [DVec2; 4]) -> bool {
        let corners = [(d, a, b), (a, b, c), (b, c, d), (c, d, a)];
        let turns_left = corners.map(|(before, at, after)| (at - before).perp_dot(after - at) > 0.0);
        self.triangles = match turns_left {
            [false, true, true, true] | [true, true, false, true] => vec![[0, 1, 2], [0, 2, 3]],
            [true, false, true, true] | [true, true, true, false] => vec![[0, 1, 3], [1, 2, 3]],
            _ => return false,
        };
        true
    }

    /// Flattens the polygon along the largest axis of its Newell normal so that it goes round counter-clockwise.
    /// Leaving a coordinate away rounds nothing.
    fn project(&mut self, polygon: &[DVec3], normal: DVec3) {
        let first = polygon.first().copied().unwrap_or_default();
        let axis = normal.abs().max_position();
        let (mut x, mut y) = ((axis + 1) % 3, (axis + 2) % 3);
        if normal[axis] < 0.0 {
            (x, y) = (y, x);
        }
        let flat = |&corner: &DVec3| {
            let relative = corner - first;
            DVec2::new(relative[x], relative[y])
        };
        self.outline.clear();
        self.outline.extend(polygon.iter().map(flat));
    }

    fn keeps_the_area(&self) -> bool {
        let corner = |index: u32| self.outline.get(index as usize).copied().unwrap_or(DVec2::NAN);
        let area = |&[a, b, c]: &[u32; 3]| (corner(b) - corner(a)).perp_dot(corner(c) - corner(a)).abs();
        let cut: f64 = self.triangles.iter().map(area).sum();
        let whole: f64 = turns(&self.outline).map(|(from, to, _)| from.perp_dot(to)).sum();
        (cut - whole).abs() <= AREA_TOLERANCE * whole
    }
}

/// The normal of the plane that fits a polygon best, twice as long as the polygon's area there is large.
pub(crate) fn newell_normal(polygon: &[DVec3]) -> DVec3 {
    spokes(polygon).map(|(from, to)| from.cross(to)).sum()
}

fn is_straight(polygon: &[DVec3]) -> bool {
    spokes(polygon).all(|(from, to)| from.cross(to) == DVec3::ZERO)
}

/// Neighbouring corners, relative to the first.
fn spokes(polygon: &[DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> {
    let first = polygon.first().copied().unwrap_or_default();
    polygon.iter().zip(polygon.iter().skip(1)).map(move |(&from, &to)| (from - first, to - first))
}

/// Each corner of an outline with the two after it.
fn turns(outline: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2, DVec2)> {
    let following = |skip| outline.iter().copied().cycle().skip(skip);
    outline.iter().copied().zip(following(1)).zip(following(2)).map(|((a, b), c)| (a, b, c))
}

/// Whether an outline only turns left, and goes round once: a five-pointed star turns left and goes round twice.
fn is_convex(outline: &[DVec2]) -> bool {
    let steps = || turns(outline).map(|(a, b, c)| (b - a, c - b));
    let turns_left =
        steps().all(|(before, after)| before.perp_dot(after) >= -STRAIGHT * before.length() * after.length());
    let angle =
        || steps().map(|(before, after)| before.perp_dot(after).atan2(before.dot(after))).sum::<f64>();
    // Four corners cannot go round twice turning left.
    turns_left && (outline.len() <= 4 || angle() < 1.5 * TAU)
}

#[cfg(test)]
mod tests;
