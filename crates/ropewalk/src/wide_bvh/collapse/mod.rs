//! Collapse: a binary tree becomes a wide one.
//!
//! A wide node stands for a binary inner node and some of its descendants; its children are the nodes of a cut below
//! it. The ways to collapse differ in the [`Cut`] that they choose and in nothing else. Boxes, leaves and the
//! triangles' order stay as they are, and so do the order of the leaves within the tree and the hits.
//!
//! Wide nodes lie in depth-first order, children in that of the binary tree. One thread; the time is linear in the
//! nodes.

mod area;
mod sah;

use super::{Collapse, EMPTY, Width};
use crate::bvh::Node;
use area::LargestArea;
use bytemuck::Zeroable;
use sah::LeastCost;

/// Chooses the children of wide nodes.
trait Cut {
    /// Replaces `cut` by between 2 and `width` nodes below the inner node `root`, in depth-first order, whose subtrees
    /// hold all of its leaves.
    fn choose(&self, root: u32, cut: &mut Vec<u32>);
}

/// The children of the wide nodes that a binary tree makes, in depth-first order. The nodes must be valid.
pub(super) fn collapse(nodes: &[Node], width: Width, how: Collapse) -> Vec<Node> {
    match (how, width) {
        (Collapse::Area, _) => by(nodes, width, &LargestArea { nodes, width: width.children() }),
        (Collapse::Sah, Width::Four) => by(nodes, width, &LeastCost::<3>::new(nodes)),
        (Collapse::Sah, Width::Eight) => by(nodes, width, &LeastCost::<7>::new(nodes)),
    }
}

