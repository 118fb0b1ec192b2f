//! Bounding spheres, and where a ray goes through one: the volumes of Toczek's traversal lists
//! ([`crate::traversal_list`]).
//!
//! **What they contain.** A triangle is hit at a `t` at which the ray is in the triangle's own padded box
//! ([`crate::triangle`]), and it is the box, not the triangle, that a sphere must contain for that `t` to be in the sphere's
//! interval too. So radii reach to the farthest corner of the triangles' boxes; to the vertices would lose hits of rays in
//! a needle's plane.
//!
//! **Entry, not the smallest positive root.** A sphere that the ray starts in is entered before the ray begins. The helper
//! that gives the smallest positive root gives its exit instead, and nodes with nearer hits are culled: 154 wrong of 120,000
//! rays (ALGORITHMS: C1).
//!
//! **Padding.** The direction is taken over its largest component, so that squares neither overflow nor lose their digits.
//! With `m` for the distance from the origin to the centre plus the radius, in the sum norm of no more than 3 roundings a
//! step, the offset from the ray to the centre is off by less than `8 * 2^-24 m`, and a hit's `t` may lie outside of its box
//! by `4e-7` of itself: together less than `1.7e-6 m`. [`Sphere::PAD`] is more than twice that.

use crate::aabb::Interval;
use crate::{Aabb, PreparedRay};
use glam::{DVec3, Vec3};

/// A ball around some points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The middle.
    pub center: Vec3,
    /// The radius; at least zero.
    pub radius: f32,
}

impl Sphere {
    /// What is added to radii and taken off entries, as a share of the distance and the radius.
    pub const PAD: f32 = 4e-6;

    /// The sphere at the middle of the points' box whose radius reaches the farthest of them
    /// (Toczek 2010, section 2.2). `None` when there are no points.
    ///
    /// ```
    /// use ropewalk::{Sphere, glam::Vec3};
    /// let sphere = Sphere::of_points(&[Vec3::ZERO, Vec3::X * 2.0]).unwrap();
    /// assert_eq!(sphere.center, Vec3::X);
    /// assert!(sphere.radius >= 1.0);
    /// ```
    #[must_use]
    pub fn of_points(points: &[Vec3]) -> Option<Self> {
        let center = Aabb::of_points(points.iter().copied()).center();
        let farthest = points.iter().map(|point| point.distance_squared(center)).reduce(f32::max)?;
        // The root and the subtraction round: 2e-6 relative keeps every point inside.
        Some(Self { center, radius: farthest.sqrt() * (1.0 + 2e-6) })
    }

    /// The smallest sphere about `center` that contains boxes. Rounded outwards.
    #[must_use]
    pub fn about(center: Vec3, boxes: impl Iterator<Item = Aabb>) -> Self {
        let middle = center.as_dvec3();
        let away = |corner: Vec3| (corner.as_dvec3() - middle).abs();
        let farthest = |bounds: Aabb| DVec3::max(away(bounds.min), away(bounds.max)).length_squared();
        Self::as_far_as(center, boxes.map(farthest))
    }

    /// The smallest sphere about `center` that contains points, and not their boxes: see [`crate::traversal_list::Reach`].
    /// Rounded outwards.
    #[must_use]
    pub fn about_points(center: Vec3, points: impl Iterator<Item = Vec3>) -> Self {
        let middle = center.as_dvec3();
        Self::as_far_as(center, points.map(|point| point.as_dvec3().distance_squared(middle)))
    }

    /// With a radius that is the root of the largest square, rounded outwards.
    fn as_far_as(center: Vec3, squares: impl Iterator<Item = f64>) -> Self {
        Self { center, radius: (squares.fold(0.0, f64::max).sqrt() as f32).next_up() }
    }

