//! From the frame of a part to the picture, in f64, with bounds of all that a walk rounds.
//!
//! With the camera's corner `C`, and `R` and `D` one pixel right and down, all taken to the frame, a point at `r` from the eye is
//! `t (C + x R + y D)`: at the place `(x, y)` of the picture, in the depth `t`, which is the ray's own parameter. The map from `r`
//! to `(t, t x, t y)` is linear, so a triangle needs no clipping: its corners may lie behind the eye.
//!
//! **Rounding.** A walk computes in f32, so it meets a triangle whose corners are moved a little. By how much at most, in units of
//! roundoff `u = 2^-24`: the ray's direction is a sum of three rounded terms, `4 u` of their magnitudes, and once more in the
//! frame; over the depth of a corner that moves it. The eye is taken to the frame by a sum of four terms. The triangle test
//! subtracts the origin and shears, `8 u` of the corner's distance; then it compares two rounded products, which moves a corner by
//! `4 u` more; and below `1e-22` products vanish. [`STEPS`] doubles what these add up to.

use super::drawing::Part;
use crate::camera::Pinhole;
use glam::{DMat3, DVec3, Vec3};
use ropewalk::Aabb;

/// Units of roundoff by which each of the terms may be wrong.
const STEPS: f64 = 24.0 / 16_777_216.0;
/// Below this products of coordinates vanish.
const VANISHING: f64 = 1e-22;

/// A camera in the frame of a part.
#[derive(Clone, Debug)]
pub(super) struct Sight {
    pub(super) eye: DVec3,
    /// The rows of the map from a place relative to the eye to depth, depth times column, depth times row.
    pub(super) rows: [DVec3; 3],
    /// The sums of their magnitudes.
    reach: DVec3,
    /// By how much directions are wrong.
    direction_error: f64,
    /// By how much the eye is.
    eye_error: f64,
}

/// A point of the picture: depth, depth times column, depth times row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) at: DVec3,
    /// By how much each may be wrong.
    pub(super) error: DVec3,
}

impl Sight {
    /// Takes a camera to the frame of a part. `size` is the picture's, in pixels. `None` where the frame is so flat that nothing
    /// can be said about what is seen where.
    pub(super) fn new(pinhole: &Pinhole, size: [u32; 2], part: &Part) -> Option<Self> {
        let [eye, corner, right, down] = pinhole.plane().map(Vec3::as_dvec3);
        let map = DMat3::from_cols(part.axes[0], part.axes[1], part.axes[2]);
        let picture = DMat3::from_cols(map * corner, map * right, map * down);
        let inverse = picture.inverse();
        if !inverse.is_finite() {
            return None;
        }
        let rows = [inverse.row(0), inverse.row(1), inverse.row(2)];
        let norm = map.row(0).abs().element_sum().max(map.row(1).abs().element_sum());
        let norm = norm.max(map.row(2).abs().element_sum());
        let [width, height] = size.map(|side| f64::from(side) + 1.0);
        let largest = |vector: DVec3| vector.abs().max_element();
        let longest = largest(corner) + largest(right) * width + largest(down) * height;
        let eye_error = match part.place {
            Some(_) => STEPS * (norm * largest(eye) + largest(part.origin)),
            None => 0.0,
        };
        let sums = rows.map(|row| row.abs().element_sum());
        Some(Self {
            eye: map * eye + part.origin,
            rows,
            reach: DVec3::from(sums),
            direction_error: STEPS * norm * longest,
            eye_error,
        })
    }

    /// Where a point of the frame is seen.
    #[inline]
    pub(super) fn look(&self, point: DVec3) -> Seen {
        let from_eye = point - self.eye;
        let at = DVec3::from(self.rows.map(|row| row.dot(from_eye)));
        let moved = STEPS * from_eye.abs().max_element()
            + at.x.abs() * self.direction_error
            + self.eye_error
            + VANISHING;
        Seen { at, error: self.reach * moved }
    }

    /// By how much a point may be wrong for a ray that begins at the eye, where its coordinates from there are no larger.
    pub(super) fn rounding(&self, from_eye: DVec3) -> f64 {
        STEPS * from_eye.max_element() + self.eye_error + VANISHING
    }

    /// A depth before which no ray meets anything of a box of the frame: not even what rounding moves to its faces, which may
    /// lie nearer than the triangle in it.
    #[inline]
    pub(super) fn nearest(&self, bounds: &Aabb) -> f32 {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let half = (max - min) * 0.5;
        let middle = self.look(min + half);
        let reach = self.rows[0].abs().dot(half);
        // The errors grow linearly from the middle outwards.
        let wrong =
            middle.error.x + self.reach.x * (STEPS * half.max_element() + reach * self.direction_error);
        let nearest = (middle.at.x - reach - wrong) * if middle.at.x > reach { 1.0 - 1e-5 } else { 1.0 };
        (nearest as f32).next_down().max(0.0)
    }
}

/// The corners of a box.
pub(super) fn corners(bounds: &Aabb) -> [DVec3; 8] {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    std::array::from_fn(|corner| {
        let pick = |axis: usize| if corner >> axis & 1 == 0 { min[axis] } else { max[axis] };
        DVec3::new(pick(0), pick(1), pick(2))
    })
}
