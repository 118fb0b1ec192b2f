//! The oracle: every triangle against a ray in f64, with no structure and nothing left out.
//!
//! An answer in f32 cannot be held to the last bit of one in f64. So the oracle tells, for each triangle that a
//! ray meets or almost meets, what a right f32 implementation may say: whether it **must** report the triangle,
//! whether it **may**, and between which two values of `t`. The bounds are not tuned: they are the forward error
//! bounds of the computation (see [`Candidate`]), so an answer outside of them is wrong for certain.
//!
//! Cost: about 30 nanoseconds a ray and triangle (measured on one thread of a server core, 10,000 random rays at
//! 10,000 triangles); rays are spread over the threads of the caller's pool.

mod candidate;
mod frame;

pub use candidate::Candidate;

use frame::RayFrame;
use glam::DVec3;
use rayon::prelude::*;
use ropewalk::{FlatScene, FlatTriangle, Ray, Scene, SceneError};
use std::collections::HashMap;

/// The triangles of a scene in f64.
#[derive(Clone, Debug)]
pub struct Oracle {
    triangles: Vec<Corners>,
    names: Vec<Name>,
    rounding: f64,
}

/// The vertices of a triangle.
type Corners = [DVec3; 3];

/// Who a triangle is.
#[derive(Clone, Copy, Debug)]
struct Name {
    id: (u32, u32, u32),
    mirrored: bool,
    /// In the top 8 bits, as in [`FlatTriangle`].
    mask: u32,
    /// The first triangle with exactly the same vertices in the same order.
    shape: u32,
}

impl Oracle {
    /// For an f32 implementation of which every operation is rounded correctly, as on the CPU and on software
    /// adapters.
    #[must_use]
    pub fn new(scene: &FlatScene) -> Self {
        let mut shapes: HashMap<[[u32; 3]; 3], u32> = HashMap::new();
        let mut names = Vec::with_capacity(scene.triangles.len());
        for (index, triangle) in scene.triangles.iter().enumerate() {
            let bits = [triangle.v0, triangle.v1, triangle.v2].map(|vertex| vertex.map(f32::to_bits));
            names.push(Name {
                id: (triangle.instance(), triangle.geometry(), triangle.primitive),
                mirrored: triangle.is_mirrored(),
                mask: triangle.instance_and_mask & 0xff00_0000,
                shape: *shapes.entry(bits).or_insert(index as u32),
            });
        }
        Self { triangles: scene.triangles.iter().map(corners).collect(), names, rounding: 1.0 }
    }

    /// The oracle of a scene's triangles.
    ///
    /// # Errors
    /// When the scene cannot be flattened.
    pub fn of_scene(scene: &Scene) -> Result<Self, SceneError> {
        Ok(Self::new(&scene.flatten()?))
    }

    /// The same with all error bounds multiplied. Real GPUs divide with an error of 2.5 units in the last place
    /// where correct rounding has 0.5, and flush or fuse as they like: [`Oracle::RELAXED`] covers that.
    #[must_use]
    pub fn with_rounding(self, rounding: f64) -> Self {
        Self { rounding, ..self }
    }

    /// The factor for [`Oracle::with_rounding`] on real GPUs.
    pub const RELAXED: f64 = 5.0;

    /// The number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Every triangle that a ray hits or may be said to hit within its window, nearest first. None for a ray
    /// that is not valid.
    #[must_use]
    pub fn candidates(&self, ray: &Ray) -> Vec<Candidate> {
        let Some(frame) = RayFrame::new(ray, self.rounding) else { return Vec::new() };
        let mut candidates: Vec<Candidate> = self
            .triangles
            .iter()
            .zip(&self.names)
            .enumerate()
            .filter(|(_, (corners, name))| !frame.surely_misses(corners) && name.mask & (ray.mask << 24) != 0)
            .filter_map(|(index, (corners, name))| Candidate::new(&frame, corners, name, index as u32))
            .collect();
        candidates.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)));
        candidates
    }

    /// The candidates of many rays, spread over threads.
    #[must_use]
    pub fn expect(&self, rays: Vec<Ray>) -> Expectation {
        let candidates = rays.par_iter().with_min_len(16).map(|ray| self.candidates(ray)).collect();
        Expectation { rays, candidates }
    }
}

fn corners(triangle: &FlatTriangle) -> Corners {
    [triangle.v0, triangle.v1, triangle.v2].map(|vertex| DVec3::from_array(vertex.map(f64::from)))
}

/// Rays, and what the oracle says of each.
#[derive(Clone, Debug, Default)]
pub struct Expectation {
    /// The rays.
    pub rays: Vec<Ray>,
    /// Their candidates, nearest first.
    pub candidates: Vec<Vec<Candidate>>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshes;
    use crate::random::Random;
    use glam::Vec3;
    use ropewalk::{Aabb, Mesh};

    fn oracle(triangles: &[[Vec3; 3]]) -> Oracle {
        let positions = triangles.iter().flatten().copied().collect();
        let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Oracle::of_scene(&Scene::from_mesh(Mesh::new(positions, indices))).unwrap()
    }

    const UNIT: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    #[test]
    fn a_plain_hit_is_certain_and_exact() {
        let ray = Ray::new(Vec3::new(0.25, 0.5, 4.0), Vec3::new(0.0, 0.0, -2.0));
        let found = oracle(&[UNIT]).candidates(&ray);
        let [hit] = found.as_slice() else { panic!("{found:?}") };
        assert!(hit.is_certain(), "{hit:?}");
        assert_eq!((hit.t, hit.barycentrics.x, hit.barycentrics.y), (2.0, 0.25, 0.5));
        assert!(hit.front_face && hit.edge_margin > 1e4);
        assert!(hit.t_low <= 2.0 && hit.t_high >= 2.0 && hit.t_high - hit.t_low < 1e-5, "{hit:?}");
    }

