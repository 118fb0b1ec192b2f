//! Triangles on which the eye lies, to within rounding. Every ray may meet them, at its very beginning; seen edge-on, or from no
//! distance at all, they cover no pixel of a picture that a graphics adapter draws. So rays are asked for them besides.

use super::drawing::{Drawing, Part};
use super::sight::Sight;
use crate::camera::Pinhole;
use glam::DVec3;
use ropewalk::{Aabb, FlatTriangle};

/// More triangles than this are not asked for one by one: then all rays are traced.
const MOST: usize = 64;

impl Drawing<'_> {
    /// The triangles on which the eye lies, as part and triangle; `None` where there are too many of them, or where of some part it
    /// cannot be said.
    pub(super) fn at_eye(&self, pinhole: &Pinhole, size: [u32; 2]) -> Option<Vec<[u32; 2]>> {
        let mut found = Vec::new();
        for (number, part) in (0..).zip(&self.parts) {
            if !part.is_seen_by(pinhole.mask()) {
                continue;
            }
            let sight = Sight::new(pinhole, size, part)?;
            if !is_near(&sight, &part.bounds, error(&sight, part)) {
                continue;
            }
            for index in part.triangles.clone() {
                let Some(triangle) = self.triangles.get(index) else { continue };
                if is_on(&sight, triangle) {
                    found.push([number, index as u32]);
                    if found.len() > MOST {
                        return None;
                    }
                }
            }
        }
        Some(found)
    }
}

/// By how much the corners of a part may be wrong, seen from the eye.
fn error(sight: &Sight, part: &Part) -> f64 {
    let (min, max) = (part.bounds.min.as_dvec3(), part.bounds.max.as_dvec3());
    sight.rounding((min - sight.eye).abs().max((max - sight.eye).abs()))
}

/// Whether the eye lies in a box that is so much larger.
fn is_near(sight: &Sight, bounds: &Aabb, error: f64) -> bool {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    sight.eye.cmpge(min - error).all() && sight.eye.cmple(max + error).all()
}

/// Whether the eye lies in the plane of a triangle and in its box, to within rounding.
fn is_on(sight: &Sight, triangle: &FlatTriangle) -> bool {
    let shape = triangle.triangle();
    let [a, b, c] = shape.vertices.map(|vertex| vertex.as_dvec3() - sight.eye);
    let error = sight.rounding(a.abs().max(b.abs()).max(c.abs()));
    if !is_near(sight, &shape.bounds(), error) {
        return false;
    }
    let normal: DVec3 = (b - a).cross(c - a);
    // A needle has no plane, and is as near as its box.
    normal.dot(a).abs() <= error * normal.length() || normal.length_squared() < error.powi(4)
}
