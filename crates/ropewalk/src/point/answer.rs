//! What a point query answers, and the rule that makes the answer unique.

use crate::{Counters, Hit, Status};
use glam::{Vec2, Vec3};

/// The nearest point of a triangle. Where nothing was found every field is written: see [`ClosestPoint::NONE`].
///
/// ```
/// use ropewalk::ClosestPoint;
/// assert!(!ClosestPoint::NONE.is_found());
/// assert_eq!(ClosestPoint::NONE.distance, f32::INFINITY);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// How far the query's point is from the triangle.
    pub distance: f32,
    /// The triangle's point that is that near.
    pub point: Vec3,
    /// The weights of the triangle's second and third vertex at the point; the first one's is `1 - u - v`.
    pub barycentrics: Vec2,
    /// The triangle within its geometry.
    pub primitive_index: u32,
    /// The geometry (mesh) within its object.
    pub geometry_index: u32,
    /// The instance within the scene.
    pub instance_index: u32,
}

impl ClosestPoint {
    /// The answer where nothing is within the radius: an infinite distance, the point and the weights zero, and the
    /// indices [`Hit::NONE`].
    pub const NONE: Self = Self {
        distance: f32::INFINITY,
        point: Vec3::ZERO,
        barycentrics: Vec2::ZERO,
        primitive_index: Hit::NONE,
        geometry_index: Hit::NONE,
        instance_index: Hit::NONE,
    };

    /// Whether anything was found.
    #[inline]
    #[must_use]
    pub const fn is_found(&self) -> bool {
        self.primitive_index != Hit::NONE
    }

    /// What orders answers of equal distance: instance, then geometry, then primitive.
    #[inline]
    #[must_use]
    pub const fn id(&self) -> (u32, u32, u32) {
        (self.instance_index, self.geometry_index, self.primitive_index)
    }

    /// Whether this answer is preferred to `other`: the smaller distance, then the smaller id.
    #[inline]
    #[must_use]
    pub fn precedes(&self, other: &Self) -> bool {
        self.distance < other.distance || (self.distance == other.distance && self.id() < other.id())
    }

    /// The same answer as words, for comparisons to the bit.
    #[must_use]
    pub fn to_words(&self) -> [u32; 9] {
        let [x, y, z] = self.point.to_array().map(f32::to_bits);
        let [u, v] = self.barycentrics.to_array().map(f32::to_bits);
        let distance = self.distance.to_bits();
        [distance, x, y, z, u, v, self.primitive_index, self.geometry_index, self.instance_index]
    }
}

impl Default for ClosestPoint {
    fn default() -> Self {
        Self::NONE
    }
}

/// The nearest triangles of every query of a batch, one list after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NearestLists {
    /// One more than there are queries: those of query `i` are `points[offsets[i]..offsets[i + 1]]`.
    pub offsets: Vec<u64>,
    /// The answers, those of a query sorted by distance, ties by id.
    pub points: Vec<ClosestPoint>,
}

impl NearestLists {
    /// The answers to one query. Empty for a query that is not there.
    #[must_use]
    pub fn of(&self, query: usize) -> &[ClosestPoint] {
        let ends = (self.offsets.get(query), self.offsets.get(query.wrapping_add(1)));
        let (Some(&from), Some(&to)) = ends else { return &[] };
        self.points.get(from as usize..to as usize).unwrap_or_default()
    }
}

/// An answered batch of point queries.
#[derive(Clone, Debug, PartialEq)]
pub struct PointAnswers<A> {
    /// The answers, in the order of the queries.
    pub points: A,
    /// A word a query that says whether its answer is complete.
    pub status: Vec<Status>,
    /// What each query's walk did, where [`TraceOptions::counters`](crate::TraceOptions::counters) asked for it.
    pub counters: Option<Vec<Counters>>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_go_to_the_smaller_id() {
        let a = ClosestPoint {
            distance: 1.0,
            primitive_index: 3,
            geometry_index: 0,
            instance_index: 1,
            ..ClosestPoint::NONE
        };
        let b = ClosestPoint { primitive_index: 9, instance_index: 0, ..a };
        assert!(b.precedes(&a) && !a.precedes(&b), "the instance counts before the primitive");
        assert!(!a.precedes(&a) && a.precedes(&ClosestPoint::NONE));
        assert!(ClosestPoint { distance: 0.5, instance_index: 7, ..a }.precedes(&b));
    }

    #[test]
    fn a_list_that_is_not_there_is_empty() {
        let lists = NearestLists { offsets: vec![0, 1, 1, 9], points: vec![ClosestPoint::NONE] };
        assert_eq!([0, 1, 2, 3, usize::MAX].map(|query| lists.of(query).len()), [1, 0, 0, 0, 0]);
    }
}
