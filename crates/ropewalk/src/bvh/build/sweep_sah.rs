//! The sweep SAH builder: of every node, every plane between two centres on every axis is weighed ([`super::sweep`]).
//!
//! It finds what the binned builder approximates. The references are sorted once along each axis, by centre, ties by
//! index; each of the three lists is partitioned stably at every split, so no node sorts again. `O(n log n)` for trees
//! of usual depth, and never more than the depth times `n`.
//!
//! Nodes are built by as many threads as there are. A node's decision looks at its own lists alone, and their order
//! is one, so the tree is the same for any number. When a node is a leaf, and how the depth cap is kept, stands in
//! [`super::limits`].
//!
//! Costs 96 bytes a reference for the lists, and in passing up to 76 more for the largest node.

use super::limits::{Choice, Limits};
use super::part::Part;
use super::reference::{Extent, Reference};
use super::subtree::Subtree;
use super::sweep::{SweepSplit, sort, sweep};
use crate::bvh::{BuildOptions, Node};
use crate::parallel::join;
use crate::progress::Progress;
use crate::{BuildError, Monitor};

/// A node with fewer references is built, with all below it, by one thread.
const SEQUENTIAL: usize = 4096;

/// Builds the nodes and puts the references into leaf order.
pub(super) fn build(
    references: &mut Vec<Reference>,
    options: &BuildOptions,
    monitor: &dyn Monitor,
) -> Result<Vec<Node>, BuildError> {
    if references.is_empty() {
        return Ok(Vec::new());
    }
    let builder = Builder { options, progress: Progress::new(monitor, references.len()) };
    let (mut second, mut third) = (references.clone(), references.clone());
    join(|| sort(references, 0), || join(|| sort(&mut second, 1), || sort(&mut third, 2)));
    // A leaf holds the same references in all three lists: those of the first are left behind in leaf order.
    let lists = Lists([references.as_mut_slice(), second.as_mut_slice(), third.as_mut_slice()]);
    let tree = builder.subtree(lists, 0, 0);
    builder.progress.finish()?;
    Ok(tree.into_nodes())
}

struct Builder<'a> {
    options: &'a BuildOptions,
    progress: Progress<'a>,
}

impl Builder<'_> {
    /// `first` is the index of the first of the references among all.
    fn subtree(&self, mut lists: Lists<'_>, first: usize, depth: u32) -> Subtree {
        if self.progress.is_cancelled() {
            return Subtree::Whole(Vec::new());
        }
        let count = lists.count();
        if count > SEQUENTIAL {
            let bounds = Part::measure(lists.0[0]).bounds;
            if let Some(middle) = self.split(&mut lists, bounds, depth, &mut Scratch::default()) {
                let [low, high] = lists.split_at(middle);
                let (low, high) = join(
                    || self.subtree(low, first, depth + 1),
                    || self.subtree(high, first + middle, depth + 1),
                );
                return Subtree::split(bounds.bounds(), [low, high]);
            }
        }
        let mut nodes = Vec::with_capacity(count);
        self.sequential(lists, first, depth, &mut nodes, &mut Scratch::default());
        self.progress.add(count);
        Subtree::Whole(nodes)
    }

    fn sequential(
        &self,
        mut lists: Lists<'_>,
        first: usize,
        depth: u32,
        nodes: &mut Vec<Node>,
        scratch: &mut Scratch,
    ) {
        let bounds = Extent::of(lists.0[0]);
        let Some(middle) = self.split(&mut lists, bounds, depth, scratch) else {
            nodes.push(Node::leaf(&bounds.bounds(), first as u32, lists.count() as u32));
            return;
        };
        let this = nodes.len();
        nodes.push(Node::inner(&bounds.bounds(), 0));
        let [low, high] = lists.split_at(middle);
        self.sequential(low, first, depth + 1, nodes, scratch);
        nodes[this].link = nodes.len() as u32;
        self.sequential(high, first + middle, depth + 1, nodes, scratch);
    }

    /// Partitions the lists in two and tells where, or `None` for a leaf.
    fn split(
        &self,
        lists: &mut Lists<'_>,
        bounds: Extent,
        depth: u32,
        scratch: &mut Scratch,
    ) -> Option<usize> {
        let count = lists.count();
        let limits = Limits::at(self.options, depth);
        if limits.forces_leaf(count) {
            return None;
        }
        let best = lists.best_split(scratch);
        let weighed = best.map(|split| (split.cost, split.counts));
        let (axis, middle) = match (limits.choose(count, bounds.half_area(), weighed), best) {
            (Choice::Leaf, _) => return None,
            (Choice::Split, Some(split)) => (split.axis, split.counts[0]),
            _ => (Part::measure(lists.0[0]).longest_axis(), count / 2),
        };
        lists.partition(axis, middle, scratch);
        Some(middle)
    }
}

/// The references of a node, three times: sorted along each axis.
struct Lists<'a>([&'a mut [Reference]; 3]);

/// Room to work in, for each axis; one node after the other uses it.
#[derive(Default)]
struct Scratch {
    upper_costs: [Vec<f32>; 3],
    high: [Vec<Reference>; 3],
}

impl Lists<'_> {
    fn count(&self) -> usize {
        self.0[0].len()
    }

    fn best_split(&self, scratch: &mut Scratch) -> Option<SweepSplit> {
        let [x, y, z] = &mut scratch.upper_costs;
        SweepSplit::best(on_axes(
            self.count() > SEQUENTIAL,
            || sweep(self.0[0], 0, x),
            || sweep(self.0[1], 1, y),
            || sweep(self.0[2], 2, z),
        ))
    }

    /// Puts the first `middle` references of the list of `axis` first in the other two as well, which keep their
    /// order.
    fn partition(&mut self, axis: usize, middle: usize, scratch: &mut Scratch) {
        let Some(pivot) = self.0[axis].get(middle).map(|reference| reference.key(axis)) else { return };
        let is_low = |reference: &Reference| reference.key(axis) < pivot;
        let parallel = self.count() > SEQUENTIAL;
        let [x, y, z] = &mut self.0;
        let [of_x, of_y, of_z] = &mut scratch.high;
        on_axes(
            parallel,
            || {
                if axis != 0 {
                    partition(x, of_x, is_low);
                }
            },
            || {
                if axis != 1 {
                    partition(y, of_y, is_low);
                }
            },
            || {
                if axis != 2 {
                    partition(z, of_z, is_low);
                }
            },
        );
    }
}

impl<'a> Lists<'a> {
    fn split_at(self, middle: usize) -> [Self; 2] {
        let [(a, d), (b, e), (c, f)] = self.0.map(|list| list.split_at_mut(middle));
        [Lists([a, b, c]), Lists([d, e, f])]
    }
}

/// Does something for each axis, side by side where that pays.
fn on_axes<R: Send>(
    parallel: bool,
    x: impl FnOnce() -> R + Send,
    y: impl FnOnce() -> R + Send,
    z: impl FnOnce() -> R + Send,
) -> [R; 3] {
    if parallel {
        let (x, (y, z)) = join(x, || join(y, z));
        [x, y, z]
    } else {
        [x(), y(), z()]
    }
}

/// Puts the low ones first; both sides keep their order. `high` is room to work in.
fn partition(list: &mut [Reference], high: &mut Vec<Reference>, is_low: impl Fn(&Reference) -> bool) {
    high.clear();
    let mut low = 0;
    for index in 0..list.len() {
        let reference = list[index];
        if is_low(&reference) {
            list[low] = reference;
            low += 1;
        } else {
            high.push(reference);
        }
    }
    list[low..].copy_from_slice(high);
}
