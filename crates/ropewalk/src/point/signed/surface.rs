//! How the triangles of a closed surface are connected, and the pseudonormals of its features.
//!
//! About 76 bytes a triangle.
//!
//! **Triangles of three points on a line** have no normal, but may be what closes the surface: where a vertex `m` lies
//! in the middle of a neighbour's edge `ab`, the triangle `a m b` joins that edge to the two edges on the other side.
//! They are looked through: what is beyond them is found by stepping from edge to edge on the line, and at `m` the
//! face at `ab` counts with its half turn.

use super::connect::{connect, number, weld};
use super::{Feature, SurfaceError};
use crate::bvh::Bvh;
use crate::point::foot::WideFoot;
use crate::{Aabb, FlatTriangle};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// A closed surface. A triangle of it is known by its number, in the order of ids.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    /// The number of the triangle at each place of the leaves: with spatial splits one may have several places.
    numbers: Vec<u32>,
    /// The vertices of each triangle, counter-clockwise from outside.
    corners: Vec<[u32; 3]>,
    /// What lies beyond the edge from a corner to the next one.
    neighbours: Vec<[u32; 3]>,
    /// Unit normals; zero for a triangle without area.
    normals: Vec<DVec3>,
    positions: Vec<DVec3>,
    vertex_normals: Vec<DVec3>,
    pub(super) volume: f64,
}

/// The vertices, counter-clockwise seen from outside. An instance that mirrors has turned them over.
#[inline(always)]
pub(super) fn outward(triangle: &FlatTriangle) -> [DVec3; 3] {
    let [a, b, c] = triangle.triangle().vertices.map(Vec3::as_dvec3);
    if triangle.is_mirrored() { [a, c, b] } else { [a, b, c] }
}

/// What a step across an edge comes to.
enum Beyond {
    /// A face with this normal.
    Face(DVec3),
    /// The point lies on a vertex of the other side.
    Vertex(u32),
}

impl Surface {
    pub(super) fn new(bvh: &Bvh) -> Result<Self, SurfaceError> {
        let references = bvh.triangles();
        let (numbers, firsts) = number(references);
        let triangles: Vec<[DVec3; 3]> = firsts.iter().map(|&first| outward(&references[first])).collect();
        let (corners, positions) = weld(&triangles);
        let neighbours = connect(&corners, &positions)
            .map_err(|error| SurfaceError { left_out: bvh.report().input.skipped(), ..error })?;
        let normal = |[a, b, c]: &[DVec3; 3]| (b - a).cross(c - a).normalize_or_zero();
        let volume = volume(&triangles, &bvh.bounds());
        let normals = triangles.iter().map(normal).collect();
        let vertex_normals = vec![DVec3::ZERO; positions.len()];
        let mut surface = Self { numbers, corners, neighbours, normals, positions, vertex_normals, volume };
        surface.vertex_normals = surface.sum_vertex_normals();
        Ok(surface)
    }

    /// Whether the triangle at a place of the leaves has a normal.
    pub(super) fn has_area(&self, reference: usize) -> bool {
        self.normals[self.numbers[reference] as usize] != DVec3::ZERO
    }

    /// Whether the id at one place of the leaves is smaller than that at another.
    pub(super) fn precedes(&self, reference: usize, other: usize) -> bool {
        self.numbers[reference] < self.numbers[other]
    }

    /// The feature of the triangle at a place of the leaves in which a foot at `position` lies, and its pseudonormal,
    /// not of unit length.
    pub(super) fn pseudonormal(
        &self,
        reference: usize,
        foot: &WideFoot,
        position: DVec3,
    ) -> (Feature, DVec3) {
        let triangle = self.numbers[reference] as usize;
        let edge = match foot.along {
            [0.0, 0.0] => {
                let vertex = self.corners[triangle][foot.vertex];
                return (Feature::Vertex, self.vertex_normals[vertex as usize]);
            }
            [_, 0.0] => foot.vertex,
            [0.0, _] => (foot.vertex + 2) % 3,
            _ => return (Feature::Face, self.normals[triangle]),
        };
        match self.beyond(triangle, edge, position) {
            Beyond::Face(normal) => (Feature::Edge, self.normals[triangle] + normal),
            Beyond::Vertex(vertex) => (Feature::Vertex, self.vertex_normals[vertex as usize]),
        }
    }

    /// What lies beyond an edge at a position in it. Triangles without area are stepped through.
    fn beyond(&self, triangle: usize, edge: usize, position: DVec3) -> Beyond {
        let (mut at, mut edge) = (triangle, edge);
        for _ in 0..MOST_STEPS {
            let next = self.neighbours[at][edge] as usize;
            if next >= self.normals.len() {
                break;
            }
            if self.normals[next] != DVec3::ZERO {
                return Beyond::Face(self.normals[next]);
            }
            let longest = self.longest_edge(next);
            let came_over_longest = self.corners[next][longest] == self.corners[at][(edge + 1) % 3]
                && self.corners[next][(longest + 1) % 3] == self.corners[at][edge];
            edge = longest;
            if came_over_longest {
                // Which of the two short edges lies opposite?
                let [from, to, middle] = self.positions_from(next, longest);
                let way = to - from;
                let (here, there) = ((position - from).dot(way), (middle - from).dot(way));
                if (here - there).abs() <= SAME_PLACE * way.dot(way) {
                    return Beyond::Vertex(self.corners[next][(longest + 2) % 3]);
                }
                edge = (longest + if here > there { 1 } else { 2 }) % 3;
            }
            at = next;
        }
        Beyond::Face(DVec3::ZERO)
    }

