//! From the top down: object splits, and spatial splits where they are worth the search.
//!
//! **Splits are weighed** by the areas of their sides times the leaves that these will make ([`super::leaves`]). References
//! that fit one leaf are one, unless they are small and far apart. Spatial splits are sought where the children of the best
//! object split overlap by a tenth of the node's area, and by more than a part `5e-6` of the root's: on scanned surfaces next
//! to nowhere, so that they cost less there.
//!
//! **The room.** References live in one array. A node has a region of it, its own references first and behind them the
//! room for those that spatial splits may add. What it does not use each child gets its share of, by the number of
//! references. A node knows its own share alone, so the tree is the same for any number of threads.
//!
//! **The depth cap** is kept by halving: a split is taken only when both sides still fit under the cap with full leaves,
//! and halving keeps what fits fitting.
//!
//! The memory: 32 bytes a reference, as much again in passing for the upper sides of large nodes, and 32 a node.

use super::SpatialOptions;
use super::leaves::Leaves;
use super::{object, planes};
use crate::bvh::build::part::{Part, halve};
use crate::bvh::build::reference::{Extent, Reference};
use crate::bvh::build::subtree::Subtree;
use crate::bvh::{MAX_DEPTH, Node};
use crate::parallel::{fill_chunks, join, map_chunks};
use crate::progress::Progress;
use crate::{Aabb, BuildError, FlatTriangle, Monitor};
use glam::Vec3;

/// A node with fewer references is built, with all below it, by one thread.
const SEQUENTIAL: usize = 4096;
/// As many references are measured by one thread.
const CHUNK: usize = 1 << 14;
/// Spatial splits are sought where the overlap exceeds this part of the root's area,
const OVERLAP_OF_ROOT: f32 = 5e-6;
/// and this part of the node's.
const OVERLAP_OF_NODE: f32 = 0.1;
/// A spatial split must cost less than this part of the object split: cut boxes are only shorter, so that the splits below
/// bring less than they promise. In the kitchen 0.99 makes half as many references again, and the tree costs 1 percent more.
const WORTH: f32 = 0.9;
/// References that fit one leaf are told apart where the sum of their areas is less than this part of their common one:
/// the collapse may have places for them. Neighbours on a surface seldom are. 2.0 lowers the cost by 0.3 to 0.7 percent more
/// and takes a third longer.
const LOOSE: f32 = 0.5;

/// Makes the nodes, in depth-first order, and the triangles of the references that their leaves point at.
pub(super) fn build(
    triangles: &[FlatTriangle],
    options: &SpatialOptions,
    monitor: &dyn Monitor,
) -> Result<(Vec<Node>, Vec<u32>), BuildError> {
    let count = triangles.len();
    let references = references(triangles, room(count, options.duplication));
    over(references, count, Limits { max_leaf: options.smallest_split, max_depth: MAX_DEPTH }, monitor)
}

/// What a tree must keep.
#[derive(Clone, Copy, Debug)]
pub(in crate::bvh8) struct Limits {
    /// The most references in a leaf.
    pub(in crate::bvh8) max_leaf: u32,
    /// The depth of the deepest leaf, 32 or more, the root being at depth 0.
    pub(in crate::bvh8) max_depth: u32,
}

