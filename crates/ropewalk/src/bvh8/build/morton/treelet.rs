//! Treelets: short ranges of the curve, each with the best ways to cut it into leaves ([`super::cuts`]), and the binary tree
//! above them.
//!
//! A range of the sorted list is halved where the highest bit that its codes differ in changes, or in the middle where
//! they do not differ, until it has at most [`MOST`] triangles. So no leaf of the binary tree is deeper than the 33 bits of a
//! code and the 28 halvings that leave 8 of 2^31 triangles.

use super::code::{INDEX_BITS, corners, index};
use super::cuts::{Cuts, Cutter, MOST, leaves, union};
use crate::bvh::Node;
use crate::bvh::build::reference::Extent;
use crate::bvh8::build::spatial::collapse::{Bottom, Cut, Part};
use crate::bvh8::build::spatial::cost::{Cost, ROWS, half_area};
use crate::bvh8::tree::WIDTH;
use crate::parallel::join;
use crate::progress::Progress;
use crate::{Aabb, BuildError, FlatTriangle, Monitor};
use std::ops::Range;

/// The treelets of a range with fewer triangles are cut by one thread.
const SEQUENTIAL: usize = 1 << 13;

/// A range of the list.
#[derive(Clone, Copy, Debug)]
struct Treelet {
    bounds: Extent,
    first: u32,
    count: u32,
    cuts: Cuts,
}

/// The tree over the treelets that the curve makes.
pub(super) struct Treelets<'a> {
    triangles: &'a [FlatTriangle],
    keys: &'a [u64],
    max_leaf: u32,
    /// In depth-first order. A leaf is one treelet, which it links.
    nodes: Vec<Node>,
    treelets: Vec<Treelet>,
}

/// A part of it. Links count from its first node and its first treelet.
#[derive(Default)]
struct Below {
    nodes: Vec<Node>,
    treelets: Vec<Treelet>,
}

impl Below {
    /// Two parts under one node.
    fn joined(low: Self, high: Self) -> Self {
        let (second, base) = (low.nodes.len() as u32 + 1, low.treelets.len() as u32);
        let mut nodes = Vec::with_capacity(1 + low.nodes.len() + high.nodes.len());
        nodes.push(Node::inner(&Aabb::EMPTY, second));
        nodes.extend(low.nodes.into_iter().map(|node| moved(node, 1, 0)));
        nodes.extend(high.nodes.into_iter().map(|node| moved(node, second, base)));
        enclose(&mut nodes, 0);
        let mut treelets = low.treelets;
        treelets.extend(high.treelets);
        Self { nodes, treelets }
    }
}

/// A node with its link moved on: by `inner` where it leads to a node, by `leaf` where to a treelet.
fn moved(node: Node, inner: u32, leaf: u32) -> Node {
    Node { link: node.link + if node.is_leaf() { leaf } else { inner }, ..node }
}

/// Gives a node the box around its children.
fn enclose(nodes: &mut [Node], this: usize) {
    let bounds = nodes[this + 1].bounds().union(nodes[nodes[this].link as usize].bounds());
    (nodes[this].min, nodes[this].max) = (bounds.min.into(), bounds.max.into());
}

impl<'a> Treelets<'a> {
    pub(super) fn cut(
        triangles: &'a [FlatTriangle],
        keys: &'a [u64],
        max_leaf: u32,
        monitor: &dyn Monitor,
    ) -> Result<Self, BuildError> {
        let most = MOST.min(WIDTH * max_leaf as usize);
        let mut this = Self { triangles, keys, max_leaf, nodes: Vec::new(), treelets: Vec::new() };
        let progress = Progress::new(monitor, triangles.len());
        let below = this.below(0..keys.len(), most, &progress);
        (this.nodes, this.treelets) = (below.nodes, below.treelets);
        progress.finish()?;
        Ok(this)
    }

