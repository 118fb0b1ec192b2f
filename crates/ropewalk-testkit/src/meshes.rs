//! Procedural meshes.

use crate::random::Random;
use glam::{DVec3, Vec3};
use ropewalk::Mesh;
use std::collections::HashMap;

/// A closed sphere of radius 1: an icosahedron whose triangles are cut in four `subdivisions` times,
/// `20 * 4^n` triangles, wound outwards.
#[must_use]
pub fn icosphere(subdivisions: u32) -> Mesh {
    let golden = f64::midpoint(1.0, 5f64.sqrt());
    let mut points: Vec<DVec3> = Vec::new();
    for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        points.push(DVec3::new(a, b, 0.0));
    }
    for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        points.push(DVec3::new(0.0, a, b));
    }
    for (a, b) in [(golden, -1.0), (golden, 1.0), (-golden, -1.0), (-golden, 1.0)] {
        points.push(DVec3::new(a, 0.0, b));
    }
    points.iter_mut().for_each(|point| *point = point.normalize());
    let mut triangles = hull(&points);
    for _ in 0..subdivisions {
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                (points.len() - 1) as u32
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    Mesh::new(points.iter().map(|point| point.as_vec3()).collect(), triangles)
}

/// The faces of a solid whose corners lie on a sphere about zero: every triple with all others on one side.
fn hull(points: &[DVec3]) -> Vec<[u32; 3]> {
    let mut faces = Vec::new();
    for a in 0..points.len() {
        for b in a + 1..points.len() {
            for c in b + 1..points.len() {
                let normal = (points[b] - points[a]).cross(points[c] - points[a]);
                let is_behind = |point: &DVec3| (*point - points[a]).dot(normal);
                if points.iter().all(|point| is_behind(point) < 1e-9) {
                    faces.push([a as u32, b as u32, c as u32]);
                } else if points.iter().all(|point| is_behind(point) > -1e-9) {
                    faces.push([a as u32, c as u32, b as u32]);
                }
            }
        }
    }
    faces
}

/// Random triangles about `size` large in the box `[-1, 1]^3`.
#[must_use]
pub fn soup(triangles: u32, size: f64, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let mut mesh = Mesh::default();
    for _ in 0..triangles {
        let center = random.in_cube();
        push(&mut mesh, [(); 3].map(|()| center + random.in_cube() * size));
    }
    mesh
}

/// A flat grid of `cells` x `cells` squares, two triangles each, in the plane `axis = height`, from 0 to `cells`
/// times `step` along the two other axes.
#[must_use]
pub fn grid(axis: usize, height: f64, cells: u32, step: f64) -> Mesh {
    let point = |i: u32, j: u32| {
        let mut point = DVec3::ZERO;
        point[axis] = height;
        point[(axis + 1) % 3] = f64::from(i) * step;
        point[(axis + 2) % 3] = f64::from(j) * step;
        point.as_vec3()
    };
    let positions = (0..=cells).flat_map(|j| (0..=cells).map(move |i| point(i, j))).collect();
    let corner = |i: u32, j: u32| j * (cells + 1) + i;
    let triangles = (0..cells)
        .flat_map(|j| (0..cells).map(move |i| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Mesh::new(positions, triangles)
}

/// A closed box, twelve triangles, wound outwards.
#[must_use]
pub fn cuboid(low: Vec3, high: Vec3) -> Mesh {
    let corner = |index: u32| {
        let pick = |axis: u32| if index >> axis & 1 == 0 { low[axis as usize] } else { high[axis as usize] };
        Vec3::new(pick(0), pick(1), pick(2))
    };
    let sides: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new((0..8).map(corner).collect(), triangles)
}

/// Triangles around one vertex: `blades` of them, the rim on a wavy circle, closed all round.
#[must_use]
pub fn fan(blades: u32, wave: f64) -> Mesh {
    let mut positions = vec![Vec3::ZERO];
    // The rim follows a square, which needs no sine.
    let rim = |index: u32| {
        let along = f64::from(index) * 8.0 / f64::from(blades);
        let offset = |shift: f64| {
            let place = (along + shift) % 8.0;
            if place < 4.0 { (place - 2.0).clamp(-1.0, 1.0) } else { (6.0 - place).clamp(-1.0, 1.0) }
        };
        let height = if index.is_multiple_of(2) { wave } else { -wave };
        DVec3::new(offset(0.0), offset(2.0), height).as_vec3()
    };
    positions.extend((0..blades).map(rim));
    Mesh::new(positions, (0..blades).map(|i| [0, i + 1, (i + 1) % blades + 1]).collect())
}

/// Adds a triangle with vertices of its own.
pub fn push(mesh: &mut Mesh, corners: [DVec3; 3]) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners.map(DVec3::as_vec3));
    mesh.triangles.push([first, first + 1, first + 2]);
}

/// Adds the triangles of another mesh.
pub fn append(mesh: &mut Mesh, other: &Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&other.positions);
    mesh.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|index| index + first)));
}

/// The same mesh with every vertex mapped.
#[must_use]
pub fn mapped(mut mesh: Mesh, map: impl Fn(DVec3) -> DVec3) -> Mesh {
    mesh.positions.iter_mut().for_each(|position| *position = map(position.as_dvec3()).as_vec3());
    mesh
}

/// Whether every edge is used once in each direction: no hole, no flipped neighbour.
#[must_use]
pub fn is_closed(mesh: &Mesh) -> bool {
    let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *edges.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    edges.values().all(|&balance| balance == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(mesh: &Mesh) -> f64 {
        let corner = |index: u32| mesh.positions[index as usize].as_dvec3();
        mesh.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c))) / 6.0).sum()
    }

    #[test]
    fn the_sphere_is_closed_and_wound_outwards() {
        let sphere = icosphere(3);
        assert_eq!((sphere.triangles.len(), sphere.positions.len()), (1280, 642));
        assert!(is_closed(&sphere));
        assert!((4.0..4.19).contains(&volume(&sphere)), "{}", volume(&sphere));
        let mut open = sphere;
        open.triangles.pop();
        assert!(!is_closed(&open));
    }

    #[test]
    fn the_box_is_closed_and_wound_outwards() {
        let cuboid = cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0));
        assert!(is_closed(&cuboid));
        assert!((volume(&cuboid) - 6.0).abs() < 1e-9);
    }

    #[test]
    fn a_grid_lies_in_its_plane_and_a_fan_goes_all_round() {
        let grid = grid(1, 0.7, 4, 0.5);
        assert_eq!(grid.triangles.len(), 32);
        assert!(grid.positions.iter().all(|position| position.y == 0.7));
        assert_eq!(grid.bounds().max, Vec3::new(2.0, 0.7, 2.0));
        let fan = fan(64, 0.0);
        let area: f32 = (0..64).map(|i| fan.triangle(i).unwrap().normal().z * 0.5).sum();
        assert!((area.abs() - 4.0).abs() < 1e-5, "the blades cover the square once: {area}");
    }
}
