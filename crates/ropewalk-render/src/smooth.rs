//! Shading normals for meshes that come without.
//!
//! At each corner of each triangle: the mean of the normals of the faces that meet there and lie within the
//! crease angle of the corner's own face, weighted by their angles at the vertex (Thürmer and Wüthrich 1998), so
//! that it does not matter how a flat face is cut into triangles. Vertices at the same place count as one:
//! STL knows no others. Time grows with the corners times the faces that meet at one, which are capped.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use ropewalk::Mesh;
use ropewalk_scene::CornerAttribute;

/// Where more faces meet than this, as at the tip of a finely cut cone, each keeps its own normal: right for a
/// tip, and no mesh can make the work grow with its square.
const MOST_FACES: usize = 64;

/// Normals for the corners of every triangle; zero where a triangle has none.
pub(crate) fn corner_normals(mesh: &Mesh, crease: f32) -> CornerAttribute<Vec3> {
    let faces: Vec<Face> =
        mesh.triangles.par_iter().enumerate().map(|(index, _)| Face::of(mesh, index)).collect();
    let places = weld(&mesh.positions);
    let meeting = Meeting::of(mesh, &places);
    // Rounded down a little, so that exactly the crease angle still counts as smooth.
    let limit = f64::from(crease).cos() as f32 - 1e-5;
    let values: Vec<Vec3> = mesh
        .triangles
        .par_iter()
        .enumerate()
        .flat_map_iter(|(triangle, vertices)| {
            let own = faces[triangle].normal;
            let (faces, places, meeting) = (&faces, &places, &meeting);
            vertices.iter().map(move |&vertex| {
                let Some(&place) = places.get(vertex as usize) else { return own };
                let corners = meeting.at(place);
                if corners.len() > MOST_FACES {
                    return own;
                }
                let sum: Vec3 = corners
                    .iter()
                    .map(|&corner| (&faces[corner as usize / 3], corner as usize % 3))
                    .filter(|(face, _)| face.normal.dot(own) >= limit)
                    .map(|(face, corner)| face.normal * face.angles[corner])
                    .sum();
                sum.try_normalize().unwrap_or(own)
            })
        })
        .collect();
    let indices =
        (0..mesh.triangles.len() as u32).map(|triangle| [0, 1, 2].map(|corner| 3 * triangle + corner));
    CornerAttribute { values, indices: Some(indices.collect()) }
}

/// What a face gives to its corners.
struct Face {
    /// Of unit length, or zero.
    normal: Vec3,
    /// In radians.
    angles: [f32; 3],
}

impl Face {
    fn of(mesh: &Mesh, index: usize) -> Self {
        let none = Self { normal: Vec3::ZERO, angles: [0.0; 3] };
        let Some(triangle) = mesh.triangle(index) else { return none };
        let [a, b, c] = triangle.vertices.map(Vec3::as_dvec3);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return none };
        let angle = |at: DVec3, one: DVec3, other: DVec3| {
            let cos = (one - at).normalize_or_zero().dot((other - at).normalize_or_zero());
            cos.clamp(-1.0, 1.0).acos() as f32
        };
        Self { normal: normal.as_vec3(), angles: [angle(a, b, c), angle(b, c, a), angle(c, a, b)] }
    }
}

