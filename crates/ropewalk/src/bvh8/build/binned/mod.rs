//! The binned builder: surface area splits (Wald 2007), eight-wide nodes and full leaves, in parallel and deterministic.
//!
//! A range of references is split in two at the cheapest plane between bins until it is small enough for one thread's cache
//! ([`SEQUENTIAL`]). From there one thread splits on ([`grow`]), decides which splits share a wide node and which ranges
//! become leaves ([`super::draft`]), and writes the nodes; the drafts never leave its cache. The splits above are collapsed
//! in the same way at the end, with the topmost levels of what the threads made, which stay open until then.
//!
//! Where a range is given to a thread depends on its size alone; minima and counts do not depend on the order in which they
//! are taken; and wider registers do the same operations in the same order: the tree is the same for any number of threads and
//! with any instructions.
//!
//! Memory beside the tree and its order: 32 bytes a reference, which end before the nodes stand there a second time while they
//! are put together; about 8 bytes a reference for what stays open; a megabyte a thread.

mod bins;
mod grow;
mod kernels;
mod lanes;
mod options;
mod partition;
mod subtree;
#[cfg(test)]
mod tests;

pub(crate) use options::BinnedOptions;

use super::draft::{Collapse, Costs, Outcome};
use super::reference::{self, Part, Reference, halve};
use crate::bvh8::tree::{Child, Tree, TreeNode};
use crate::parallel::{join, map_chunks};
use crate::processor::Processor;
use crate::progress::Progress;
use crate::{BuildError, FlatTriangle, Monitor, NoMonitor};
use bins::{Binning, Bins};
use grow::{Grower, Room, fits};
use std::sync::Mutex;
use subtree::{Finished, Subtree};

/// Bins count in 32 bits with a sign, and round up.
const MOST_TRIANGLES: usize = (1 << 31) - 16;
/// A range of no more references is built by one thread: they and their drafts take half a megabyte, a core's own cache.
const SEQUENTIAL: usize = 1 << 13;
/// So many levels of nodes below the first of a range stay open until the splits above are known. Were every range a node of
/// its own, the expected cost of a kitchen would be 6 percent above the least that the splits allow, of a bunny and of a
/// dragon 2.4; with one level open it is 0.3, 1.0 and 1.1 above, with two 0.1, 0.7 and 0.8, with three nothing, but then all
/// of a range is open.
const OPEN_LEVELS: u32 = 2;
/// A range of more references is binned by several threads.
const PARALLEL_BINNING: usize = 1 << 16;

/// Builds the tree.
///
/// # Errors
/// When an option is out of range, there are more triangles than can be counted, or the monitor says stop.
pub(crate) fn build_binned(
    triangles: &[FlatTriangle],
    options: &BinnedOptions,
    monitor: &dyn Monitor,
) -> Result<Tree, BuildError> {
    build_at(triangles, options, monitor, Processor::detect())
}

fn build_at(
    triangles: &[FlatTriangle],
    options: &BinnedOptions,
    monitor: &dyn Monitor,
    processor: Processor,
) -> Result<Tree, BuildError> {
    options.check()?;
    if triangles.len() > MOST_TRIANGLES {
        return Err(BuildError::TooMany { what: "triangles", count: triangles.len(), limit: MOST_TRIANGLES });
    }
    build_over(reference::of_triangles(triangles), options, monitor, processor)
}

/// Builds the tree over boxes, of which there are as many as an instance's index can count.
///
/// # Errors
/// When an option is out of range.
pub(crate) fn build_boxes(boxes: Vec<Reference>, options: &BinnedOptions) -> Result<Tree, BuildError> {
    options.check()?;
    build_over(boxes, options, &NoMonitor, Processor::detect())
}

fn build_over(
    mut references: Vec<Reference>,
    options: &BinnedOptions,
    monitor: &dyn Monitor,
    processor: Processor,
) -> Result<Tree, BuildError> {
    let mut order = vec![0; references.len()];
    let builder = Builder {
        costs: options.costs(),
        grower: Grower::new(options),
        processor,
        progress: Progress::new(monitor, references.len()),
        rooms: Mutex::new(Vec::new()),
    };
    let part = Part::measure(&references);
    let range = Range { references: &mut references, order: &mut order, first: 0 };
    let subtree = builder.subtree(range, &part, 0);
    builder.progress.finish()?;
    // Before the nodes stand there twice.
    drop(references);
    Ok(Tree { nodes: subtree.into_nodes(builder.costs), order })
}