/// The same over any boxes, of which there are `count`; what stands behind them is room for spatial splits.
pub(in crate::bvh8) fn over(
    mut references: Vec<Reference>,
    count: usize,
    limits: Limits,
    monitor: &dyn Monitor,
) -> Result<(Vec<Node>, Vec<u32>), BuildError> {
    if count == 0 {
        return Ok((Vec::new(), Vec::new()));
    }
    let bounds = measure(&references[..count], Extent::of, Extent::union);
    let builder = Builder {
        leaves: Leaves::of_at_most(limits.max_leaf),
        max_depth: limits.max_depth,
        progress: Progress::new(monitor, count),
        smallest_overlap: OVERLAP_OF_ROOT * bounds.half_area(),
    };
    let root = Task { bounds, count, primitives: count, depth: 0 };
    let tree = builder.subtree(&mut references, 0, root, Scratch::default());
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

/// How many references may be added to `triangles`. A tree's nodes, two a reference, must be counted by 32 bits.
fn room(triangles: usize, duplication: u32) -> usize {
    let wanted = triangles as u64 * u64::from(duplication) / 100;
    let limit = u64::from(u32::MAX / 2).saturating_sub(triangles as u64);
    wanted.min(limit) as usize
}

/// The references of all triangles, and room behind them.
fn references(triangles: &[FlatTriangle], room: usize) -> Vec<Reference> {
    let nothing = Reference::new(&Aabb::new(Vec3::ZERO, Vec3::ZERO), 0);
    let mut references = vec![nothing; triangles.len() + room];
    fill_chunks(&mut references[..triangles.len()], CHUNK, |first, part| {
        for (offset, (place, triangle)) in part.iter_mut().zip(&triangles[first..]).enumerate() {
            *place = Reference::new(&triangle.triangle().bounds(), (first + offset) as u32);
        }
    });
    references
}

/// Something of all references, by several threads where there are many.
fn measure<R: Send>(
    references: &[Reference],
    of: impl Fn(&[Reference]) -> R + Sync,
    merge: impl Fn(R, R) -> R,
) -> R {
    if references.len() <= CHUNK {
        return of(references);
    }
    let mut parts = map_chunks(references, CHUNK, |_, chunk| of(chunk)).into_iter();
    let first = parts.next().unwrap_or_else(|| of(&[]));
    parts.fold(first, merge)
}

/// The box around the doubled centres.
fn centers(references: &[Reference]) -> Extent {
    let of = |references: &[Reference]| {
        let mut extent = Extent::EMPTY;
        references.iter().for_each(|reference| extent.add_point(reference.doubled_center()));
        extent
    };
    measure(references, of, Extent::union)
}

struct Builder<'a> {
    leaves: Leaves,
    max_depth: u32,
    progress: Progress<'a>,
    smallest_overlap: f32,
}

/// What a node is told from above.
#[derive(Clone, Copy)]
struct Task {
    bounds: Extent,
    /// References: the first ones of the region.
    count: usize,
    /// For how many of the primitives the node stands in the monitor's eyes.
    primitives: usize,
    depth: u32,
}

/// A node's two children.
struct Halves {
    /// Where the region of the second begins in that of the node.
    middle: usize,
    tasks: [Task; 2],
}

/// Room to work in; one node after the other uses it.
#[derive(Default)]
struct Scratch {
    bins: object::Bins,
    sides: planes::Sides,
    /// The references of an upper side, and anything behind them.
    high: Vec<Reference>,
}