    #[test]
    fn edges_vertices_and_grazes_are_candidates_but_not_certain() {
        let oracle = oracle(&[UNIT]);
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.0), (0.5, 0.5), (0.5, 0.500_000_06)] {
            let found = oracle.candidates(&Ray::new(Vec3::new(x, y, 3.0), -Vec3::Z));
            assert!(found.len() == 1 && !found[0].is_certain(), "{x} {y} {found:?}");
        }
        let graze = oracle.candidates(&Ray::new(Vec3::new(-1.0, 0.25, 0.0), Vec3::X));
        assert!(graze.len() == 1 && !graze[0].is_certain(), "{graze:?}");
        // In the plane anything along the triangle may be reported, and nothing beyond it.
        assert!(graze[0].t_low >= 0.999 && graze[0].t_high <= 2.001, "{graze:?}");
    }

    #[test]
    fn what_is_plainly_missed_is_no_candidate() {
        let oracle = oracle(&[UNIT]);
        for (origin, dir) in [
            (Vec3::new(0.6, 0.6, 3.0), -Vec3::Z),
            (Vec3::new(-1e-5, 0.5, 3.0), -Vec3::Z),
            (Vec3::new(0.2, 0.2, 3.0), Vec3::Z),
            (Vec3::new(-1.0, 0.25, 0.01), Vec3::X),
            // In the plane, but beside the triangle's box.
            (Vec3::new(-1.0, 2.0, 0.0), Vec3::X),
            (Vec3::new(-1.0, 2.0, 0.0), Vec3::new(1.0, -0.3, 0.0)),
        ] {
            assert!(oracle.candidates(&Ray::new(origin, dir)).is_empty(), "{origin} {dir}");
        }
        let ray = Ray::new(Vec3::new(0.2, 0.2, 3.0), -Vec3::Z);
        assert!(oracle.candidates(&ray.window(0.0, 2.9)).is_empty());
        assert!(oracle.candidates(&ray.window(3.1, 9.0)).is_empty());
        assert!(oracle.candidates(&ray.window(4.0, 1.0)).is_empty());
        assert!(oracle.candidates(&ray.with_mask(0)).is_empty());
        assert!(oracle.candidates(&Ray::new(Vec3::ONE, Vec3::ZERO)).is_empty());
    }

    #[test]
    fn the_ends_of_the_window_are_uncertain() {
        let ray = Ray::new(Vec3::new(0.2, 0.2, 3.0), -Vec3::Z);
        for (t_min, t_max, certain) in [(0.0, 3.0, false), (3.0, 9.0, false), (2.9, 3.1, true)] {
            let found = oracle(&[UNIT]).candidates(&ray.window(t_min, t_max));
            assert_eq!(found.iter().map(Candidate::is_certain).collect::<Vec<_>>(), [certain]);
        }
    }

    /// The bounds must hold for the f32 test itself: it is fed hits of all sizes and must stay inside of them,
    /// and they must be tight enough to mean something.
    #[test]
    fn the_f32_triangle_test_stays_within_the_bounds() {
        let mut random = Random::new(77);
        let (mut hits, mut certain) = (0, 0usize);
        for round in 0..40 {
            let scale = 10f32.powi(round % 9 - 4);
            let offset = Vec3::splat(if round % 3 == 0 { 1000.0 * scale } else { 0.0 });
            let mut mesh = meshes::soup(200, 0.8, u64::from(round.unsigned_abs()));
            mesh.positions.iter_mut().for_each(|position| *position = *position * scale + offset);
            let scene = Scene::from_mesh(mesh);
            let (flat, bounds) = (scene.flatten().unwrap(), scene.bounds());
            let oracle = Oracle::new(&flat);
            for _ in 0..1000 {
                let origin = random.in_box(&Aabb::new(bounds.min, bounds.max), 1.5).as_vec3();
                let ray = Ray::new(origin, random.direction().as_vec3() * 3.0);
                let candidates = oracle.candidates(&ray);
                let prepared = ropewalk::PreparedRay::new(&ray).unwrap();
                for (index, triangle) in flat.triangles.iter().enumerate() {
                    let hit = triangle.intersect(&prepared, ray.t_max);
                    let candidate = candidates.iter().find(|candidate| candidate.triangle == index as u32);
                    match (hit, candidate) {
                        (Some(hit), None) => panic!("{hit:?} is no candidate of {ray:?}"),
                        (None, Some(candidate)) => assert!(!candidate.is_certain(), "{ray:?} {candidate:?}"),
                        (None, None) => {}
                        (Some(hit), Some(candidate)) => {
                            hits += 1;
                            certain += usize::from(candidate.is_certain());
                            assert_eq!(candidate.objection(&hit), None, "{ray:?} {hit:?} {candidate:?}");
                        }
                    }
                }
            }
        }
        assert!(hits > 30_000 && certain * 100 > hits * 99, "{certain} of {hits} are clear");
    }

    #[test]
    fn the_same_vertices_are_the_same_shape() {
        let found = oracle(&[UNIT, UNIT, [Vec3::X, Vec3::Y, Vec3::ZERO]])
            .candidates(&Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z));
        let shapes: Vec<u32> = found.iter().map(|candidate| candidate.shape).collect();
        assert_eq!(shapes, [0, 0, 2]);
    }
}