fn by(nodes: &[Node], width: Width, cuts: &impl Cut) -> Vec<Node> {
    let width = width.children();
    let mut children: Vec<Node> = Vec::new();
    if nodes.is_empty() {
        return children;
    }
    // Binary inner nodes that become wide ones, and the place that waits for the index of each.
    let mut pending: Vec<(u32, Option<usize>)> = vec![(0, None)];
    let mut cut = Vec::with_capacity(width);
    while let Some((root, place)) = pending.pop() {
        let first = children.len();
        if let Some(place) = place {
            children[place].link = (first / width) as u32;
        }
        if nodes[root as usize].is_leaf() {
            // Only the root of the whole tree can be one here.
            cut.push(root);
        } else {
            cuts.choose(root, &mut cut);
        }
        children.extend(cut.iter().map(|&child| {
            let node = nodes[child as usize];
            if node.is_leaf() { node } else { Node { link: EMPTY, ..node } }
        }));
        children.resize(first + width, Node::zeroed());
        let inner = cut.iter().enumerate().filter(|&(_, &child)| !nodes[child as usize].is_leaf());
        pending.extend(inner.map(|(slot, &child)| (child, Some(first + slot))).rev());
    }
    children
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Bvh, MAX_DEPTH};
    use crate::wide_bvh::{MAX_LEVELS, WideBvh, is_empty};
    use crate::{Aabb, BuildOptions, FlatTriangle, Mesh, Scene};
    use glam::Vec3;

    const EVERY: [(Width, Collapse); 4] = [
        (Width::Four, Collapse::Area),
        (Width::Four, Collapse::Sah),
        (Width::Eight, Collapse::Area),
        (Width::Eight, Collapse::Sah),
    ];

    fn strip(triangles: u32, max_leaf: u32) -> Bvh {
        let positions = (0..triangles + 2).map(|i| {
            // Uneven steps, so that areas differ.
            let i = i as f32;
            Vec3::new(i + (i * 12.9898).sin(), (i * 78.233).sin() * 3.0, (i * 37.719).sin())
        });
        let mesh = Mesh::new(positions.collect(), (0..triangles).map(|i| [i, i + 1, i + 2]).collect());
        Scene::from_mesh(mesh).build(&BuildOptions { max_leaf, ..BuildOptions::default() }).unwrap()
    }

    /// The leaves in the order of the tree.
    fn leaves(children: &[Node], width: usize, wide: usize, found: &mut Vec<Node>) {
        for child in children[wide * width..][..width].iter().filter(|child| !is_empty(child)) {
            if child.is_leaf() {
                found.push(*child);
            } else {
                leaves(children, width, child.link as usize, found);
            }
        }
    }

    #[test]
    fn the_leaves_stay_as_they_are_and_the_tree_is_valid() {
        for triangles in [1, 2, 3, 5, 9, 17, 64, 333] {
            for max_leaf in [1, 4] {
                let bvh = strip(triangles, max_leaf);
                for (width, how) in EVERY {
                    let wide = WideBvh::from_bvh(&bvh, width, how);
                    assert_eq!(wide.validate(), Ok(()), "{triangles} {width:?} {how:?}");
                    let mut found = Vec::new();
                    leaves(wide.children(), width.children(), 0, &mut found);
                    let expected: Vec<Node> =
                        bvh.nodes().iter().filter(|node| node.is_leaf()).copied().collect();
                    assert_eq!(found, expected, "{triangles} {width:?} {how:?}");
                    assert_eq!(wide.bounds(), bvh.bounds());
                    let (wide, bvh) = (wide.report(), bvh.report());
                    assert_eq!((wide.leaves, wide.largest_leaf), (bvh.leaves, bvh.largest_leaf));
                    assert!(wide.depth <= bvh.depth.max(1) && wide.nodes <= bvh.nodes.max(2));
                }
            }
        }
    }

    /// Depth first: the first inner child is the next wide node, and each subtree ends where the next begins.
    #[test]
    fn wide_nodes_lie_in_depth_first_order() {
        fn end(children: &[Node], width: usize, wide: usize) -> usize {
            let inner = children[wide * width..][..width].iter().filter(|it| !it.is_leaf() && !is_empty(it));
            inner.fold(wide + 1, |next, child| {
                assert_eq!(child.link as usize, next);
                end(children, width, next)
            })
        }
        let bvh = strip(500, 2);
        for (width, how) in EVERY {
            let wide = WideBvh::from_bvh(&bvh, width, how);
            let children = wide.children();
            assert_eq!(end(children, width.children(), 0) * width.children(), children.len());
        }
    }

    #[test]
    fn one_leaf_becomes_a_node_with_one_child_and_nothing_stays_nothing() {
        let bvh = strip(1, 4);
        assert_eq!(bvh.nodes().len(), 1);
        let empty = Scene::default().build(&BuildOptions::default()).unwrap();
        for (width, how) in EVERY {
            let wide = WideBvh::from_bvh(&bvh, width, how);
            assert_eq!(wide.children().len(), width.children());
            assert_eq!(wide.children()[0], bvh.nodes()[0]);
            assert!(wide.children()[1..].iter().all(is_empty));
            assert_eq!((wide.report().depth, wide.report().nodes, wide.stack_entries()), (1, 2, 0));
            let wide = WideBvh::from_bvh(&empty, width, how);
            assert_eq!((wide.children().len(), wide.report().depth, wide.validate()), (0, 0, Ok(())));
        }
    }

    /// Every inner node has a leaf first: the deepest tree there is.
    #[test]
    fn the_deepest_chain_is_collapsed() {
        let unit = Aabb::new(Vec3::ZERO, Vec3::ONE);
        let mut nodes = Vec::new();
        for level in 0..MAX_DEPTH {
            nodes.push(Node::inner(&unit, 2 * level + 2));
            nodes.push(Node::leaf(&unit, level, 1));
        }
        nodes.push(Node::leaf(&unit, MAX_DEPTH, 1));
        let triangles = (0..=MAX_DEPTH).map(|primitive| FlatTriangle {
            primitive,
            v1: [1.0, 0.0, 0.0],
            v2: [0.0, 1.0, 0.0],
            ..FlatTriangle::zeroed()
        });
        let bvh = Bvh::from_parts(nodes, triangles.collect()).unwrap();
        for (width, how) in EVERY {
            let wide = WideBvh::from_bvh(&bvh, width, how);
            assert_eq!(wide.validate(), Ok(()));
            // Each wide node takes all but one of its places from the chain.
            let expected = MAX_DEPTH.div_ceil(width.children() as u32 - 1);
            assert_eq!(wide.report().depth, expected, "{width:?} {how:?}");
            assert!(wide.report().depth <= MAX_LEVELS);
            assert_eq!(wide.stack_entries(), MAX_DEPTH);
        }
    }
}
