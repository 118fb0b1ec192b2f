//! Every query of every tree is answered as the binary tree answers it, to the bit.

use crate::scenes::{builds, rays, scene, scenes};
use crate::{levels, packed};
use ropewalk::bvh8::SimdLevel;
use ropewalk::{Answer, Bvh8, Hit, Query, Ray, Scene, TraceOptions, Walk, glam};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::compare::same_bits;

pub(crate) fn check(name: &str, bvh: &ropewalk::Bvh, tree: &Bvh8, query: Query, rays: &[Ray]) {
    let plain = TraceOptions::default();
    let expected = bvh.trace(Walk::default(), query, rays, plain).unwrap();
    for (walk, options) in [
        (Walk::default(), plain),
        (Walk::default(), TraceOptions { counters: true }),
        (Walk::BruteForce, plain),
    ] {
        let given = tree.trace(walk, query, rays, options).unwrap();
        if let Err(mismatch) = same_bits(rays, &expected, &given, false) {
            panic!("{name}, {}, {walk}, {query}, {options:?}: {mismatch}", tree.level());
        }
    }
}

#[test]
fn every_preset_and_level_answers_as_the_binary_tree() {
    for (name, scene) in scenes() {
        let rays = rays(&scene, 40);
        let bvh = scene.build(&builds()[0]).unwrap();
        for (preset, _, tree) in packed(&scene) {
            for query in Query::EVERY {
                check(&format!("{name} {preset:?}"), &bvh, &tree, query, &rays);
            }
        }
    }
}

#[test]
fn the_hard_cases_are_answered_as_by_the_binary_tree() {
    for case in Case::every() {
        let bvh = case.scene.build(&builds()[0]).unwrap();
        for (preset, _, tree) in packed(&case.scene) {
            assert_eq!(tree.report().input, bvh.report().input);
            for query in [Query::Closest, Query::Any] {
                check(&format!("{} {preset:?}", case.name), &bvh, &tree, query, &case.rays);
            }
        }
    }
}

/// Trees that were built and collapsed elsewhere, with triangles in several leaves.
#[test]
fn other_trees_can_be_packed() {
    for name in ["sticks", "twice", "chain", "one", "nothing"] {
        let scene = scene(name);
        let rays = rays(&scene, 30);
        for options in builds() {
            let bvh = scene.build(&options).unwrap();
            for level in levels() {
                let tree = Bvh8::from_bvh(&bvh, Some(level)).unwrap();
                assert_eq!((tree.level(), tree.validate()), (level, Ok(())));
                assert_eq!(tree.has_repeats(), bvh.has_repeats());
                assert_eq!(tree.triangles().len(), bvh.triangles().len());
                for query in Query::EVERY {
                    check(name, &bvh, &tree, query, &rays);
                }
            }
        }
    }
}

/// Batches of every length around the number of rays in turn, and over the ends of what a thread takes.
#[test]
fn one_ray_is_answered_like_a_batch() {
    let scene = scene("soup");
    let mut rays = rays(&scene, 700);
    let invalid = Ray::new(glam::Vec3::ZERO, glam::Vec3::ZERO);
    for place in [0, 7, 8, 100, 4095, 4096] {
        rays[place] = invalid;
    }
    assert!(rays.len() > 2 * 4096, "{} rays", rays.len());
    for (_, level, tree) in packed(&scene) {
        let single: Vec<Hit> = rays.iter().map(|ray| tree.closest(ray)).collect();
        let mut all = vec![Hit::MISS];
        for (ray, closest) in rays.iter().zip(&single).take(2000) {
            assert_eq!(tree.any(ray), closest.is_hit(), "{level}");
            tree.all(ray, &mut all);
            assert_eq!(all.first().copied().unwrap_or(Hit::MISS).to_words(), closest.to_words());
            assert_eq!(all.len(), tree.count(ray) as usize);
        }
        for length in (0..40).chain([4095, 4096, 4097, rays.len()]) {
            let (mut hits, mut any) = (vec![Hit::MISS; length], vec![true; length]);
            tree.closest_batch(&rays, &mut hits);
            tree.any_batch(&rays, &mut any);
            for (index, hit) in hits.iter().enumerate() {
                assert_eq!(hit.to_words(), single[index].to_words(), "{level}, {index} of {length}");
                assert_eq!(any[index], single[index].is_hit(), "{level}, {index} of {length}");
            }
        }
    }
}

/// Every level visits the same nodes, in the same order: what they count is the same.
#[test]
fn levels_count_the_same() {
    for name in ["soup", "shells", "concentric"] {
        let scene = scene(name);
        let rays = rays(&scene, 60);
        for query in [Query::Closest, Query::Any] {
            let counted = |tree: &Bvh8| {
                tree.trace(Walk::default(), query, &rays, TraceOptions { counters: true }).unwrap().counters
            };
            let trees = packed(&scene);
            for pair in trees.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
                assert_eq!(counted(&pair[0].2), counted(&pair[1].2), "{name} {query} {}", pair[1].1);
            }
        }
    }
}

#[test]
fn a_level_that_the_machine_lacks_is_another_one() {
    let tree = scene("six").build_packed(&Default::default()).unwrap();
    assert_eq!(tree.level(), SimdLevel::best());
    for level in SimdLevel::EVERY {
        let there = tree.clone().at(level).level();
        assert_eq!(there, if level.is_available() { level } else { SimdLevel::best() });
    }
    assert_eq!(tree.at(SimdLevel::Portable).level(), SimdLevel::Portable);
}

#[test]
fn nothing_is_hit_where_there_is_nothing() {
    let tree = Scene::default().build_packed(&Default::default()).unwrap();
    let rays = [Ray::new(glam::Vec3::ZERO, glam::Vec3::X); 20];
    for query in Query::EVERY {
        let traced = tree.trace(Walk::default(), query, &rays, TraceOptions::default()).unwrap();
        assert_eq!(traced.answer.rays_that_hit(), 0);
        assert_eq!(traced.answer.len(), rays.len());
    }
    let mut hits = [Hit { t: 1.0, ..Hit::MISS }; 20];
    tree.closest_batch(&rays, &mut hits);
    assert!(hits.iter().all(|hit| hit.to_words() == Hit::MISS.to_words()));
    assert!(matches!(
        tree.trace(Walk::default(), Query::Any, &[], TraceOptions::default()).unwrap().answer,
        Answer::Any(hits) if hits.is_empty()
    ));
}
