//! Axis-aligned boxes and the slab test every hierarchy of boxes shares.
//!
//! **The test** pads both ends of the interval by 4e-7 (Ize 2013 pads the far end; the near end needs it too,
//! or a flat box hides a coplanar neighbour that is one float closer) and is closed: a box whose entry equals
//! the limit is entered. It is monotone: a box that contains another one is never missed where the inner one is
//! hit, and is never entered later. The triangle test builds on that, see [`crate::triangle`].
//!
//! The twin is `slab_test` in `shared/aabb.wgsl`.

use crate::ray::PreparedRay;
use glam::{Vec3, Vec3A, Vec4};

/// The far end of a slab interval is multiplied by this, three and a half floats further.
pub const PAD_EXIT: f32 = 1.0 + 4e-7;
/// The near end of a slab interval is multiplied by this.
pub const PAD_ENTRY: f32 = 1.0 - 4e-7;

/// An axis-aligned box; empty when a component of `min` exceeds that of `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The smallest corner.
    pub min: Vec3,
    /// The largest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box that contains nothing and that any point grows.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The box of two corners.
    #[inline]
    #[must_use]
    pub const fn new(min: Vec3, max: Vec3) -> Self {
        Self { min, max }
    }

    /// The smallest box around some points.
    #[must_use]
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with_point)
    }

    /// The smallest box around this one and a point.
    #[inline]
    #[must_use]
    pub fn with_point(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box around this one and another.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the box contains no point.
    #[inline]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Whether `other` lies inside this box, faces included. An empty box lies in every box.
    #[inline]
    #[must_use]
    pub fn contains(&self, other: &Self) -> bool {
        other.is_empty() || (self.min.cmple(other.min).all() && self.max.cmpge(other.max).all())
    }

    /// The lengths of the edges; zero for an empty box.
    #[inline]
    #[must_use]
    pub fn size(&self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { self.max - self.min }
    }

    /// The middle.
    #[inline]
    #[must_use]
    pub fn center(&self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Half the surface area: the measure of the surface area heuristic.
    #[inline]
    #[must_use]
    pub fn half_area(&self) -> f32 {
        let size = self.size();
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}

/// Where a ray enters and leaves a box, padded. The box is hit when `entry <= exit`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The padded entry, at least the ray's `t_min`.
    pub entry: f32,
    /// The padded exit, at most the limit that was given.
    pub exit: f32,
}

impl Interval {
    /// Whether the box is hit within the limits.
    #[inline]
    #[must_use]
    pub fn is_hit(&self) -> bool {
        self.entry <= self.exit
    }
}

/// Where the ray's line enters and leaves the box `min..max`, padded, whatever its window. The box must not be
/// empty. The fourth lanes of the corners mean nothing.
#[inline(always)]
#[must_use]
pub fn slab_span(ray: &PreparedRay, min: Vec4, max: Vec4) -> Interval {
    let low = (min - ray.origin_low) * ray.inverse;
    let high = (max - ray.origin_high) * ray.inverse;
    let near = Vec3A::from_vec4(low.min(high)).max_element();
    let far = Vec3A::from_vec4(low.max(high)).min_element();
    Interval { entry: near * PAD_ENTRY, exit: far * PAD_EXIT }
}

/// The padded slab test of the box `min..max` for `t` from the ray's `t_min` up to `t_max`. The box must not be
/// empty. The fourth lanes of the corners mean nothing.
#[inline(always)]
#[must_use]
pub fn slab_test(ray: &PreparedRay, min: Vec4, max: Vec4, t_max: f32) -> Interval {
    let span = slab_span(ray, min, max);
    Interval { entry: larger(span.entry, ray.t_min), exit: smaller(span.exit, t_max) }
}

/// The larger of two numbers, in one instruction: `f32::max` spends three more on NaN, which cannot be here.
#[inline(always)]
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, in one instruction.
#[inline(always)]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ray;

    fn test(ray: Ray, min: Vec3, max: Vec3) -> Interval {
        slab_test(&PreparedRay::new(&ray).unwrap(), min.extend(0.0), max.extend(0.0), ray.t_max)
    }

    #[test]
    fn a_ray_in_a_face_hits() {
        let (min, max) = (Vec3::ZERO, Vec3::ONE);
        for y in [0.0, 1.0] {
            for dir in [Vec3::X, Vec3::new(1.0, -0.0, 0.0), Vec3::new(1.0, 1e-30, -1e-30)] {
                assert!(test(Ray::new(Vec3::new(-1.0, y, 0.0), dir), min, max).is_hit());
                assert!(test(Ray::new(Vec3::new(-1.0, y, 1.0), dir), min, max).is_hit());
            }
        }
        assert!(!test(Ray::new(Vec3::new(-1.0, 1.0001, 0.5), Vec3::X), min, max).is_hit());
        assert!(!test(Ray::new(Vec3::new(-1.0, -1e-6, 0.5), Vec3::X), min, max).is_hit());
    }

    /// Floats near zero are close together: the step outwards must not shrink with them.
    #[test]
    fn a_face_at_zero_is_a_face() {
        for length in [1e-18, 1e-12, 1.0, 1e12, 1e18] {
            for size in [1e-9, 1.0, 1e12] {
                let (min, max) = (Vec3::splat(-size), Vec3::new(size, 0.0, size));
                let ray = Ray::new(Vec3::new(-2.0 * size, 0.0, 0.0), Vec3::X * length);
                assert!(test(ray, min, max).is_hit(), "{size} {length}: the upper face");
                let (min, max) = (Vec3::new(-size, 0.0, -size), Vec3::splat(size));
                assert!(test(ray, min, max).is_hit(), "{size} {length}: the lower face");
                let beside = Ray { origin: Vec3::new(-2.0 * size, -0.01 * size, 0.0), ..ray };
                assert!(!test(beside, min, max).is_hit() || length < 1e-15, "{size} {length}: beside");
            }
        }
    }

    #[test]
    fn a_flat_box_is_hit_in_its_plane_and_across() {
        let (min, max) = (Vec3::new(0.0, 2.0, 0.0), Vec3::new(1.0, 2.0, 1.0));
        assert!(test(Ray::new(Vec3::new(0.5, 0.0, 0.5), Vec3::Y), min, max).is_hit());
        assert!(test(Ray::new(Vec3::new(-1.0, 2.0, 0.5), Vec3::X), min, max).is_hit());
        assert!(!test(Ray::new(Vec3::new(0.5, 3.0, 0.5), Vec3::Y), min, max).is_hit());
    }

    #[test]
    fn the_empty_box_has_no_size() {
        assert!(Aabb::EMPTY.is_empty());
        assert_eq!((Aabb::EMPTY.half_area(), Aabb::EMPTY.size()), (0.0, Vec3::ZERO));
        assert!(Aabb::new(Vec3::ONE, Vec3::ONE).contains(&Aabb::EMPTY));
    }

    #[test]
    fn growing_a_box_never_loses_it() {
        let ray = Ray::new(Vec3::new(0.1, -3.0, 0.7), Vec3::new(0.01, 1.0, -0.2));
        let inner = test(ray, Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.3, 0.1, 1.0));
        let outer = test(ray, Vec3::new(-0.5, -0.2, 0.0), Vec3::new(0.3, 0.1, 1.1));
        assert!(inner.is_hit() && outer.is_hit());
        assert!(outer.entry <= inner.entry && outer.exit >= inner.exit);
    }
}
