//! The distance to a box, and how far a search reaches.

use super::PreparedPoint;
use crate::aabb::PAD_EXIT;
use glam::{Vec3, Vec4};

/// The squared distance from the point to the box `min..max`; zero inside. The box must not be empty. The fourth
/// lanes of the corners mean nothing.
///
/// Monotone: differences, maxima, squares and sums keep their order when they are rounded, so a box that contains
/// another one is never farther.
#[inline(always)]
#[must_use]
pub fn box_distance_squared(point: &PreparedPoint, min: Vec4, max: Vec4) -> f32 {
    let outside = (min - point.lanes).max(point.lanes - max).max(Vec4::ZERO).truncate();
    outside.dot(outside)
}

/// The squared distance up to which a search must look in order to find everything within `distance`: no smaller than
/// any number whose root is rounded to `distance` or less. Never infinite, and it grows with the distance.
///
/// Roots are rounded, so several squares have the same: the square is padded as the exit of a slab is
/// ([`crate::aabb`]), by more than three floats. What is found beyond `distance` itself is for the caller to refuse.
#[inline(always)]
#[must_use]
pub fn reach(distance: f32) -> f32 {
    // In this order, since graphics drivers multiply by a constant first.
    (distance * (distance * PAD_EXIT)).min(f32::MAX)
}

/// The largest way along an axis from the point to a side of a box: no corner is farther than the root of 3 times it.
#[inline(always)]
pub(super) fn farthest_side(point: Vec3, min: Vec3, max: Vec3) -> f32 {
    (point - min).abs().max((max - point).abs()).max_element()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PointQuery;

    fn squared(point: Vec3, min: Vec3, max: Vec3) -> f32 {
        let point = PreparedPoint::new(&PointQuery::new(point)).unwrap();
        box_distance_squared(&point, min.extend(f32::NAN), max.extend(f32::NAN))
    }

    #[test]
    fn a_box_is_as_far_as_its_nearest_point() {
        let (min, max) = (Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0));
        for (point, expected) in [
            (Vec3::new(0.5, 1.0, 1.0), 0.0),
            (Vec3::new(1.0, 2.0, 3.0), 0.0),
            (Vec3::new(3.0, 1.0, 1.0), 4.0),
            (Vec3::new(-1.0, -2.0, 5.0), 9.0),
        ] {
            assert_eq!(squared(point, min, max), expected);
        }
    }

    #[test]
    fn growing_a_box_never_makes_it_farther() {
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 20) as f32 - 8.0
        };
        for _ in 0..100_000 {
            let corners = [(); 3].map(|()| Vec3::new(next(), next(), next()));
            let (min, max) = (corners[0].min(corners[1]), corners[0].max(corners[1]));
            let (outer_min, outer_max) = (min.min(corners[2]), max.max(corners[2]));
            let point = Vec3::new(next(), next(), next()) * 3.0;
            assert!(squared(point, outer_min, outer_max) <= squared(point, min, max));
        }
    }

    /// The promise of [`reach`], for every size of number.
    #[test]
    fn what_has_the_same_root_is_within_reach() {
        for exponent in -140..=127 {
            for mantissa in [1.0f64, 1.000_000_1, 1.3, 1.5, 1.999_999_9] {
                let distance = (mantissa * f64::from(exponent).exp2()) as f32;
                let reach = reach(distance);
                assert!(reach.is_finite());
                let beyond = reach.next_up();
                assert!(beyond.is_infinite() || beyond.sqrt() > distance, "{distance:e}");
                // Below, the square has lost digits.
                let too_far = reach.sqrt() > distance * (1.0 + 5e-7);
                assert!(!too_far || exponent < -60, "{distance:e}: it looks too far");
            }
        }
        assert_eq!((reach(0.0), reach(f32::INFINITY)), (0.0, f32::MAX));
    }
}
