//! What a search keeps of the triangles it is offered.

use super::{ClosestPoint, PreparedPoint};
use std::cmp::Ordering;
use std::collections::BTreeSet;

/// Takes triangles' nearest points, in any order.
pub trait CollectPoints {
    /// Nothing farther need be offered. It never grows.
    fn limit(&self) -> f32;
    /// A triangle's nearest point, perhaps beyond the limit, and perhaps not for the first time.
    fn offer(&mut self, found: ClosestPoint);
}

/// Keeps the closest, ties by id.
#[derive(Clone, Copy, Debug)]
pub struct KeepClosest {
    limit: f32,
    closest: ClosestPoint,
}

impl KeepClosest {
    /// Nothing found yet.
    #[inline(always)]
    #[must_use]
    pub fn new(point: &PreparedPoint) -> Self {
        Self { limit: point.radius, closest: ClosestPoint::NONE }
    }

    /// What was found.
    #[inline(always)]
    #[must_use]
    pub const fn answer(&self) -> ClosestPoint {
        self.closest
    }
}

impl CollectPoints for KeepClosest {
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn offer(&mut self, found: ClosestPoint) {
        if found.distance <= self.limit && found.precedes(&self.closest) {
            self.closest = found;
            self.limit = found.distance;
        }
    }
}

/// An answer, in the order of distance and id.
#[derive(Clone, Copy, Debug)]
struct Ranked(ClosestPoint);

impl Ranked {
    /// Distances are not negative, so their bits have the order of the numbers.
    fn key(&self) -> (u32, (u32, u32, u32)) {
        (self.0.distance.to_bits(), self.0.id())
    }
}

impl Ord for Ranked {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }
}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ranked {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl Eq for Ranked {}

/// Keeps the `k` closest, each triangle once.
///
/// A sorted tree: an offer costs the logarithm of `k`, however large it is, room is taken for what is found alone, and
/// a triangle that is offered again, which spatial splits do, has the same distance and finds its place taken.
#[derive(Clone, Debug)]
pub struct KeepNearest {
    k: usize,
    limit: f32,
    nearest: BTreeSet<Ranked>,
}

impl KeepNearest {
    /// Nothing found yet. With `k` of 0 nothing ever is.
    #[must_use]
    pub const fn new(point: &PreparedPoint, k: usize) -> Self {
        Self { k, limit: point.radius, nearest: BTreeSet::new() }
    }

    /// Appends what was found, sorted by distance, ties by id.
    pub fn append_to(&self, points: &mut Vec<ClosestPoint>) {
        points.extend(self.nearest.iter().map(|ranked| ranked.0));
    }
}

impl CollectPoints for KeepNearest {
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline]
    fn offer(&mut self, found: ClosestPoint) {
        if found.distance > self.limit {
            return;
        }
        self.nearest.insert(Ranked(found));
        if self.nearest.len() > self.k {
            self.nearest.pop_last();
        }
        if self.nearest.len() == self.k
            && let Some(farthest) = self.nearest.last()
        {
            self.limit = farthest.0.distance;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PointQuery;

    fn found(distance: f32, primitive_index: u32) -> ClosestPoint {
        ClosestPoint { distance, primitive_index, instance_index: 0, geometry_index: 0, ..ClosestPoint::NONE }
    }

    fn prepared(radius: f32) -> PreparedPoint {
        PreparedPoint::new(&PointQuery::new(glam::Vec3::ZERO).within(radius)).unwrap()
    }

    #[test]
    fn the_closest_is_kept_and_the_radius_is_closed() {
        let mut keep = KeepClosest::new(&prepared(2.0));
        keep.offer(found(2f32.next_up(), 0));
        assert!(!keep.answer().is_found());
        keep.offer(found(2.0, 4));
        keep.offer(found(2.0, 3));
        keep.offer(found(2.0, 5));
        assert_eq!((keep.answer().primitive_index, keep.limit()), (3, 2.0));
    }

    /// Against sorting everything, with few different distances and many repeats.
    #[test]
    fn the_nearest_are_those_that_sorting_gives() {
        let mut state = 3u32;
        for k in [0, 1, 2, 7, 40, usize::MAX] {
            let mut keep = KeepNearest::new(&prepared(13.0), k);
            let mut model = Vec::new();
            for _ in 0..300 {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let id = (state >> 16) % 60;
                let offer = found((id % 17) as f32, id);
                keep.offer(offer);
                model.push(offer);
                let limit = keep.limit();
                assert!(limit <= 13.0);
            }
            model.retain(|offer| offer.distance <= 13.0);
            model.sort_by_key(|offer| Ranked(*offer).key());
            model.dedup();
            model.truncate(k);
            let mut points = Vec::new();
            keep.append_to(&mut points);
            assert_eq!(points, model, "k = {k}");
        }
    }
}
