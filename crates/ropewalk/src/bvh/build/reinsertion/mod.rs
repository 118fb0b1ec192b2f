//! Parallel reinsertion (Meister and Bittner 2018): after the build, subtrees move to where they make the boxes
//! above them smaller.
//!
//! A round asks of every node how much its parent and the nodes above would shrink without it, which is what a
//! move of it may gain at most, and searches the best new place of the most promising ones ([`search`]). The
//! searches run in parallel on a tree that stands still. Then the moves are made one after the other, the largest
//! gain first ([`moving`]): each is weighed again on the tree as it is by then, so no lock is needed, and a move
//! that others have spoilt is refused and its subtree searched once more.
//!
//! **Invariants.** Every move lowers the surface area cost and keeps the depth cap, so the cost never rises, and
//! `n` rounds are the first `n` of any larger number. Leaves keep their triangles and their boxes. Searches do not
//! see each other and moves have one order, so the tree is the same for any number of threads. Where the area of
//! the root vanishes or overflows in `f32` there is nothing to compare, and the tree stays as it is.
//!
//! **Cost.** Per node 35 bytes for the tree that moves ([`tree`]) and 8 for the ranking, while it runs. A round takes
//! some 50 ns a node for the ranking and 1 µs a search. Apart from that the layout at the end is paid once.
//!
//! **What it brings.** Scenes of walls and long triangles gain much, scanned surfaces little. Measured on 2026-11-22 on
//! an AMD EPYC (family 26), one thread, with the binned builder, leaves of up to 4 and depth cap 48: the cost, the mean
//! inner visits of the ordered stack walk for primary, diffuse and (any hit) ambient occlusion rays, and the processor
//! time of the whole build. The kitchen and Crytek Sponza are seen from six places inside, the others from outside.
//!
//! | scene | rounds | cost | primary | diffuse | occlusion | ms |
//! |---|---|---|---|---|---|---|
//! | kitchen, 56,939 triangles | 0 | 54.36 | 29.2 | 32.0 | 19.2 | 16 |
//! | | 1 | 43.55 | 22.3 | 24.4 | 15.8 | 36 |
//! | | 2 | 42.49 | 20.9 | 23.4 | 15.4 | 36 |
//! | | 3 | 42.32 | 21.0 | 23.3 | 15.5 | 44 |
//! | | 5 | 42.25 | 20.9 | 23.2 | 15.4 | 64 |
//! | | 10 | 42.23 | 20.9 | 23.2 | 15.4 | 184 |
//! | Crytek Sponza, 262,205 | 0 | 76.75 | 47.0 | 40.5 | 30.4 | 77 |
//! | | 1 | 62.93 | 31.3 | 27.9 | 22.2 | 146 |
//! | | 2 | 61.45 | 31.2 | 27.1 | 21.3 | 205 |
//! | | 3 | 60.71 | 25.8 | 27.5 | 19.5 | 211 |
//! | | 5 | 60.16 | 25.4 | 27.3 | 19.2 | 280 |
//! | | 10 | 59.99 | 25.9 | 27.3 | 18.7 | 724 |
//! | bunny, 69,451 | 0 | 31.44 | 6.79 | 23.2 | 22.2 | 23 |
//! | | 1 | 31.25 | 6.80 | 23.2 | 22.2 | 33 |
//! | | 2 | 31.22 | 6.80 | 23.2 | 22.2 | 41 |
//! | | 3 | 31.19 | 6.79 | 23.2 | 22.1 | 48 |
//! | | 5 | 31.15 | 6.78 | 23.2 | 22.1 | 73 |
//! | | 10 | 31.12 | 6.77 | 23.2 | 22.1 | 193 |
//! | dragon, 871,414 | 0 | 49.10 | 7.99 | 33.4 | 30.7 | 355 |
//! | | 1 | 48.37 | 7.93 | 33.1 | 30.3 | 566 |
//! | | 2 | 48.17 | 7.93 | 33.2 | 30.3 | 704 |
//! | | 3 | 48.10 | 7.92 | 33.1 | 30.2 | 810 |
//! | | 5 | 47.94 | 7.90 | 33.0 | 30.1 | 1129 |
//! | | 10 | 47.66 | 7.87 | 32.8 | 30.0 | 2904 |
//!
//! Trees become deeper on the way (kitchen 27 to 48 and back to 36 after 1 and 3 rounds); depth cap 31 raises the cost
//! by 0.3 to 0.8 percent after 1 and 2 rounds. After 2 rounds the sweep builder's trees cost 42.35 (kitchen) and 61.31
//! (Crytek Sponza), those with spatial splits 40.18 instead of 44.41 and 58.18 instead of 64.06.
//!
//! Building with leaves of one triangle and merging them after the rounds gave no lower cost (kitchen 42.6, Crytek
//! Sponza 61.2, 3 rounds), and merging sibling leaves of a finished tree lowers it by less than 0.1 percent: leaves
//! are left alone.

