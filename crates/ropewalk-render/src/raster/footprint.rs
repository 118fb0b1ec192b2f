//! Which pixels a triangle may touch: never one too few.
//!
//! A triangle that lies in front of the eye with certainty has an outline in the picture, and a margin by which rounding may
//! move its corners; since every point of a triangle is a mean of its corners, no sample farther from the outline than the margin
//! can be met. A triangle through the plane of the eye has no outline; but with its corners as depth, depth times column and depth
//! times row it has edges that are linear over the picture all the same (Olano, Greer 1997), and a side of them on which what is
//! in front of the eye lies.

use super::sight::{Seen, Sight, corners};
use glam::{DVec2, DVec3};
use ropewalk::{Aabb, FlatTriangle};

/// A rectangle of places, and where the samples of a pixel lie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    /// Pixels: left, top, right, bottom, the last ones included.
    pub(super) pixels: [u32; 4],
    /// The least and the largest step from a pixel's corner to a sample.
    pub(super) least: DVec2,
    pub(super) largest: DVec2,
}

/// The pixels that a triangle may touch.
#[derive(Clone, Debug)]
pub(super) struct Footprint {
    /// The place of its part in the order of drawing.
    pub(super) rank: u32,
    /// The triangle.
    pub(super) triangle: u32,
    /// Left, top, right, bottom, the last ones included.
    pub(super) pixels: [u32; 4],
    /// No ray meets the triangle before this.
    pub(super) nearest: f32,
    outline: Outline,
}

/// What is known of the shape.
#[derive(Clone, Debug)]
enum Outline {
    /// The corners in pixels, and by how much they may be wrong.
    Corners([DVec2; 3], f64),
    /// It reaches behind the eye; its edges, where it is certain which side of them counts.
    Around(Option<Box<[Edge; 3]>>),
}

/// An edge as it is seen: a linear function of the place, which is not negative where the triangle is, but for rounding.
#[derive(Clone, Copy, Debug)]
struct Edge {
    /// Its value at the picture's corner, and its growth along columns and rows.
    value: DVec3,
    /// By how much each of these may be wrong.
    error: DVec3,
}

/// Where some points, and all between them, are seen.
pub(super) enum Extent {
    /// Nowhere in the window.
    Outside,
    /// Within pixels: left, top, right, bottom, with corners wrong by no more than a margin.
    Within([u32; 4], f64),
    /// Perhaps everywhere.
    Around,
}

impl Window {
    /// The places of all samples: the least and the largest.
    fn places(&self) -> [DVec2; 2] {
        let [left, top, right, bottom] = self.pixels.map(f64::from);
        [DVec2::new(left, top) + self.least, DVec2::new(right, bottom) + self.largest]
    }

    /// A part of it.
    pub(super) fn part(&self, pixels: [u32; 4]) -> Self {
        Self { pixels, ..*self }
    }

    /// By how much a place that was rounded to f32 may be wrong.
    fn place_error(&self) -> f64 {
        f64::from(self.pixels[2].max(self.pixels[3]) + 2) / 8_388_608.0
    }

    /// Where points, and all between them, are seen.
    pub(super) fn extent(&self, seen: &[Seen]) -> Extent {
        if seen.iter().all(|seen| seen.at.x + seen.error.x < 0.0) || self.is_beyond(seen) {
            return Extent::Outside;
        }
        if !seen.iter().all(|seen| seen.at.x - seen.error.x > 0.0) {
            return Extent::Around;
        }
        let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (mut error, mut nearest) = (DVec3::ZERO, f64::INFINITY);
        for seen in seen {
            let place = place(seen);
            (min, max) = (min.min(place), max.max(place));
            error = error.max(seen.error);
            nearest = nearest.min(seen.at.x - seen.error.x);
        }
        let farthest = min.abs().max(max.abs()).max_element();
        let margin = (error.y.max(error.z) + farthest * error.x) / nearest
            + self.place_error()
            // What f64 itself rounds.
            + farthest * 1e-12;
        if !margin.is_finite() || !min.is_finite() || !max.is_finite() {
            return Extent::Around;
        }
        let first = (min - self.largest - margin).ceil();
        let last = (max - self.least + margin).floor();
        let [left, top, right, bottom] = self.pixels.map(f64::from);
        let (first, last) = (first.max(DVec2::new(left, top)), last.min(DVec2::new(right, bottom)));
        if first.x > last.x || first.y > last.y {
            return Extent::Outside;
        }
        Extent::Within([first.x, first.y, last.x, last.y].map(|pixel| pixel as u32), margin)
    }

