//! Building from scratch: binned SAH while a node is large, [`super::few`] below that.
//!
//! With one entry a leaf a subtree of `k` entries has `2k - 1` nodes, so each knows its place before it is built:
//! nodes are written once, where they stay, and threads that build two subtrees write to two parts of one array.

use super::few::{Few, MANY};
use super::{MAX_DEPTH, TopLevelError};
use crate::bvh::Node;
use crate::bvh::build::binned_sah::{Binning, Bins};
use crate::bvh::build::part::{Part, halve};
use crate::bvh::build::reference::Reference;
use crate::parallel::join;
use crate::{Aabb, BuildOptions};

/// A node with fewer entries is built, with all below it, by one thread: some 2 ms of work.
const SEQUENTIAL: usize = 8192;
/// Candidate planes an axis. Few nodes are binned, so many planes cost little.
const BINS: u32 = BuildOptions::MAX_BINS as u32;

/// Room that one thread works in: 9 kB, on its stack.
#[derive(Default)]
struct Scratch {
    bins: Bins,
    few: Few,
}

/// Makes references of boxes, in `references`, and measures them.
pub(super) fn refer_to(boxes: &[Aabb], references: &mut Vec<Reference>) -> Result<Part, TopLevelError> {
    references.clear();
    references.reserve(boxes.len());
    let mut part = Part::EMPTY;
    for (entry, bounds) in boxes.iter().enumerate() {
        if !is_usable(bounds) {
            return Err(TopLevelError::Box { entry });
        }
        let reference = Reference::new(bounds, entry as u32);
        part.add(&reference);
        references.push(reference);
    }
    Ok(part)
}

/// Whether an entry may have this box.
pub(super) fn is_usable(bounds: &Aabb) -> bool {
    bounds.min.is_finite() && bounds.max.is_finite() && !bounds.is_empty()
}

/// Builds the subtree of all `references` into `nodes`, of which there must be twice as many less one. `base` is the
/// index of the first node in the whole tree, `depth` its depth.
pub(super) fn build(nodes: &mut [Node], base: usize, references: &mut [Reference], part: &Part, depth: u32) {
    debug_assert_eq!(nodes.len() + 1, 2 * references.len());
    subtree(nodes, base, references, part, depth, &mut Scratch::default());
}

fn subtree(
    nodes: &mut [Node],
    base: usize,
    references: &mut [Reference],
    part: &Part,
    depth: u32,
    scratch: &mut Scratch,
) {
    let count = references.len();
    let levels = MAX_DEPTH.saturating_sub(depth);
    if count <= MANY {
        scratch.few.build(nodes, base, references, levels);
        return;
    }
    let binning = Binning::new(part, count, BINS);
    let (middle, parts) = match binning.best_split(references, &mut scratch.bins) {
        Some(split) if fits(split.counts, levels) => binning.partition(references, &split),
        _ => halve(references, part),
    };
    let (low, high) = references.split_at_mut(middle);
    let Some((this, below)) = nodes.split_first_mut() else { return };
    let (near, far) = below.split_at_mut(2 * middle - 1);
    let second = base + 2 * middle;
    *this = Node::inner(&part.bounds.bounds(), second as u32);
    let [low_part, high_part] = &parts;
    if count > SEQUENTIAL {
        join(
            || subtree(near, base + 1, low, low_part, depth + 1, scratch),
            || subtree(far, second, high, high_part, depth + 1, &mut Scratch::default()),
        );
    } else {
        subtree(near, base + 1, low, low_part, depth + 1, scratch);
        subtree(far, second, high, high_part, depth + 1, scratch);
    }
}

/// Whether two children of so many entries each fit under a node that has `levels` levels below it.
pub(super) fn fits(counts: [usize; 2], levels: u32) -> bool {
    let room = 1_u64 << levels.saturating_sub(1).min(63);
    counts.iter().all(|&count| count as u64 <= room)
}
