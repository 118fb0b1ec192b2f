//! Half-spaces, and what lies outside of them for certain.

use crate::{Aabb, Sphere};
use glam::Vec3;

/// How far a half-space is moved outwards: this share of the largest coordinate, times the sum of the magnitudes of the
/// normal's components. Fifty times what the sums here round, three steps of 2^-24; a ray's origin that was computed as a point
/// on a triangle is off by no more than these.
pub const PAD: f32 = 1e-5;

/// How far a triangle's own half-space is moved inwards for rays that begin above it, as a share like [`PAD`]: five times
/// what the sums here round, so that the triangle itself is outside, and what touches its plane from below.
pub const ABOVE: f32 = 1e-6;

/// How far above a triangle's plane, as a share like [`PAD`], a ray must begin of which it is known that it begins above:
/// what is outside lies below it by more than the triangle test rounds.
pub const CLEAR: f32 = 2.5e-6;

/// The points `x` with `normal . x >= offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Its normal, of any length but so that its components are about 1.
    pub normal: Vec3,
    /// Where it begins, moved outwards, or inwards for rays that begin above it.
    pub offset: f32,
    /// The length of the normal.
    pub length: f32,
}

impl Plane {
    /// The half-space that begins at the first of some points, when the largest coordinate of all is `largest`, moved outwards
    /// by the share [`PAD`].
    #[must_use]
    pub fn from_first_of(normal: Vec3, points: [Vec3; 3], largest: f32) -> Self {
        Self::moved_outwards(normal, points, PAD, largest)
    }

    /// The same, moved by another share; inwards by a negative one.
    #[must_use]
    pub fn moved_outwards(normal: Vec3, points: [Vec3; 3], share: f32, largest: f32) -> Self {
        let [a, b, c] = points.map(|point| normal.dot(point));
        let pad = (normal.x.abs() + normal.y.abs() + normal.z.abs()) * (share * largest);
        Self { normal, offset: a.min(b).min(c) - pad, length: normal.dot(normal).sqrt() }
    }

    /// Whether all of a sphere is outside.
    #[must_use]
    pub fn excludes_sphere(&self, sphere: &Sphere) -> bool {
        self.normal.dot(sphere.center) + sphere.radius * self.length < self.offset
    }

    /// Whether all of a box is outside.
    #[must_use]
    pub fn excludes_box(&self, bounds: &Aabb) -> bool {
        let farthest = Vec3::select(self.normal.cmpge(Vec3::ZERO), bounds.max, bounds.min);
        self.normal.dot(farthest) < self.offset
    }

    /// Whether all of a triangle is outside.
    #[must_use]
    pub fn excludes_triangle(&self, vertices: &[Vec3; 3]) -> bool {
        vertices.iter().all(|&vertex| self.normal.dot(vertex) < self.offset)
    }
}