    /// Where a ray goes through, padded, up to `limit`; not hit where it passes by.
    #[inline(always)]
    #[must_use]
    pub fn interval(&self, ray: &PreparedRay, limit: f32) -> Interval {
        let offset = self.center - Vec3::from(ray.origin);
        let [x, y, z] = ray.axes.map(|axis| offset.extend(0.0)[usize::from(axis & 3)]);
        // In units of the direction's largest component.
        let along = Vec3::new(ray.shear[0], ray.shear[1], 1.0);
        let offset = Vec3::new(x, y, z);
        let square = along.length_squared();
        let middle = offset.dot(along) / square;
        let pad = Self::PAD * (offset.abs().element_sum() + self.radius);
        let radius = self.radius + pad;
        let distance = (offset - along * middle).length();
        if distance > radius {
            return Interval { entry: f32::INFINITY, exit: f32::NEG_INFINITY };
        }
        // Two roots: a product of small numbers would lose its digits.
        let half = (radius - distance).sqrt() * (radius + distance).sqrt() / square.sqrt() + pad;
        let (a, b) = ((middle - half) * ray.shear[2], (middle + half) * ray.shear[2]);
        let (entry, exit) = if ray.forward { (a, b) } else { (b, a) };
        Interval {
            entry: if entry > ray.t_min { entry } else { ray.t_min },
            exit: if exit < limit { exit } else { limit },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ray;

    fn interval(sphere: Sphere, ray: Ray) -> Interval {
        sphere.interval(&PreparedRay::new(&ray).unwrap(), ray.t_max)
    }

    #[test]
    fn a_ray_goes_in_and_out() {
        let sphere = Sphere { center: Vec3::new(5.0, 0.0, 0.0), radius: 2.0 };
        for length in [1.0, 0.25, 1e9, 1e-9] {
            let through = interval(sphere, Ray::new(Vec3::ZERO, Vec3::X * length));
            assert!(through.is_hit());
            assert!((through.entry * length - 3.0).abs() < 1e-4 && through.entry * length <= 3.0);
            assert!((through.exit * length - 7.0).abs() < 1e-4 && through.exit * length >= 7.0);
            assert!(!interval(sphere, Ray::new(Vec3::ZERO, Vec3::NEG_X * length)).is_hit());
            assert!(!interval(sphere, Ray::new(Vec3::Y * 2.1, Vec3::X * length)).is_hit());
            assert!(interval(sphere, Ray::new(Vec3::Y * 1.9, Vec3::X * length)).is_hit());
        }
    }

    /// The smallest positive root would be the exit.
    #[test]
    fn a_ray_that_starts_inside_enters_where_it_begins() {
        let sphere = Sphere { center: Vec3::ZERO, radius: 2.0 };
        let from_inside = interval(sphere, Ray::new(Vec3::X, Vec3::X));
        assert_eq!(from_inside.entry, 0.0);
        assert!((from_inside.exit - 1.0).abs() < 1e-4);
        assert!(interval(sphere, Ray::new(Vec3::X, Vec3::X).window(0.0, 0.1)).is_hit());
        assert!(!interval(sphere, Ray::new(Vec3::X, Vec3::X).window(1.5, 9.0)).is_hit());
        assert!(interval(sphere, Ray::new(Vec3::NEG_X * 9.0, Vec3::X).window(7.0, 7.0)).is_hit(), "closed");
    }

    /// Wherever the ray is within a box that the sphere was made for, it is within the interval.
    #[test]
    fn no_point_of_a_box_is_outside() {
        let mut state = 7u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        for round in 0..20_000 {
            let mut point = || Vec3::new(next(), next(), next());
            let scale = [1e-6, 1.0, 1e6][round % 3];
            let (a, b) = (point() * scale, point() * scale);
            let bounds = Aabb::of_points([a, b]);
            let sphere = Sphere::about(bounds.center(), [bounds].into_iter());
            let origin = point() * scale * [1.0, 30.0, 3000.0][round / 3 % 3];
            // Through a corner, and through the middle of an edge.
            for target in [bounds.min, bounds.max, Vec3::new(bounds.min.x, bounds.max.y, bounds.center().z)] {
                if target == origin {
                    continue;
                }
                let ray = Ray::new(origin, target - origin);
                let found = interval(sphere, ray);
                assert!(
                    found.is_hit() && found.entry <= 1.0 && found.exit >= 1.0,
                    "{found:?} {ray:?} {sphere:?}"
                );
            }
        }
    }
}
