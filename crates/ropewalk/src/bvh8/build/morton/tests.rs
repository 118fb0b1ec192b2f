use super::{MortonOptions, build_morton};
use crate::bvh8::build::spatial::check::check;
use crate::bvh8::build::spatial::collapse::{Plain, collapse};
use crate::bvh8::build::spatial::tests::{hard_cases, soup};
use crate::bvh8::tree::Tree;
use crate::{BuildError, BuildOptions, NoMonitor};
use std::ops::ControlFlow;

#[test]
fn trees_are_valid_whatever_comes() {
    for (name, triangles) in hard_cases() {
        for max_leaf in [1, 3, 4, 8] {
            let tree = build_morton(&triangles, &MortonOptions { max_leaf }, &NoMonitor).unwrap();
            let found = check(&tree, &triangles).unwrap_or_else(|what| panic!("{name}, {max_leaf}: {what}"));
            assert!(found.largest_leaf <= max_leaf, "{name}, {max_leaf}");
            assert_eq!(found.references, triangles.len());
        }
    }
}

#[test]
fn one_leaf_is_one_node_with_one_child() {
    let triangles = soup(4, 3, 1.0);
    let tree = build_morton(&triangles, &MortonOptions::default(), &NoMonitor).unwrap();
    assert_eq!((tree.nodes.len(), tree.nodes[0].len(), tree.nodes[0].children[0].count), (1, 1, 4));
}

#[test]
fn the_tree_does_not_depend_on_the_number_of_threads() {
    // Large enough that several threads sort.
    let triangles = soup(150_000, 5, 0.1);
    let build = || build_morton(&triangles, &MortonOptions::default(), &NoMonitor).unwrap();
    let first = build();
    check(&first, &triangles).unwrap();
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

/// Against the binned SAH builder and the collapse of least cost, by the same model.
#[test]
fn it_costs_little_more_than_binned_sah() {
    for (seed, size) in [(1, 0.1), (2, 0.5)] {
        let triangles = soup(5000, seed, size);
        let ours = build_morton(&triangles, &MortonOptions::default(), &NoMonitor).unwrap();
        let ours = check(&ours, &triangles).unwrap();
        let (nodes, order) = crate::bvh::tree_over(&triangles, &BuildOptions::default(), &NoMonitor).unwrap();
        let theirs = collapse(&nodes, 4, &Plain { order: &order });
        let theirs = check(&theirs, &triangles).unwrap();
        assert!(ours.cost <= theirs.cost * 1.25, "{seed} {size}: {ours:?} {theirs:?}");
    }
}

#[test]
fn options_out_of_range_are_named() {
    for max_leaf in [0, 9] {
        let error = build_morton(&[], &MortonOptions { max_leaf }, &NoMonitor).unwrap_err();
        assert!(matches!(error, BuildError::Option { option: "max-leaf", .. }), "{error}");
    }
}

#[test]
fn a_monitor_can_cancel() {
    let triangles = soup(20_000, 9, 0.1);
    let stop = |_: usize, _: usize| ControlFlow::Break(());
    let error = build_morton(&triangles, &MortonOptions::default(), &stop).unwrap_err();
    assert_eq!(error, BuildError::Cancelled);
}
