//! Many rays of every class through real scenes, at every level, against the scalar walk: not a bit may differ.
//!
//! `ROPEWALK_RAYS=10000000` asks for so many rays of each class; left out, few enough for every run.

use crate::packed;
use ropewalk::{BuildOptions, Hit, Mesh, Ray, Scene, glam::Vec3};
use ropewalk_testkit::rays::{RayClass, RayMaker};
use std::io::Read;

/// A scene file, where it is there: vertices and faces of an OBJ, gzipped.
pub(crate) fn kitchen() -> Option<Scene> {
    let path =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes/kitchen_obvhs/kitchen_56939.obj.gz");
    let file = std::fs::File::open(path).ok()?;
    let mut text = String::new();
    flate2::read::GzDecoder::new(file).read_to_string(&mut text).ok()?;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let [x, y, z] =
                    [(); 3].map(|()| words.next().and_then(|word| word.parse().ok()).unwrap_or(0.0));
                positions.push(Vec3::new(x, y, z));
            }
            Some("f") => {
                let corners: Vec<u32> = words
                    .filter_map(|word| word.split('/').next()?.parse::<u32>().ok())
                    .map(|index| index - 1)
                    .collect();
                triangles.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
            }
            _ => {}
        }
    }
    Some(Scene::from_mesh(Mesh::new(positions, triangles)))
}

#[test]
fn no_bit_differs_on_many_rays_of_every_class() {
    let Some(scene) = kitchen() else {
        println!("skipped: the kitchen is not there");
        return;
    };
    let count = std::env::var("ROPEWALK_RAYS").ok().and_then(|text| text.parse().ok()).unwrap_or(20_000);
    let bvh = scene.build(&BuildOptions::default()).unwrap();
    let flat = scene.flatten().unwrap();
    let trees = packed(&scene);
    let closest = |rays: &[Ray]| rays.iter().map(|ray| bvh.closest(ray)).collect::<Vec<Hit>>();
    for class in RayClass::EVERY {
        // In parts, so that ten million fit any machine.
        for (part, first) in (0..count).step_by(1 << 18).enumerate() {
            let rays = RayMaker::new(&flat, part as u64).make(class, (count - first).min(1 << 18), &closest);
            let (mut expected, mut any) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
            bvh.closest_batch(&rays, &mut expected);
            let mut given = expected.clone();
            for (preset, level, tree) in &trees {
                given.fill(Hit::MISS);
                tree.closest_batch(&rays, &mut given);
                tree.any_batch(&rays, &mut any);
                for (index, (a, b)) in expected.iter().zip(&given).enumerate() {
                    assert_eq!(a.to_words(), b.to_words(), "{class} {preset:?} {level}: {:?}", rays[index]);
                    assert_eq!(any[index], a.is_hit(), "{class} {preset:?} {level}: {:?}", rays[index]);
                }
            }
        }
    }
}
