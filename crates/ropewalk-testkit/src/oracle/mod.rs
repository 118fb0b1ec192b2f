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
    /// How far each vertex may lie from its place, as a part of how far it and the ray's origin are from zero.
    shift: f64,
    /// By how many times the radius of a triangle its box reaches out, where boxes are those of objects' spaces.
    spread: f64,
    one_sided: bool,
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
    /// The first triangle with exactly the same vertices in the same order, mirrored or not as this one.
    shape: u32,
}

impl Oracle {
    /// For an f32 implementation of which every operation is rounded correctly, as on the CPU and on software
    /// adapters.
    #[must_use]
    pub fn new(scene: &FlatScene) -> Self {
        let mut shapes: HashMap<([[u32; 3]; 3], bool), u32> = HashMap::new();
        let mut names = Vec::with_capacity(scene.triangles.len());
        for (index, triangle) in scene.triangles.iter().enumerate() {
            let bits = [triangle.v0, triangle.v1, triangle.v2].map(|vertex| vertex.map(f32::to_bits));
            names.push(Name {
                id: (triangle.instance(), triangle.geometry(), triangle.primitive),
                mirrored: triangle.is_mirrored(),
                mask: triangle.instance_and_mask & 0xff00_0000,
                shape: *shapes.entry((bits, triangle.is_mirrored())).or_insert(index as u32),
            });
        }
        Self {
            triangles: scene.triangles.iter().map(corners).collect(),
            names,
            rounding: 1.0,
            shift: 0.0,
            spread: 0.0,
            one_sided: false,
        }
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

    /// The same for an implementation that takes rays to objects, of which the transforms make some vectors `stretch` times
    /// longer than others. A ray's direction is rounded there by a few units more, times the stretch. Since its origin is
    /// rounded, too, each vertex lies elsewhere by so many units of how far the origin and it are from zero. And a triangle's own
    /// box, in which its hit is, is that in the object's space: no corner of it is farther from its middle than √3 of the triangle's
    /// radius there.
    #[must_use]
    pub fn taking_rays(self, stretch: f64) -> Self {
        let rounding = self.rounding * 8.0 * stretch;
        Self { rounding, shift: rounding * 4.0, spread: 3f64.sqrt() * stretch, ..self }
    }

    /// The same of triangles that have one side: a hit counts only on the front, the side from which the vertices run
    /// counter-clockwise in the object's own space, and strictly: where the facing is lost in its error, the triangle may
    /// be reported, and need not be.
    #[must_use]
    pub fn one_sided(self) -> Self {
        Self { one_sided: true, ..self }
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
        let Some(mut frame) = RayFrame::new(ray, self.rounding) else { return Vec::new() };
        if self.shift > 0.0 {
            let from_zero = |point: DVec3| point.abs().max_element();
            let largest = self.triangles.iter().flatten().copied().map(from_zero).fold(0.0, f64::max);
            frame.set_shift(self.shift, from_zero(ray.origin.as_dvec3()) + largest);
            frame.spread = self.spread;
        }
        let mut candidates: Vec<Candidate> = self
            .triangles
            .iter()
            .zip(&self.names)
            .enumerate()
            .filter(|(_, (corners, name))| !frame.surely_misses(corners) && name.mask & (ray.mask << 24) != 0)
            .filter_map(|(index, (corners, name))| Candidate::new(&frame, corners, name, index as u32))
            .filter_map(|candidate| if self.one_sided { candidate.one_sided() } else { Some(candidate) })
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

impl Expectation {
    /// What is expected of the same rays where triangles have one side. It asks the oracle nothing again.
    #[must_use]
    pub fn one_sided(&self) -> Self {
        let front = |all: &Vec<Candidate>| all.iter().filter_map(|it| it.one_sided()).collect();
        Self { rays: self.rays.clone(), candidates: self.candidates.iter().map(front).collect() }
    }
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
        let (mut fronts, mut certain_fronts) = (0, 0usize);
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
                    let candidate = candidates.iter().find(|candidate| candidate.triangle == index as u32);
                    let front = triangle.intersect_front(&prepared, ray.t_max);
                    match (front, candidate.and_then(|it| it.one_sided())) {
                        (Some(hit), None) => panic!("the back {hit:?} is no candidate of {ray:?}"),
                        (None, Some(it)) => assert!(!it.is_certain(), "{ray:?} {it:?}"),
                        (None, None) => {}
                        (Some(hit), Some(it)) => {
                            fronts += 1;
                            certain_fronts += usize::from(it.is_certain());
                            assert_eq!(it.objection(&hit), None, "{ray:?} {hit:?} {it:?}");
                        }
                    }
                    let hit = triangle.intersect(&prepared, ray.t_max);
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
        let clear = format!("{certain_fronts} of {fronts} fronts are clear");
        assert!(fronts > 14_000 && fronts < hits && certain_fronts * 100 > fronts * 99, "{clear}");
    }

    /// In each of the three orders of the axes, turned either way, and mirrored.
    #[test]
    fn one_side_is_seen_from_its_front_alone() {
        for turn in 0..3 {
            let turned = |v: Vec3| Vec3::from_array(std::array::from_fn(|i| v[(i + 3 - turn) % 3]));
            let mesh = Mesh::new([Vec3::ZERO, Vec3::X, Vec3::Y].map(turned).to_vec(), vec![[0, 1, 2]]);
            for (scale, front) in [(1.0, -1.0), (-1.0, 1.0)] {
                let mut scene = Scene::default();
                let object = scene.add_object(mesh.clone());
                // Mirrored along the normal: the vertices stay where they are, the front turns round.
                let mirror = Vec3::ONE + turned(Vec3::Z) * (scale - 1.0);
                let place = ropewalk::Transform::new(glam::Affine3A::from_scale(mirror)).unwrap();
                scene.add_instance(object, place);
                let (both, one) =
                    (Oracle::of_scene(&scene).unwrap(), Oracle::of_scene(&scene).unwrap().one_sided());
                let ray = |z: f32| {
                    Ray::new(turned(Vec3::new(0.2, 0.3, -3.0 * z)), turned(Vec3::new(0.01, -0.02, z)))
                };
                let [hit] = one.candidates(&ray(front))[..] else { panic!("turn {turn}, scale {scale}") };
                assert!(hit.is_certain() && hit.front_face && hit.facing_margin > 1e4, "{hit:?}");
                assert!(one.candidates(&ray(-front)).is_empty(), "turn {turn}, scale {scale}");
                let [back] = both.candidates(&ray(-front))[..] else { panic!() };
                assert!(back.is_certain() && !back.front_face && back.facing_margin < -1e4, "{back:?}");
                // What is seen in the plane may be called either.
                let graze = Ray::new(turned(Vec3::new(-1.0, 0.25, 0.0)), turned(Vec3::X));
                assert!(one.candidates(&graze).iter().all(|it| it.facing_margin.abs() <= 1.0));
                let expected = both.expect(vec![ray(front), ray(-front), graze]).one_sided();
                let again = one.expect(expected.rays.clone());
                assert_eq!(expected.candidates, again.candidates);
            }
        }
    }

    /// A ray that sees the front almost from the side is certain as long as f32 can tell, and no longer.
    #[test]
    fn the_facing_is_lost_where_f32_loses_it() {
        let oracle =
            oracle(&[[Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.3, 0.4, 0.9), Vec3::new(0.2, 1.7, 0.6)]])
                .one_sided();
        let corners = oracle.triangles[0];
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let along = (corners[1] - corners[0]).normalize();
        let certain = |slope: f64| {
            let dir = along - normal * slope;
            let ray = Ray::new((middle - dir * 2.0).as_vec3(), dir.as_vec3());
            oracle.candidates(&ray).first().map(|candidate| candidate.facing_margin > 1.0)
        };
        assert_eq!((certain(1e-3), certain(-1e-3)), (Some(true), None));
        assert_ne!(certain(1e-8), Some(true));
        assert_ne!(certain(-1e-8), Some(true));
    }

    #[test]
    fn the_same_vertices_are_the_same_shape() {
        let found = oracle(&[UNIT, UNIT, [Vec3::X, Vec3::Y, Vec3::ZERO]])
            .candidates(&Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z));
        let shapes: Vec<u32> = found.iter().map(|candidate| candidate.shape).collect();
        assert_eq!(shapes, [0, 0, 2]);
    }
}
