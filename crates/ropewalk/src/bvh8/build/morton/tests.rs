use super::{MortonOptions, build_morton};
use crate::bvh8::build::check::{largest_leaf, validate, visits};
use crate::bvh8::build::reinserted::collapse::{Plain, collapse};
use crate::bvh8::build::reinserted::tests::{hard_cases, soup};
use crate::{BuildError, BuildOptions, NoMonitor};
use std::ops::ControlFlow;

#[test]
fn trees_are_valid_whatever_comes() {
    for (name, triangles) in hard_cases() {
        for max_leaf in [1, 3, 4, 8] {
            let tree = build_morton(&triangles, &MortonOptions { max_leaf }, &NoMonitor).unwrap();
            assert_eq!(validate(&tree, &triangles), Ok(()), "{name}, {max_leaf}");
            assert!(largest_leaf(&tree) <= max_leaf, "{name}, {max_leaf}");
        }
    }
}

#[test]
fn one_leaf_is_one_node_with_one_child() {
    let triangles = soup(4, 3, 1.0);
    let tree = build_morton(&triangles, &MortonOptions::default(), &NoMonitor).unwrap();
    assert_eq!((tree.nodes.len(), tree.nodes[0].len(), tree.nodes[0].children[0].count), (1, 1, 4));
}

#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_makes_the_same_tree() {
    // Large enough that several threads sort.
    let triangles = soup(150_000, 5, 0.1);
    let build = || build_morton(&triangles, &MortonOptions::default(), &NoMonitor).unwrap();
    crate::bvh8::build::check::assert_same_for_any_threads(&triangles, build);
}

/// Against the binned SAH builder and the collapse of least cost, by the same model.
#[test]
fn it_costs_little_more_than_binned_sah() {
    for (seed, size) in [(1, 0.1), (2, 0.5)] {
        let triangles = soup(5000, seed, size);
        let ours = build_morton(&triangles, &MortonOptions::default(), &NoMonitor).unwrap();
        let (nodes, order) = crate::bvh::tree_over(&triangles, &BuildOptions::default(), &NoMonitor).unwrap();
        let theirs = collapse(&nodes, 4, &Plain { order: &order });
        let [ours, theirs] = [ours, theirs].map(|tree| visits(&tree).iter().sum::<f64>());
        assert!(ours <= theirs * 1.25, "{seed} {size}: {ours} {theirs}");
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
