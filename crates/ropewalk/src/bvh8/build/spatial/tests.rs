use super::check::{Summary, check};
use super::{SpatialOptions, build_spatial};
use crate::bvh8::tree::Tree;
use crate::{BuildError, BuildOptions, Builder, FlatTriangle, Mesh, NoMonitor, Scene};
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

fn summary(tree: &Tree, triangles: &[FlatTriangle]) -> Summary {
    check(tree, triangles).unwrap()
}

#[test]
fn trees_are_valid_whatever_comes() {
    for (name, triangles) in hard_cases() {
        for options in [
            SpatialOptions::default(),
            SpatialOptions { max_leaf: 1, smallest_split: 1, duplication: 400, reinsertion: 3 },
            SpatialOptions { max_leaf: 8, smallest_split: 8, duplication: 100, reinsertion: 0 },
            SpatialOptions { duplication: 30, ..SpatialOptions::default() },
        ] {
            let tree = build_spatial(&triangles, &options, &NoMonitor).unwrap();
            let found = check(&tree, &triangles).unwrap_or_else(|what| panic!("{name}, {options:?}: {what}"));
            assert!(found.largest_leaf <= options.max_leaf, "{name}, {options:?}");
            let most = triangles.len() + triangles.len() * options.duplication as usize / 100;
            assert!(found.references <= most, "{name}, {options:?}: {}", found.references);
        }
    }
}

#[test]
fn one_leaf_is_one_node_with_one_child() {
    let triangles = soup(4, 3, 1.0);
    let tree = build_spatial(&triangles, &SpatialOptions::default(), &NoMonitor).unwrap();
    assert_eq!((tree.nodes.len(), tree.nodes[0].len(), tree.nodes[0].children[0].count), (1, 1, 4));
}

#[test]
fn the_tree_does_not_depend_on_the_number_of_threads() {
    // Large enough for every parallel path, and with spatial splits.
    let triangles = soup(90_000, 5, 0.6);
    let options = SpatialOptions { duplication: 30, ..SpatialOptions::default() };
    let build = || build_spatial(&triangles, &options, &NoMonitor).unwrap();
    let first = build();
    assert!(first.order.len() > triangles.len());
    summary(&first, &triangles);
    #[cfg(feature = "parallel")]
    for threads in [1, 2, 7] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let other = pool.install(build);
        assert_eq!(first.order, other.order, "{threads}");
        let bytes = |tree: &Tree| -> Vec<_> {
            tree.nodes
                .iter()
                .map(|node| (node.bounds.map(|row| row.map(f32::to_bits)), node.children))
                .collect()
        };
        assert!(bytes(&first) == bytes(&other), "{threads}");
    }
}

/// Against the binary SBVH builder with sweeps and the collapse of least cost, by the same model.
#[test]
fn it_costs_no_more_than_the_slow_builder() {
    for (seed, size) in [(1, 0.1), (2, 0.5), (3, 2.0)] {
        let triangles = soup(3000, seed, size);
        let ours = build_spatial(&triangles, &SpatialOptions::default(), &NoMonitor).unwrap();
        let ours = summary(&ours, &triangles);
        let options = BuildOptions {
            builder: Builder::Sbvh,
            duplication: 30,
            reinsertion: 2,
            ..BuildOptions::default()
        };
        let (nodes, order) = crate::bvh::tree_over(&triangles, &options, &NoMonitor).unwrap();
        let theirs = super::collapse::collapse(&nodes, 4, &super::Plain { order: &order });
        let theirs = summary(&theirs, &triangles);
        assert!(ours.cost <= theirs.cost * 1.03, "{seed} {size}: {ours:?} {theirs:?}");
    }
}

#[test]
fn options_out_of_range_are_named() {
    let wrong = [
        (SpatialOptions { max_leaf: 9, ..SpatialOptions::default() }, "max-leaf"),
        (SpatialOptions { max_leaf: 0, ..SpatialOptions::default() }, "max-leaf"),
        (SpatialOptions { max_leaf: 3, ..SpatialOptions::default() }, "smallest-split"),
        (SpatialOptions { duplication: 401, ..SpatialOptions::default() }, "duplication"),
        (SpatialOptions { reinsertion: 33, ..SpatialOptions::default() }, "reinsertion"),
    ];
    for (options, name) in wrong {
        let error = build_spatial(&[], &options, &NoMonitor).unwrap_err();
        assert!(matches!(error, BuildError::Option { option, .. } if option == name), "{error}");
    }
}

#[test]
fn a_monitor_can_cancel() {
    let triangles = soup(20_000, 9, 0.1);
    let stop = |_: usize, _: usize| ControlFlow::Break(());
    let error = build_spatial(&triangles, &SpatialOptions::default(), &stop).unwrap_err();
    assert_eq!(error, BuildError::Cancelled);
}