impl Builder<'_> {
    /// `first` is the index of the region's first reference among all.
    fn subtree(&self, region: &mut [Reference], first: usize, task: Task, mut scratch: Scratch) -> Subtree {
        if self.progress.is_cancelled() {
            return Subtree::Whole(Vec::new());
        }
        if task.count > SEQUENTIAL
            && let Some(Halves { middle, tasks }) = self.split(region, &task, &mut scratch)
        {
            let (low, high) = region.split_at_mut(middle);
            let (low, high) = join(
                || self.subtree(low, first, tasks[0], scratch),
                || self.subtree(high, first + middle, tasks[1], Scratch::default()),
            );
            return Subtree::split(task.bounds.bounds(), [low, high]);
        }
        let mut nodes = Vec::with_capacity(region.len());
        self.sequential(region, first, task, &mut nodes, &mut scratch);
        self.progress.add(task.primitives);
        Subtree::Whole(nodes)
    }

    fn sequential(
        &self,
        region: &mut [Reference],
        first: usize,
        task: Task,
        nodes: &mut Vec<Node>,
        scratch: &mut Scratch,
    ) {
        let bounds = task.bounds.bounds();
        let Some(Halves { middle, tasks }) = self.split(region, &task, scratch) else {
            nodes.push(Node::leaf(&bounds, first as u32, task.count as u32));
            return;
        };
        let this = nodes.len();
        nodes.push(Node::inner(&bounds, 0));
        let (low, high) = region.split_at_mut(middle);
        self.sequential(low, first, tasks[0], nodes, scratch);
        nodes[this].link = nodes.len() as u32;
        self.sequential(high, first + middle, tasks[1], nodes, scratch);
    }

    /// Splits the references of a node in two, or tells that they are a leaf.
    fn split(&self, region: &mut [Reference], task: &Task, scratch: &mut Scratch) -> Option<Halves> {
        let Task { count, depth, .. } = *task;
        let is_leaf = self.leaves.is_one(count);
        if is_leaf && !is_loose(&region[..count], &task.bounds) {
            return None;
        }
        let levels = self.max_depth.saturating_sub(depth);
        let references = &mut region[..count];
        let grid = object::Grid::new(&centers(references), count);
        let object = grid.best_split(references, self.leaves, levels, &mut scratch.bins);
        if is_leaf && (levels == 0 || object.is_none_or(|split| split.cost >= task.bounds.half_area())) {
            return None;
        }
        if !is_leaf
            && let Some(halves) = self.split_space(region, task, object.as_ref(), levels, &mut scratch.sides)
        {
            return Some(halves);
        }
        let references = &mut region[..count];
        let high = &mut scratch.high;
        let (low, bounds) = if let Some(split) = object {
            (partition(references, high, |reference| grid.is_low(reference, &split)), split.bounds)
        } else {
            let part = Part { bounds: task.bounds, centers: centers(references) };
            let (middle, parts) = halve(references, &part);
            let upper = &references[middle..];
            if high.len() < upper.len() {
                high.resize(upper.len(), upper[0]);
            }
            high[..upper.len()].copy_from_slice(upper);
            (middle, parts.map(|part| part.bounds))
        };
        Some(share(region, task, [low, count - low], bounds, high))
    }

    /// Makes the best spatial split where it is worth it.
    fn split_space(
        &self,
        region: &mut [Reference],
        task: &Task,
        object: Option<&object::ObjectSplit>,
        levels: u32,
        sides: &mut planes::Sides,
    ) -> Option<Halves> {
        let room = region.len() - task.count;
        if room == 0 {
            return None;
        }
        let overlap = object.map_or(f32::INFINITY, object::ObjectSplit::overlap);
        let least = self.smallest_overlap.max(OVERLAP_OF_NODE * task.bounds.half_area());
        // Boxes without area overlap by nothing.
        if overlap <= least {
            return None;
        }
        let references = &mut region[..task.count];
        let grid = planes::Grid::new(&task.bounds);
        let split = grid.best_split(references, room, self.leaves, levels)?;
        if object.is_some_and(|object| split.cost >= WORTH * object.cost) {
            return None;
        }
        let low = grid.partition(references, &split, room, sides);
        let bounds = [Extent::of(&references[..low]), Extent::of(&sides.high)];
        Some(share(region, task, [low, sides.high.len()], bounds, &sides.high))
    }
}

/// Whether two or more references are small and far apart for their common box.
fn is_loose(references: &[Reference], bounds: &Extent) -> bool {
    let areas = references.iter().map(|reference| reference.corners().half_area());
    references.len() > 1 && areas.sum::<f32>() < LOOSE * bounds.half_area()
}

/// Puts the lower references first. Tells how many go low; the others are left
/// at the front of `high`, which grows as it must.
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
    low
}

/// Shares out what is left of the region, and puts the upper references where theirs begins.
fn share(
    region: &mut [Reference],
    task: &Task,
    counts: [usize; 2],
    bounds: [Extent; 2],
    high: &[Reference],
) -> Halves {
    let all = (counts[0] + counts[1]).max(1);
    let part_of = |whole: usize| (whole as u64 * counts[0] as u64 / all as u64) as usize;
    let middle = counts[0] + part_of(region.len().saturating_sub(all));
    region[middle..middle + counts[1]].copy_from_slice(&high[..counts[1]]);
    let low = part_of(task.primitives);
    let primitives = [low, task.primitives - low];
    let tasks = [0, 1].map(|side| Task {
        bounds: bounds[side],
        count: counts[side],
        primitives: primitives[side],
        depth: task.depth + 1,
    });
    Halves { middle, tasks }
}
