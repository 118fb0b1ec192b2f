//! The peers themselves, where the program is built with them.
//!
//! Every peer that is there answers as the reference does over small scenes, whatever way rays are handed over; one that is not
//! there is told, and nothing panics.

#![cfg(feature = "peers")]

use ropewalk::glam::Affine3A;
use ropewalk::{BuildOptions, Hit, Query, Ray, Scene};
use ropewalk_lab::arena::{Answers, ArenaClass, Engine, Judge, RaySet, Shape, Viewpoint};
use ropewalk_peers::{Places, engines};
use ropewalk_testkit::meshes;
use std::path::PathBuf;

const RAYS: usize = 5_003;

fn shape() -> Shape {
    Shape::new(&Scene::from_mesh(meshes::icosphere(4))).unwrap()
}

fn name(engine: &dyn Engine) -> String {
    format!("{} {}", engine.name(), engine.preset())
}

#[test]
fn peers_agree_on_every_class() {
    let shape = shape();
    let bvh = shape.scene().build(&BuildOptions::default()).unwrap();
    let closest = |rays: &[Ray]| rays.iter().map(|ray| bvh.closest(ray)).collect::<Vec<Hit>>();
    let judge = Judge::new(shape.flat());
    let viewpoint = Viewpoint::outside(&shape.bounds());
    let sets = ArenaClass::EVERY
        .map(|class| RaySet::make(class, shape.flat(), &viewpoint, None, RAYS, 1, &closest))
        .map(|set| (closest(&set.rays), set));
    let peers = engines(&Places::default());
    println!("absent: {:?}", peers.absent);
    for engine in &peers.engines {
        for threads in [1, 2] {
            let tracer = engine.build(&shape, threads).unwrap();
            for (reference, set) in &sets {
                for &mode in tracer.modes() {
                    if mode.is_packet() && !set.class.is_coherent() {
                        continue;
                    }
                    let mut answers = Answers::poisoned(set);
                    let verdict = match set.query() {
                        Query::Any => {
                            tracer.any(mode, set, 0..set.rays.len(), &mut answers.any);
                            judge.any(&set.rays, reference, &answers.any)
                        }
                        _ => {
                            tracer.closest(mode, set, 0..set.rays.len(), &mut answers.hits);
                            judge.closest(&set.rays, reference, &answers.hits)
                        }
                    };
                    let who = name(&**engine);
                    // obvhs' compressed boxes lose a hit in a hundred thousand; all others lose none here.
                    assert!(verdict.suspect() <= 2, "{who}, {}, {mode}: {verdict:?}", set.class);
                }
            }
        }
    }
}

#[test]
fn peers_follow_what_moves() {
    let shape = shape();
    let bent = shape.bent(0.2).unwrap();
    for engine in &engines(&Places::default()).engines {
        if let Some(refitter) = engine.refitter(&shape, 1) {
            refitter.unwrap().refit(&bent).unwrap();
        }
        let Some(level) = engine.top_level(&shape, 1) else { continue };
        let mut level = level.unwrap();
        for count in [3usize, 5, 2] {
            let place = |at: usize| Affine3A::from_translation(ropewalk::glam::Vec3::X * (4.0 * at as f32));
            let places: Vec<Affine3A> = (0..count).map(place).collect();
            level.place(&places).unwrap();
            let rays = (0..6)
                .map(|at| {
                    Ray::new(
                        ropewalk::glam::Vec3::new(4.0 * at as f32, 0.1, 5.0),
                        ropewalk::glam::Vec3::NEG_Z,
                    )
                })
                .collect();
            let set = RaySet::new(ArenaClass::Diffuse, rays);
            let mut hits = vec![Hit::MISS; 6];
            for &mode in level.modes() {
                level.closest(mode, &set, 0..6, &mut hits);
                let seen: Vec<u32> = hits.iter().map(|hit| hit.instance_index).collect();
                let expected: Vec<u32> =
                    (0..6).map(|at| if at < count { at as u32 } else { u32::MAX }).collect();
                assert_eq!(seen, expected, "{} {mode}", name(&**engine));
            }
        }
    }
}

#[test]
fn an_absent_library_is_told() {
    let nowhere = Some(PathBuf::from("no/such/library.so"));
    let peers = engines(&Places { embree3: nowhere.clone(), embree4: nowhere });
    for version in ["embree 3", "embree 4"] {
        let absent = peers.absent.iter().find(|absent| absent.name == version).unwrap();
        assert!(absent.why.contains("no/such/library.so"), "{absent:?}");
    }
    assert!(!peers.engines.is_empty());
}

#[test]
fn an_empty_shape_is_an_error_or_an_empty_tree() {
    let empty = Shape::new(&Scene::default()).unwrap();
    for engine in &engines(&Places::default()).engines {
        if engine.name().starts_with("tinybvh") || engine.name().starts_with("parry3d") {
            assert!(engine.build(&empty, 1).is_err(), "{}", name(&**engine));
        }
    }
}
