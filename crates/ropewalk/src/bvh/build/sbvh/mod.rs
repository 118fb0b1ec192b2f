//! The SBVH builder (Stich, Friedrich and Dietrich 2009): object splits and spatial splits.
//!
//! Large triangles make boxes overlap, and no grouping of whole triangles helps. So where the children of the best
//! object split overlap, by more than a part `1e-5` of the root's area, the best spatial split is sought as well: a
//! plane at which references that straddle it become two, one on each side ([`spatial`]). The cheaper split is taken.
//! No node holds two references to one triangle, because the two go to different sides; so no leaf does.
//!
//! **What a reference's part is.** The paper clips the triangle to each side and takes the box of what is left. Here
//! the reference's *box* is cut at the plane, and its two parts share that plane. This is deliberate. The contract of
//! [`crate::triangle`] is that the same ray has the same hit, to the bit, in every structure. There `t` is moved into
//! the interval in which the ray is in the triangle's own box, so it may be any `t` of that interval: where a ray runs
//! along the triangle's plane, it is noise. All leaves with that triangle together must be open to the ray at
//! that `t`, whichever it is. With cut boxes they are:
//!
//! > Let `t` lie in the padded interval of a box, and cut the box by a plane. Then `t` lies in the padded interval of
//! > one of the parts. Both compute where the ray meets the plane; the lower part, as seen along the ray, with the
//! > origin that puts it later, the upper part with the one that puts it earlier, or with the same one. So the lower
//! > part's interval ends no earlier than the upper one's begins, before padding and after it, and everything else
//! > the two have in common with the box.
//!
//! By induction over the cuts some leaf's interval contains `t`; those of all boxes above it do, too. With clipped
//! triangles there is no such rule: with boxes widened by 2e-6 of the largest coordinate, 1 to 7 of 2,700,000 rays in
//! planes of triangles had another hit than in a tree without spatial splits (kitchen, two Sponzas), a wider margin
//! did not help, and a ray of the conformance suite was among them. With cut boxes none of 24,300,000 rays of all kinds
//! had. What clipping would save, with leaves of 4: no inner visits in the kitchen and in Dabrovic's Sponza, 7 to 12
//! percent of them in Crytek's, and 12 to 25 percent of the primitive tests.
//!
//! **The budget.** Spatial splits may add `duplication` percent of the number of triangles. Of what a node does not
//! use each child gets its share, by the number of references. A node knows its own share alone, so the tree is the
//! same for any number of threads. What one subtree leaves over no other one gets. Of a budget of 50 percent,
//! interiors use 16 to 20; one of 10 already has most of the gain, and one of 400 no more.
//!
//! When a node is a leaf, and how the depth cap is kept, stands in [`super::limits`]; a spatial split that would break
//! the cap is not considered.

mod object;
mod spatial;

use super::limits::{Choice, Limits};
use super::part::{Part, halve};
use super::reference::Reference;
use super::subtree::Subtree;
use crate::bvh::{BuildOptions, Node};
use crate::parallel::join;
use crate::progress::Progress;
use crate::{BuildError, Monitor};
use object::{ObjectScratch, ObjectSplit};
use spatial::Grid;

/// A node with fewer references is built, with all below it, by one thread.
const SEQUENTIAL: usize = 4096;
/// Spatial splits are tried where the children of the best object split overlap by more than this part of the root's
/// area: the value of the paper.
const ALPHA: f32 = 1e-5;

/// Builds the nodes and replaces the references of whole triangles by those of the leaves, in leaf order.
pub(super) fn build(
    references: &mut Vec<Reference>,
    options: &BuildOptions,
    monitor: &dyn Monitor,
) -> Result<Vec<Node>, BuildError> {
    if references.is_empty() {
        return Ok(Vec::new());
    }
    let part = Part::measure(references);
    let builder = Builder {
        options,
        progress: Progress::new(monitor, references.len()),
        smallest_overlap: ALPHA * part.bounds.half_area(),
    };
    let budget = budget(references.len(), options.duplication);
    let root = Task { part, budget, primitives: references.len(), depth: 0 };
    let (tree, leaves) = builder.subtree(std::mem::take(references), root);
    builder.progress.finish()?;
    *references = leaves;
    let mut nodes = tree.into_nodes();
    link_leaves(&mut nodes);
    Ok(nodes)
}

/// How many references may be added to `triangles`. A tree's nodes, two a reference, must be counted by 32 bits.
fn budget(triangles: usize, duplication: u32) -> usize {
    let wanted = triangles as u64 * u64::from(duplication) / 100;
    let limit = u64::from(u32::MAX / 2).saturating_sub(triangles as u64);
    wanted.min(limit) as usize
}

/// In depth-first order the leaves take their references one after the other.
fn link_leaves(nodes: &mut [Node]) {
    let mut first = 0;
    for leaf in nodes.iter_mut().filter(|node| node.is_leaf()) {
        leaf.link = first;
        first += leaf.count;
    }
}

struct Builder<'a> {
    options: &'a BuildOptions,
    progress: Progress<'a>,
    smallest_overlap: f32,
}

