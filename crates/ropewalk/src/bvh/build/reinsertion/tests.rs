//! The search against trying every place, moves against measuring the whole tree, and odd numbers.

use super::*;
use crate::bvh::BuildReport;
use crate::bvh::build::reference::{Extent, Reference, of_triangles};
use crate::{FlatTriangle, NoMonitor};
use bytemuck::Zeroable;
use glam::Vec3;
use tree::{ROOT, sibling};

/// A small generator of numbers between -1 and 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        (self.0 >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    }

    fn point(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

/// Triangles of up to `size` in a cube from -1 to 1, in no order.
fn soup(count: usize, size: f32, seed: u64) -> Vec<FlatTriangle> {
    let mut numbers = Numbers(seed);
    let triangle = |index| {
        let center = numbers.point();
        let mut corner = || (center + numbers.point() * size).into();
        let (v0, v1, v2) = (corner(), corner(), corner());
        FlatTriangle { v0, v1, v2, primitive: index as u32, ..FlatTriangle::zeroed() }
    };
    (0..count).map(triangle).collect()
}

fn scaled(triangles: &[FlatTriangle], scale: Vec3) -> Vec<FlatTriangle> {
    let corner = |corner: [f32; 3]| (Vec3::from(corner) * scale).into();
    let map = |old: &FlatTriangle| FlatTriangle {
        v0: corner(old.v0),
        v1: corner(old.v1),
        v2: corner(old.v2),
        ..*old
    };
    triangles.iter().map(map).collect()
}

/// A tree that halves the triangles as they come: a bad one. `share` of 256 go first; with 0 it is a chain.
fn as_they_come(triangles: &[FlatTriangle], share: usize) -> Vec<Node> {
    fn build(references: &[Reference], first: usize, share: usize, nodes: &mut Vec<Node>) {
        let mut extent = Extent::EMPTY;
        references.iter().for_each(|reference| extent.add(reference));
        let count = references.len();
        if count == 1 {
            nodes.push(Node::leaf(&extent.bounds(), first as u32, 1));
            return;
        }
        let this = nodes.len();
        nodes.push(Node::inner(&extent.bounds(), 0));
        let middle = (count * share / 256).max(1);
        build(&references[..middle], first, share, nodes);
        nodes[this].link = nodes.len() as u32;
        build(&references[middle..], first + middle, share, nodes);
    }
    let mut nodes = Vec::new();
    build(&of_triangles(triangles), 0, share, &mut nodes);
    nodes
}

fn rounds(reinsertion: u32, max_depth: u32) -> BuildOptions {
    BuildOptions { reinsertion, max_depth, ..BuildOptions::default() }
}

/// Optimises and gives back the nodes with the triangles in leaf order, validated.
fn optimised(
    nodes: &[Node],
    triangles: &[FlatTriangle],
    options: &BuildOptions,
) -> (Vec<Node>, Vec<FlatTriangle>) {
    let mut references = of_triangles(triangles);
    let nodes = optimise(nodes, &mut references, options, &NoMonitor).unwrap();
    let triangles: Vec<_> = references.iter().map(|reference| triangles[reference.index()]).collect();
    crate::bvh::validate::validate(&nodes, &triangles).unwrap();
    (nodes, triangles)
}

fn report(nodes: &[Node], triangles: &[FlatTriangle]) -> BuildReport {
    BuildReport::measure(nodes, triangles, triangles.len())
}

/// The inner nodes of a tree, downwards from the root. Panics when links, ways up, heights or boxes disagree.
fn inner_nodes(tree: &Tree) -> Vec<u32> {
    let (mut inner, mut pending) = (Vec::new(), vec![ROOT]);
    while let Some(slot) = pending.pop() {
        let node = tree.node(slot);
        if node.is_leaf() {
            assert_eq!(tree.height(slot), 0);
            continue;
        }
        let children = [node.link, sibling(node.link)];
        assert!(children.iter().all(|&child| tree.parent(child) == slot));
        assert_eq!(
            tree.height(slot),
            1 + children.map(|child| tree.height(child)).into_iter().max().unwrap()
        );
        let union = tree.extent(children[0]).union(tree.extent(children[1])).bounds();
        assert_eq!(node.bounds(), union, "the box of {slot}");
        inner.push(slot);
        pending.extend(children);
    }
    inner
}

fn inner_area(tree: &Tree) -> f64 {
    inner_nodes(tree).iter().map(|&slot| f64::from(tree.area(slot))).sum()
}

/// Every possible move of a small tree, made and measured: the mover must tell the truth, and the search must find
/// the best one.
#[test]
fn the_search_finds_the_best_of_all_places() {
    let (mut found_any, mut found_none) = (0, 0);
    for (seed, share) in [(1, 128), (2, 100), (3, 40), (4, 0), (5, 200)] {
        let tree = Tree::new(&as_they_come(&soup(14, 0.2, seed), share));
        let before = inner_area(&tree);
        let mut everything = Mover::new(64, f64::NEG_INFINITY);
        for moved in tree.slots() {
            let mut best = 0.0;
            for target in std::iter::once(ROOT).chain(tree.slots()) {
                let mut changed = tree.clone();
                let one = Move { moved, target, gain: 0.0 };
                let Some(gain) = everything.apply(&mut changed, one) else { continue };
                let measured = before - inner_area(&changed);
                assert!((gain - measured).abs() < 1e-5, "{moved} to {target}: {gain} is {measured}");
                best = f64::max(best, measured);
            }
            let search = Search::new(&tree).best_move(moved, 1e-4);
            let gain = search.map_or(0.0, |found| f64::from(found.gain));
            assert!((gain - best).abs() < 2e-4, "{moved}: found {search:?}, there is {best}");
            assert!(
                best <= f64::from(promise(&tree, moved)) + 1e-4,
                "{moved} may gain more than it promises"
            );
            *(if search.is_some() { &mut found_any } else { &mut found_none }) += 1;
        }
    }
    assert!(found_any > 50 && found_none > 5, "{found_any} {found_none}");
}

/// Many moves on one tree, good and bad ones: it stays a tree.
#[test]
fn a_tree_stays_a_tree_whatever_is_moved() {
    let triangles = soup(40, 0.3, 6);
    let mut tree = Tree::new(&as_they_come(&triangles, 128));
    let mut mover = Mover::new(12, f64::NEG_INFINITY);
    let mut numbers = Numbers(7);
    let mut made = 0;
    for _ in 0..5000 {
        let mut slot = || {
            let slot = ((numbers.next() + 1.0) * tree.slots().end as f32 / 2.0) as u32;
            if tree.slots().contains(&slot) { slot } else { ROOT }
        };
        let one = Move { moved: slot(), target: slot(), gain: 0.0 };
        made += u32::from(mover.apply(&mut tree, one).is_some());
        assert_eq!(inner_nodes(&tree).len(), 39);
        assert!(tree.height(ROOT) <= 12);
    }
    assert!((1000..4000).contains(&made), "{made}");
}

#[test]
fn a_bad_tree_becomes_a_good_one() {
    let triangles = soup(3000, 0.01, 8);
    let bad = as_they_come(&triangles, 128);
    let options = rounds(0, 64);
    let mut references = of_triangles(&triangles);
    let good = crate::bvh::build::binned_sah::build(&mut references, &options, &NoMonitor).unwrap();
    let good = BuildReport::measure(&good, &triangles, triangles.len()).sah_cost;
    let mut last = report(&bad, &triangles).sah_cost;
    assert!(last > 10.0 * good, "{last} is not bad beside {good}");
    for reinsertion in [1, 2, 3, 4, 8, 16, 32] {
        let (nodes, ordered) = optimised(&bad, &triangles, &rounds(reinsertion, 64));
        let cost = report(&nodes, &ordered).sah_cost;
        assert!(cost < last || reinsertion > 8 && cost == last, "{reinsertion} rounds: {cost} after {last}");
        last = cost;
    }
    assert!(last < 1.2 * good, "{last} beside {good}");
}

#[test]
fn the_depth_cap_is_kept_by_chains_and_others() {
    let triangles = soup(30, 0.02, 9);
    for share in [0, 30, 128, 240] {
        let nodes = as_they_come(&triangles, share);
        let before = report(&nodes, &triangles);
        for max_depth in [before.depth, before.depth + 1, 64] {
            let (nodes, ordered) = optimised(&nodes, &triangles, &rounds(5, max_depth));
            let after = report(&nodes, &ordered);
            assert!(after.depth <= max_depth, "{share}: {} deep, not {max_depth}", after.depth);
            assert!(after.sah_cost < before.sah_cost);
        }
    }
}

/// Areas that overflow, vanish, or are zero: the tree stays valid and the cost does not rise.
#[test]
fn numbers_of_any_size_are_served() {
    for scale in [1e30, 1.5e38, 1e19, 1e12, 1e-12, 1e-19, 1e-22, 1e-30, 1e-44] {
        for axes in [Vec3::ONE, Vec3::new(1.0, 0.0, 1.0), Vec3::X, Vec3::new(1.0, 1e-5, 1e5), Vec3::ZERO] {
            let triangles =
                scaled(&soup(200, 0.1, 10), (axes * scale).clamp(Vec3::ZERO, Vec3::splat(1.5e38)));
            let nodes = as_they_come(&triangles, 100);
            let (after, ordered) = optimised(&nodes, &triangles, &rounds(8, 64));
            let costs = [report(&nodes, &triangles).sah_cost, report(&after, &ordered).sah_cost];
            let rises = costs[1] > costs[0];
            assert!(!rises, "{scale:e} {axes}: {costs:?}");
            let ordinary = (1e-12..=1e12).contains(&scale) && axes == Vec3::ONE;
            assert!(!ordinary || costs[1] < 0.8 * costs[0], "{scale:e}: {costs:?}");
        }
    }
}

#[test]
fn all_triangles_alike_gain_nothing_and_end_at_once() {
    let one = soup(1, 0.5, 11)[0];
    let triangles = vec![one; 300];
    let nodes = as_they_come(&triangles, 128);
    let calls = std::sync::atomic::AtomicUsize::new(0);
    let count = |_: usize, _: usize| {
        calls.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    optimise(&nodes, &mut of_triangles(&triangles), &rounds(32, 64), &count).unwrap();
    assert_eq!(calls.into_inner(), 1);
}

#[test]
fn trees_of_few_nodes_are_served() {
    for count in 1..=4 {
        for share in [0, 128, 255] {
            let triangles = soup(count, 0.2, 12);
            let nodes = as_they_come(&triangles, share);
            let (after, ordered) = optimised(&nodes, &triangles, &rounds(32, 64));
            assert_eq!(after.len(), 2 * count - 1);
            assert!(report(&after, &ordered).sah_cost <= report(&nodes, &triangles).sah_cost);
        }
    }
    assert_eq!(optimise(&[], &mut Vec::<Reference>::new(), &rounds(32, 64), &NoMonitor), Ok(Vec::new()));
}

/// Of two near ones and a far one the near ones are siblings afterwards: the one gain that five nodes can have.
#[test]
fn five_nodes_are_paired_up_well() {
    let mut triangles = soup(3, 0.01, 13);
    triangles[0].v0[0] = 0.0;
    let near = triangles[0];
    let shift = |x: f32| scaled(&[near], Vec3::splat(x))[0];
    let triangles = vec![
        shift(1.0),
        FlatTriangle { primitive: 1, ..shift(50.0) },
        FlatTriangle { primitive: 2, ..shift(1.01) },
    ];
    for share in [0, 200] {
        let nodes = as_they_come(&triangles, share);
        let (after, ordered) = optimised(&nodes, &triangles, &rounds(1, 64));
        let second = after[after[0].link as usize];
        let alone = if second.is_leaf() { second } else { after[1] };
        assert_eq!(ordered[alone.link as usize].primitive, 1);
    }
}

#[test]
fn the_monitor_cancels_between_rounds() {
    let triangles = soup(500, 0.01, 14);
    let nodes = as_they_come(&triangles, 128);
    for allowed in 0..3 {
        let calls = std::sync::atomic::AtomicUsize::new(0);
        let stop = |done: usize, total: usize| {
            assert_eq!((done, total), (500, 500));
            let call = calls.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            if call >= allowed { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let mut references = of_triangles(&triangles);
        assert_eq!(optimise(&nodes, &mut references, &rounds(4, 64), &stop), Err(BuildError::Cancelled));
    }
}

/// A tree that breaks a rule does not pass what these tests rely on.
#[test]
fn a_wrong_tree_would_be_noticed() {
    let triangles = soup(50, 0.1, 15);
    let (nodes, ordered) = optimised(&as_they_come(&triangles, 128), &triangles, &rounds(2, 64));
    let is_valid = |nodes: &[Node]| crate::bvh::validate::validate(nodes, &ordered).is_ok();
    assert!(is_valid(&nodes));
    let leaf = nodes.iter().position(Node::is_leaf).unwrap();
    let mut wrong = nodes.clone();
    wrong[leaf].link = (wrong[leaf].link + 1) % 50;
    assert!(!is_valid(&wrong), "a leaf with the triangle of another");
    // The references as the builder left them are not in the order of the leaves any more.
    let mut references = of_triangles(&triangles);
    let untouched = references.clone();
    let moved =
        optimise(&as_they_come(&triangles, 128), &mut references, &rounds(2, 64), &NoMonitor).unwrap();
    let by = |references: &[Reference]| {
        let triangles: Vec<_> = references.iter().map(|reference| triangles[reference.index()]).collect();
        crate::bvh::validate::validate(&moved, &triangles).is_ok()
    };
    assert!(by(&references) && !by(&untouched));
    // A move without its boxes.
    let mut tree = Tree::new(&as_they_come(&triangles, 128));
    let slots = tree.slots();
    let one = slots.clone().find_map(|slot| Search::new(&tree).best_move(slot, 0.01)).unwrap();
    tree.reinsert(one.moved, one.target);
    let mut references = of_triangles(&triangles);
    let nodes = tree.lay_out(&mut references);
    let ordered: Vec<_> = references.iter().map(|reference| triangles[reference.index()]).collect();
    assert!(crate::bvh::validate::validate(&nodes, &ordered).is_err());
}
