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
use crate::bvh8::arena::prefetch;
use crate::bvh8::build::reinserted::collapse::{Bottom, Cut, Part};
use crate::bvh8::build::reinserted::cost::{Cost, ROWS, half_area};
use crate::bvh8::simd::{Detected, Level, Task, dispatch};
use crate::bvh8::tree::WIDTH;
use crate::memory::with_capacity;
use crate::parallel::map_chunks;
use crate::progress::Progress;
use crate::{Aabb, BuildError, FlatTriangle, Monitor};
use glam::Vec3;
use std::ops::Range;

/// The treelets of a range with fewer triangles are cut by one thread.
const SEQUENTIAL: usize = 1 << 13;
/// So many triangles lie between asking for one and reading it: those of about two treelets.
const AHEAD: usize = 40;

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
    /// In depth-first order. A leaf is one treelet: its link tells which of a part, its count, less one, of which part.
    nodes: Vec<Node>,
    /// The treelets that each thread made at a time.
    parts: Vec<Vec<Treelet>>,
}

/// The nodes and the treelets of a range. Links count from its first node and its first treelet.
#[derive(Default)]
struct Below {
    nodes: Vec<Node>,
    treelets: Vec<Treelet>,
}

/// The binary tree above the ranges that one thread takes, in depth-first order.
enum Step {
    Split,
    Range(Range<usize>),
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
        let mut this = Self { triangles, keys, max_leaf, nodes: Vec::new(), parts: Vec::new() };
        if keys.is_empty() {
            return Ok(this);
        }
        let progress = Progress::new(monitor, triangles.len());
        let mut steps = Vec::new();
        this.divide(0..keys.len(), &mut steps);
        let level = Detected::or_best(None);
        let below = map_chunks(&steps, 1, |_, step| match step {
            [Step::Range(range)] if !progress.is_cancelled() => {
                let below = dispatch(level, Work { treelets: &this, range: range.clone() });
                progress.add(range.len());
                below
            }
            _ => Below::default(),
        });
        progress.finish()?;
        this.nodes = with_capacity(steps.len() + below.iter().map(|below| below.nodes.len()).sum::<usize>());
        let mut parts = steps.iter().zip(below);
        this.append(&mut parts);
        Ok(this)
    }

    /// Appends the steps of a range and all below it. As deep as the splits are.
    fn divide(&self, range: Range<usize>, steps: &mut Vec<Step>) {
        if range.len() <= SEQUENTIAL {
            return steps.push(Step::Range(range));
        }
        let middle = self.middle(&range);
        steps.push(Step::Split);
        self.divide(range.start..middle, steps);
        self.divide(middle..range.end, steps);
    }

    /// Appends the nodes of the next step and all below it.
    fn append<'s>(&mut self, parts: &mut impl Iterator<Item = (&'s Step, Below)>) {
        let this = self.nodes.len();
        match parts.next() {
            Some((Step::Split, _)) => {
                self.nodes.push(Node::inner(&Aabb::EMPTY, 0));
                self.append(parts);
                self.nodes[this].link = self.nodes.len() as u32;
                self.append(parts);
                enclose(&mut self.nodes, this);
            }
            Some((Step::Range(_), below)) => {
                self.parts.push(below.treelets);
                let part = self.parts.len() as u32;
                self.nodes.extend(below.nodes.into_iter().map(|node| match node.is_leaf() {
                    true => Node { count: part, ..node },
                    false => Node { link: node.link + this as u32, ..node },
                }));
            }
            None => {}
        }
    }

    /// The nodes, and beside them what their leaves are.
    pub(super) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Where a range of two or more is cut.
    #[inline(always)]
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

    #[inline(always)]
    fn treelet(&self, range: Range<usize>, cutter: &mut Cutter) -> Treelet {
        // Triangles lie anywhere.
        for &key in self.keys.iter().skip(range.start + AHEAD).take(range.len()) {
            let triangle = std::ptr::from_ref(&self.triangles[index(key) as usize]);
            // Every other one goes on in the next line.
            prefetch(triangle);
            prefetch(triangle.cast::<u32>().wrapping_add(size_of::<FlatTriangle>() / 4 - 2));
        }
        for (place, &key) in self.keys[range.clone()].iter().enumerate() {
            cutter.set(place, corners(&self.triangles[index(key) as usize]));
        }
        let cuts = cutter.cuts(range.len());
        // Around all is what is around its leaves.
        let leaves = cuts.begins[WIDTH - 1].count_ones() as usize;
        let boxes = cuts.boxes.iter().take(leaves);
        let bounds = union(boxes.map(|&[low, high]| Extent {
            low: Vec3::from(low).extend(0.0),
            high: Vec3::from(high).extend(0.0),
        }));
        Treelet { bounds, first: range.start as u32, count: range.len() as u32, cuts }
    }

    fn of(&self, leaf: &Node) -> &Treelet {
        &self.parts[leaf.count as usize - 1][leaf.link as usize]
    }
}

/// A range of some triangles that one thread cuts into treelets.
struct Work<'a> {
    treelets: &'a Treelets<'a>,
    range: Range<usize>,
}

impl Task for Work<'_> {
    type Output = Below;

    #[inline(always)]
    fn run<L: Level>(self, _: L) -> Below {
        let Self { treelets, mut range } = self;
        let most = MOST.min(WIDTH * treelets.max_leaf as usize);
        let mut cutter = Cutter::new(treelets.max_leaf);
        // The mean treelet has two thirds of the most.
        let mut below = Below {
            nodes: Vec::with_capacity(4 * range.len() / most + 1),
            treelets: Vec::with_capacity(2 * range.len() / most + 1),
        };
        // Second halves, and the nodes that wait for them.
        let mut waiting: Vec<(Range<usize>, usize)> = Vec::new();
        loop {
            if range.len() > most {
                let middle = treelets.middle(&range);
                waiting.push((middle..range.end, below.nodes.len()));
                below.nodes.push(Node::inner(&Aabb::EMPTY, 0));
                range.end = middle;
                continue;
            }
            let treelet = treelets.treelet(range, &mut cutter);
            below.nodes.push(Node::leaf(&treelet.bounds.bounds(), below.treelets.len() as u32, 1));
            below.treelets.push(treelet);
            let Some((second, parent)) = waiting.pop() else { break };
            below.nodes[parent].link = below.nodes.len() as u32;
            range = second;
        }
        // Children come after their parents.
        for this in (0..below.nodes.len()).rev() {
            if !below.nodes[this].is_leaf() {
                enclose(&mut below.nodes, this);
            }
        }
        below
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
