//! What is asked of a point.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

/// The largest magnitude, `2^60`, that a coordinate of a query's point may have: squares of it do not overflow.
pub const LARGEST_POINT: f32 = f32::from_bits((127 + 60) << 23);

/// A point, and how far to search around it: a ball that contains its surface.
///
/// Five little-endian words, the same on the CPU, in a GPU buffer and in a file.
///
/// ```
/// use ropewalk::{PointQuery, glam::Vec3};
/// let near = PointQuery::new(Vec3::ONE).within(0.5);
/// assert!(near.is_valid());
/// assert!(!near.within(-1.0).is_valid());
/// ```
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct PointQuery {
    /// Where to search.
    pub point: Vec3,
    /// The largest distance that counts as found, included; may be infinite.
    pub radius: f32,
    /// An instance is seen only when `mask & instance.mask` has a bit, as for [`Ray::mask`](crate::Ray::mask).
    pub mask: u32,
}

impl PointQuery {
    /// A search at any distance that sees every instance.
    #[inline]
    #[must_use]
    pub const fn new(point: Vec3) -> Self {
        Self { point, radius: f32::INFINITY, mask: crate::Ray::ALL }
    }

    /// The same search, no farther than `radius`.
    #[inline]
    #[must_use]
    pub const fn within(self, radius: f32) -> Self {
        Self { radius, ..self }
    }

    /// The same search with another mask.
    #[inline]
    #[must_use]
    pub const fn with_mask(self, mask: u32) -> Self {
        Self { mask, ..self }
    }

    /// Whether the search can be made: no coordinate is NaN or beyond [`LARGEST_POINT`], and the radius is neither NaN
    /// nor negative.
    ///
    /// A query that is not valid finds nothing, and a batch gives it the status
    /// [`Status::INVALID_RAY`](crate::Status::INVALID_RAY), which means "not valid" here as it does for rays.
    #[inline]
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.point.abs().cmple(Vec3::splat(LARGEST_POINT)).all() && self.radius >= 0.0
    }
}

impl From<Vec3> for PointQuery {
    fn from(point: Vec3) -> Self {
        Self::new(point)
    }
}

/// A valid [`PointQuery`], as the tests of boxes and triangles want it.
#[derive(Clone, Copy, Debug)]
pub struct PreparedPoint {
    /// The point. The fourth lane is 1, because those of a node's corners are its link and count.
    pub(super) lanes: Vec4,
    /// The point.
    pub point: Vec3,
    /// The largest distance, included.
    pub radius: f32,
    /// The query's mask, in the top 8 bits, as [`crate::FlatTriangle`] keeps that of its instance.
    pub mask: u32,
}

impl PreparedPoint {
    /// Prepares a query, or `None` when it is not [valid](PointQuery::is_valid).
    #[inline(always)]
    #[must_use]
    pub fn new(query: &PointQuery) -> Option<Self> {
        let PointQuery { point, radius, mask } = *query;
        query.is_valid().then(|| Self { lanes: point.extend(1.0), point, radius, mask: mask << 24 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_query_is_five_words() {
        assert_eq!(size_of::<PointQuery>(), 20);
    }

    #[test]
    fn bad_queries_are_not_prepared() {
        let good = PointQuery::from(Vec3::new(1.0, -2.0, LARGEST_POINT));
        assert!(PreparedPoint::new(&good).is_some_and(|point| point.mask == 0xff00_0000));
        assert!(good.within(0.0).is_valid());
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, LARGEST_POINT.next_up(), f32::MIN] {
            for axis in 0..3 {
                let mut query = good;
                query.point[axis] = bad;
                assert!(PreparedPoint::new(&query).is_none(), "{query:?}");
            }
        }
        for radius in [f32::NAN, -1.0, f32::NEG_INFINITY] {
            assert!(!good.within(radius).is_valid(), "{radius}");
        }
    }
}