    /// The edge of a triangle that is not shorter than the others.
    fn longest_edge(&self, triangle: usize) -> usize {
        let [a, b, c] = self.positions_from(triangle, 0);
        let [ab, bc, ca] = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
        if ab >= bc && ab >= ca {
            0
        } else if bc >= ca {
            1
        } else {
            2
        }
    }

    /// The vertices of a triangle from one of them on.
    fn positions_from(&self, triangle: usize, first: usize) -> [DVec3; 3] {
        [0, 1, 2].map(|step| self.positions[self.corners[triangle][(first + step) % 3] as usize])
    }

    /// The normals around each vertex, each weighted by its triangle's angle there.
    fn sum_vertex_normals(&self) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for (triangle, &normal) in self.normals.iter().enumerate() {
            if normal == DVec3::ZERO {
                let longest = self.longest_edge(triangle);
                let [_, _, middle] = self.positions_from(triangle, longest);
                if let Beyond::Face(normal) = self.beyond(triangle, longest, middle) {
                    sums[self.corners[triangle][(longest + 2) % 3] as usize] += normal * PI;
                }
                continue;
            }
            for corner in 0..3 {
                let [here, next, last] = self.positions_from(triangle, corner);
                let (one, other) = (next - here, last - here);
                let angle = one.cross(other).length().atan2(one.dot(other));
                sums[self.corners[triangle][corner] as usize] += normal * angle;
            }
        }
        sums
    }
}

/// More steps through triangles on one line than any sensible surface has.
const MOST_STEPS: usize = 1000;

/// Two positions in an edge are one when they are nearer than this part of it: some thousand times what f64 rounds.
const SAME_PLACE: f64 = 1e-12;

/// The volume that triangles enclose: the sum of the tetrahedra between them and the middle of the box.
fn volume(triangles: &[[DVec3; 3]], bounds: &Aabb) -> f64 {
    if bounds.is_empty() {
        return 0.0;
    }
    let middle = bounds.center().as_dvec3();
    let tetrahedron = |triangle: &[DVec3; 3]| {
        let [a, b, c] = triangle.map(|vertex| vertex - middle);
        a.dot(b.cross(c)) / 6.0
    };
    triangles.iter().map(tetrahedron).sum()
}

#[cfg(test)]
mod tests {
    use super::super::super::{Feature, SignedDistance};
    use super::*;
    use crate::{BuildOptions, Mesh, Scene};

    fn corners() -> Vec<Vec3> {
        vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]
    }

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    #[test]
    fn vertices_are_one_by_their_position() {
        let positions: Vec<Vec3> = TETRAHEDRON
            .iter()
            .flatten()
            .map(|&index| corners()[index as usize] * Vec3::new(1.0, -1.0, 1.0))
            .collect();
        // Mirrored by hand, so the other way round; -0 where 0 was.
        let triangles = (0..4).map(|index| [3 * index, 3 * index + 2, 3 * index + 1]).collect();
        let bvh = Scene::from_mesh(Mesh::new(positions, triangles)).build(&BuildOptions::default()).unwrap();
        let solid = SignedDistance::new(&bvh).unwrap();
        assert!((solid.volume() - 1.0 / 6.0).abs() < 1e-12);
        assert!(solid.contains(Vec3::new(0.1, -0.1, 0.1)) && !solid.contains(Vec3::new(0.1, 0.1, 0.1)));
    }

    /// A sharp roof of which one side is in two halves that meet the other side's ridge at `m`, where a triangle
    /// without area closes the gap. Near the ridge the nearest face alone would give wrong signs.
    #[test]
    fn a_triangle_without_area_is_looked_through() {
        // Ridge a b, its middle m; the feet c on one side, d on the other; the ends and the floor close it.
        let (a, b, m) = (Vec3::new(0.0, 0.0, 4.0), Vec3::new(2.0, 0.0, 4.0), Vec3::new(1.0, 0.0, 4.0));
        let (c, d) = (Vec3::new(1.0, -0.25, 0.0), Vec3::new(1.0, 0.25, 0.0));
        let positions = vec![a, b, m, c, d];
        let triangles = vec![[0, 3, 1], [0, 2, 4], [2, 1, 4], [0, 1, 2], [0, 4, 3], [1, 3, 4]];
        let bvh = Scene::from_mesh(Mesh::new(positions, triangles)).build(&BuildOptions::default()).unwrap();
        assert_eq!(bvh.report().input.collinear, 1);
        let solid = SignedDistance::new(&bvh).unwrap();
        assert!(solid.volume() > 0.0);
        for x in [0.1f32, 0.5, 0.999, 1.0, 1.001, 1.7] {
            for y in [-0.02f32, -0.01, 0.0, 0.01, 0.02] {
                let above = solid.closest(Vec3::new(x, y, 4.5)).unwrap();
                assert!(above.signed_distance > 0.0 && above.feature != Feature::Face, "{x} {y}: {above:?}");
                assert!((above.signed_distance - 0.5f32.hypot(y)).abs() < 1e-6);
            }
            let reach = 0.25 * (1.0 - (x - 1.0).abs());
            assert!(solid.contains(Vec3::new(x, 0.0, 4.0 - 0.01 * reach)), "{x}");
        }
        assert!(solid.contains(m) && solid.distance(m) == 0.0, "the surface belongs to the inside");
    }
}
