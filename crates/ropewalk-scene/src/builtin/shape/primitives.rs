//! Spheres, boxes and plane pieces.

use super::Solid;
use glam::DVec3;
use std::collections::HashMap;

/// A sphere from an icosahedron whose faces are quartered `levels` times: 20 * 4^levels triangles of nearly one size.
pub(crate) fn icosphere(radius: f64, levels: u32, material: u32) -> Solid {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut directions: Vec<DVec3> = Vec::new();
    for (s, t) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
        directions.push(DVec3::new(s, t * golden, 0.0).normalize());
        directions.push(DVec3::new(0.0, s, t * golden).normalize());
        directions.push(DVec3::new(t * golden, 0.0, s).normalize());
    }
    // The faces are the triples of neighbours: two corners of an icosahedron are neighbours or far apart.
    let near = |a: usize, b: usize| directions[a].dot(directions[b]) > 0.4;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    let outward = directions[a].dot(directions[b].cross(directions[c])) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles: HashMap<(usize, usize), usize> = HashMap::new();
        let mut middle = |a: usize, b: usize| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                directions.push((directions[a] + directions[b]).normalize());
                directions.len() - 1
            })
        };
        let mut quarters = Vec::with_capacity(triangles.len() * 4);
        for [a, b, c] in triangles {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            quarters.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = quarters;
    }
    let mut solid = Solid::default();
    solid.ring(directions.iter().map(|&direction| direction * radius));
    for triangle in triangles {
        solid.triangle(triangle.map(|vertex| vertex as u32), material);
    }
    solid
}

/// A cube around the origin whose edges are bevelled: 24 vertices, 44 triangles.
pub(crate) fn bevelled_cube(size: f64, bevel: f64, material: u32) -> Solid {
    let half = size / 2.0;
    let mut solid = Solid::default();
    // Vertex 3 * corner + axis lies on the face across `axis`, near the corner with those signs.
    for corner in 0..8_u32 {
        let sign = DVec3::from_array([0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 }));
        for axis in 0..3 {
            let mut position = sign * (half - bevel);
            position[axis] = sign[axis] * half;
            solid.vertex(position);
        }
    }
    let id = |corner: u32, axis: u32| 3 * corner + axis;
    for axis in 0..3_u32 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in 0..2_u32 {
            let at = |i: u32, j: u32| side << axis | i << u | j << v;
            let face = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)].map(|corner| id(corner, axis));
            outward_quad(&mut solid, face, material);
            // The bevel between the face across `u` and that across `v`, along `axis`, at each of four edges.
            let (i, j) = (side, [0, 1]);
            for j in j {
                let (low, high) = (i << u | j << v, 1 << axis | i << u | j << v);
                outward_quad(&mut solid, [id(low, u), id(low, v), id(high, v), id(high, u)], material);
            }
        }
    }
    for corner in 0..8 {
        let [a, b, c] = [0, 1, 2].map(|axis| id(corner, axis));
        // An odd number of negative signs turns the corner's triangle round.
        solid.triangle(if corner.count_ones() % 2 == 1 { [a, b, c] } else { [a, c, b] }, material);
    }
    solid
}

/// Adds a quad of a body around the origin so that it looks outwards.
fn outward_quad(solid: &mut Solid, [a, b, c, d]: [u32; 4], material: u32) {
    let [p, q, r] = [a, b, c].map(|vertex| solid.positions[vertex as usize]);
    let outward = (q - p).cross(r - p).dot(p + r) > 0.0;
    solid.quad(if outward { [a, b, c, d] } else { [a, d, c, b] }, material);
}

/// A square in the plane y = 0 that looks up: two triangles. It is not closed.
pub(crate) fn ground_square(half: f64, material: u32) -> Solid {
    let mut solid = Solid::default();
    let corners = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)];
    let ring = solid.ring(corners.map(|(x, z)| DVec3::new(x * half, 0.0, z * half)));
    solid.quad([ring[0], ring[1], ring[2], ring[3]], material);
    solid
}

#[cfg(test)]
mod tests {
    use super::super::check::volume;
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn spheres_and_cubes_are_closed() {
        let sphere = icosphere(2.0, 4, 0);
        assert_eq!((sphere.triangles.len(), sphere.positions.len()), (5120, 2562));
        let share = volume(&sphere).unwrap() / (32.0 / 3.0 * PI);
        assert!(share > 0.99 && share < 1.0, "{share}");
        let cube = bevelled_cube(2.0, 0.1, 0);
        assert_eq!((cube.triangles.len(), cube.positions.len()), (44, 24));
        let volume = volume(&cube).unwrap();
        // Twelve wedges and what the corners lose.
        assert!(volume < 8.0 && volume > 7.8, "{volume}");
    }

    #[test]
    fn the_ground_looks_up() {
        let ground = ground_square(3.0, 0);
        for triangle in ground.triangles {
            let [a, b, c] = triangle.map(|vertex| ground.positions[vertex as usize]);
            assert!((b - a).cross(c - a).y > 0.0);
        }
    }
}
