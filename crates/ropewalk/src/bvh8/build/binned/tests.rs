//! Trees of the binned builder: valid, the same for any number of threads and any processor, and as cheap as those of the
//! other builders.

use super::grow::MAX_DEPTH;
use super::*;
#[cfg(feature = "parallel")]
use crate::bvh8::build::check::assert_same_for_any_threads;
use crate::bvh8::build::check::{bits, validate, visits};
use crate::bvh8::tree::MAX_LEVELS;
use crate::wide_bvh::{Collapse, WideBvh, Width};
use crate::{BuildOptions, Builder as BinaryBuilder, Mesh, NoMonitor, Scene};
use glam::Vec3;
use std::ops::ControlFlow;

fn random(seed: u32) -> impl FnMut() -> f32 {
    let mut state = u64::from(seed) << 20 | 0x9e37;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / 16_777_216.0
    }
}

fn scene(positions: Vec<Vec3>) -> Scene {
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Scene::from_mesh(Mesh::new(positions, triangles))
}

fn flat(positions: Vec<Vec3>) -> Vec<FlatTriangle> {
    scene(positions).flatten().unwrap().triangles
}

/// Small triangles everywhere, as large as `size` of the cube of edge 1.
fn soup(triangles: usize, size: f32, seed: u32) -> Vec<Vec3> {
    let mut random = random(seed);
    let mut point = || Vec3::new(random(), random(), random());
    (0..triangles)
        .flat_map(|_| {
            let center = point();
            [(); 3].map(|()| center + size * point())
        })
        .collect()
}

/// A wavy surface of `2 * side * side` triangles.
fn surface(side: usize) -> Vec<Vec3> {
    let point = |x: usize, y: usize| {
        let [x, y] = [x, y].map(|step| step as f32 / side as f32);
        Vec3::new(x, y, 0.1 * (9.0 * x).sin() * (7.0 * y + 3.0 * x * x).cos())
    };
    let quads = (0..side).flat_map(|x| (0..side).map(move |y| (x, y)));
    quads
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [point(x, y), point(x + 1, y), point(x, y + 1), point(x + 1, y + 1)];
            [a, b, c, c, b, d]
        })
        .collect()
}

fn build(triangles: &[FlatTriangle], options: &BinnedOptions) -> Tree {
    build_binned(triangles, options, &NoMonitor).unwrap()
}

/// A tree in numbers that tell whether two are the same.
fn levels(tree: &Tree) -> u32 {
    let mut levels = vec![1; tree.nodes.len()];
    for (index, node) in tree.nodes.iter().enumerate() {
        for child in node.children.iter().filter(|child| !child.is_leaf() && !child.is_nothing()) {
            levels[child.link as usize] = levels[index] + 1;
        }
    }
    levels.into_iter().max().unwrap_or(0)
}

#[test]
fn trees_of_any_size_are_valid() {
    for options in [BinnedOptions::BALANCED, BinnedOptions::FAST] {
        for count in (0..40).chain([63, 64, 65, 200, 1000, 8191, 8192, 8193, 20_000]) {
            for max_leaf in [1, 3, 4, 8] {
                let smallest_split = options.smallest_split.min(max_leaf);
                let options = BinnedOptions { max_leaf, smallest_split, ..options };
                let triangles = flat(soup(count, 0.1, count as u32));
                let tree = build(&triangles, &options);
                assert_eq!(validate(&tree, &triangles), Ok(()), "{count} {max_leaf}");
                let leaves = tree.nodes.iter().flat_map(|node| &node.children);
                assert!(leaves.map(|child| child.count).max().unwrap_or(0) <= max_leaf);
            }
        }
    }
}

