//! The binary splits of a range of references, by one thread.

use super::bins::{Binning, Bins, Planes};
use super::lanes::Lanes;
use super::options::BinnedOptions;
use super::partition::partition;
use crate::bvh8::build::draft::Draft;
use crate::bvh8::build::reference::{Part, Reference, halve};

/// The most splits on a path from the root. So a path has no more nodes, [`MAX_LEVELS`](crate::bvh8::tree::MAX_LEVELS): each
/// wide node stands for at least one split.
///
/// It is kept for any input: a range at some depth is split by the heuristic only if both sides can be halved down to single
/// references in the levels that are left, and is halved otherwise. Halves of what fits fit; 2^31 references fit into 31
/// levels, the root has 60.
pub(super) const MAX_DEPTH: u32 = 60;

/// Whether two sides can be halved down to single references below a split at some depth.
#[inline(always)]
pub(super) fn fits(depth: u32, counts: [usize; 2]) -> bool {
    let levels = MAX_DEPTH.saturating_sub(depth + 1);
    counts.iter().all(|&count| count as u64 <= 1 << levels)
}

/// Splits small ranges.
pub(super) struct Grower {
    pub(super) planes: Planes,
    smallest_split: usize,
}

/// What one thread needs to work in, kept from range to range.
pub(super) struct Room {
    pub(super) sets: [Bins; 2],
    /// The splits of the last range, first halves right after the whole.
    pub(super) drafts: Vec<Draft>,
    /// The ones of them that stay open.
    pub(super) crown: Vec<Draft>,
    waiting: Vec<Waiting>,
}

impl Room {
    pub(super) fn new() -> Self {
        Self { sets: [Bins::EMPTY, Bins::EMPTY], drafts: Vec::new(), crown: Vec::new(), waiting: Vec::new() }
    }
}

/// The second half of a split, while the first one is worked on.
struct Waiting {
    first: usize,
    count: usize,
    part: Part,
    depth: u32,
    /// The draft that was split.
    parent: u32,
}

impl Grower {
    pub(super) const fn new(options: &BinnedOptions) -> Self {
        Self {
            planes: Planes::new(options.bins, options.max_leaf),
            smallest_split: options.smallest_split as usize,
        }
    }

    /// Splits `references` until there is nothing left to split. The drafts count their first references from the range's.
    #[inline(always)]
    pub(super) fn grow<L: Lanes>(
        &self,
        lanes: L,
        references: &mut [Reference],
        part: &Part,
        depth: u32,
        room: &mut Room,
    ) {
        let Room { sets, drafts, waiting, .. } = room;
        drafts.clear();
        // More than there will be: only what is used is touched.
        drafts.reserve(references.len());
        waiting.clear();
        let (mut first, mut count, mut part, mut depth) = (0, references.len(), *part, depth);
        loop {
            let index = drafts.len() as u32;
            drafts.push(Draft::new(&part.bounds, first as u32, count as u32));
            if count > self.smallest_split {
                let (low, [near, far]) =
                    self.split(lanes, &mut references[first..first + count], &part, depth, sets);
                depth += 1;
                let second =
                    Waiting { first: first + low, count: count - low, part: far, depth, parent: index };
                waiting.push(second);
                (count, part) = (low, near);
                continue;
            }
            let Some(next) = waiting.pop() else { return };
            let index = drafts.len() as u32;
            drafts[next.parent as usize].split(index);
            (first, count, part, depth) = (next.first, next.count, next.part, next.depth);
        }
    }

    #[inline(always)]
    fn split<L: Lanes>(
        &self,
        lanes: L,
        references: &mut [Reference],
        part: &Part,
        depth: u32,
        sets: &mut [Bins; 2],
    ) -> (usize, [Part; 2]) {
        let binning = Binning::new(part, references.len(), self.planes);
        Bins::fill(lanes, sets, &binning, references);
        match sets[0].best_split(lanes, &binning) {
            // Where all areas vanish, no plane is better than another, and the first would make a chain.
            Some(split) if split.cost > 0.0 && fits(depth, [split.low, references.len() - split.low]) => {
                let (low, [near, far]) = partition(lanes, references, binning.side(split.axis, split.bin));
                debug_assert_eq!(low, split.low);
                let [bounds, far_bounds] = split.bounds;
                (low, [Part { bounds, centers: near }, Part { bounds: far_bounds, centers: far }])
            }
            _ => halve(references, part),
        }
    }
}