mod moving;
mod search;
#[cfg(test)]
mod tests;
mod tree;

use crate::bvh::{BuildOptions, Node};
use crate::parallel::{fill_chunks, map_chunks};
use crate::processor::Processor;
use crate::{BuildError, Monitor};
use moving::Mover;
use search::{Move, Search, promise};
use std::ops::ControlFlow;
use tree::Tree;

/// The share of the nodes that a round searches places for. On Crytek Sponza and the dragon 0.05 leaves the cost 0.1
/// and 0.4 percent higher after 6 rounds; 0.2 lowers it by as much, at 1.5 to 2 times the time of a round.
const SHARE: f64 = 0.1;
/// A round that lowers the cost by less than this part of it has exhausted what so few searches find: the next ones
/// search for twice as many nodes each.
const EXHAUSTED: f64 = 1e-3;
/// In small trees as many nodes as this are searched for: it takes a millisecond.
const LEAST_SEARCHES: usize = 1024;
/// How often a round searches: first for all its nodes, then for those whose moves were refused, which are a third to
/// a half of the moves at first. The second time adds a quarter to what a first round gains, the last two 3 percent.
const PASSES: usize = 4;
/// Searches that a thread takes at a time, about 0.2 ms.
const CHUNK: usize = 256;

/// Makes up to `options.reinsertion` rounds, fewer when nothing is left to gain. The references are put into the
/// order of the leaves again.
pub(crate) fn optimise<T: Copy>(
    nodes: &[Node],
    references: &mut Vec<T>,
    options: &BuildOptions,
    monitor: &dyn Monitor,
) -> Result<Vec<Node>, BuildError> {
    optimise_at(nodes, references, options, monitor, Processor::detect())
}

/// The same with less than the processor can do.
pub(crate) fn optimise_at<T: Copy>(
    nodes: &[Node],
    references: &mut Vec<T>,
    options: &BuildOptions,
    monitor: &dyn Monitor,
    processor: Processor,
) -> Result<Vec<Node>, BuildError> {
    let Some(mut rounds) = Rounds::new(nodes, options.max_depth, processor) else {
        return Ok(nodes.to_vec());
    };
    let total = references.len();
    for _ in 0..options.reinsertion {
        if monitor.progress(total, total).is_break() {
            return Err(BuildError::Cancelled);
        }
        if rounds.next().is_break() {
            break;
        }
    }
    Ok(rounds.tree.lay_out(references))
}

/// The tree between rounds.
struct Rounds {
    tree: Tree,
    mover: Mover,
    /// A move that gains no more is none.
    least: f32,
    /// The sum over inner nodes of their areas and over leaves of their areas times triangles.
    cost: f64,
    /// The share of the nodes that the next round searches places for.
    share: f64,
    ranked: Vec<Ranked>,
    processor: Processor,
}

/// A node and the worth of a search for it.
#[derive(Clone, Copy, Default)]
struct Ranked {
    worth: f32,
    slot: u32,
}

