//! From the top down, by object splits.
//!
//! **Splits are weighed** by the areas of their sides times the leaves that these will make ([`super::leaves`]). References
//! that fit one leaf are one, unless they are small and far apart.
//!
//! **The depth cap** is kept by halving: a split is taken only when both sides still fit under the cap with full leaves,
//! and halving keeps what fits fitting.
//!
//! A node knows its own references alone, so the tree is the same for any number of threads. The memory: 32 bytes a reference, as much
//! again in passing for the upper sides of large nodes, and 32 a node.

use super::leaves::Leaves;
use super::object;
use crate::bvh::build::part::{Part, halve};
use crate::bvh::build::reference::{self, Extent, Reference};
use crate::bvh::build::subtree::Subtree;
use crate::bvh::{MAX_DEPTH, Node};
use crate::parallel::{fill_chunks, join, map_chunks};
use crate::processor::Processor;
use crate::progress::Progress;
use crate::{BuildError, FlatTriangle, Monitor};

/// A node with fewer references is built, with all below it, by one thread.
const SEQUENTIAL: usize = 4096;
/// As many references are measured by one thread.
const CHUNK: usize = 1 << 14;
/// References that fit one leaf are told apart where the sum of their areas is less than this part of their common one:
/// the collapse may have places for them. Neighbours on a surface seldom are. 2.0 lowers the cost by 0.3 to 0.7 percent more
/// and takes a third longer.
const LOOSE: f32 = 0.5;

/// Makes the nodes, in depth-first order, and the triangles of the references that their leaves point at. Leaves have `max_leaf`
/// references at most.
pub(super) fn build(
    triangles: &[FlatTriangle],
    max_leaf: u32,
    monitor: &dyn Monitor,
    processor: Processor,
) -> Result<(Vec<Node>, Vec<u32>), BuildError> {
    if triangles.is_empty() {
        return Ok((Vec::new(), Vec::new()));
    }
    let mut references = reference::of_triangles(triangles);
    let bounds = map_chunks(&references, CHUNK, |_, chunk| Extent::of(chunk));
    let bounds = bounds.into_iter().fold(Extent::EMPTY, Extent::union);
    let leaves = Leaves::of_at_most(max_leaf);
    let builder = Builder { leaves, progress: Progress::new(monitor, triangles.len()), processor };
    let tree = builder.subtree(&mut references, 0, Task { bounds, depth: 0 }, Scratch::default());
    builder.progress.finish()?;
    let nodes = tree.into_nodes();
    let mut order = vec![0; references.len()];
    fill_chunks(&mut order, CHUNK, |first, part| {
        for (place, reference) in part.iter_mut().zip(&references[first..]) {
            *place = reference.index() as u32;
        }
    });
    Ok((nodes, order))
}

/// The box around the doubled centres.
#[inline(always)]
fn centers(references: &[Reference]) -> Extent {
    let mut extent = Extent::EMPTY;
    for reference in references {
        extent.add_point(reference.doubled_center());
    }
    extent
}

struct Builder<'a> {
    leaves: Leaves,
    progress: Progress<'a>,
    processor: Processor,
}

/// What a node is told from above.
#[derive(Clone, Copy)]
struct Task {
    bounds: Extent,
    depth: u32,
}

/// A node's two children.
struct Halves {
    /// The first reference of the second one.
    middle: usize,
    tasks: [Task; 2],
}

/// Room to work in; one node after the other uses it.
#[derive(Default)]
struct Scratch {
    bins: object::Bins,
    /// The references of an upper side, and anything behind them.
    high: Vec<Reference>,
}

