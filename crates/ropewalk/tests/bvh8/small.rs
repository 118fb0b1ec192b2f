//! Little of everything, at the portable level: small enough for an interpreter that watches every access to memory.
//!
//! `MIRIFLAGS=-Zmiri-disable-isolation cargo +nightly miri test -p ropewalk --no-default-features --test bvh8 small`

use ropewalk::bvh8::{Preset, SimdLevel};
use ropewalk::glam::{Affine3A, Vec3};
use ropewalk::{Bvh8, Bvh8Options, Hit, Mesh, Object, Ray, Scene, Transform};

/// Triangles of a wavy sheet: enough for several nodes and leaves of every size.
fn sheet(lift: f32) -> Mesh {
    let side = if cfg!(miri) { 4 } else { 5 };
    let point = |x: u32, y: u32| {
        let wave = ((x * 7 + y * 5) % 4) as f32 * 0.2;
        Vec3::new(x as f32, y as f32, lift + wave)
    };
    let positions = (0..=side).flat_map(|y| (0..=side).map(move |x| point(x, y))).collect();
    let corner = |x: u32, y: u32| y * (side + 1) + x;
    let triangles = (0..side)
        .flat_map(|y| (0..side).map(move |x| (x, y)))
        .flat_map(|(x, y)| {
            let square = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            [[square[0], square[1], square[2]], [square[0], square[2], square[3]]]
        })
        .collect();
    Mesh::new(positions, triangles)
}

/// A whole packet, a small one, and a few that go one by one.
fn rays() -> Vec<Ray> {
    let eye = Vec3::new(2.3, 2.6, 9.0);
    let mut rays: Vec<Ray> = (0..75)
        .map(|place| Ray::new(eye, Vec3::new(0.1 + (place % 9) as f32, 0.2 + (place / 9) as f32, 0.0) - eye))
        .collect();
    rays.push(Ray::new(Vec3::new(2.5, 2.5, 5.0), -Vec3::Z));
    rays.push(Ray::new(Vec3::new(-5.0, 2.5, 0.1), Vec3::X));
    rays.push(Ray::new(Vec3::ZERO, Vec3::ZERO));
    rays
}

fn check(tree: &Bvh8, scene: &Scene, rays: &[Ray]) {
    let bvh = scene.build(&Default::default()).unwrap();
    let (mut hits, mut any) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
    tree.closest_batch(rays, &mut hits);
    tree.any_batch(rays, &mut any);
    for (place, ray) in rays.iter().enumerate() {
        let expected = bvh.closest(ray).to_words();
        assert_eq!(hits[place].to_words(), expected, "{ray:?}");
        assert_eq!(tree.closest(ray).to_words(), expected, "{ray:?}");
        assert_eq!((any[place], tree.any(ray)), (hits[place].is_hit(), hits[place].is_hit()), "{ray:?}");
    }
}

#[test]
fn every_preset_builds_walks_and_refits() {
    let (still, moved) = (Scene::from_mesh(sheet(0.0)), Scene::from_mesh(sheet(0.7)));
    let rays = rays();
    // An interpreter takes minutes for each; walks are the same.
    let presets = if cfg!(miri) { &[Preset::Balanced, Preset::Compact][..] } else { &Preset::EVERY };
    for &preset in presets {
        let level = Some(SimdLevel::Portable);
        let mut tree = still.build_packed(&Bvh8Options { preset, level }).unwrap();
        assert_eq!(tree.validate(), Ok(()), "{preset:?}");
        check(&tree, &still, &rays);
        if !preset.can_refit() {
            continue;
        }
        tree.refit(&moved).unwrap();
        assert_eq!(tree.validate(), Ok(()), "{preset:?}");
        check(&tree, &moved, &rays);
    }
}

#[test]
fn instances_are_walked() {
    let mut scene = Scene::default();
    let object = scene.add_object(Object { geometries: vec![sheet(0.0)] });
    for place in 0..3 {
        let there = Affine3A::from_translation(Vec3::new(place as f32, 0.0, 1.5 * place as f32));
        scene.add_instance(object, Transform::new(there).unwrap());
    }
    let tree = scene.build_instanced(&Default::default()).unwrap();
    let bvh = scene.build(&Default::default()).unwrap();
    let rays = rays();
    let mut hits = vec![Hit::MISS; rays.len()];
    tree.closest_batch(&rays, &mut hits);
    for (ray, hit) in rays.iter().zip(&hits) {
        let expected = bvh.closest(ray);
        assert_eq!(tree.closest(ray).to_words(), hit.to_words(), "{ray:?}");
        assert_eq!(hit.is_hit(), expected.is_hit(), "{ray:?}");
        assert!(!hit.is_hit() || (hit.t - expected.t).abs() <= 1e-5 * hit.t, "{ray:?}");
    }
}
