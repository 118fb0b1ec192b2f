//! What of a triangle lies in a cell: the polygon that the cell's six planes leave of it (Sutherland and Hodgman 1974), and
//! the box around it.
//!
//! Only the cost goes by that, never which triangles a cell has: see [`super`].

use crate::{Aabb, Triangle};
use glam::Vec3;

/// A triangle, and a corner more for each plane.
const MOST_CORNERS: usize = 9;

/// The corners of a convex polygon, in f64.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [[f64; 3]; MOST_CORNERS],
    len: usize,
}

impl Polygon {
    fn of(triangle: &Triangle) -> Self {
        let mut polygon = Self { corners: [[0.0; 3]; MOST_CORNERS], len: 3 };
        for (to, from) in polygon.corners.iter_mut().zip(triangle.vertices) {
            *to = from.as_dvec3().to_array();
        }
        polygon
    }

    fn push(&mut self, corner: [f64; 3]) {
        if let Some(place) = self.corners.get_mut(self.len) {
            *place = corner;
            self.len += 1;
        }
    }

    /// What lies on one side of a plane, the plane included: with `sign` 1 above, with -1 below.
    fn cut(&self, axis: usize, plane: f64, sign: f64) -> Self {
        let mut left = Self { corners: [[0.0; 3]; MOST_CORNERS], len: 0 };
        let corners = &self.corners[..self.len.min(MOST_CORNERS)];
        let Some(mut from) = corners.last() else { return left };
        let mut from_height = (from[axis] - plane) * sign;
        for to in corners {
            let to_height = (to[axis] - plane) * sign;
            if (from_height < 0.0) != (to_height < 0.0) {
                let along = from_height / (from_height - to_height);
                let mut corner = [0, 1, 2].map(|k| from[k] + (to[k] - from[k]) * along);
                corner[axis] = plane;
                left.push(corner);
            }
            if to_height >= 0.0 {
                left.push(*to);
            }
            (from, from_height) = (to, to_height);
        }
        left
    }
}

/// The box around what of a triangle lies in a cell, faces included; `None` where nothing does.
pub(in crate::kd_tree) fn clip(triangle: &Triangle, cell: &Aabb) -> Option<Aabb> {
    let own = triangle.bounds();
    let mut polygon = Polygon::of(triangle);
    for axis in 0..3 {
        if own.min[axis] < cell.min[axis] {
            polygon = polygon.cut(axis, f64::from(cell.min[axis]), 1.0);
        }
        if own.max[axis] > cell.max[axis] {
            polygon = polygon.cut(axis, f64::from(cell.max[axis]), -1.0);
        }
    }
    let corners = polygon.corners[..polygon.len].iter();
    let bounds = Aabb::of_points(corners.map(|&[x, y, z]| Vec3::new(x as f32, y as f32, z as f32)));
    // Rounding may lead out of the cell.
    let inside = Aabb::new(bounds.min.max(own.min).max(cell.min), bounds.max.min(own.max).min(cell.max));
    (!inside.is_empty()).then_some(inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clipped(vertices: [[f32; 3]; 3], min: [f32; 3], max: [f32; 3]) -> Option<[[f32; 3]; 2]> {
        let triangle = Triangle { vertices: vertices.map(Vec3::from) };
        clip(&triangle, &Aabb::new(min.into(), max.into())).map(|it| [it.min.into(), it.max.into()])
    }

    #[test]
    fn the_box_is_that_of_the_part() {
        let slanted = [[0.0, 0.0, 0.0], [4.0, 4.0, 0.0], [4.0, 4.0, 1.0]];
        assert_eq!(
            clipped(slanted, [1.0, 0.0, -1.0], [2.0, 9.0, 9.0]),
            Some([[1.0, 1.0, 0.0], [2.0, 2.0, 0.5]])
        );
        assert_eq!(clipped(slanted, [1.0, 2.5, -1.0], [2.0, 9.0, 9.0]), None);
        assert_eq!(clipped(slanted, [-1.0; 3], [9.0; 3]), Some([[0.0; 3], [4.0, 4.0, 1.0]]), "all of it");
        assert_eq!(
            clipped(slanted, [4.0, 0.0, 0.0], [5.0, 9.0, 9.0]),
            Some([[4.0, 4.0, 0.0], [4.0, 4.0, 1.0]]),
            "a face is a part of the cell"
        );
    }

    #[test]
    fn every_plane_may_add_a_corner() {
        // In the plane x + y + z = 0.5, which cuts a hexagon out of the cell.
        let large = [[-9.0, -9.0, 18.5], [18.5, -9.0, -9.0], [-9.0, 18.5, -9.0]];
        let bounds = clipped(large, [-1.0; 3], [1.0; 3]).unwrap();
        assert!(
            bounds[0].iter().all(|&it| it == -1.0) && bounds[1].iter().all(|&it| it == 1.0),
            "{bounds:?}"
        );
    }
}