    /// The nodes, and beside them what their leaves are.
    pub(super) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    fn below(&self, range: Range<usize>, most: usize, progress: &Progress<'_>) -> Below {
        let mut below = Below::default();
        if range.is_empty() || progress.is_cancelled() {
            return below;
        }
        if range.len() > SEQUENTIAL {
            let middle = self.middle(&range);
            let (low, high) = join(
                || self.below(range.start..middle, most, progress),
                || self.below(middle..range.end, most, progress),
            );
            // A part is empty when the build is cancelled.
            return if low.nodes.is_empty() || high.nodes.is_empty() {
                low
            } else {
                Below::joined(low, high)
            };
        }
        // The mean treelet has two thirds of the most.
        below.treelets.reserve(2 * range.len() / most + 1);
        below.nodes.reserve(4 * range.len() / most + 1);
        let count = range.len();
        self.sequential(range, most, &mut Cutter::new(self.max_leaf), &mut below);
        progress.add(count);
        below
    }

    fn sequential(&self, range: Range<usize>, most: usize, cutter: &mut Cutter, below: &mut Below) {
        if range.len() <= most {
            let treelet = self.treelet(range, cutter);
            below.nodes.push(Node::leaf(&treelet.bounds.bounds(), below.treelets.len() as u32, 1));
            below.treelets.push(treelet);
            return;
        }
        let middle = self.middle(&range);
        let this = below.nodes.len();
        below.nodes.push(Node::inner(&Aabb::EMPTY, 0));
        self.sequential(range.start..middle, most, cutter, below);
        below.nodes[this].link = below.nodes.len() as u32;
        self.sequential(middle..range.end, most, cutter, below);
        enclose(&mut below.nodes, this);
    }

    /// Where a range of two or more is cut.
    fn middle(&self, range: &Range<usize>) -> usize {
        let keys = &self.keys[range.clone()];
        let [Some(first), Some(last)] = [keys.first(), keys.last()] else { return range.start };
        let differing = (first ^ last) >> INDEX_BITS;
        if differing == 0 {
            return range.start + keys.len() / 2;
        }
        let bit = 1 << (INDEX_BITS + differing.ilog2());
        range.start + keys.partition_point(|key| key & bit == 0)
    }

    fn treelet(&self, range: Range<usize>, cutter: &mut Cutter) -> Treelet {
        let mut bounds = Extent::EMPTY;
        for (place, &key) in cutter.boxes.iter_mut().zip(&self.keys[range.clone()]) {
            *place = corners(&self.triangles[index(key) as usize]);
            bounds = bounds.union(*place);
        }
        let cuts = cutter.cuts(range.len());
        Treelet { bounds, first: range.start as u32, count: range.len() as u32, cuts }
    }

    fn of(&self, leaf: &Node) -> &Treelet {
        &self.treelets[leaf.link as usize]
    }
}

impl Bottom for Treelets<'_> {
    fn weigh(&self, leaf: &Node) -> Cost {
        let treelet = self.of(leaf);
        let mut least = [half_area(leaf); ROWS];
        if treelet.count > self.max_leaf {
            least[0] += treelet.cuts.least[WIDTH - 1];
        }
        for places in 2..=ROWS {
            least[places - 1] = treelet.cuts.least[places - 1].min(least[places - 2]);
        }
        Cost { least, references: treelet.count }
    }

    fn references(&self, leaf: &Node) -> Range<usize> {
        let treelet = self.of(leaf);
        treelet.first as usize..(treelet.first + treelet.count) as usize
    }

    fn triangle(&self, reference: usize) -> u32 {
        index(self.keys[reference])
    }

    fn fill(&self, leaf: &Node, places: usize, whole: Part, cut: &mut Cut) {
        let treelet = self.of(leaf);
        let as_leaves = treelet.cuts.least[places - 1];
        let alone =
            half_area(leaf) + if treelet.count > self.max_leaf { treelet.cuts.least[WIDTH - 1] } else { 0.0 };
        if places < WIDTH && alone < as_leaves {
            return cut.push(whole);
        }
        let begins = treelet.cuts.begins[places - 1];
        for (number, leaf) in leaves(begins, treelet.count as usize).enumerate() {
            let references = treelet.first as usize + leaf.start..treelet.first as usize + leaf.end;
            let bounds = if begins == treelet.cuts.begins[WIDTH - 1] {
                let [low, high] = treelet.cuts.boxes[number % WIDTH];
                Aabb::new(low.into(), high.into())
            } else {
                let box_of = |&key: &u64| corners(&self.triangles[index(key) as usize]);
                union(self.keys[references.clone()].iter().map(box_of)).bounds()
            };
            cut.push(Part::Leaf(bounds, references));
        }
    }
}
