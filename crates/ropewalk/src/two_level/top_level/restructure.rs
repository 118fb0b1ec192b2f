//! Local restructuring: builds those subtrees anew that moving boxes have made bad (after Yoon, Curtis, Manocha 2007).
//!
//! **Efficiency.** The paper judges a node by how many tests below it a ray is expected to make that has met its box. Here that is
//! the sum of the areas of the inner nodes of its subtree over its own area. Refitting raises it where entries that were together
//! part: the boxes between them and the node grow, up to the node's own. Boxes that only grow or move together leave it as it is.
//!
//! **Benefit.** If building the subtree anew makes it as efficient again as it was when it was built, this much of the cost goes:
//! its area times what the efficiency has become worse by. Against it stands the work: a subtree of `k` of the `n` entries is
//! `k log k` of the `n log n` of building everything. The `tolerance` is what building everything would have to save to be worth it,
//! as a part of the cost; a subtree has to save its share of that.
//!
//! **Choice.** One pass from the last node to the first: a node is built anew where its benefit, less its share of the work, is more
//! than what the best choice below it brings. So the chosen subtrees do not overlap, and no other set of subtrees promises more.
//!
//! **In place.** A subtree of `k` entries has `2k - 1` nodes, whichever way it is built, so nothing else moves. The new one is taken
//! only where it is cheaper; either way it counts as built just now, so that what cannot be better is not tried in every frame.
//! The cost never rises.
//!
//! Measured with 10,000 entries, those in a quarter of the scene moved at random by up to a quarter of its side, tolerance 0.05, as in the
//! table of [`super`]:
//!
//! | boxes | drift after refitting | after restructuring | if all is built anew | entries in what was rebuilt | time |
//! |---|---|---|---|---|---|
//! | of like sizes | 1.45 | 0.79 | 0.79 | 5,003 | 1.6 ms |
//! | of very different sizes | 1.06 | 0.87 | 0.84 | 3,833 | 1.1 ms |
//! | on a plain, one of 100 large | 1.15 | 1.01 | 1.00 | 2,433 | 0.8 ms |
//!
//! 16 bytes a node to work in, and 4 a node to remember efficiencies.

use super::{TopLevel, build, cost};
use crate::bvh::Node;
use crate::bvh::build::part::Part;
use crate::bvh::build::reference::Reference;
use bytemuck::Zeroable;
use std::ops::Range;

/// What [`TopLevel::restructure`] did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Restructuring {
    /// Subtrees that were built anew.
    pub rebuilt: usize,
    /// How many of those came out cheaper, and were taken.
    pub taken: usize,
    /// Entries in all of them.
    pub entries: usize,
}

/// What is known of a node's subtree.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Measure {
    /// The sum of the areas of its inner nodes.
    cost: f32,
    /// Nodes.
    size: u32,
    /// What the best choice of subtrees in it brings.
    best: f32,
    /// Whether that is the subtree itself.
    is_chosen: bool,
}

impl TopLevel {
    /// Builds subtrees anew that have become bad since they were built, where that saves enough: see the module's text for
    /// `tolerance`, of which 0.05 is a usual value. Takes the boxes as the last [`TopLevel::refit`] left them. What it changes joins
    /// [`TopLevel::changed`].
    pub fn restructure(&mut self, tolerance: f32) -> Restructuring {
        let mut report = Restructuring::default();
        // Nothing has moved since the whole was built, or there is nothing to choose.
        if self.built_efficiency.len() != self.nodes.len() || self.nodes.len() < 5 {
            return report;
        }
        self.measure(tolerance);
        self.restructure_below(0, 0, &mut report);
        self.changes.merge();
        report
    }

    /// Goes from a node down to what is chosen, and builds that.
    fn restructure_below(&mut self, index: usize, depth: u32, report: &mut Restructuring) {
        let (Some(&measure), Some(&node)) = (self.measures.get(index), self.nodes.get(index)) else { return };
        if measure.is_chosen {
            let range = index..index + measure.size as usize;
            report.rebuilt += 1;
            report.entries += range.len().div_ceil(2);
            report.taken += usize::from(self.rebuild_subtree(range, depth));
        } else if measure.best > 0.0 {
            self.restructure_below(index + 1, depth + 1, report);
            self.restructure_below(node.link as usize, depth + 1, report);
        }
    }