#[test]
fn hard_scenes_are_built() {
    let mut random = random(5);
    let mut point = || Vec3::new(random(), random(), random());
    let small = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner * 1e-3);
    let at = |count: usize, place: &dyn Fn(usize) -> Vec3| -> Vec<Vec3> {
        (0..count).flat_map(|index| small.map(|corner| place(index) + corner)).collect()
    };
    let line =
        |axis: Vec3| (0..9000).flat_map(|i| [0.0, 0.3, 0.7].map(|step| axis * (i as f32 + step))).collect();
    let cases: Vec<(&str, Vec<Vec3>)> = vec![
        ("all equal", at(20_000, &|_| Vec3::ONE)),
        (
            "almost all equal",
            at(20_000, &|index| if index < 9 { Vec3::splat(index as f32) } else { Vec3::ONE }),
        ),
        ("a line along x", line(Vec3::X)),
        ("a line along z", line(Vec3::Z)),
        ("a slanted line", line(Vec3::new(0.3, -0.5, 0.9))),
        ("huge", soup(10_000, 0.2, 1).into_iter().map(|at| (at - 0.5) * 1.6e12).collect()),
        ("tiny", soup(10_000, 0.2, 2).into_iter().map(|at| (at - 0.5) * 1e-30).collect()),
        ("below the normal numbers", soup(9_000, 0.2, 3).into_iter().map(|at| at * 1e-39).collect()),
        ("far away", soup(9_000, 0.1, 4).into_iter().map(|at| at + 1e7).collect()),
        (
            "every scale",
            at(12_000, &|index| {
                Vec3::splat(2.0_f32.powi(-(index as i32 % 120)) * (1.0 + index as f32 * 1e-5))
            }),
        ),
        (
            "needles",
            (0..9000)
                .flat_map(|_| {
                    let from = point();
                    [from, from + 100.0 * point(), from + 1e-5 * point()]
                })
                .collect(),
        ),
        (
            "one large one over many small ones",
            [Vec3::ZERO, Vec3::X * 100.0, Vec3::Y * 100.0].into_iter().chain(soup(9_000, 0.01, 6)).collect(),
        ),
    ];
    for (name, positions) in cases {
        let triangles = flat(positions);
        assert!(!triangles.is_empty(), "{name}");
        for options in [BinnedOptions::BALANCED, BinnedOptions::FAST] {
            let tree = build(&triangles, &options);
            assert_eq!(validate(&tree, &triangles), Ok(()), "{name}");
            assert!(levels(&tree) <= MAX_LEVELS, "{name}");
        }
    }
}

/// Nothing but halving is left, and eight halves fill a node.
#[test]
fn what_coincides_makes_full_nodes() {
    let triangles = flat((0..4096).flat_map(|_| [Vec3::ZERO, Vec3::X, Vec3::Y]).collect());
    let tree =
        build(&triangles, &BinnedOptions { max_leaf: 8, smallest_split: 8, ..BinnedOptions::BALANCED });
    assert_eq!(validate(&tree, &triangles), Ok(()));
    assert_eq!((levels(&tree), tree.nodes.len()), (3, 1 + 8 + 64));
}

#[test]
fn a_path_never_exceeds_the_cap() {
    // What is left of the levels must hold both sides.
    assert!(fits(0, [1, (1 << 31) - 1]));
    assert!(fits(MAX_DEPTH - 5, [16, 16]) && !fits(MAX_DEPTH - 5, [17, 15]));
    assert!(fits(MAX_DEPTH - 1, [1, 1]) && !fits(MAX_DEPTH - 1, [1, 2]));
    const { assert!(MAX_DEPTH <= MAX_LEVELS) };
    // Ever smaller steps: each plane cuts off a few.
    let positions = (0..3000).flat_map(|index| {
        let x = 1.5_f32.powi(-(index % 170));
        [Vec3::ZERO, Vec3::X * x * 0.1, Vec3::Y * x].map(|corner| corner + Vec3::X * x)
    });
    let triangles = flat(positions.collect());
    let tree = build(&triangles, &BinnedOptions { max_leaf: 1, smallest_split: 1, ..BinnedOptions::FAST });
    assert_eq!(validate(&tree, &triangles), Ok(()));
}

#[test]
fn what_the_processor_can_do_makes_the_same_tree() {
    for (triangles, options) in
        [(flat(soup(30_000, 0.05, 7)), BinnedOptions::BALANCED), (flat(surface(100)), BinnedOptions::FAST)]
    {
        let best = build(&triangles, &options);
        for processor in Processor::all() {
            let other = build_at(&triangles, &options, &NoMonitor, processor).unwrap();
            assert_eq!(bits(&best), bits(&other), "{processor:?}");
        }
    }
}

