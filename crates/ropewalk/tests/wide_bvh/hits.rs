//! Every walk of a wide tree answers every query as the binary tree does, to the bit.

use crate::scenes::{builds, collapsed, rays, scenes};
use glam::Vec3;
use ropewalk::catalogue::{TrailOptions, TrailRegister};
use ropewalk::{
    BuildError, BuildOptions, Hit, Query, Ray, Scene, TraceOptions, Walk, WideBvh, WideOptions, glam,
};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::compare::same_bits;
use std::ops::ControlFlow;

fn trail(short_stack: u32, register: TrailRegister) -> Walk {
    Walk::RestartTrail(TrailOptions { short_stack, register, ..TrailOptions::default() })
}

/// Compares a walk with the binary tree's default.
fn check(name: &str, bvh: &ropewalk::Bvh, wide: &WideBvh, walk: Walk, query: Query, rays: &[Ray]) {
    let expected = bvh.trace(Walk::default(), query, rays, TraceOptions::default()).unwrap();
    let given = wide.trace(walk, query, rays, TraceOptions { counters: true }).unwrap();
    if let Err(mismatch) = same_bits(rays, &expected, &given, false) {
        panic!("{name}, {:?}, {walk}, {query}: {mismatch}", wide.width());
    }
}

#[test]
fn every_short_stack_and_register_answers_as_the_binary_tree() {
    for (name, scene) in scenes() {
        let rays = rays(&scene, 12);
        for options in builds() {
            let (bvh, trees) = collapsed(&scene, &options);
            for wide in &trees {
                assert_eq!(wide.validate(), Ok(()), "{name} {options:?}");
                for query in Query::EVERY {
                    check(name, &bvh, wide, Walk::BruteForce, query, &rays);
                    check(name, &bvh, wide, Walk::default(), query, &rays);
                }
                for short_stack in 0..=TrailOptions::MAX_SHORT_STACK {
                    // Every query with some, closest with all.
                    let queries = if short_stack % 8 < 2 { &Query::EVERY[..] } else { &Query::EVERY[..1] };
                    for &query in queries {
                        check(name, &bvh, wide, trail(short_stack, TrailRegister::Array), query, &rays);
                        if wide.report().depth <= 16 {
                            check(name, &bvh, wide, trail(short_stack, TrailRegister::U64), query, &rays);
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn the_hard_cases_are_answered_as_by_the_binary_tree() {
    for case in Case::every() {
        for options in
            [BuildOptions::default(), BuildOptions { max_leaf: 1, max_depth: 64, ..Default::default() }]
        {
            let (bvh, trees) = collapsed(&case.scene, &options);
            for wide in &trees {
                assert_eq!(wide.report().input, bvh.report().input);
                for query in [Query::Closest, Query::All] {
                    for walk in
                        [Walk::default(), trail(0, TrailRegister::Auto), trail(2, TrailRegister::Auto)]
                    {
                        check(case.name, &bvh, wide, walk, query, &case.rays);
                    }
                }
            }
        }
    }
}

#[test]
fn one_ray_is_answered_like_a_batch() {
    let (_, scene) = scenes().remove(0);
    let rays = rays(&scene, 20);
    for options in [builds()[0], builds()[3]] {
        let (bvh, trees) = collapsed(&scene, &options);
        for wide in trees {
            assert_eq!(wide.has_repeats(), bvh.has_repeats());
            let (mut hits, mut any) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
            wide.closest_batch(&rays, &mut hits);
            wide.any_batch(&rays, &mut any);
            let (mut all, mut expected) = (vec![Hit::MISS], Vec::new());
            for (index, ray) in rays.iter().enumerate() {
                let closest = bvh.closest(ray);
                assert_eq!(wide.closest(ray).to_words(), closest.to_words());
                assert_eq!(hits[index].to_words(), closest.to_words());
                assert_eq!((wide.any(ray), any[index]), (closest.is_hit(), closest.is_hit()));
                wide.all(ray, &mut all);
                bvh.all(ray, &mut expected);
                assert_eq!(all, expected);
                assert_eq!(wide.count(ray) as usize, expected.len());
            }
            // Shorter outputs than inputs, and the other way round.
            let mut few = [Hit::MISS; 3];
            wide.closest_batch(&rays, &mut few);
            assert_eq!(few[..], hits[..3]);
            wide.any_batch(&rays[..2], &mut any);
        }
    }
}

#[test]
fn a_scene_is_built_wide_with_its_report() {
    let (_, scene) = scenes().remove(0);
    let options = WideOptions::default();
    let (bvh, wide) = (scene.build(&options.build).unwrap(), scene.build_wide(&options).unwrap());
    let again = WideBvh::from_bvh(&bvh, options.width, options.collapse);
    assert_eq!((wide.children(), wide.triangles()), (again.children(), again.triangles()));
    assert_eq!(wide.stack_entries(), again.stack_entries());
    assert_eq!(wide.bounds(), bvh.bounds());
    let (bvh, wide, again) = (bvh.report(), wide.report(), again.report());
    assert_eq!((wide.input, wide.triangles, wide.leaves), (bvh.input, bvh.triangles, bvh.leaves));
    assert_eq!((again.flatten_time, again.sah_cost), (bvh.flatten_time, wide.sah_cost));
    assert!(again.build_time >= bvh.build_time && wide.depth < bvh.depth && wide.sah_cost < bvh.sah_cost);

    let cancelled = scene.build_wide_monitored(&options, &|_: usize, _: usize| ControlFlow::Break(()));
    assert_eq!(cancelled.unwrap_err(), BuildError::Cancelled);
    let wrong = WideOptions { build: BuildOptions { max_leaf: 0, ..options.build }, ..options };
    assert!(scene.build_wide(&wrong).unwrap_err().to_string().contains("max-leaf"));
    let empty = Scene::default().build_wide(&options).unwrap();
    assert!(empty.children().is_empty() && !empty.closest(&Ray::new(Vec3::ZERO, Vec3::X)).is_hit());
}

/// What the catalogue does not have is refused, with what it has.
#[test]
fn what_is_not_offered_is_refused() {
    let wide = scenes().remove(0).1.build_wide(&WideOptions::default()).unwrap();
    let refuse = |walk| {
        let refused = wide.trace(walk, Query::Closest, &[], TraceOptions::default());
        refused.unwrap_err().to_string()
    };
    for walk in [Walk::Recursive, "stack:order=sorted".parse().unwrap(), trail(2, TrailRegister::U32)] {
        assert!(refuse(walk).contains("stack:order=ordered"), "{}", refuse(walk));
    }
}
