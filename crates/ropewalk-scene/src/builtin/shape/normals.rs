//! Shading normals: smooth over curved surfaces, hard at edges.
//!
//! The normal of a face's corner is the mean, weighted by angle and area, of those faces around the vertex that
//! turn away from it by less than the crease angle. The area makes the narrow chamfer bend instead of the wide
//! plane beside it; the angle makes the result independent of how a plane was cut into triangles.

use crate::CornerAttribute;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

use super::Solid;

/// Normals for each corner of each triangle; `crease` is in radians.
pub(crate) fn smooth(solid: &Solid, crease: f64) -> CornerAttribute<Vec3> {
    let limit = crease.cos();
    let faces: Vec<(DVec3, f64)> = solid
        .triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|vertex| solid.positions[vertex as usize]);
            let cross = (b - a).cross(c - a);
            (cross.normalize_or_zero(), cross.length())
        })
        .collect();
    let around = Around::new(solid);
    let mut values = Vec::new();
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    let indices = solid
        .triangles
        .iter()
        .zip(&faces)
        .map(|(triangle, face)| {
            triangle.map(|vertex| {
                let mut sum = DVec3::ZERO;
                for &(other, angle) in around.of(vertex) {
                    let (normal, area) = faces[other as usize];
                    if normal.dot(face.0) >= limit {
                        sum += normal * (area * angle);
                    }
                }
                let normal = sum.try_normalize().unwrap_or(face.0).as_vec3();
                *known.entry(normal.to_array().map(f32::to_bits)).or_insert_with(|| {
                    values.push(normal);
                    (values.len() - 1) as u32
                })
            })
        })
        .collect();
    CornerAttribute { values, indices: Some(indices) }
}

/// The triangles around each vertex, with their angles there.
struct Around {
    starts: Vec<u32>,
    faces: Vec<(u32, f64)>,
}

impl Around {
    fn new(solid: &Solid) -> Self {
        let mut starts = vec![0_u32; solid.positions.len() + 1];
        for &vertex in solid.triangles.iter().flatten() {
            starts[vertex as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut ends = starts.clone();
        let mut faces = vec![(0, 0.0); solid.triangles.len() * 3];
        for (face, triangle) in solid.triangles.iter().enumerate() {
            for corner in 0..3 {
                let [a, b, c] = [0, 1, 2].map(|k| solid.positions[triangle[(corner + k) % 3] as usize]);
                let end = &mut ends[triangle[corner] as usize];
                faces[*end as usize] = (face as u32, (b - a).angle_between(c - a));
                *end += 1;
            }
        }
        Self { starts, faces }
    }

    fn of(&self, vertex: u32) -> &[(u32, f64)] {
        let vertex = vertex as usize;
        &self.faces[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::super::primitives::{bevelled_cube, icosphere};
    use super::*;

    #[test]
    fn a_sphere_is_smooth() {
        let sphere = icosphere(1.0, 3, 0);
        let normals = smooth(&sphere, 0.6);
        assert_eq!(normals.values.len(), sphere.positions.len());
        for (face, &triangle) in sphere.triangles.iter().enumerate() {
            let corners = normals.corners(face, triangle).unwrap();
            for (corner, vertex) in corners.iter().zip(triangle) {
                assert!(corner.as_dvec3().dot(sphere.positions[vertex as usize]) > 0.999);
            }
        }
    }

    #[test]
    fn the_edges_of_a_cube_stay_hard() {
        let cube = bevelled_cube(1.0, 0.1, 0);
        let normals = smooth(&cube, 0.6);
        assert_eq!(normals.values.len(), 26, "6 faces, 12 edges, 8 corners");
    }
}
