//! A half space taken away from a solid. Where it was cut the solid gets plane faces, so it stays closed.
//!
//! New vertices stand where edges cross the plane, one an edge, so neighbouring triangles share them. The cut
//! edges are then followed into loops; loops that run clockwise are holes of those around them.

use super::Solid;
use super::fill::signed_area;
use super::outline::contains;
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// A plane: the points p with `normal . p = offset`. What lies beyond it, where the normal points, is taken away.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
}

impl Plane {
    /// The plane through a point.
    pub(crate) fn through(point: DVec3, normal: DVec3) -> Self {
        let normal = normal.normalize();
        Self { normal, offset: normal.dot(point) }
    }

    /// The distance beyond the plane.
    pub(crate) fn beyond(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }

    fn basis(&self) -> (DVec3, DVec3) {
        let u = self.normal.any_orthonormal_vector();
        (u, self.normal.cross(u))
    }
}

/// What of a closed body lies on the near side of a plane; empty when nothing does. No vertex may lie exactly
/// on the plane. `material` is that of the new faces.
pub(crate) fn cut(solid: &Solid, plane: &Plane, material: u32) -> Solid {
    let beyond: Vec<f64> = solid.positions.iter().map(|&position| plane.beyond(position)).collect();
    let mut result = Solid { positions: solid.positions.clone(), ..Solid::default() };
    let mut crossings: HashMap<(u32, u32), u32> = HashMap::new();
    // From each new vertex to the next one around the material, as the new face sees it.
    let mut onward: HashMap<u32, u32> = HashMap::new();
    let mut order = Vec::new();
    for (triangle, &paint) in solid.triangles.iter().zip(&solid.materials) {
        let gone = triangle.map(|vertex| beyond[vertex as usize] >= 0.0);
        let count = gone.iter().filter(|&&gone| gone).count();
        if count == 0 {
            result.triangle(*triangle, paint);
        }
        if count == 0 || count == 3 {
            continue;
        }
        // Turned so that the first corner is the one that is alone on its side.
        let alone =
            (0..3).find(|&i| gone[i] != gone[(i + 1) % 3] && gone[i] != gone[(i + 2) % 3]).unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|i| triangle[(alone + i) % 3]);
        let mut crossing = |p: u32, q: u32| {
            let (p, q) = (p.min(q), p.max(q));
            *crossings.entry((p, q)).or_insert_with(|| {
                let share = beyond[p as usize] / (beyond[p as usize] - beyond[q as usize]);
                let position = solid.positions[p as usize].lerp(solid.positions[q as usize], share);
                result.vertex(position)
            })
        };
        let (ab, ca) = (crossing(a, b), crossing(c, a));
        let (from, to) = if count == 2 {
            result.triangle([a, ab, ca], paint);
            (ca, ab)
        } else {
            result.quad([ab, b, c, ca], paint);
            (ab, ca)
        };
        onward.insert(from, to);
        order.push(from);
    }
    cap(&mut result, &onward, &order, plane, material);
    result.compact();
    result
}

/// Closes the loops of cut edges.
fn cap(solid: &mut Solid, onward: &HashMap<u32, u32>, order: &[u32], plane: &Plane, material: u32) {
    let (u, v) = plane.basis();
    let flat = |solid: &Solid, vertex: u32| {
        let position = solid.positions[vertex as usize];
        DVec2::new(position.dot(u), position.dot(v))
    };
    let mut seen = vec![false; solid.positions.len()];
    let (mut outlines, mut holes) = (Vec::new(), Vec::new());
    for &start in order {
        let mut ring = Vec::new();
        let mut vertex = start;
        while !seen[vertex as usize] {
            seen[vertex as usize] = true;
            ring.push(vertex);
            let Some(&next) = onward.get(&vertex) else { break };
            vertex = next;
        }
        if ring.len() >= 3 {
            let points: Vec<DVec2> = ring.iter().map(|&vertex| flat(solid, vertex)).collect();
            if signed_area(&points) > 0.0 { outlines.push((ring, points)) } else { holes.push(ring) }
        }
    }
    for (outline, points) in &outlines {
        let inside = |hole: &&Vec<u32>| contains(points, flat(solid, hole[0]));
        let mut rings: Vec<&[u32]> = vec![outline];
        rings.extend(holes.iter().filter(inside).map(Vec::as_slice));
        solid.fill_plane(&rings, u, v, material);
    }
}

#[cfg(test)]
mod tests {
    use super::super::check::volume;
    use super::super::lathe::ring_of;
    use super::super::outline::circle;
    use super::super::primitives::{bevelled_cube, icosphere};
    use super::*;

    #[test]
    fn both_halves_are_closed_and_make_the_whole() {
        let torus = ring_of(&circle(DVec2::new(3.0, 0.0), 1.0, 40), 60, 0);
        for solid in [bevelled_cube(2.0, 0.1, 0), icosphere(1.0, 3, 0), torus] {
            let whole = volume(&solid).unwrap();
            for normal in [DVec3::Z, DVec3::new(1.0, 2.0, 0.3), DVec3::new(-0.2, 0.1, 1.0), DVec3::X] {
                let plane = Plane::through(DVec3::new(0.123, 0.0456, 0.0789), normal);
                let other = Plane { normal: -plane.normal, offset: -plane.offset };
                let parts = [plane, other].map(|plane| volume(&cut(&solid, &plane, 7)).unwrap());
                assert!(parts.iter().all(|&part| part > 0.0), "{parts:?}");
                assert!((parts[0] + parts[1] - whole).abs() < 1e-9, "{parts:?} {whole}");
            }
        }
    }

    #[test]
    fn a_plane_that_misses_takes_all_or_nothing() {
        let cube = bevelled_cube(2.0, 0.1, 0);
        let above = Plane::through(DVec3::Z * 2.0, DVec3::Z);
        assert_eq!(cut(&cube, &above, 1).triangles.len(), 44);
        let below = Plane::through(DVec3::Z * -2.0, DVec3::Z);
        assert!(cut(&cube, &below, 1).positions.is_empty());
    }
}