impl Rounds {
    /// `None` where no move is possible or none can be told to be one.
    fn new(nodes: &[Node], max_depth: u32, processor: Processor) -> Option<Self> {
        // Two leaves have one place each.
        let root_area = nodes.first().filter(|_| nodes.len() > 3)?.bounds().half_area();
        if !(root_area > 0.0 && root_area.is_finite()) {
            return None;
        }
        // Far below what is worth a move, far above what is lost when a million areas are added up in f64.
        let least = root_area * 1e-9;
        let cost = nodes
            .iter()
            .map(|node| f64::from(node.bounds().half_area()) * f64::from(node.count.max(1)))
            .sum();
        let tree = Tree::new(nodes);
        let ranked = vec![Ranked::default(); tree.slots().len()];
        let mover = Mover::new(max_depth, f64::from(least));
        Some(Self { tree, mover, least, cost, share: SHARE, ranked, processor })
    }

    /// Makes a round; `Break` when no further one can gain anything.
    fn next(&mut self) -> ControlFlow<()> {
        let wanted = LEAST_SEARCHES.max((self.share * self.ranked.len() as f64) as usize);
        let mut slots = self.most_promising(wanted);
        let all = slots.len() < wanted;
        let mut gain = 0.0;
        for _ in 0..PASSES {
            let moves = self.search(&slots);
            slots.clear();
            gain += self.make(moves, &mut slots);
            if slots.is_empty() {
                break;
            }
        }
        if gain < EXHAUSTED * self.cost {
            if all && gain == 0.0 {
                return ControlFlow::Break(());
            }
            self.share *= 2.0;
        }
        self.cost -= gain;
        ControlFlow::Continue(())
    }

    /// Makes moves and tells what they gain; adds the subtrees whose moves are refused.
    fn make(&mut self, moves: Vec<Move>, refused: &mut Vec<u32>) -> f64 {
        let Self { tree, mover, processor, .. } = self;
        processor.run(
            #[inline(always)]
            || {
                let mut gain = 0.0;
                for one in moves {
                    match mover.apply(tree, one) {
                        Some(gained) => gain += gained,
                        None => refused.push(one.moved),
                    }
                }
                gain
            },
        )
    }

    /// The up to `wanted` nodes for which a search is worth most, by slot.
    fn most_promising(&mut self, wanted: usize) -> Vec<u32> {
        let (tree, least, first_slot, processor) =
            (&self.tree, self.least, self.tree.slots().start, self.processor);
        fill_chunks(&mut self.ranked, CHUNK * 16, |first, part| {
            processor.run(
                #[inline(always)]
                || {
                    for (place, slot) in part.iter_mut().zip(first_slot + first as u32..) {
                        let promise = promise(tree, slot);
                        // A small subtree is more likely to find a place that keeps the promise.
                        let worth = if promise > least { promise / tree.area(slot).sqrt() } else { 0.0 };
                        *place = Ranked { worth, slot };
                    }
                },
            );
        });
        let ranked = match wanted.checked_sub(1).filter(|&last| last < self.ranked.len()) {
            None => &self.ranked[..],
            Some(last) => {
                let order = |a: &Ranked, b: &Ranked| b.worth.total_cmp(&a.worth).then(a.slot.cmp(&b.slot));
                self.ranked.select_nth_unstable_by(last, order);
                &self.ranked[..=last]
            }
        };
        let mut slots: Vec<u32> =
            ranked.iter().filter(|node| node.worth > 0.0).map(|node| node.slot).collect();
        slots.sort_unstable();
        slots
    }

    /// The best moves of some subtrees, the largest gain first.
    fn search(&self, slots: &[u32]) -> Vec<Move> {
        let found = map_chunks(slots, CHUNK, |_, part| {
            let (mut search, mut moves) = (Search::new(&self.tree), Vec::new());
            self.processor.run(
                #[inline(always)]
                || {
                    for &slot in part {
                        moves.extend(search.best_move(slot, self.least));
                    }
                },
            );
            moves
        });
        let mut moves = found.concat();
        moves.sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.moved.cmp(&b.moved)));
        moves
    }
}
