//! A flattened triangle's answer to a point query.
//!
//! Its distance is raised to at least that of its own box, which no ancestor's exceeds: see [`super`].

use super::foot::Foot;
use super::{ClosestPoint, PreparedPoint, box_distance_squared};
use crate::FlatTriangle;
use glam::{Vec2, Vec3};

impl FlatTriangle {
    /// The triangle's nearest point to the query's, where the squared distance is at most `reach` and the query sees
    /// the instance. Whether it is within the query's radius is for the caller to ask of the distance.
    #[inline(always)]
    #[must_use]
    pub fn closest_point(&self, query: &PreparedPoint, reach: f32) -> Option<ClosestPoint> {
        if self.instance_and_mask & query.mask == 0 {
            return None;
        }
        let triangle = self.triangle();
        let bounds = triangle.bounds();
        let box_square = box_distance_squared(query, bounds.min.extend(1.0), bounds.max.extend(1.0));
        // Most triangles of a leaf that is entered late end here.
        if box_square > reach {
            return None;
        }
        let foot = Foot::find(query.point, triangle.vertices);
        let square = if foot.square > box_square { foot.square } else { box_square };
        if square > reach {
            return None;
        }
        let [_, u, v] = foot.weights();
        Some(ClosestPoint {
            distance: square.sqrt(),
            // Plus zero: of -0 and 0 either may come, and no bits must depend on it.
            point: foot.position(&triangle.vertices) + Vec3::ZERO,
            barycentrics: Vec2::new(u, v),
            primitive_index: self.primitive,
            geometry_index: self.geometry(),
            instance_index: self.instance(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PointQuery;

    fn flat() -> FlatTriangle {
        FlatTriangle {
            v0: [0.0; 3],
            primitive: 5,
            v1: [4.0, 0.0, 0.0],
            geometry_and_mirror: 2 | FlatTriangle::MIRROR,
            v2: [0.0, 4.0, 0.0],
            instance_and_mask: 0x0100_0003,
        }
    }

    fn ask(query: PointQuery, reach: f32) -> Option<ClosestPoint> {
        flat().closest_point(&PreparedPoint::new(&query).unwrap(), reach)
    }

    #[test]
    fn an_answer_has_all_its_fields() {
        let found = ask(PointQuery::new(Vec3::new(1.0, 2.0, -3.0)), f32::MAX).unwrap();
        assert_eq!((found.distance, found.point), (3.0, Vec3::new(1.0, 2.0, 0.0)));
        assert_eq!((found.barycentrics, found.id()), (Vec2::new(0.25, 0.5), (3, 2, 5)));
    }

    #[test]
    fn the_reach_is_closed_and_the_mask_decides() {
        let query = PointQuery::new(Vec3::new(1.0, 2.0, -3.0));
        assert!(ask(query, 9.0).is_some() && ask(query, 9f32.next_down()).is_none());
        assert!(ask(query.with_mask(3), 9.0).is_some() && ask(query.with_mask(0xfe), 9.0).is_none());
    }
}