struct Builder<'a> {
    costs: Costs,
    grower: Grower,
    processor: Processor,
    progress: Progress<'a>,
    /// Of threads that are between two ranges.
    rooms: Mutex<Vec<Room>>,
}

/// Some references, and the places of their triangles in the order of the leaves.
struct Range<'a> {
    references: &'a mut [Reference],
    order: &'a mut [u32],
    /// The place of the first of them among all.
    first: u32,
}

impl Range<'_> {
    fn split_at(&mut self, middle: usize) -> [Range<'_>; 2] {
        let (low, high) = self.references.split_at_mut(middle);
        let (low_order, high_order) = self.order.split_at_mut(middle);
        [
            Range { references: low, order: low_order, first: self.first },
            Range { references: high, order: high_order, first: self.first + middle as u32 },
        ]
    }
}

impl Builder<'_> {
    fn subtree(&self, mut range: Range<'_>, part: &Part, depth: u32) -> Subtree {
        if range.references.len() <= SEQUENTIAL {
            return Subtree::Finished(self.finished(range, part, depth));
        }
        if self.progress.is_cancelled() {
            return Subtree::Finished(Finished::nothing());
        }
        let (middle, parts) = self.split(range.references, part, depth);
        let [low, high] = range.split_at(middle);
        let children =
            join(|| self.subtree(low, &parts[0], depth + 1), || self.subtree(high, &parts[1], depth + 1));
        Subtree::Split { bounds: part.bounds, children: Box::new(children.into()) }
    }

    /// Partitions the references in two and tells where.
    fn split(&self, references: &mut [Reference], part: &Part, depth: u32) -> (usize, [Part; 2]) {
        let binning = Binning::new(part, references.len(), self.grower.planes);
        let bins = if references.len() > PARALLEL_BINNING {
            let parts =
                map_chunks(references, PARALLEL_BINNING / 4, |_, chunk| self.bins_of(chunk, &binning));
            let mut all = Bins::EMPTY;
            parts.iter().for_each(|bins| self.processor.merge(&mut all, bins, &binning));
            all
        } else {
            self.bins_of(references, &binning)
        };
        match self.processor.best_split(&bins, &binning) {
            Some(split) if split.cost > 0.0 && fits(depth, [split.low, references.len() - split.low]) => {
                let side = binning.side(split.axis, split.bin);
                let (low, [near, far]) = self.processor.partition(references, side);
                let [bounds, far_bounds] = split.bounds;
                (low, [Part { bounds, centers: near }, Part { bounds: far_bounds, centers: far }])
            }
            _ => halve(references, part),
        }
    }

    fn bins_of(&self, references: &[Reference], binning: &Binning) -> Bins {
        let mut sets = [Bins::EMPTY, Bins::EMPTY];
        self.processor.fill(&mut sets, binning, references);
        let [bins, _] = sets;
        bins
    }

    fn finished(&self, range: Range<'_>, part: &Part, depth: u32) -> Finished {
        if self.progress.is_cancelled() || range.references.is_empty() {
            return Finished::nothing();
        }
        let mut room = self.take_room();
        self.processor.grow(&self.grower, range.references, part, depth, &mut room);
        for (place, reference) in range.order.iter_mut().zip(&*range.references) {
            *place = reference.index();
        }
        let Room { drafts, crown, .. } = &mut room;
        let mut collapse = Collapse { drafts, costs: self.costs };
        self.processor.run(
            #[inline(always)]
            || collapse.weigh(),
        );
        // About one node comes to so many references.
        let mut nodes = Vec::with_capacity(range.references.len() / 12 + 1);
        crown.clear();
        if depth == 0 {
            let leaf = |first, count| Child::leaf(first, count);
            if let Outcome::Leaf { first, count } = collapse.emit(&mut nodes, leaf) {
                let mut node = TreeNode::EMPTY;
                node.set(0, &part.bounds.bounds(), leaf(first, count));
                nodes.push(node);
            }
        } else {
            collapse.emit_crown(OPEN_LEVELS, range.first, &mut nodes, crown);
        }
        let crown = crown.as_slice().into();
        self.progress.add(range.references.len());
        self.give_room(room);
        Finished { nodes, crown }
    }

    fn take_room(&self) -> Room {
        let waiting = self.rooms.lock().ok().and_then(|mut rooms| rooms.pop());
        waiting.unwrap_or_else(Room::new)
    }

    fn give_room(&self, room: Room) {
        if let Ok(mut rooms) = self.rooms.lock() {
            rooms.push(room);
        }
    }
}
