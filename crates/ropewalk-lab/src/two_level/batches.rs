//! The rays of a class, the pixel of each, and the answers that every setting must give.

use super::Sight;
use glam::DVec3;
use ropewalk::{
    Aabb, Answer, BuildOptions, FlatTriangle, Hit, Query, Ray, Scene, Structure, TraceOptions, Traced, Walk,
};
use ropewalk_gpu::GpuError;
use ropewalk_testkit::random::Random;
use ropewalk_testkit::rays::RayClass;

use crate::comparison::ComparisonError;

/// How far rays that leave a surface are moved off it, as a part of the scene's largest coordinate: far more than it takes not to
/// meet the surface again, in any object's frame, and too little to be seen.
const OFF: f64 = 2e-5;

/// What is traced.
pub(super) const CLASSES: [RayClass; 3] = [RayClass::Primary, RayClass::Shadow, RayClass::DiffuseBounce];

/// The rays of a class.
#[derive(Clone, Debug)]
pub(super) struct Batch {
    pub(super) class: RayClass,
    pub(super) rays: Vec<Ray>,
    /// The pixel that each belongs to.
    pub(super) pixels: Vec<u32>,
    /// What the BVH over the flattened scene answers.
    pub(super) expected: Traced,
}

impl Batch {
    pub(super) fn query(&self) -> Query {
        self.class.query()
    }
}

/// The flattened scene, and one BVH over it.
#[derive(Clone, Debug)]
pub(super) struct Flat {
    pub(super) triangles: Vec<FlatTriangle>,
    tree: Structure,
}

impl Flat {
    pub(super) fn new(scene: &Scene, triangles: Vec<FlatTriangle>) -> Result<Self, ComparisonError> {
        Ok(Self { triangles, tree: Structure::Bvh(scene.build(&BuildOptions::default())?) })
    }

    /// The triangle of a hit.
    pub(super) fn triangle(&self, hit: &Hit) -> Option<&FlatTriangle> {
        let id = |triangle: &FlatTriangle| (triangle.instance(), triangle.geometry(), triangle.primitive);
        let place = self.triangles.binary_search_by_key(&hit.id(), id).ok()?;
        self.triangles.get(place)
    }

    /// The box around everything.
    pub(super) fn bounds(&self) -> Aabb {
        self.triangles.iter().fold(Aabb::EMPTY, |bounds, it| bounds.union(it.triangle().bounds()))
    }

    fn answer(&self, query: Query, rays: &[Ray]) -> Result<Traced, ComparisonError> {
        let traced = self.tree.trace(Walk::default(), query, rays, TraceOptions::default());
        Ok(traced.map_err(GpuError::from)?)
    }
}

/// A point that a pixel sees, moved off the surface, and the normal on the camera's side.
struct SurfacePoint {
    pixel: u32,
    position: DVec3,
    normal: DVec3,
}

/// The batches of a picture so many pixels wide and high; classes without rays are left out.
pub(super) fn make(flat: &Flat, sight: &Sight, side: usize) -> Result<Vec<Batch>, ComparisonError> {
    let rays = sight.picture(side);
    let expected = flat.answer(Query::Closest, &rays)?;
    let seen = seen(flat, &rays, &expected);
    let pixels = (0..rays.len() as u32).collect();
    let mut batches = vec![Batch { class: RayClass::Primary, rays, pixels, expected }];
    for (class, (rays, pixels)) in
        [(RayClass::Shadow, to_light(&seen, sight)), (RayClass::DiffuseBounce, bounced(&seen))]
    {
        let expected = flat.answer(class.query(), &rays)?;
        batches.push(Batch { class, rays, pixels, expected });
    }
    batches.retain(|batch| !batch.rays.is_empty());
    Ok(batches)
}

