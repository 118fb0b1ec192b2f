//! Two layers: what does not move, and what does.

use super::support::{every, placed, rays};
use ropewalk::traversal_list::{Cull, ListOptions};
use ropewalk::{Query, Scene, TraceOptions, Walk};

#[test]
fn two_layers_answer_as_one() {
    let scene = placed();
    let rays = rays(400);
    for options in every() {
        for cull in [Cull::None, Cull::Exact] {
            let one = scene.build_list(&ListOptions { cull, ..options }).unwrap();
            // The second layer has all instances, two, one, none.
            for moving in [0, 1, 2, 3, 9] {
                let two = scene.build_list(&ListOptions { cull, moving: Some(moving), ..options }).unwrap();
                two.validate().unwrap();
                assert_eq!((one.layers(), two.layers()), (1, 2));
                assert_eq!(two.layer(1).unwrap().triangles().is_empty(), moving >= 3);
                for query in Query::EVERY {
                    let trace = |list: &ropewalk::TraversalList| {
                        list.trace(Walk::List, query, &rays, TraceOptions::default())
                    };
                    assert_eq!(trace(&one), trace(&two), "{query}, {options:?}, from {moving} on");
                }
            }
        }
    }
}

/// What the first layer has found shortens the walk through the second.
#[test]
fn the_second_list_is_shorter_than_alone() {
    let scene = placed();
    let part = |instances: std::ops::Range<usize>| Scene {
        instances: scene.instances[instances].to_vec(),
        ..scene.clone()
    };
    let rays = rays(2000);
    for options in every() {
        let work = |scene: &Scene, moving| {
            let list = scene.build_list(&ListOptions { moving, ..options }).unwrap();
            let traced =
                list.trace(Walk::List, Query::Closest, &rays, TraceOptions { counters: true }).unwrap();
            let totals = traced.totals().unwrap();
            totals.inner_visits + totals.primitive_tests
        };
        let (both, first, second) = (work(&scene, Some(1)), work(&part(0..1), None), work(&part(1..3), None));
        assert!(both - first < second * 9 / 10, "{options:?}: {both}, {first}, {second}");
    }
}
