//! The collapse: from a binary tree to eight-wide nodes, with small subtrees merged into leaves, where that costs least
//! ([`super::cost`]).
//!
//! Nodes come out in depth-first order, a node's own leaves before those of its subtrees.
//!
//! Large subtrees are collapsed side by side and put behind each other, so the tree is the same for any number of
//! threads. Linear in the nodes.

use super::cost::{Cost, ROWS, half_area, spread, weigh};
use crate::Aabb;
use crate::bvh::Node;
use crate::bvh8::tree::{Child, Tree, TreeNode, WIDTH};
use crate::memory::with_capacity;
use crate::parallel::map_chunks;
use crate::processor::Processor;
use std::ops::Range;

/// A subtree of fewer references is collapsed by one thread: half a millisecond.
const SEQUENTIAL: u32 = 1 << 14;

/// What the leaves of the binary tree are.
pub(in crate::bvh8) trait Bottom: Sync {
    /// What such a leaf costs, and how many references it has.
    fn weigh(&self, leaf: &Node) -> Cost;

    /// Its references.
    fn references(&self, leaf: &Node) -> Range<usize>;

    /// The triangle of a reference.
    fn triangle(&self, reference: usize) -> u32;

    /// Adds what stands for the leaf in at most `places` places, 2 to 8; with 8 it is a wide node's children. `whole` is
    /// the leaf in one place.
    fn fill(&self, leaf: &Node, places: usize, whole: Part, cut: &mut Cut);
}

/// Leaves that are leaves: of at most `max_leaf` references each.
pub(in crate::bvh8) struct Plain<'a> {
    /// The triangle of each reference.
    pub(in crate::bvh8) order: &'a [u32],
}

impl Bottom for Plain<'_> {
    fn weigh(&self, leaf: &Node) -> Cost {
        Cost { least: [half_area(leaf); ROWS], references: leaf.count }
    }

    fn references(&self, leaf: &Node) -> Range<usize> {
        leaf.link as usize..leaf.link as usize + leaf.count as usize
    }

    fn triangle(&self, reference: usize) -> u32 {
        self.order[reference]
    }

    fn fill(&self, _leaf: &Node, _places: usize, whole: Part, cut: &mut Cut) {
        cut.push(whole);
    }
}

/// A child of a wide node.
#[derive(Clone, Debug)]
pub(in crate::bvh8) enum Part {
    /// Some references of one leaf of the binary tree.
    Leaf(Aabb, Range<usize>),
    /// The subtree of a binary node: a leaf, where its references fit one, or a wide node.
    Subtree(u32),
}

/// The children of a wide node, at most 8.
#[derive(Default)]
pub(in crate::bvh8) struct Cut {
    parts: [Option<Part>; WIDTH],
    len: usize,
}

impl Cut {
    pub(in crate::bvh8) fn push(&mut self, part: Part) {
        // The shares of a node's places add up to 8, so there is always one left.
        if let Some(place) = self.parts.get_mut(self.len) {
            *place = Some(part);
            self.len += 1;
        }
    }
}

/// The wide nodes that wait for their index: in which place of their parent, and of which binary node.
#[derive(Default)]
struct Inner {
    children: [(usize, u32); WIDTH],
    len: usize,
}

/// Collapses nodes in depth-first order.
pub(in crate::bvh8) fn collapse(nodes: &[Node], max_leaf: u32, bottom: &impl Bottom) -> Tree {
    let costs = weigh(nodes, max_leaf, bottom, Processor::detect());
    let collapse = Collapse { nodes, costs: &costs, max_leaf, bottom };
    let mut tree = Tree::default();
    let Some(all) = costs.first() else { return tree };
    if all.references <= max_leaf {
        let mut root = TreeNode::EMPTY;
        root.set(0, &nodes[0].bounds(), collapse.leaf(0, &mut tree.order));
        tree.nodes.push(root);
        return tree;
    }
    collapse.whole()
}

/// A part of the tree.
enum Piece {
    /// A node and the references of its leaves. The links of its other children are told apart from it.
    Node(Tree),
    /// What is below a binary node.
    Subtree(u32),
}

/// The place of a piece's first node that leads to another piece's.
struct Link {
    piece: usize,
    place: usize,
    to: usize,
}

struct Collapse<'a, B> {
    nodes: &'a [Node],
    costs: &'a [Cost],
    max_leaf: u32,
    bottom: &'a B,
}

