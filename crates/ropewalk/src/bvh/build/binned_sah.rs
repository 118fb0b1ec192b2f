//! The binned SAH builder (Wald 2007), parallel and deterministic.
//!
//! Each node sorts its references into bins along all three axes at once, by the centres of their boxes, and
//! splits at the plane between bins at which the surface area heuristic expects the least cost (1 for a node,
//! 1 for a triangle). Minima, maxima and counts do not depend on the order in which they are taken, and a node's
//! references are partitioned by one thread, so the tree is the same for any number of threads.
//!
//! The depth cap is kept by falling back to halving: a split is taken only when both sides still fit under the
//! cap with full leaves.

use super::reference::{Extent, Reference};
use super::subtree::Subtree;
use crate::bvh::{BuildOptions, Node};
use crate::parallel::{join, map_chunks};
use crate::{BuildError, Monitor};
use glam::Vec4;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

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
    let builder = Builder {
        options,
        monitor,
        total: references.len(),
        done: AtomicUsize::new(0),
        cancelled: AtomicBool::new(false),
    };
    let part = Part::measure(references);
    let tree = builder.subtree(references, part, 0, 0);
    if builder.cancelled.into_inner() { Err(BuildError::Cancelled) } else { Ok(tree.into_nodes()) }
}

struct Builder<'a> {
    options: &'a BuildOptions,
    monitor: &'a dyn Monitor,
    total: usize,
    done: AtomicUsize,
    cancelled: AtomicBool,
}

/// What is known of a node's references: their common box, and the box of their doubled centres.
#[derive(Clone, Copy)]
struct Part {
    bounds: Extent,
    centers: Extent,
}

impl Part {
    const EMPTY: Self = Self { bounds: Extent::EMPTY, centers: Extent::EMPTY };

    fn measure(references: &[Reference]) -> Self {
        map_chunks(references, 1 << 14, |_, chunk| {
            let mut part = Self::EMPTY;
            for reference in chunk {
                part.add(reference);
            }
            part
        })
        .into_iter()
        .fold(Self::EMPTY, |a, b| Self {
            bounds: a.bounds.union(b.bounds),
            centers: a.centers.union(b.centers),
        })
    }

    #[inline(always)]
    fn add(&mut self, reference: &Reference) {
        self.bounds.add(reference);
        self.centers.add_point(reference.doubled_center());
    }
}

impl Builder<'_> {
    /// `first` is the index of the first of `references` among all.
    fn subtree(&self, references: &mut [Reference], part: Part, first: usize, depth: u32) -> Subtree {
        if self.cancelled.load(Ordering::Relaxed) {
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
        let done = self.done.fetch_add(references.len(), Ordering::Relaxed) + references.len();
        if self.monitor.progress(done, self.total).is_break() {
            self.cancelled.store(true, Ordering::Relaxed);
        }
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
        let levels = self.options.max_depth - depth;
        if references.len() <= 1 || levels == 0 {
            return None;
        }
        let max_leaf = self.options.max_leaf as usize;
        let may_be_leaf = references.len() <= max_leaf;
        let binning = Binning::new(part, references.len(), self.options.bins);
        let best = binning.best_split(references, scratch);
        // All areas times 1 / the node's: a leaf costs its triangles, a split one more for the node.
        let area = part.bounds.half_area();
        match best {
            Some(split) => {
                if may_be_leaf && area + split.cost >= area * references.len() as f32 {
                    return None;
                }
                let room = u64::from(self.options.max_leaf) << (levels - 1).min(32);
                let fits = |count: usize| count as u64 <= room;
                if fits(split.low_count) && fits(references.len() - split.low_count) {
                    return Some(binning.partition(references, &split));
                }
            }
            None if may_be_leaf => return None,
            None => {}
        }
        Some(halve(references, part))
    }
}

/// Puts the lower half along the longest axis of the centres first. Needs no order of the centres to be there.
fn halve(references: &mut [Reference], part: &Part) -> (usize, [Part; 2]) {
    let middle = references.len() / 2;
    let size = part.centers.high - part.centers.low;
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    references.select_nth_unstable_by(middle, |a, b| {
        let order = a.doubled_center()[axis].total_cmp(&b.doubled_center()[axis]);
        order.then(a.index().cmp(&b.index()))
    });
    let (low, high) = references.split_at(middle);
    (middle, [Part::measure(low), Part::measure(high)])
}

/// How centres map to bins, on all axes at once.
struct Binning {
    bins: usize,
    origin: Vec4,
    scale: Vec4,
}

/// A plane between bins.
struct Split {
    axis: usize,
    /// The first bin of the upper side.
    bin: u32,
    /// References on the lower side.
    low_count: usize,
    /// The sum over both sides of half area times count.
    cost: f32,
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
struct Bins([[Bin; BuildOptions::MAX_BINS]; 3]);

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
    fn new(part: &Part, count: usize, bins: u32) -> Self {
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

    fn best_split(&self, references: &[Reference], bins: &mut Bins) -> Option<Split> {
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
                let low_count = lower.count as usize;
                *best = Some(Split { axis, bin: plane as u32 + 1, low_count, cost });
            }
        }
    }

    /// Puts the lower side first, measuring both sides on the way.
    fn partition(&self, references: &mut [Reference], split: &Split) -> (usize, [Part; 2]) {
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
        debug_assert_eq!(low, split.low_count);
        (low, parts)
    }
}