/// For each vertex, the number of its place; vertices at the same place share one.
fn weld(positions: &[Vec3]) -> Vec<u32> {
    // Adding zero makes the two zeros one.
    let key = |vertex: u32| (positions[vertex as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|&vertex| (key(vertex), vertex));
    let mut places = vec![0; positions.len()];
    let mut place = 0;
    for (rank, &vertex) in order.iter().enumerate() {
        if rank > 0 && key(vertex) != key(order[rank - 1]) {
            place += 1;
        }
        places[vertex as usize] = place;
    }
    places
}

/// The corners, three a triangle, that meet at each place.
struct Meeting {
    offsets: Vec<u32>,
    corners: Vec<u32>,
}

impl Meeting {
    fn of(mesh: &Mesh, places: &[u32]) -> Self {
        let mut offsets = vec![0_u32; places.len() + 1];
        let place_of = |vertex: &u32| places.get(*vertex as usize).map(|&place| place as usize);
        for place in mesh.triangles.iter().flatten().filter_map(place_of) {
            offsets[place + 1] += 1;
        }
        for place in 0..places.len() {
            offsets[place + 1] += offsets[place];
        }
        let mut next = offsets.clone();
        let mut corners = vec![0; offsets.last().map_or(0, |&count| count as usize)];
        for (corner, vertex) in mesh.triangles.iter().flatten().enumerate() {
            if let Some(place) = place_of(vertex) {
                corners[next[place] as usize] = corner as u32;
                next[place] += 1;
            }
        }
        Self { offsets, corners }
    }

    fn at(&self, place: u32) -> &[u32] {
        let place = place as usize;
        &self.corners[self.offsets[place] as usize..self.offsets[place + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two unit squares that meet along the y axis at an angle.
    fn fold(radians: f32) -> Mesh {
        let (sin, cos) = radians.sin_cos();
        let points = vec![
            Vec3::new(-1.0, 0.0, 0.0),
            Vec3::ZERO,
            Vec3::Y,
            Vec3::new(-1.0, 1.0, 0.0),
            Vec3::new(cos, 0.0, sin),
            Vec3::new(cos, 1.0, sin),
            // The edge again, as formats without shared vertices write it; one zero is negative.
            Vec3::new(-0.0, 0.0, 0.0),
            Vec3::Y,
        ];
        Mesh::new(points, vec![[0, 1, 2], [0, 2, 3], [6, 4, 5], [6, 5, 7]])
    }

    fn corners(mesh: &Mesh, crease: f32, triangle: usize) -> [Vec3; 3] {
        corner_normals(mesh, crease).corners(triangle, mesh.triangles[triangle]).unwrap()
    }

    #[test]
    fn a_bend_is_round_and_a_crease_is_sharp() {
        let bend = fold(0.5);
        let [flat, edge, _] = corners(&bend, 0.6, 0);
        assert!(flat.distance(Vec3::Z) < 1e-6);
        let middle = Vec3::new(-0.25_f32.sin(), 0.0, 0.25_f32.cos());
        assert!(edge.distance(middle) < 1e-5, "{edge} is not half-way");
        assert!(corners(&bend, 0.6, 2)[0].distance(middle) < 1e-5, "both sides agree");
        assert!(corners(&bend, 0.4, 0)[1].distance(Vec3::Z) < 1e-6, "a sharper bend than the crease stays");
    }

    #[test]
    fn bad_triangles_do_no_harm() {
        let mut mesh = fold(0.5);
        mesh.positions.push(Vec3::NAN);
        mesh.triangles.extend([[0, 1, 8], [1, 1, 2], [0, 1, 400]]);
        let normals = corner_normals(&mesh, 0.6);
        assert!(normals.values.iter().all(|normal| normal.is_finite()));
        assert!(normals.values[1].length() > 0.99);
        assert_eq!(normals.values[3 * 5], Vec3::ZERO, "no face, no normal");
        assert!(corner_normals(&Mesh::default(), 0.6).values.is_empty());
    }

    #[test]
    fn a_vertex_where_all_faces_meet_takes_no_square_time() {
        let count = 200_000;
        let mut points = vec![Vec3::Z];
        points.extend((0..count).map(|index| {
            let (sin, cos) = (index as f32 / count as f32 * std::f32::consts::TAU).sin_cos();
            Vec3::new(cos, sin, 0.0)
        }));
        let triangles = (1..count).map(|index| [0, index, index + 1]).collect();
        let normals = corner_normals(&Mesh::new(points, triangles), 0.6);
        assert_eq!(normals.values.len(), 3 * (count as usize - 1));
    }
}
