//! Bounding spheres, the volumes of Toczek's traversal lists.

use crate::{Aabb, Ray};
use glam::Vec3;

/// A ball around some points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The middle.
    pub center: Vec3,
    /// The radius; at least zero.
    pub radius: f32,
}

impl Sphere {
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

    /// Where a ray's line enters and leaves the sphere, or `None` when it misses. The entry is negative when
    /// the origin is inside: a walk must compare the exit with zero and the entry with its limit, never "the
    /// smallest positive root", which loses hits.
    #[must_use]
    pub fn interval(&self, ray: &Ray) -> Option<(f32, f32)> {
        let to_center = self.center - ray.origin;
        let length_squared = ray.dir.length_squared();
        let nearest = to_center.dot(ray.dir) / length_squared;
        // The distance of the line to the centre, from the difference vector: the textbook discriminant
        // cancels when the sphere is small and far away.
        let off = to_center - ray.dir * nearest;
        let inside = self.radius * self.radius - off.length_squared();
        if inside < 0.0 || inside.is_nan() {
            return None;
        }
        let half = (inside / length_squared).sqrt();
        Some((nearest - half, nearest + half))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_keeps_its_negative_entry() {
        let sphere = Sphere { center: Vec3::ZERO, radius: 2.0 };
        assert_eq!(sphere.interval(&Ray::new(Vec3::ZERO, Vec3::X * 2.0)), Some((-1.0, 1.0)));
        assert_eq!(sphere.interval(&Ray::new(Vec3::new(-4.0, 0.0, 0.0), Vec3::X)), Some((2.0, 6.0)));
        assert_eq!(sphere.interval(&Ray::new(Vec3::new(-4.0, 2.5, 0.0), Vec3::X)), None);
        assert_eq!(Sphere::of_points(&[]), None);
    }
}