    /// Whether points all lie beyond one side of the window, so that nothing between them that is in front of the eye is in it.
    fn is_beyond(&self, seen: &[Seen]) -> bool {
        let [least, largest] = self.places();
        let slack = self.place_error();
        let (least, largest) = (least - slack, largest + slack);
        let beyond = |side: f64, axis: usize, sign: f64| {
            seen.iter().all(|seen| {
                (seen.at[axis] - side * seen.at.x) * sign > seen.error[axis] + side.abs() * seen.error.x
            })
        };
        beyond(least.x, 1, -1.0)
            || beyond(largest.x, 1, 1.0)
            || beyond(least.y, 2, -1.0)
            || beyond(largest.y, 2, 1.0)
    }

    /// Where a box of a frame is seen, and the least depth in which.
    pub(super) fn of_box(&self, sight: &Sight, bounds: &Aabb) -> (Extent, f32) {
        let seen = corners(bounds).map(|corner| sight.look(corner));
        (self.extent(&seen), sight.nearest(bounds))
    }
}

impl Footprint {
    /// The footprint of a triangle in a window; `None` where no ray through it can meet the triangle. Without a sight nothing is
    /// known, and the triangle may be everywhere.
    #[inline]
    pub(super) fn new(
        window: &Window,
        sight: Option<&Sight>,
        rank: u32,
        triangle: u32,
        flat: &FlatTriangle,
    ) -> Option<Self> {
        let Some(sight) = sight else {
            let outline = Outline::Around(None);
            return Some(Self { rank, triangle, pixels: window.pixels, nearest: 0.0, outline });
        };
        let shape = flat.triangle();
        let seen = shape.vertices.map(|vertex| sight.look(vertex.as_dvec3()));
        let (pixels, outline) = match window.extent(&seen) {
            Extent::Outside => return None,
            Extent::Within(pixels, margin) => {
                (pixels, Outline::Corners([place(&seen[0]), place(&seen[1]), place(&seen[2])], margin))
            }
            Extent::Around => (window.pixels, Outline::Around(Edge::of(&seen).map(Box::new))),
        };
        Some(Self { rank, triangle, pixels, nearest: sight.nearest(&shape.bounds()), outline })
    }

    /// Calls for every pixel of a part of the window that the triangle may touch.
    #[inline]
    pub(super) fn for_each_pixel(&self, part: &Window, mut each: impl FnMut(u32, u32)) {
        let [left, top, right, bottom] = meet(self.pixels, part.pixels);
        if left > right || top > bottom {
            return;
        }
        match &self.outline {
            Outline::Around(edges) => {
                let edges = edges.as_ref().map_or(&[][..], |edges| &edges[..]);
                for row in top..=bottom {
                    let kept = edges.iter().try_fold([left, right], |kept, edge| edge.keep(part, row, kept));
                    if let Some([first, last]) = kept {
                        (first..=last).for_each(|column| each(column, row));
                    }
                }
            }
            // Few pixels are sooner tested than looked at again.
            Outline::Corners(..) if right - left < 2 => {
                for row in top..=bottom {
                    (left..=right).for_each(|column| each(column, row));
                }
            }
            Outline::Corners(corners, margin) => {
                for row in top..=bottom {
                    let least = f64::from(row) + part.least.y - margin;
                    let largest = f64::from(row) + part.largest.y + margin;
                    let Some([from, to]) = columns(corners, least, largest) else { continue };
                    let first = (from - margin - part.largest.x).ceil().max(f64::from(left));
                    let last = (to + margin - part.least.x).floor().min(f64::from(right));
                    if first <= last {
                        (first as u32..=last as u32).for_each(|column| each(column, row));
                    }
                }
            }
        }
    }
}