#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_makes_the_same_tree() {
    // Enough to bin in parallel.
    let triangles = flat(soup(100_000, 0.02, 8));
    for options in [BinnedOptions::BALANCED, BinnedOptions::FAST] {
        assert_same_for_any_threads(&triangles, || build(&triangles, &options));
    }
}

/// The expected visits of nodes and leaves of a binary tree that was collapsed in the best way.
fn visits_of_collapsed(scene: &Scene, builder: BinaryBuilder) -> f64 {
    let build = BuildOptions { builder, max_leaf: 4, ..BuildOptions::default() };
    let wide = WideBvh::from_bvh(&scene.build(&build).unwrap(), Width::Eight, Collapse::Sah);
    let children = wide.children().iter().filter(|child| child.count > 0 || child.link > 0);
    let area: f64 = children.map(|child| f64::from(child.bounds().half_area())).sum();
    1.0 + area / f64::from(wide.bounds().half_area())
}

/// The collapsed ones have leaves of up to 4, which are more: most so where triangles overlap.
#[test]
fn trees_cost_less_than_those_of_the_other_builders() {
    for (name, positions, margin) in [
        ("surface", surface(120), 0.88),
        ("soup", soup(20_000, 0.03, 9), 0.91),
        ("crowd", soup(9_000, 0.3, 10), 0.59),
    ] {
        let scene = scene(positions);
        let triangles = scene.flatten().unwrap().triangles;
        let [binned, sweep] = [BinaryBuilder::BinnedSah, BinaryBuilder::SweepSah]
            .map(|builder| visits_of_collapsed(&scene, builder));
        let cost = |options: &BinnedOptions| visits(&build(&triangles, options)).iter().sum::<f64>();
        let [balanced, fast] = [BinnedOptions::BALANCED, BinnedOptions::FAST].map(|options| cost(&options));
        println!(
            "{name}: balanced {balanced:.3} fast {fast:.3}, collapsed binned {binned:.3} sweep {sweep:.3}"
        );
        let other = f64::min(binned, sweep);
        assert!(balanced < margin * other, "{name}: {balanced} of {other}");
        assert!(balanced < fast && fast < 1.07 * balanced, "{name}: balanced {balanced}, fast {fast}");
    }
}

#[test]
fn options_out_of_range_are_refused_and_a_build_can_be_cancelled() {
    let triangles = flat(soup(10_000, 0.1, 11));
    let good = BinnedOptions::BALANCED;
    for (bad, name) in [
        (BinnedOptions { bins: 1, ..good }, "bins"),
        (BinnedOptions { bins: 33, ..good }, "bins"),
        (BinnedOptions { max_leaf: 9, ..good }, "max-leaf"),
        (BinnedOptions { smallest_split: good.max_leaf + 1, ..good }, "smallest-split"),
        (BinnedOptions { node_cost: 0, ..good }, "node-cost"),
        (BinnedOptions { leaf_cost: 1001, ..good }, "leaf-cost"),
        (BinnedOptions { triangle_cost: 1001, ..good }, "triangle-cost"),
    ] {
        let error = build_binned(&triangles, &bad, &NoMonitor).unwrap_err();
        assert!(matches!(error, BuildError::Option { option, .. } if option == name), "{name}: {error}");
    }
    let stop = |_: usize, _: usize| ControlFlow::Break(());
    assert_eq!(build_binned(&triangles, &good, &stop).unwrap_err(), BuildError::Cancelled);
    let amounts = Mutex::new(Vec::new());
    let listen = |done: usize, total: usize| {
        amounts.lock().unwrap().push((done, total));
        ControlFlow::Continue(())
    };
    build_binned(&triangles, &good, &listen).unwrap();
    let amounts = amounts.into_inner().unwrap();
    assert_eq!(amounts.iter().max(), Some(&(10_000, 10_000)));
}
