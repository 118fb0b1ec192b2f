//! What the collapse weighs: the least expected cost of every subtree, by dynamic programming.
//!
//! A ray that enters a box pays 1 for the node behind it or 1 for the leaf behind it, however much is in either: both
//! are one test of eight lanes. `cost(n, i)` is the least cost of the subtree of the binary node `n` where it may use at
//! most `i` places of the wide node above it:
//! ```text
//! cost(n, 1)   = area                                      n becomes a leaf, where its references fit one
//!              = area + spread(n, 8)                       otherwise: a wide node
//! cost(n, i)   = min(spread(n, i), cost(n, i - 1))
//! spread(n, i) = min over 0 < k < i of cost(first, k) + cost(second, i - k)
//! ```
//! The scheme is that of Ylitie, Karras and Laine (2017). 32 bytes a binary node, some 25 ns, as many threads as there
//! are: the subtrees of a tree in depth-first order are slices of it.

use super::collapse::Bottom;
use crate::bvh::Node;
use crate::bvh8::tree::WIDTH;
use crate::parallel::join;
use crate::processor::Processor;

/// The places that a subtree may get beside another one.
pub(in crate::bvh8) const ROWS: usize = WIDTH - 1;
/// A subtree of fewer nodes is weighed by one thread: 0.1 ms.
const SEQUENTIAL: usize = 1 << 12;

/// Of a binary node.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::bvh8) struct Cost {
    /// The least cost with at most 1, 2, .. 7 places.
    pub(in crate::bvh8) least: [f32; ROWS],
    /// The references below, not more than `u32::MAX`.
    pub(in crate::bvh8) references: u32,
}

/// The costs of all nodes, which lie in depth-first order.
pub(super) fn weigh(nodes: &[Node], max_leaf: u32, bottom: &impl Bottom, processor: Processor) -> Vec<Cost> {
    let mut costs = vec![Cost::default(); nodes.len()];
    if !nodes.is_empty() {
        let weighing = Weighing { nodes, max_leaf, bottom, processor };
        weighing.below(0, &mut costs);
    }
    costs
}

struct Weighing<'a, B> {
    nodes: &'a [Node],
    max_leaf: u32,
    bottom: &'a B,
    processor: Processor,
}

impl<B: Bottom> Weighing<'_, B> {
    /// Fills in the costs of the subtree at `root`, which is as long as `costs`.
    fn below(&self, root: usize, costs: &mut [Cost]) {
        if costs.len() <= SEQUENTIAL {
            return self.processor.run(
                #[inline(always)]
                || self.sequential(root, costs),
            );
        }
        let second = self.nodes[root].link as usize;
        let [this, below @ ..] = costs else { return };
        let (low, high) = below.split_at_mut(second - root - 1);
        join(|| self.below(root + 1, low), || self.below(second, high));
        if let (Some(first), Some(second)) = (low.first(), high.first()) {
            *this = of_inner(&self.nodes[root], first, second, self.max_leaf);
        }
    }

    #[inline(always)]
    fn sequential(&self, root: usize, costs: &mut [Cost]) {
        // Children come after their parents.
        for place in (0..costs.len()).rev() {
            let node = &self.nodes[root + place];
            costs[place] = if node.is_leaf() {
                self.bottom.weigh(node)
            } else {
                of_inner(node, &costs[place + 1], &costs[node.link as usize - root], self.max_leaf)
            };
        }
    }
}

#[inline(always)]
fn of_inner(node: &Node, first: &Cost, second: &Cost, max_leaf: u32) -> Cost {
    let spreads = spreads(first, second);
    let references = first.references.saturating_add(second.references);
    let mut least = [half_area(node); ROWS];
    if references > max_leaf {
        least[0] += spreads[WIDTH - 2];
    }
    for places in 2..=ROWS {
        least[places - 1] = smaller(spreads[places - 2], least[places - 2]);
    }
    Cost { least, references }
}

/// The least cost of two subtrees in 2, 3, .. 8 places.
#[inline(always)]
fn spreads(first: &Cost, second: &Cost) -> [f32; ROWS] {
    let mut spreads = [f32::INFINITY; ROWS];
    for (share, one) in first.least.iter().enumerate() {
        for (spread, other) in spreads[share..].iter_mut().zip(&second.least) {
            *spread = smaller(*spread, one + other);
        }
    }
    spreads
}

/// The least cost of two subtrees in `places` places, 2 to 8, and how many of them the first one gets; the fewest of
/// equals. To the bit what [`weigh`] has found.
pub(super) fn spread(first: &Cost, second: &Cost, places: usize) -> (f32, usize) {
    let mut best = (f32::INFINITY, 1);
    for (share, one) in first.least[..places - 1].iter().enumerate() {
        let cost = one + second.least[places - share - 2];
        if cost < best.0 {
            best = (cost, share + 1);
        }
    }
    best
}

/// Half the surface area of a node, which is not empty.
#[inline(always)]
pub(in crate::bvh8) fn half_area(node: &Node) -> f32 {
    let [low, high] = node.corners();
    let size = high - low;
    size.x * size.y + size.y * size.z + size.z * size.x
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
