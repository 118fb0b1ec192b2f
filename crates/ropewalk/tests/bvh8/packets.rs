//! Rays that run side by side: what packets answer is what each ray is answered.

use crate::scenes::{builds, scene};
use crate::{levels, packed};
use ropewalk::bvh8::Preset;
use ropewalk::glam::{Vec2, Vec3};
use ropewalk::{Bvh, Bvh8, Hit, Ray, Scene};
use ropewalk_testkit::rays::RayMaker;

/// More than a whole packet, and not a multiple of one.
const SIDE: usize = 71;

/// What one ray of many may be instead: something that packets do not take, or that sees nothing.
fn odd(ray: Ray, kind: usize) -> Ray {
    match kind % 9 {
        0 => Ray { dir: Vec3::ZERO, ..ray },
        1 => Ray { dir: ray.dir.with_x(0.0), ..ray },
        2 => Ray { dir: ray.dir.with_y(-0.0).with_z(0.0), ..ray },
        3 => ray.with_mask(0),
        4 => ray.window(2.0, 1.0),
        5 => Ray { origin: Vec3::new(f32::NAN, 0.0, 0.0), ..ray },
        6 => Ray { t_max: f32::NAN, ..ray },
        7 => Ray { origin: ray.origin.with_x(3e38), ..ray },
        _ => Ray { dir: ray.dir * 1e-30, ..ray },
    }
}

/// Rays in rows: from an eye, side by side, towards a lamp, along the axes' diagonals, and with odd ones among them.
fn batches(scene: &Scene) -> Vec<(&'static str, Vec<Ray>)> {
    let flat = scene.flatten().unwrap();
    let bounds = RayMaker::new(&flat, 1).bounds();
    let (center, size) = (bounds.center(), bounds.size().length().max(1e-3));
    let places: Vec<Vec2> = (0..SIDE * SIDE)
        .map(|place| Vec2::new((place % SIDE) as f32, (place / SIDE) as f32) / SIDE as f32 - 0.5)
        .collect();
    let eye = |from: Vec3| -> Vec<Ray> {
        let forward = (center - from).normalize_or(Vec3::X);
        let (right, up) = forward.any_orthonormal_pair();
        places.iter().map(|at| Ray::new(from, forward + right * at.x + up * at.y)).collect()
    };
    let slanted = eye(center + Vec3::new(0.7, 0.4, 1.1) * size);
    let inside = eye(center - Vec3::splat(1e-3 * size));
    let along: Vec<Ray> = places
        .iter()
        .map(|at| Ray::new(center + Vec3::new(at.x, at.y, -1.0) * size, Vec3::new(0.02, -0.03, 1.0)))
        .collect();
    let lamp = center + Vec3::new(0.3, 2.0, 0.2) * size;
    let shadow: Vec<Ray> = places
        .iter()
        .map(|at| {
            let from = center + Vec3::new(at.x, -0.6, at.y) * size;
            Ray::new(from, lamp - from).window(1e-3, 0.999)
        })
        .collect();
    // A stride that has no common divisor with their number spreads them.
    let spread = (0..along.len()).map(|place| along[place * 997 % along.len()]).collect();
    let diagonal = places
        .iter()
        .map(|at| Ray::new(center - Vec3::ONE * size, Vec3::ONE + Vec3::new(at.x, at.y, 0.0) * 1e-6))
        .collect();
    let with_odd = (0..slanted.len())
        .map(|place| if place % 41 == 7 { odd(slanted[place], place / 41) } else { slanted[place] })
        .collect();
    let masked = slanted.iter().enumerate().map(|(place, ray)| ray.with_mask(1 << (place % 3))).collect();
    vec![
        ("eye", slanted),
        ("inside", inside),
        ("along", along),
        ("shadow", shadow),
        ("spread", spread),
        ("diagonal", diagonal),
        ("odd", with_odd),
        ("masks", masked),
    ]
}

fn check(what: &str, bvh: &Bvh, tree: &Bvh8, rays: &[Ray]) {
    let (mut hits, mut any) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
    tree.closest_batch(rays, &mut hits);
    tree.any_batch(rays, &mut any);
    for (index, ray) in rays.iter().enumerate() {
        let expected = bvh.closest(ray);
        assert_eq!(hits[index].to_words(), expected.to_words(), "{what}, {}, {index}: {ray:?}", tree.level());
        assert_eq!(any[index], expected.is_hit(), "{what}, {}, {index}: {ray:?}", tree.level());
    }
}

#[test]
fn rays_side_by_side_are_answered_as_one_by_one() {
    for name in ["soup", "shells", "sticks", "concentric", "twice", "grid", "one", "masks"] {
        let scene = if name == "masks" { crate::names::scene([0x81, 0x02, 0x84]) } else { scene(name) };
        let bvh = scene.build(&builds()[0]).unwrap();
        for (preset, _, tree) in packed(&scene) {
            if matches!(preset, Preset::Balanced | Preset::High | Preset::Compact) {
                for (rays_by, rays) in batches(&scene) {
                    check(&format!("{name} {preset:?}, {rays_by}"), &bvh, &tree, &rays);
                }
            }
        }
    }
}

/// Around the numbers of rays of packets, large and small.
#[test]
fn every_number_of_rays_side_by_side_is_answered() {
    let scene = scene("shells");
    let bvh = scene.build(&builds()[0]).unwrap();
    let tree = scene.build_packed(&Default::default()).unwrap();
    for level in levels() {
        let tree = tree.clone().at(level);
        for (rays_by, rays) in batches(&scene) {
            for length in [1, 7, 8, 9, 15, 16, 63, 64, 65, 72, 127, 128, 200] {
                check(&format!("{length} of {rays_by}"), &bvh, &tree, &rays[3..3 + length]);
            }
        }
    }
}