fn seen(flat: &Flat, rays: &[Ray], traced: &Traced) -> Vec<SurfacePoint> {
    let Answer::Closest(hits) = &traced.answer else { return Vec::new() };
    let bounds = flat.bounds();
    let off = OFF * f64::from(bounds.min.abs().max(bounds.max.abs()).max_element());
    let point = |(pixel, (ray, hit)): (usize, (&Ray, &Hit))| {
        let [a, b, c] = flat.triangle(hit)?.triangle().vertices.map(glam::Vec3::as_dvec3);
        let normal = (b - a).cross(c - a).try_normalize()?;
        let dir = ray.dir.as_dvec3();
        let normal = if normal.dot(dir) > 0.0 { -normal } else { normal };
        let position = ray.origin.as_dvec3() + dir * f64::from(hit.t) + normal * off;
        Some(SurfacePoint { pixel: pixel as u32, position, normal })
    };
    rays.iter().zip(hits).enumerate().filter_map(point).collect()
}

/// A ray to the light, no farther, from each point that faces it.
fn to_light(seen: &[SurfacePoint], sight: &Sight) -> (Vec<Ray>, Vec<u32>) {
    let ray = |point: &SurfacePoint| {
        let origin = point.position.as_vec3();
        let dir = sight.light().as_dvec3() - origin.as_dvec3();
        let is_lit = dir.dot(point.normal) > 0.0;
        is_lit.then(|| (Ray::new(origin, dir.as_vec3()).window(0.0, 1.0), point.pixel))
    };
    seen.iter().filter_map(ray).unzip()
}

/// A ray from each point, distributed by the cosine to the normal.
fn bounced(seen: &[SurfacePoint]) -> (Vec<Ray>, Vec<u32>) {
    let mut random = Random::new(7);
    let ray = |point: &SurfacePoint| {
        let dir = (point.normal + random.direction() * 0.999_999).normalize();
        (Ray::new(point.position.as_vec3(), dir.as_vec3()), point.pixel)
    };
    seen.iter().map(ray).unzip()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use glam::Vec3;
    use ropewalk::Transform;
    use ropewalk_testkit::meshes;

    /// Balls in a row, one turned, one stretched.
    pub(in crate::two_level) fn balls() -> Scene {
        let mut scene = Scene::default();
        let ball = scene.add_object(meshes::icosphere(2));
        for step in 0..4 {
            let place = Vec3::new(1.7 * step as f32, 0.1 * step as f32, 0.0);
            let turn = glam::Quat::from_rotation_y(0.4 * step as f32);
            let size = Vec3::new(1.0, 1.0 + 0.5 * step as f32, 1.0);
            let map = glam::Affine3A::from_scale_rotation_translation(size, turn, place);
            scene.add_instance(ball, Transform::new(map).unwrap());
        }
        scene
    }

    pub(in crate::two_level) fn sight() -> Sight {
        let (eye, light) = (Vec3::new(2.5, 1.0, 9.0), Vec3::new(-5.0, 12.0, 8.0));
        Sight::new(eye, -Vec3::Z, Vec3::Y, 0.9, light).unwrap()
    }

    pub(in crate::two_level) fn flat(scene: &Scene) -> Flat {
        Flat::new(scene, scene.flatten().unwrap().triangles).unwrap()
    }

    #[test]
    fn rays_leave_what_is_seen() {
        let scene = balls();
        let flat = flat(&scene);
        let batches = make(&flat, &sight(), 24).unwrap();
        assert_eq!(batches.iter().map(|batch| batch.class).collect::<Vec<_>>(), CLASSES);
        let [primary, shadow, diffuse] = batches.as_slice() else { panic!("{batches:?}") };
        assert_eq!(primary.rays.len(), 24 * 24);
        let hits = primary.expected.answer.rays_that_hit();
        assert!(hits > 60 && hits == diffuse.rays.len() && shadow.rays.len() < hits);
        assert!(shadow.rays.iter().all(|ray| ray.t_max == 1.0) && shadow.rays.len() > hits / 3);
        for batch in &batches {
            assert_eq!(batch.rays.len(), batch.pixels.len());
            assert!(batch.pixels.is_sorted() && batch.pixels.iter().all(|&pixel| pixel < 24 * 24));
            assert_eq!(batch.query(), batch.expected.answer.query());
        }
        // Looking away there is nothing to start from.
        let away = Sight::new(Vec3::new(2.5, 1.0, 9.0), Vec3::Z, Vec3::Y, 0.9, Vec3::ZERO).unwrap();
        assert_eq!(make(&flat, &away, 8).unwrap().len(), 1);
    }
}
