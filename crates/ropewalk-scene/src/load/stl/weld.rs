//! Vertices of facets that lie at the same place become one.

use crate::load::placement::Placement;
use glam::DVec3;
use ropewalk::Mesh;
use std::collections::HashMap;

/// Makes a mesh of facets. Corners are one vertex when all their bits are equal; zero and minus zero are one place.
pub(super) fn weld(facets: &[[DVec3; 3]], placement: Placement) -> Mesh {
    let mut mesh = Mesh::default();
    mesh.triangles.reserve(facets.len());
    let mut numbers: HashMap<[u64; 3], u32> = HashMap::with_capacity(facets.len());
    for facet in facets {
        mesh.triangles.push(facet.map(|corner| {
            // Adding zero makes plus zero of minus zero.
            let key = (corner + DVec3::ZERO).to_array().map(f64::to_bits);
            *numbers.entry(key).or_insert_with(|| {
                mesh.positions.push(placement.place(corner));
                mesh.positions.len() as u32 - 1
            })
        }));
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_corners_are_one() {
        let [a, b, c, d] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(-0.0, 1.0, f64::EPSILON)];
        let facets = [[a, b, c], [c, b, -a], [d, b, DVec3::NAN]];
        let mesh = weld(&facets, Placement { origin: DVec3::ZERO });
        assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 0], [3, 1, 4]]);
        assert_eq!(mesh.positions.len(), 5);
    }
}
