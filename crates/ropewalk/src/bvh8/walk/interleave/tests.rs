//! Few rays in turn and many, which batches take to large scenes alone, against rays one by one, in full and compact.

use super::{AnyGoal, ClosestGoal, FEW, Interleaved, MANY};
use crate::bvh8::arena::Reader;
use crate::bvh8::simd::dispatch;
use crate::bvh8::walk::single::{ByForm, Place};
use crate::bvh8::{Bvh8, Preset, SimdLevel};
use crate::{Bvh8Options, Hit, Mesh, Ray, Scene};
use glam::{Quat, Vec3};

/// Slanted triangles in a ball, two of them alike.
fn scene() -> Scene {
    let mut mesh = Mesh::default();
    for index in 0..400u16 {
        let step = f32::from(index / 2 * 2);
        let turn = Quat::from_euler(glam::EulerRot::XYZ, step, 0.3 * step, 0.7);
        let place = Vec3::new((1.3 * step).sin(), (0.7 * step).cos(), (0.4 * step).sin());
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([Vec3::X, Vec3::Y, Vec3::Z * 0.5].map(|corner| place + turn * corner * 0.2));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    Scene::from_mesh(mesh)
}

fn rays() -> Vec<Ray> {
    let mut rays: Vec<Ray> = (0..900u16)
        .map(|index| {
            let step = f32::from(index);
            let target = Vec3::new((0.3 * step).sin(), (0.7 * step).cos(), (1.1 * step).sin());
            let origin = Vec3::new((2.0 * step).cos(), (0.9 * step).sin(), 1.0) * 7.0;
            Ray::new(origin, target - origin)
        })
        .collect();
    rays[4] = Ray::new(Vec3::ZERO, Vec3::ZERO);
    rays
}

/// Tells how many rays hit something.
fn check<'a, R: Reader<'a>, const SLOTS: usize>(place: Place<'a, R>, bvh: &Bvh8, rays: &[Ray]) -> usize {
    let (mut hits, mut any) = (vec![Hit::MISS; rays.len()], vec![true; rays.len()]);
    // Some are left out.
    let runs = [0..rays.len() / 3, rays.len() / 3 + 5.min(rays.len())..rays.len()];
    let answers = &mut hits;
    dispatch(bvh.level, Interleaved::<'a, '_, R, ClosestGoal, SLOTS> { place, rays, runs: &runs, answers });
    let answers = &mut any;
    dispatch(bvh.level, Interleaved::<'a, '_, R, AnyGoal, SLOTS> { place, rays, runs: &runs, answers });
    let mut met = 0;
    for index in runs.into_iter().flatten() {
        let (ray, hit) = (&rays[index], &hits[index]);
        assert_eq!(hit.to_words(), bvh.closest(ray).to_words(), "{}: {ray:?}", bvh.level());
        assert_eq!((any[index], bvh.any(ray)), (hit.is_hit(), hit.is_hit()), "{}: {ray:?}", bvh.level());
        met += usize::from(hit.is_hit());
    }
    met
}

#[test]
fn rays_in_turn_are_answered_as_rays_one_by_one() {
    let (scene, rays) = (scene(), rays());
    let mut met = 0;
    for level in SimdLevel::EVERY.into_iter().filter(|level| level.is_available()) {
        for preset in [Preset::Balanced, Preset::Compact] {
            let bvh = scene.build_packed(&Bvh8Options { preset, level: Some(level) }).unwrap();
            for count in [9, 15, 16, 17, 40, rays.len()] {
                let rays = &rays[..count];
                met += match bvh.place() {
                    ByForm::Full(place) => {
                        check::<_, FEW>(place, &bvh, rays) + check::<_, MANY>(place, &bvh, rays)
                    }
                    ByForm::Compact(place) => {
                        check::<_, FEW>(place, &bvh, rays) + check::<_, MANY>(place, &bvh, rays)
                    }
                };
            }
        }
    }
    assert!(met > 1000, "{met}");
}