impl Builder<'_> {
    /// The box around the doubled centres, by several threads where there are many.
    #[inline(always)]
    fn centers(&self, references: &[Reference]) -> Extent {
        if references.len() <= CHUNK {
            return centers(references);
        }
        let of_chunk = |_, chunk: &[Reference]| {
            self.processor.run(
                #[inline(always)]
                || centers(chunk),
            )
        };
        map_chunks(references, CHUNK, of_chunk).into_iter().fold(Extent::EMPTY, Extent::union)
    }

    /// `first` is the index of the first reference among all.
    fn subtree(
        &self,
        references: &mut [Reference],
        first: usize,
        task: Task,
        mut scratch: Scratch,
    ) -> Subtree {
        if self.progress.is_cancelled() {
            return Subtree::Whole(Vec::new());
        }
        if references.len() > SEQUENTIAL
            && let Some(Halves { middle, tasks }) = self.split(references, &task, &mut scratch)
        {
            let (low, high) = references.split_at_mut(middle);
            let (low, high) = join(
                || self.subtree(low, first, tasks[0], scratch),
                || self.subtree(high, first + middle, tasks[1], Scratch::default()),
            );
            return Subtree::split(task.bounds.bounds(), [low, high]);
        }
        let mut nodes = Vec::with_capacity(references.len());
        self.sequential(references, first, task, &mut nodes, &mut scratch);
        self.progress.add(references.len());
        Subtree::Whole(nodes)
    }

    fn sequential(
        &self,
        references: &mut [Reference],
        first: usize,
        task: Task,
        nodes: &mut Vec<Node>,
        scratch: &mut Scratch,
    ) {
        let bounds = task.bounds.bounds();
        let Some(Halves { middle, tasks }) = self.split(references, &task, scratch) else {
            nodes.push(Node::leaf(&bounds, first as u32, references.len() as u32));
            return;
        };
        let this = nodes.len();
        nodes.push(Node::inner(&bounds, 0));
        let (low, high) = references.split_at_mut(middle);
        self.sequential(low, first, tasks[0], nodes, scratch);
        nodes[this].link = nodes.len() as u32;
        self.sequential(high, first + middle, tasks[1], nodes, scratch);
    }

    /// Puts the references of a node in two halves, or tells that they are a leaf.
    fn split(&self, references: &mut [Reference], task: &Task, scratch: &mut Scratch) -> Option<Halves> {
        self.processor.run(
            #[inline(always)]
            || self.halves(references, task, scratch),
        )
    }

    #[inline(always)]
    fn halves(&self, references: &mut [Reference], task: &Task, scratch: &mut Scratch) -> Option<Halves> {
        let is_leaf = self.leaves.is_one(references.len());
        if is_leaf && !is_loose(references, &task.bounds) {
            return None;
        }
        let levels = MAX_DEPTH.saturating_sub(task.depth);
        let grid = object::Grid::new(&self.centers(references), references.len());
        let object = grid.best_split(self.processor, references, self.leaves, levels, &mut scratch.bins);
        if is_leaf && (levels == 0 || object.is_none_or(|split| split.cost >= task.bounds.half_area())) {
            return None;
        }
        let (middle, bounds) = if let Some(split) = object {
            let is_low = |reference: &Reference| grid.is_low(reference, &split);
            (partition(references, &mut scratch.high, is_low), split.bounds)
        } else {
            let part = Part { bounds: task.bounds, centers: self.centers(references) };
            let (middle, parts) = halve(references, &part);
            (middle, parts.map(|part| part.bounds))
        };
        Some(Halves { middle, tasks: bounds.map(|bounds| Task { bounds, depth: task.depth + 1 }) })
    }
}

/// Whether two or more references are small and far apart for their common box.
#[inline(always)]
fn is_loose(references: &[Reference], bounds: &Extent) -> bool {
    let areas = references.iter().map(|reference| reference.corners().half_area());
    references.len() > 1 && areas.sum::<f32>() < LOOSE * bounds.half_area()
}

/// Puts the lower references first, and tells how many these are. `high` grows as it must.
#[inline(always)]
fn partition(
    references: &mut [Reference],
    high: &mut Vec<Reference>,
    is_low: impl Fn(&Reference) -> bool,
) -> usize {
    let Some(&any) = references.first() else { return 0 };
    if high.len() < references.len() {
        high.resize(references.len(), any);
    }
    // Every reference is written to both sides, and counts on one: no branch that half of the time goes wrong.
    let mut low = 0;
    for place in 0..references.len() {
        let reference = references[place];
        references[low] = reference;
        high[place - low] = reference;
        low += usize::from(is_low(&reference));
    }
    let upper = references.len() - low;
    references[low..].copy_from_slice(&high[..upper]);
    low
}