/// What a node is told from above.
#[derive(Clone, Copy)]
struct Task {
    part: Part,
    /// How many references may be added at this node and below.
    budget: usize,
    /// For how many of the primitives the node stands in the monitor's eyes.
    primitives: usize,
    depth: u32,
}

impl Task {
    /// What the children are told: what is left of the budget and of the primitives is shared out by references.
    fn share(&self, parts: [Part; 2], counts: [usize; 2], before: usize) -> [Self; 2] {
        let all = counts[0] + counts[1];
        let left = self.budget.saturating_sub(all - before.min(all));
        let part_of = |whole: usize| (whole as u128 * counts[0] as u128 / all.max(1) as u128) as usize;
        let low = [part_of(left), part_of(self.primitives)];
        let high = [left - low[0], self.primitives - low[1]];
        let depth = self.depth + 1;
        let child = |part, [budget, primitives]: [usize; 2]| Self { part, budget, primitives, depth };
        [child(parts[0], low), child(parts[1], high)]
    }
}

/// Room to work in; one node after the other uses it.
#[derive(Default)]
struct Scratch {
    object: ObjectScratch,
    sides: [Vec<Reference>; 2],
}

/// What the sequential part has made.
struct Made {
    nodes: Vec<Node>,
    /// References in leaf order.
    leaves: Vec<Reference>,
}

impl Builder<'_> {
    /// The subtree, and its references in leaf order.
    fn subtree(&self, mut references: Vec<Reference>, task: Task) -> (Subtree, Vec<Reference>) {
        if self.progress.is_cancelled() {
            return (Subtree::Whole(Vec::new()), Vec::new());
        }
        let mut scratch = Scratch::default();
        if references.len() > SEQUENTIAL
            && let Some(tasks) = self.split(&mut references, &task, &mut scratch)
        {
            drop(references);
            let [low, high] = scratch.sides;
            let ((low, mut leaves), (high, more)) =
                join(|| self.subtree(low, tasks[0]), || self.subtree(high, tasks[1]));
            leaves.extend(more);
            return (Subtree::split(task.part.bounds.bounds(), [low, high]), leaves);
        }
        let mut made = Made {
            nodes: Vec::with_capacity(references.len()),
            leaves: Vec::with_capacity(references.len()),
        };
        self.sequential(&mut references, 0, task, &mut made, &mut scratch);
        self.progress.add(task.primitives);
        (Subtree::Whole(made.nodes), made.leaves)
    }

    /// Builds the node of the references from `first` on, and takes them from `pending`.
    fn sequential(
        &self,
        pending: &mut Vec<Reference>,
        first: usize,
        task: Task,
        made: &mut Made,
        scratch: &mut Scratch,
    ) {
        let bounds = task.part.bounds.bounds();
        let Some(tasks) = self.split(&mut pending[first..], &task, scratch) else {
            made.nodes.push(Node::leaf(&bounds, 0, (pending.len() - first) as u32));
            made.leaves.extend(pending.drain(first..));
            return;
        };
        let this = made.nodes.len();
        made.nodes.push(Node::inner(&bounds, 0));
        // The lower side comes last, because it is built first.
        pending.truncate(first);
        let [low, high] = &mut scratch.sides;
        pending.append(high);
        let second = pending.len();
        pending.append(low);
        self.sequential(pending, second, tasks[0], made, scratch);
        made.nodes[this].link = made.nodes.len() as u32;
        self.sequential(pending, first, tasks[1], made, scratch);
    }

    /// Splits a node: the references of its children stand in `scratch.sides` then. `None` for a leaf.
    fn split(&self, references: &mut [Reference], task: &Task, scratch: &mut Scratch) -> Option<[Task; 2]> {
        let count = references.len();
        let limits = Limits::at(self.options, task.depth);
        if limits.forces_leaf(count) {
            return None;
        }
        let object = ObjectSplit::make(references, &task.part, self.options, &mut scratch.object);
        let area = task.part.bounds.half_area();
        scratch.sides.iter_mut().for_each(Vec::clear);

        let overlap = object.as_ref().map_or(f32::INFINITY, ObjectSplit::overlap);
        if task.budget > 0 && overlap > self.smallest_overlap {
            let grid = Grid::new(&task.part.bounds, self.options.bins);
            let rival = object.as_ref().filter(|object| object.fits(count, &limits));
            if let Some(spatial) = grid.best_split(references, task.budget, &limits)
                && rival.is_none_or(|rival| spatial.cost < rival.cost)
                && limits.choose(count, area, Some((spatial.cost, spatial.counts))) == Choice::Split
            {
                let parts = grid.partition(references, &spatial, task.budget, &mut scratch.sides);
                return Some(task.share(parts, scratch.sides.each_ref().map(Vec::len), count));
            }
        }

        let weighed = object.as_ref().map(|object| object.weighed(count));
        let (middle, parts) = match (limits.choose(count, area, weighed), object) {
            (Choice::Leaf, _) => return None,
            (Choice::Split, Some(object)) => (object.middle, object.parts),
            _ => halve(references, &task.part),
        };
        let (low, high) = references.split_at(middle);
        scratch.sides[0].extend_from_slice(low);
        scratch.sides[1].extend_from_slice(high);
        Some(task.share(parts, [low.len(), high.len()], count))
    }
}
