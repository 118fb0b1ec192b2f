//! The binned SAH builder (Wald 2007), parallel and deterministic.
//!
//! Each node sorts its references into bins along all three axes at once, by the centres of their boxes, and
//! splits at the plane between bins at which the surface area heuristic expects the least cost (1 for a node,
//! 1 for a triangle). Minima, maxima and counts do not depend on the order in which they are taken, and a node's
//! references are partitioned by one thread, so the tree is the same for any number of threads.
//!
//! When a node is a leaf, and how the depth cap is kept, stands in [`super::limits`].

use super::limits::{Choice, Limits};
use super::part::{Part, halve};
use super::reference::{Extent, Reference};
use super::subtree::Subtree;
use crate::bvh::{BuildOptions, Node};
use crate::parallel::{join, map_chunks};
use crate::progress::Progress;
use crate::{BuildError, Monitor};
use glam::Vec4;

/// A node with fewer references is built, with all below it, by one thread.
const SEQUENTIAL: usize = 4096;
/// A node with more references is binned by several threads.
const PARALLEL_BINNING: usize = 1 << 16;

/// Builds the nodes and puts the references into leaf order.
pub(super) fn build(
    references: &mut [Reference],
    options: &BuildOptions,
    monitor: &dyn Monitor,
) -> Result<Vec<Node>, BuildError> {
    if references.is_empty() {
        return Ok(Vec::new());
    }
    let builder = Builder { options, progress: Progress::new(monitor, references.len()) };
    let part = Part::measure(references);
    let tree = builder.subtree(references, part, 0, 0);
    builder.progress.finish()?;
    Ok(tree.into_nodes())
}

struct Builder<'a> {
    options: &'a BuildOptions,
    progress: Progress<'a>,
}

impl Builder<'_> {
    /// `first` is the index of the first of `references` among all.
    fn subtree(&self, references: &mut [Reference], part: Part, first: usize, depth: u32) -> Subtree {
        if self.progress.is_cancelled() {
            return Subtree::Whole(Vec::new());
        }
        if references.len() > SEQUENTIAL
            && let Some((middle, parts)) = self.split(references, &part, depth, &mut Bins::default())
        {
            let (low, high) = references.split_at_mut(middle);
            let (low, high) = join(
                || self.subtree(low, parts[0], first, depth + 1),
                || self.subtree(high, parts[1], first + middle, depth + 1),
            );
            return Subtree::split(part.bounds.bounds(), [low, high]);
        }
        let mut nodes = Vec::with_capacity(references.len());
        self.sequential(references, &part, first, depth, &mut nodes, &mut Bins::default());
        self.progress.add(references.len());
        Subtree::Whole(nodes)
    }

    fn sequential(
        &self,
        references: &mut [Reference],
        part: &Part,
        first: usize,
        depth: u32,
        nodes: &mut Vec<Node>,
        scratch: &mut Bins,
    ) {
        let bounds = part.bounds.bounds();
        let Some((middle, parts)) = self.split(references, part, depth, scratch) else {
            nodes.push(Node::leaf(&bounds, first as u32, references.len() as u32));
            return;
        };
        let this = nodes.len();
        nodes.push(Node::inner(&bounds, 0));
        let (low, high) = references.split_at_mut(middle);
        self.sequential(low, &parts[0], first, depth + 1, nodes, scratch);
        nodes[this].link = nodes.len() as u32;
        self.sequential(high, &parts[1], first + middle, depth + 1, nodes, scratch);
    }

    /// Partitions the references in two and tells where, or `None` for a leaf.
    fn split(
        &self,
        references: &mut [Reference],
        part: &Part,
        depth: u32,
        scratch: &mut Bins,
    ) -> Option<(usize, [Part; 2])> {
        let limits = Limits::at(self.options, depth);
        if limits.forces_leaf(references.len()) {
            return None;
        }
        let binning = Binning::new(part, references.len(), self.options.bins);
        let best = binning.best_split(references, scratch);
        let weighed = best.as_ref().map(|split| (split.cost, split.counts));
        match (limits.choose(references.len(), part.bounds.half_area(), weighed), best) {
            (Choice::Leaf, _) => None,
            (Choice::Split, Some(split)) => Some(binning.partition(references, &split)),
            _ => Some(halve(references, part)),
        }
    }
}

/// How centres map to bins, on all axes at once.
pub(crate) struct Binning {
    bins: usize,
    origin: Vec4,
    scale: Vec4,
}

/// A plane between bins.
pub(crate) struct Split {
    axis: usize,
    /// The first bin of the upper side.
    bin: u32,
    /// References on the lower side and on the upper one.
    pub(crate) counts: [usize; 2],
    /// The sum over both sides of half area times count.
    pub(crate) cost: f32,
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Extent,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Extent::EMPTY, count: 0 };
}

