use super::*;
use crate::bvh8::build::check::{bits, largest_leaf, validate, visits};
use crate::{Builder, Mesh, NoMonitor, Scene};
use glam::Vec3;
use std::ops::ControlFlow;

/// Triangles in a cube of edge 4, whose edges are `size` long at most.
pub(in crate::bvh8) fn soup(triangles: u32, seed: u32, size: f32) -> Vec<FlatTriangle> {
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    let corners = (0..triangles).flat_map(|_| {
        let center = Vec3::new(random(), random(), random()) * 4.0;
        [(); 3].map(|()| center + Vec3::new(random(), random(), random()) * size)
    });
    flat(corners.collect())
}

/// Triangles of every three points.
pub(in crate::bvh8) fn flat(points: Vec<Vec3>) -> Vec<FlatTriangle> {
    let triangles = (0..points.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Scene::from_mesh(Mesh::new(points, triangles)).flatten().unwrap().triangles
}

/// What makes builders stumble, with a name each.
pub(in crate::bvh8) fn hard_cases() -> Vec<(&'static str, Vec<FlatTriangle>)> {
    let unit = |at: Vec3, size: f32| [at, at + Vec3::X * size, at + Vec3::Y * size];
    let many =
        |count: u32, of: &dyn Fn(f32) -> [Vec3; 3]| flat((0..count).flat_map(|i| of(i as f32)).collect());
    vec![
        ("nothing", Vec::new()),
        ("one", many(1, &|_| unit(Vec3::ZERO, 1.0))),
        ("a leaf", many(4, &|i| unit(Vec3::X * i, 1.0))),
        ("one more than a leaf", many(5, &|i| unit(Vec3::X * i, 1.0))),
        ("all the same", many(1000, &|_| unit(Vec3::ONE, 1.0))),
        (
            "all centres the same",
            many(500, &|i| {
                [Vec3::new(-i - 1.0, -1.0, 0.0), Vec3::new(i + 1.0, -1.0, 0.0), Vec3::new(0.0, 1.0, 0.0)]
            }),
        ),
        ("along a line", many(777, &|i| unit(Vec3::Z * i, 0.5))),
        ("ever smaller", many(60, &|i| unit(Vec3::splat(2.0_f32.powf(-i)), 2.0_f32.powf(-i)))),
        ("ever larger, all overlapping", many(100, &|i| unit(Vec3::ZERO, 1.2_f32.powf(i)))),
        (
            "needles across each other",
            many(400, &|i| {
                let turn = Vec3::new((i * 0.7).sin(), (i * 1.3).cos(), (i * 2.9).sin());
                [turn * 100.0, turn * -100.0, turn * 100.0 + Vec3::splat(1e-3)]
            }),
        ),
        ("tiny", many(200, &|i| unit(Vec3::splat(i * 1e-30), 1e-30))),
        ("huge", many(200, &|i| unit(Vec3::new(i * 1e9, -i * 4e9, 7e11), 1e11))),
        ("far from the origin", many(300, &|i| unit(Vec3::new(1e7 + i, 1e7, 1e7), 3.0))),
        (
            "a crowd in a corner of a desert",
            many(900, &|i| {
                if i == 0.0 {
                    unit(Vec3::ZERO, 1e6)
                } else {
                    unit(Vec3::new((i * 0.37).sin(), (i * 0.11).cos(), i * 1e-3), 1e-2)
                }
            }),
        ),
        ("a floor", many(640, &|i| unit(Vec3::new(i % 32.0, (i / 32.0).floor(), 0.0), 1.0))),
    ]
}

#[test]
fn trees_are_valid_whatever_comes() {
    for (name, triangles) in hard_cases() {
        for options in [
            ReinsertedOptions::default(),
            ReinsertedOptions { max_leaf: 1, smallest_split: 1, reinsertion: 3 },
            ReinsertedOptions { max_leaf: 8, smallest_split: 8, reinsertion: 0 },
        ] {
            let tree = build_reinserted(&triangles, &options, &NoMonitor).unwrap();
            assert_eq!(validate(&tree, &triangles), Ok(()), "{name}, {options:?}");
            assert!(largest_leaf(&tree) <= options.max_leaf, "{name}, {options:?}");
        }
    }
}

#[test]
fn one_leaf_is_one_node_with_one_child() {
    let triangles = soup(4, 3, 1.0);
    let tree = build_reinserted(&triangles, &ReinsertedOptions::default(), &NoMonitor).unwrap();
    assert_eq!((tree.nodes.len(), tree.nodes[0].len(), tree.nodes[0].children[0].count), (1, 1, 4));
}

#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_makes_the_same_tree() {
    // Large enough for every parallel path.
    let triangles = soup(90_000, 5, 0.6);
    let build = || build_reinserted(&triangles, &ReinsertedOptions::default(), &NoMonitor).unwrap();
    crate::bvh8::build::check::assert_same_for_any_threads(&triangles, build);
}