    /// Fills the measures.
    fn measure(&mut self, tolerance: f32) {
        self.measures.clear();
        self.measures.resize(self.nodes.len(), Measure::default());
        let whole = self.nodes.iter().filter(|node| !node.is_leaf()).map(cost::half_area).sum::<f64>() as f32;
        let price = tolerance.max(0.0) * whole / work(self.entries());
        for index in (0..self.nodes.len()).rev() {
            let node = self.nodes[index];
            if node.is_leaf() {
                self.measures[index].size = 1;
                continue;
            }
            let (Some(&first), Some(&second)) =
                (self.measures.get(index + 1), self.measures.get(node.link as usize))
            else {
                continue;
            };
            let area = cost::half_area(&node) as f32;
            let size = 1 + first.size + second.size;
            let cost = area + first.cost + second.cost;
            let below = first.best + second.best;
            let benefit =
                cost - area * self.built_efficiency[index] - price * work(size.div_ceil(2) as usize);
            // Comparisons with NaN, where areas overflow, choose nothing.
            let is_chosen = benefit > below;
            let best = if is_chosen { benefit } else { below };
            self.measures[index] = Measure { cost, size, best, is_chosen };
        }
    }

    /// Builds the subtree of a range of nodes; tells whether it has become cheaper. If not, it stays as it was.
    fn rebuild_subtree(&mut self, range: Range<usize>, depth: u32) -> bool {
        let Some(old) = self.nodes.get(range.clone()) else { return false };
        let mut part = Part::EMPTY;
        self.references.clear();
        for leaf in old.iter().filter(|node| node.is_leaf()) {
            let reference = Reference::new(&leaf.bounds(), leaf.link);
            part.add(&reference);
            self.references.push(reference);
        }
        // In the order of entries, so that the tree depends on the boxes alone.
        self.references.sort_unstable_by_key(Reference::index);
        self.rebuilt.clear();
        self.rebuilt.resize(range.len(), Node::zeroed());
        build::build(&mut self.rebuilt, range.start, &mut self.references, &part, depth);
        let sum = |nodes: &[Node]| nodes.iter().map(cost::half_area).sum::<f64>();
        let is_cheaper = sum(&self.rebuilt) < sum(old);
        if is_cheaper && let Some(place) = self.nodes.get_mut(range.clone()) {
            place.copy_from_slice(&self.rebuilt);
            self.changes.add(range.clone());
        }
        remember_in(&self.nodes, range, &mut self.measures, &mut self.built_efficiency);
        is_cheaper
    }
}

/// The work of building a subtree of so many entries.
fn work(entries: usize) -> f32 {
    let entries = entries as f32;
    entries * entries.log2().max(1.0)
}

/// Remembers how efficient the nodes are.
pub(super) fn remember(nodes: &[Node], efficiency: &mut Vec<f32>, measures: &mut Vec<Measure>) {
    efficiency.clear();
    efficiency.resize(nodes.len(), 0.0);
    measures.clear();
    measures.resize(nodes.len(), Measure::default());
    remember_in(nodes, 0..nodes.len(), measures, efficiency);
}

/// The same for the nodes of one subtree.
fn remember_in(nodes: &[Node], range: Range<usize>, measures: &mut [Measure], efficiency: &mut [f32]) {
    for index in range.rev() {
        let Some(node) = nodes.get(index).filter(|node| !node.is_leaf()) else {
            if let Some(measure) = measures.get_mut(index) {
                measure.cost = 0.0;
            }
            continue;
        };
        let area = cost::half_area(node) as f32;
        let below = |child: usize| measures.get(child).map_or(0.0, |measure| measure.cost);
        let cost = area + below(index + 1) + below(node.link as usize);
        if let (Some(measure), Some(place)) = (measures.get_mut(index), efficiency.get_mut(index)) {
            measure.cost = cost;
            // Without area nothing can be gained; the cost is no number then, and chooses nothing.
            *place = cost / area;
        }
    }
}
