//! No triangle is lost where others lose some: a ray at the middle of every triangle of the scenes on which engines with an absolute
//! tolerance, or with spatial splits that cut too much, miss hits. Packed trees of every preset at every level, and the binary tree.

mod common;

use ropewalk::bvh8::{Preset, SimdLevel};
use ropewalk::glam::{DMat3, DVec3, EulerRot};
use ropewalk::{Answer, BuildOptions, Bvh8Options, Hit, Query, Ray, Scene, TraceOptions, Walk};

/// How far above a triangle its ray begins, of the scene's diagonal.
const ABOVE: f64 = 1e-3;
/// Circles inside of triangles that a ray is sure to meet: in units of the last place of the largest coordinate.
const SURE: f64 = 64.0 * f32::EPSILON as f64;

fn scene(name: &str) -> Option<Scene> {
    common::model(name).map(|model| model.scene)
}

/// All vertices turned off the axes.
fn turned(scene: &Scene) -> Scene {
    let turn = DMat3::from_euler(EulerRot::XYZ, 0.6, 0.7, 0.3);
    let mut scene = scene.clone();
    for mesh in scene.objects.iter_mut().flat_map(|object| &mut object.geometries) {
        for position in &mut mesh.positions {
            *position = (turn * position.as_dvec3()).as_vec3();
        }
    }
    scene
}

/// A ray straight down at the middle of every triangle that is not too thin to be aimed at, and how far its triangle is.
fn rays(scene: &Scene) -> (Vec<Ray>, Vec<f32>, usize) {
    let bounds = scene.bounds();
    let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let above = ABOVE * (high - low).length();
    let largest = high.abs().max(low.abs()).max_element() + above;
    let flat = scene.flatten().unwrap();
    let mut aimed = (Vec::new(), Vec::new(), flat.triangles.len());
    for triangle in &flat.triangles {
        let [a, b, c] = [triangle.v0, triangle.v1, triangle.v2]
            .map(|[x, y, z]| DVec3::new(f64::from(x), f64::from(y), f64::from(z)));
        let normal = (b - a).cross(c - a);
        let around = (b - a).length() + (c - b).length() + (a - c).length();
        if normal.length() / around < SURE * largest {
            continue;
        }
        let normal = normal.normalize();
        let middle = (a + b + c) / 3.0;
        aimed.0.push(Ray::new((middle + normal * above).as_vec3(), (-normal).as_vec3()));
        aimed.1.push(above as f32);
    }
    aimed
}

fn closest(answer: Answer) -> Vec<Hit> {
    match answer {
        Answer::Closest(hits) => hits,
        other => panic!("{other:?}"),
    }
}

fn assert_none_is_lost(name: &str, scene: &Scene) {
    let (rays, far, all) = rays(scene);
    println!("{name}: {} of {all} triangles are wide enough to be aimed at", rays.len());
    assert!(rays.len() * 10 > all * 8);
    let lost = |hits: &[Hit]| hits.iter().zip(&far).filter(|(hit, far)| hit.t > **far * 1.01).count();
    let bvh = scene.build(&BuildOptions::default()).unwrap();
    let walk: Walk = "stack:order=ordered".parse().unwrap();
    let expected = closest(bvh.trace(walk, Query::Closest, &rays, TraceOptions::default()).unwrap().answer);
    assert_eq!(lost(&expected), 0, "{name}, the binary tree");
    for preset in Preset::EVERY {
        let tree = scene.build_packed(&Bvh8Options { preset, level: None }).unwrap();
        for level in SimdLevel::EVERY.into_iter().filter(|level| level.is_available()) {
            let tree = tree.clone().at(level);
            let mut hits = vec![Hit::MISS; rays.len()];
            tree.closest_batch(&rays, &mut hits);
            for ((ray, hit), expected) in rays.iter().zip(&hits).zip(&expected) {
                assert_eq!(hit.to_words(), expected.to_words(), "{name} {preset:?} {level}: {ray:?}");
            }
        }
    }
}

#[test]
fn every_triangle_of_a_kitchen_is_hit() {
    let Some(kitchen) = scene("kitchen_obvhs/kitchen_56939.obj.gz") else { return };
    assert_none_is_lost("kitchen", &kitchen);
    assert_none_is_lost("kitchen, turned", &turned(&kitchen));
}

#[test]
fn every_triangle_of_a_scan_is_hit() {
    let Some(bunny) = scene("stanford_bunny/bun_zipper.ply.gz") else { return };
    assert_none_is_lost("bunny", &bunny);
    let Some(dragon) = scene("stanford_dragon/dragon_vrip_871414_le.ply.gz") else { return };
    assert_none_is_lost("dragon", &dragon);
}