impl<B: Bottom> Collapse<'_, B> {
    /// All wide nodes, of which there is at least one.
    fn whole(&self) -> Tree {
        let (pieces, links) = self.pieces();
        let below = map_chunks(&pieces, 1, |_, piece| match piece {
            [Piece::Subtree(root)] => self.sequential(*root),
            _ => Tree::default(),
        });
        let count = |of: fn(&Tree) -> usize| below.iter().map(of).sum::<usize>();
        let mut tree = Tree {
            nodes: with_capacity(pieces.len() + count(|tree| tree.nodes.len())),
            order: with_capacity(self.costs[0].references as usize),
        };
        let mut firsts = Vec::with_capacity(pieces.len());
        for (piece, below) in pieces.into_iter().zip(below) {
            let [node_base, order_base] = [tree.nodes.len() as u32, tree.order.len() as u32];
            firsts.push(node_base);
            let Tree { nodes, order } = match piece {
                Piece::Node(tree) => tree,
                Piece::Subtree(_) => below,
            };
            tree.order.extend(order);
            tree.nodes.extend(nodes.into_iter().map(|mut node| {
                for child in &mut node.children {
                    // Nothing leads to the first node of a subtree, so that link 0 stays nothing.
                    let base = if child.is_leaf() { order_base } else { node_base };
                    child.link += if child.is_nothing() { 0 } else { base };
                }
                node
            }));
        }
        for Link { piece, place, to } in links {
            tree.nodes[firsts[piece] as usize].children[place].link = firsts[to];
        }
        tree
    }

    /// The nodes of many references and the subtrees of few below them, in depth-first order, and what leads from one to the other.
    fn pieces(&self) -> (Vec<Piece>, Vec<Link>) {
        let (mut pieces, mut links) = (Vec::new(), Vec::new());
        let mut pending: Vec<(u32, Option<(usize, usize)>)> = vec![(0, None)];
        while let Some((root, waiting)) = pending.pop() {
            let to = pieces.len();
            links.extend(waiting.map(|(piece, place)| Link { piece, place, to }));
            if self.costs[root as usize].references <= SEQUENTIAL {
                pieces.push(Piece::Subtree(root));
                continue;
            }
            let mut order = Vec::new();
            let (node, inner) = self.node(root, &mut order);
            pieces.push(Piece::Node(Tree { nodes: vec![node], order }));
            let inner = inner.children[..inner.len].iter().rev();
            pending.extend(inner.map(|&(place, child)| (child, Some((to, place)))));
        }
        (pieces, links)
    }

    fn sequential(&self, root: u32) -> Tree {
        let references = self.costs[root as usize].references as usize;
        // Nodes have about 6 children and leaves about 3 references.
        let mut tree =
            Tree { nodes: Vec::with_capacity(references / 10 + 1), order: Vec::with_capacity(references) };
        // Binary nodes that become wide ones, and the places that wait for their indices.
        let mut pending: Vec<(u32, Option<(usize, usize)>)> = vec![(root, None)];
        while let Some((root, waiting)) = pending.pop() {
            let this = tree.nodes.len();
            if let Some((parent, place)) = waiting {
                tree.nodes[parent].children[place].link = this as u32;
            }
            let (node, inner) = self.node(root, &mut tree.order);
            tree.nodes.push(node);
            let inner = inner.children[..inner.len].iter().rev();
            pending.extend(inner.map(|&(place, child)| (child, Some((this, place)))));
        }
        tree
    }

    /// The wide node that a binary node becomes, with its leaves, and which children it waits for.
    fn node(&self, root: u32, order: &mut Vec<u32>) -> (TreeNode, Inner) {
        let mut node = TreeNode::EMPTY;
        let mut inner = Inner::default();
        let cut = self.cut(root);
        for (place, part) in cut.parts.into_iter().flatten().enumerate() {
            match part {
                Part::Leaf(bounds, references) => {
                    let first = order.len();
                    order.extend(references.map(|reference| self.bottom.triangle(reference)));
                    node.set(place, &bounds, Child::leaf(first as u32, (order.len() - first) as u32));
                }
                Part::Subtree(index) => {
                    let child = if self.costs[index as usize].references <= self.max_leaf {
                        self.leaf(index, order)
                    } else {
                        inner.children[inner.len] = (place, index);
                        inner.len += 1;
                        Child::NOTHING
                    };
                    node.set(place, &self.nodes[index as usize].bounds(), child);
                }
            }
        }
        (node, inner)
    }

    /// Merges a subtree into a leaf.
    fn leaf(&self, index: u32, order: &mut Vec<u32>) -> Child {
        let first = order.len();
        let mut left = self.costs[index as usize].references as usize;
        // In depth-first order a subtree's leaves follow its root.
        for leaf in self.nodes[index as usize..].iter().filter(|node| node.is_leaf()) {
            let references = self.bottom.references(leaf);
            left = left.saturating_sub(references.len());
            order.extend(references.map(|reference| self.bottom.triangle(reference)));
            if left == 0 {
                break;
            }
        }
        Child::leaf(first as u32, (order.len() - first) as u32)
    }

    /// The children of the wide node that a node becomes.
    fn cut(&self, root: u32) -> Cut {
        let mut cut = Cut::default();
        let node = &self.nodes[root as usize];
        if node.is_leaf() {
            self.bottom.fill(node, WIDTH, Part::Subtree(root), &mut cut);
            return cut;
        }
        let (first, second) = (root + 1, node.link);
        let (_, share) = spread(&self.costs[first as usize], &self.costs[second as usize], WIDTH);
        self.fill(first, share, &mut cut);
        self.fill(second, WIDTH - share, &mut cut);
        cut
    }

    /// Adds the children that stand for a subtree in at most `places` places. At most [`WIDTH`] calls deep.
    fn fill(&self, index: u32, mut places: usize, cut: &mut Cut) {
        let node = &self.nodes[index as usize];
        if node.is_leaf() && places > 1 {
            return self.bottom.fill(node, places, Part::Subtree(index), cut);
        }
        let least = &self.costs[index as usize].least;
        while places > 1 {
            let (first, second) = (index + 1, node.link);
            let (cost, share) = spread(&self.costs[first as usize], &self.costs[second as usize], places);
            // Of equals the one that uses the places.
            if cost <= least[places - 2] {
                self.fill(first, share, cut);
                return self.fill(second, places - share, cut);
            }
            places -= 1;
        }
        cut.push(Part::Subtree(index));
    }
}