impl Edge {
    /// The edges of a triangle; `None` where rounding may turn it over.
    fn of(seen: &[Seen; 3]) -> Option<[Self; 3]> {
        let [a, b, c] = seen;
        let edges = [(b, c), (c, a), (a, b)].map(|(from, to)| {
            let (p, q) = (from.at.abs() + from.error, to.at.abs() + to.error);
            // What may be wrong in a product of two numbers that are wrong.
            let wrong = |i: usize, j: usize| {
                p[i] * to.error[j] + from.error[i] * q[j] + p[j] * to.error[i] + from.error[j] * q[i]
            };
            let error = DVec3::new(wrong(1, 2), wrong(2, 0), wrong(0, 1));
            Self { value: from.at.cross(to.at), error }
        });
        let volume = a.at.dot(edges[0].value);
        let wrong = a.at.abs().dot(edges[0].error) + a.error.dot(edges[0].value.abs() + edges[0].error);
        // Written so that what is no number is not certain.
        let is_certain = volume.abs() > wrong * 2.0;
        is_certain.then(|| edges.map(|edge| Self { value: edge.value * volume.signum(), ..edge }))
    }

    /// Those of some columns of a row in which the edge leaves something of the triangle; `None` where in none.
    #[inline]
    fn keep(&self, part: &Window, row: u32, [left, right]: [u32; 2]) -> Option<[u32; 2]> {
        let rounded = part.place_error();
        let (top, bottom) =
            (f64::from(row) + part.least.y - rounded, f64::from(row) + part.largest.y + rounded);
        let farthest = DVec3::new(
            1.0,
            f64::from(right) + part.largest.x.abs() + part.least.x.abs() + 1.0,
            top.abs().max(bottom.abs()),
        );
        let rest = self.value.x
            + (self.value.z * top).max(self.value.z * bottom)
            + self.error.dot(farthest)
            // What f64 itself rounds.
            + self.value.abs().dot(farthest) * 1e-12;
        let growth = self.value.y;
        let (mut first, mut last) = (f64::from(left), f64::from(right));
        if growth > 0.0 {
            first = first.max((-rest / growth - part.largest.x - rounded).ceil());
        } else if growth < 0.0 {
            last = last.min((rest / -growth - part.least.x + rounded).floor());
        } else if rest < 0.0 {
            return None;
        }
        // A quotient that is no number takes nothing away: `max` and `min` leave it out.
        (first <= last).then_some([first as u32, last as u32])
    }
}

/// What two rectangles have in common; empty where its right is less than its left, or its bottom than its top.
pub(super) fn meet(a: [u32; 4], b: [u32; 4]) -> [u32; 4] {
    [a[0].max(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].min(b[3])]
}

/// The place of a point in front of the eye.
fn place(seen: &Seen) -> DVec2 {
    DVec2::new(seen.at.y, seen.at.z) / seen.at.x
}

/// From where to where a triangle reaches between two heights; `None` where it is not there.
#[inline]
fn columns(corners: &[DVec2; 3], least: f64, largest: f64) -> Option<[f64; 2]> {
    let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut take = |x: f64| (from, to) = (from.min(x), to.max(x));
    for (a, b) in [(corners[0], corners[1]), (corners[1], corners[2]), (corners[2], corners[0])] {
        if (least..=largest).contains(&a.y) {
            take(a.x);
        }
        for height in [least, largest] {
            if (a.y < height) != (b.y < height) {
                // Held between the ends, where a flat edge's quotient would leave them.
                let x = a.x + (b.x - a.x) * ((height - a.y) / (b.y - a.y));
                take(x.clamp(a.x.min(b.x), a.x.max(b.x)));
            }
        }
    }
    (from <= to).then_some([from, to])
}