/// Against the binary SBVH builder with sweeps and the collapse of least cost, by the same model.
#[test]
fn it_costs_no_more_than_the_slow_builder() {
    for (seed, size) in [(1, 0.1), (2, 0.5), (3, 2.0)] {
        let triangles = soup(3000, seed, size);
        let ours = build_reinserted(&triangles, &ReinsertedOptions::default(), &NoMonitor).unwrap();
        let options = BuildOptions {
            builder: Builder::Sbvh,
            duplication: 30,
            reinsertion: 2,
            ..BuildOptions::default()
        };
        let (nodes, order) = crate::bvh::tree_over(&triangles, &options, &NoMonitor).unwrap();
        let theirs = collapse::collapse(&nodes, 4, &Plain { order: &order });
        let [ours, theirs] = [ours, theirs].map(|tree| visits(&tree).iter().sum::<f64>());
        assert!(ours <= theirs * 1.03, "{seed} {size}: {ours} {theirs}");
    }
}

#[test]
fn options_out_of_range_are_named() {
    let wrong = [
        (ReinsertedOptions { max_leaf: 9, ..ReinsertedOptions::default() }, "max-leaf"),
        (ReinsertedOptions { max_leaf: 0, ..ReinsertedOptions::default() }, "max-leaf"),
        (ReinsertedOptions { max_leaf: 3, ..ReinsertedOptions::default() }, "smallest-split"),
        (ReinsertedOptions { reinsertion: 33, ..ReinsertedOptions::default() }, "reinsertion"),
    ];
    for (options, name) in wrong {
        let error = build_reinserted(&[], &options, &NoMonitor).unwrap_err();
        assert!(matches!(error, BuildError::Option { option, .. } if option == name), "{error}");
    }
}

#[test]
fn a_monitor_can_cancel() {
    let triangles = soup(20_000, 9, 0.1);
    let stop = |_: usize, _: usize| ControlFlow::Break(());
    let error = build_reinserted(&triangles, &ReinsertedOptions::default(), &stop).unwrap_err();
    assert_eq!(error, BuildError::Cancelled);
}

#[test]
fn what_the_processor_can_do_makes_the_same_tree() {
    let triangles = soup(40_000, 11, 0.1);
    let options = ReinsertedOptions::default();
    let best = build_reinserted(&triangles, &options, &NoMonitor).unwrap();
    let (nodes, order) = builder::build(&triangles, 4, &NoMonitor, Processor::detect()).unwrap();
    let least = |processor| {
        let costs = cost::weigh(&nodes, 8, &Plain { order: &order }, processor);
        costs.iter().flat_map(|cost| cost.least.map(f32::to_bits)).collect::<Vec<_>>()
    };
    for processor in Processor::all() {
        let other = build_at(&triangles, &options, &NoMonitor, processor).unwrap();
        assert_eq!(bits(&best), bits(&other), "{processor:?}");
        assert_eq!(least(Processor::Any), least(processor), "{processor:?}");
    }
}