/// The bins of the three axes, 4.6 kB. Several nodes use them one after the other; each clears as many as it needs.
pub(crate) struct Bins([[Bin; BuildOptions::MAX_BINS]; 3]);

impl Default for Bins {
    fn default() -> Self {
        Self([[Bin::EMPTY; BuildOptions::MAX_BINS]; 3])
    }
}

impl Bins {
    fn merge(mut self, other: Self) -> Self {
        for (a, b) in self.0.as_flattened_mut().iter_mut().zip(other.0.as_flattened()) {
            *a = Bin { bounds: a.bounds.union(b.bounds), count: a.count + b.count };
        }
        self
    }
}

/// Adding this to a small number leaves the number, rounded, in the low bits of the sum.
const ROUND_TO_BITS: f32 = 8_388_608.0;

impl Binning {
    pub(crate) fn new(part: &Part, count: usize, bins: u32) -> Self {
        // Few references do not need many planes; most nodes are small and the sweep over bins dominates them.
        let bins = (bins as usize).min(4 + count / 4);
        let size = part.centers.high - part.centers.low;
        // An axis without extent, or one so short that the division overflows, gets the scale 0: one bin.
        let scale = (Vec4::splat(bins as f32) / size).to_array();
        let scale = scale.map(|scale| if scale.is_finite() { scale } else { 0.0 });
        Self { bins, origin: part.centers.low, scale: Vec4::from_array(scale) }
    }

    /// The bins of a reference on the three axes.
    #[inline(always)]
    fn place(&self, reference: &Reference) -> [u32; 3] {
        let position = (reference.doubled_center() - self.origin) * self.scale;
        let position = position.min(Vec4::splat(self.bins as f32 - 0.75)) - 0.5;
        let position = position.max(Vec4::ZERO) + ROUND_TO_BITS;
        let [x, y, z, _] = position.to_array().map(|lane| lane.to_bits() & 31);
        [x, y, z]
    }

    fn fill(&self, references: &[Reference], bins: &mut Bins) {
        for axis in &mut bins.0 {
            axis[..self.bins].fill(Bin::EMPTY);
        }
        for reference in references {
            for (axis, place) in bins.0.iter_mut().zip(self.place(reference)) {
                let bin = &mut axis[place as usize & 31];
                bin.bounds.add(reference);
                bin.count += 1;
            }
        }
    }

    pub(crate) fn best_split(&self, references: &[Reference], bins: &mut Bins) -> Option<Split> {
        if references.len() > PARALLEL_BINNING {
            let parts = map_chunks(references, PARALLEL_BINNING / 4, |_, chunk| {
                let mut bins = Bins::default();
                self.fill(chunk, &mut bins);
                bins
            });
            *bins = parts.into_iter().reduce(Bins::merge)?;
        } else {
            self.fill(references, bins);
        }
        let mut best: Option<Split> = None;
        for (axis, bins) in bins.0.iter().enumerate() {
            if self.scale[axis] > 0.0 {
                self.sweep(axis, &bins[..self.bins], references.len(), &mut best);
            }
        }
        best
    }

    /// Weighs every plane of one axis.
    fn sweep(&self, axis: usize, bins: &[Bin], total: usize, best: &mut Option<Split>) {
        let mut upper_costs = [0.0; BuildOptions::MAX_BINS];
        let mut upper = Bin::EMPTY;
        for (bin, cost) in bins.iter().zip(&mut upper_costs).skip(1).rev() {
            upper = Bin { bounds: upper.bounds.union(bin.bounds), count: upper.count + bin.count };
            *cost = if upper.count == 0 { 0.0 } else { upper.bounds.half_area() * upper.count as f32 };
        }
        let mut lower = Bin::EMPTY;
        for (plane, bin) in bins.iter().enumerate().take(bins.len() - 1) {
            lower = Bin { bounds: lower.bounds.union(bin.bounds), count: lower.count + bin.count };
            if lower.count == 0 || lower.count as usize == total {
                continue;
            }
            let cost = lower.bounds.half_area() * lower.count as f32 + upper_costs[plane + 1];
            if best.as_ref().is_none_or(|best| cost < best.cost) {
                let low = lower.count as usize;
                *best = Some(Split { axis, bin: plane as u32 + 1, counts: [low, total - low], cost });
            }
        }
    }

    /// Puts the lower side first, measuring both sides on the way.
    pub(crate) fn partition(&self, references: &mut [Reference], split: &Split) -> (usize, [Part; 2]) {
        let mut parts = [Part::EMPTY; 2];
        let (mut low, mut high) = (0, references.len());
        while low < high {
            let reference = references[low];
            if self.place(&reference)[split.axis] < split.bin {
                parts[0].add(&reference);
                low += 1;
            } else {
                parts[1].add(&reference);
                high -= 1;
                references.swap(low, high);
            }
        }
        debug_assert_eq!(low, split.counts[0]);
        (low, parts)
    }
}
