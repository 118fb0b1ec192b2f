//! Rays in turn, which batches take to large scenes alone, against rays one by one.

use super::find::{FindAny, FindClosest};
use super::levels::Levels;
use super::many::Many;
use crate::bvh8::arena::Reader;
use crate::bvh8::simd::{Detected, dispatch};
use crate::bvh8::walk::single::ByForm;
use crate::bvh8::{Bvh8Options, Instanced, Preset, SimdLevel};
use crate::{Hit, Mesh, Ray, Scene, Transform};
use glam::{Affine3A, Quat, Vec3};
use std::marker::PhantomData;

/// A fan of slanted triangles.
fn object(triangles: u8) -> Mesh {
    let mut mesh = Mesh::default();
    for index in 0..triangles {
        let turn = Quat::from_euler(glam::EulerRot::XYZ, f32::from(index), 0.3 * f32::from(index), 0.7);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([Vec3::X, Vec3::Y, Vec3::Z * 0.5].map(|corner| turn * corner));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    mesh
}

#[test]
fn rays_in_turn_are_answered_as_rays_one_by_one() {
    let mut scene = Scene::default();
    let objects = [scene.add_object(object(40)), scene.add_object(object(3))];
    for index in 0..60u8 {
        let step = f32::from(index);
        let scale = Vec3::new(0.4, if index % 3 == 0 { -0.3 } else { 0.5 }, 0.6);
        let place = Vec3::new(step.sin(), (1.7 * step).cos(), (0.6 * step).sin()) * 3.0;
        let map = Affine3A::from_scale_rotation_translation(scale, Quat::from_rotation_x(step), place);
        scene.add_instance(objects[usize::from(index % 2)], Transform::new(map).unwrap());
    }
    scene.instances[9].mask = 2;
    let mut rays = Vec::new();
    for index in 0..900u16 {
        let step = f32::from(index);
        let target = Vec3::new((0.3 * step).sin(), (0.7 * step).cos(), (1.1 * step).sin()) * 3.0;
        let origin = Vec3::new((2.0 * step).cos(), (0.9 * step).sin(), 1.0) * 7.0;
        rays.push(Ray::new(origin, target - origin).with_mask(1 << (index % 2)));
    }
    rays[4] = Ray::new(Vec3::ZERO, Vec3::ZERO);
    let mut met = 0;
    for level in SimdLevel::EVERY.into_iter().filter(|level| level.is_available()) {
        for preset in [Preset::Balanced, Preset::Compact] {
            let instanced = scene.build_instanced(&Bvh8Options { preset, level: None }).unwrap().at(level);
            for count in [0, 1, 7, 8, 9, rays.len()] {
                met += match instanced.levels() {
                    ByForm::Full(levels) => check(levels, &instanced, &rays[..count]),
                    ByForm::Compact(levels) => check(levels, &instanced, &rays[..count]),
                };
            }
        }
    }
    assert!(met > 100, "{met}");
}

/// Tells how many rays hit something.
fn check<'a, R: Reader<'a>>(levels: Levels<'a, R>, instanced: &'a Instanced, rays: &[Ray]) -> usize {
    let (level, count) = (instanced.level(), rays.len());
    let detected = Detected::or_best(Some(level));
    let (mut hits, mut any) = (vec![Hit::MISS; count], vec![true; count]);
    let answers = &mut hits;
    dispatch(detected, Many::<'_, '_, R, FindClosest<'_>, 8> { levels, rays, answers, goal: PhantomData });
    let answers = &mut any;
    dispatch(detected, Many::<'_, '_, R, FindAny, 8> { levels, rays, answers, goal: PhantomData });
    for ((ray, hit), &any) in rays.iter().zip(&hits).zip(&any) {
        assert_eq!(hit.to_words(), instanced.closest(ray).to_words(), "{level}: {ray:?}");
        assert_eq!((any, instanced.any(ray)), (hit.is_hit(), any), "{level}: {ray:?}");
    }
    any.into_iter().filter(|&any| any).count()
}
