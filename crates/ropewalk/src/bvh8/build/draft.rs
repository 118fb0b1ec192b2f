//! Drafts: the binary splits of a range of references, and the cheapest way to make wide nodes and leaves of them.
//!
//! The surface area heuristic counts the visits that a ray is expected to make: a wide node costs the same whatever its
//! children, and so does a leaf, because one SIMD test takes all of its triangles. So a draft goes on splitting below the
//! largest leaf, and then is decided which of its ranges become leaves and which of its splits share a wide node (the
//! dynamic programming of Wald, Benthin, Boulos 2008, in the form of Ylitie, Karras, Laine 2017):
//! ```text
//! leaf(n)        = area * (leaf + triangle * count)          only up to the largest leaf
//! cost(n, 1)     = min(leaf(n), area * node + spread(n, 8))
//! cost(n, i)     = min(spread(n, i), cost(n, i - 1))         i places of the wide node above, 1 < i < 8
//! spread(n, i)   = min over 0 < k < i of cost(low, k) + cost(high, i - k)
//! ```
//! One pass from the last draft to the first finds the costs; the choices are found again on the way down. A draft takes 64
//! bytes, and no more of them live at a time than one thread makes of a range that fits into its cache.

#[cfg(test)]
mod tests;

use super::extent::Extent;
use crate::bvh8::tree::{Child, LARGEST_LEAF, TreeNode, WIDTH};

/// The most places that one child may take of its node.
const ROWS: usize = WIDTH - 1;
/// Areas below this count as this. Where everything lies on a line, or in a point, the number of nodes decides.
const SMALLEST_AREA: f32 = 1e-30;

/// A range of references: split in two, or not.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Draft {
    /// Smallest x, y, z, largest x, y, z.
    corners: [f32; 6],
    /// The first reference.
    first: u32,
    count: u32,
    /// The least costs in at most 1, 2, .. places of a wide node.
    costs: [f32; ROWS],
    /// The draft of the second half; 0 where there is no split. The first half's follows this one.
    second: u32,
}

/// What visits and tests cost, relative to each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Costs {
    pub(crate) node: f32,
    /// Of leaves of 1, 2, .. triangles; infinite for those that may not be.
    leaves: [f32; LARGEST_LEAF as usize],
}

impl Costs {
    /// A leaf of at most `max_leaf` triangles costs `leaf` and `triangle` for each.
    pub(crate) fn new(node: f32, leaf: f32, triangle: f32, max_leaf: u32) -> Self {
        let leaves = std::array::from_fn(|index| {
            if index < max_leaf as usize { leaf + triangle * (index + 1) as f32 } else { f32::INFINITY }
        });
        Self { node, leaves }
    }

    fn leaf(&self, count: u32) -> f32 {
        self.leaves.get((count as usize).wrapping_sub(1)).copied().unwrap_or(f32::INFINITY)
    }
}

impl Draft {
    /// More references than any leaf has.
    pub(crate) const MANY: u32 = u32::MAX - 1;
    /// The number of references of what has become a node, in place of a number; its first reference is the node.
    pub(crate) const FINISHED: u32 = u32::MAX;

    /// A range that is not split, or not yet.
    #[inline(always)]
    pub(crate) fn new(bounds: &Extent, first: u32, count: u32) -> Self {
        Self { corners: bounds.corners(), first, count, costs: [0.0; ROWS], second: 0 }
    }

    /// What stands for the draft when it has become that node: its costs are no longer a matter of choice.
    fn finished(self, node: u32) -> Self {
        Self { first: node, count: Self::FINISHED, costs: [0.0; ROWS], second: 0, ..self }
    }

    /// The draft behind `before` others, where what is finished is behind `nodes` others.
    pub(crate) fn shifted(self, before: u32, nodes: u32) -> Self {
        let first = if self.is_finished() { self.first + nodes } else { self.first };
        let second = if self.second == 0 { 0 } else { self.second + before };
        Self { first, second, ..self }
    }

    /// Splits it: its second half is that draft, its first half the one that follows.
    #[inline(always)]
    pub(crate) fn split(&mut self, second: u32) {
        self.second = second;
    }

    #[inline(always)]
    fn area(&self) -> f32 {
        let [x, y, z, to_x, to_y, to_z] = self.corners;
        let [x, y, z] = [to_x - x, to_y - y, to_z - z];
        // A comparison that fails for NaN: there is none, but the costs below must be numbers whatever happens.
        let area = x * y + y * z + z * x;
        if area > SMALLEST_AREA { area } else { SMALLEST_AREA }
    }

    const fn is_finished(&self) -> bool {
        self.count == Self::FINISHED
    }
}

/// What a draft has become, seen from the node above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Some references, counted from the first of the range.
    Leaf { first: u32, count: u32 },
    /// The first of the nodes that were appended.
    Node,
}

/// Weighs drafts and makes nodes of them.
pub(crate) struct Collapse<'a> {
    pub(crate) drafts: &'a mut [Draft],
    pub(crate) costs: Costs,
}

/// The least costs of an inner draft's two halves in 2, 3, .. 8 places.
#[inline(always)]
fn spreads(low: &[f32; ROWS], high: &[f32; ROWS]) -> [f32; ROWS] {
    let mut spreads = [f32::INFINITY; ROWS];
    for (share, cost) in low.iter().enumerate() {
        for (spread, other) in spreads[share..].iter_mut().zip(high) {
            let sum = cost + other;
            *spread = if sum < *spread { sum } else { *spread };
        }
    }
    spreads
}

impl Collapse<'_> {
    /// Finds the costs of all drafts.
    #[inline(always)]
    pub(crate) fn weigh(&mut self) {
        for index in (0..self.drafts.len()).rev() {
            let draft = &self.drafts[index];
            if draft.is_finished() {
                continue;
            }
            let area = draft.area();
            let leaf = area * self.costs.leaf(draft.count);
            let costs = if draft.second == 0 {
                [leaf; ROWS]
            } else {
                let spreads = self.spreads(index);
                let inner = area * self.costs.node + spreads[ROWS - 1];
                let mut least = if leaf <= inner { leaf } else { inner };
                let mut costs = [least; ROWS];
                for (cost, spread) in costs[1..].iter_mut().zip(spreads) {
                    least = if spread < least { spread } else { least };
                    *cost = least;
                }
                costs
            };
            self.drafts[index].costs = costs;
        }
    }

    #[inline(always)]
    fn spreads(&self, index: usize) -> [f32; ROWS] {
        let second = self.drafts[index].second as usize;
        spreads(&self.drafts[index + 1].costs, &self.drafts[second].costs)
    }

    /// Whether a draft that has one place is a leaf in it.
    fn is_leaf(&self, draft: &Draft) -> bool {
        // The very product that was taken above: equal where it was the cheapest.
        draft.second == 0 || draft.costs[0] == draft.area() * self.costs.leaf(draft.count)
    }

    /// The fewest places that give an inner draft its least cost in at most `places`. A node has all of its own.
    fn places(&self, draft: &Draft, places: usize) -> usize {
        let mut places = places;
        while (2..WIDTH).contains(&places) && draft.costs[places - 1] == draft.costs[places - 2] {
            places -= 1;
        }
        places
    }

    /// How many of an inner draft's places its first half gets; the fewest of equals.
    fn first_share(&self, index: u32, places: usize) -> usize {
        let second = self.drafts[index as usize].second as usize;
        let (low, high) = (&self.drafts[index as usize + 1].costs, &self.drafts[second].costs);
        let mut best = (f32::INFINITY, 1);
        for share in 1..places {
            let cost = low[share - 1] + high[places - share - 1];
            if cost < best.0 {
                best = (cost, share);
            }
        }
        best.1
    }

    /// Adds the drafts that take the places of a node: those that stand for `index` in at most `places` of them. At most
    /// eight calls deep.
    fn fill(&self, index: u32, places: usize, cut: &mut Cut) {
        let draft = &self.drafts[index as usize];
        if draft.second != 0 {
            let places = self.places(draft, places);
            if places > 1 {
                return self.share(index, places, cut);
            }
        }
        cut.push(index);
    }

    fn share(&self, index: u32, places: usize, cut: &mut Cut) {
        let second = self.drafts[index as usize].second;
        let share = self.first_share(index, places);
        self.fill(index + 1, share, cut);
        self.fill(second, places - share, cut);
    }

    /// Appends the node of the first draft, and all below it.
    pub(crate) fn emit(&self, nodes: &mut Vec<TreeNode>, leaf: impl Fn(u32, u32) -> Child) -> Outcome {
        let Some(root) = self.drafts.first() else { return Outcome::Leaf { first: 0, count: 0 } };
        if self.is_leaf(root) {
            return Outcome::Leaf { first: root.first, count: root.count };
        }
        self.emit_from(0, nodes, &leaf);
        Outcome::Node
    }

    /// Appends the node of a draft and all below it, parents before children, in depth-first order. `leaf` makes the child of a
    /// leaf's first reference and their number, or of what is finished; links of inner nodes count from the first of all
    /// nodes.
    fn emit_from(&self, root: u32, nodes: &mut Vec<TreeNode>, leaf: &impl Fn(u32, u32) -> Child) {
        // Drafts that become nodes, and the node and the place that wait for the index of each.
        let mut pending: Vec<(u32, Option<(u32, u8)>)> = vec![(root, None)];
        while let Some((index, waiting)) = pending.pop() {
            let this = nodes.len() as u32;
            if let Some((parent, place)) = waiting {
                nodes[parent as usize].children[usize::from(place)].link = this;
            }
            let cut = self.cut(index);
            let mut node = TreeNode::EMPTY;
            for (place, &child) in cut.drafts().iter().enumerate() {
                let draft = &self.drafts[child as usize];
                for (row, corner) in node.bounds.iter_mut().zip(draft.corners) {
                    row[place] = corner;
                }
                if self.is_leaf(draft) {
                    node.children[place] = leaf(draft.first, draft.count);
                }
            }
            nodes.push(node);
            // The first child's node comes next.
            for (place, &child) in cut.drafts().iter().enumerate().rev() {
                if !self.is_leaf(&self.drafts[child as usize]) {
                    pending.push((child, Some((this, place as u8))));
                }
            }
        }
    }

    fn cut(&self, index: u32) -> Cut {
        let mut cut = Cut { len: 0, drafts: [0; WIDTH] };
        self.share(index, WIDTH, &mut cut);
        cut
    }

    /// Appends the nodes that are some levels below the first draft, and all below them, and copies the drafts above: which of
    /// those become nodes depends on how many places there are for the first one. The costs of the copies are to be found
    /// anew, with those drafts above that make the places.
    ///
    /// The levels are counted as if the first draft became a node. Where it does not, the best tree may have its nodes
    /// elsewhere; some levels below that matters little. First references are counted from `first`.
    pub(crate) fn emit_crown(
        &self,
        levels: u32,
        first: u32,
        nodes: &mut Vec<TreeNode>,
        crown: &mut Vec<Draft>,
    ) {
        if !self.drafts.is_empty() {
            self.crown(0, WIDTH, levels, &mut Crown { first, nodes, drafts: crown });
        }
    }

    /// As deep as the drafts of the nodes that stay open: at most seven calls a level.
    fn crown(&self, index: u32, places: usize, levels: u32, crown: &mut Crown<'_>) {
        let draft = &self.drafts[index as usize];
        let places = if draft.second == 0 { 1 } else { self.places(draft, places) };
        let first = draft.first + crown.first;
        if places == 1 && self.is_leaf(draft) {
            crown.drafts.push(Draft { first, second: 0, ..*draft });
            return;
        }
        let (places, levels) = match (places, levels) {
            (1, 0) => {
                let node = crown.nodes.len() as u32;
                let leaf = |first, count| Child::leaf(crown.first + first, count);
                self.emit_from(index, crown.nodes, &leaf);
                crown.drafts.push(draft.finished(node));
                return;
            }
            (1, levels) => (WIDTH, levels - 1),
            some => some,
        };
        let this = crown.drafts.len();
        crown.drafts.push(Draft { first, ..*draft });
        let share = self.first_share(index, places);
        self.crown(index + 1, share, levels, crown);
        let second = crown.drafts.len() as u32;
        crown.drafts[this].second = second;
        self.crown(draft.second, places - share, levels, crown);
    }
}

/// Where an open top of a subtree goes.
struct Crown<'a> {
    first: u32,
    nodes: &'a mut Vec<TreeNode>,
    drafts: &'a mut Vec<Draft>,
}

/// The drafts that take the places of a node.
struct Cut {
    len: usize,
    drafts: [u32; WIDTH],
}

impl Cut {
    fn drafts(&self) -> &[u32] {
        &self.drafts[..self.len]
    }

    fn push(&mut self, draft: u32) {
        // Shares add up to the places that there are.
        if let Some(place) = self.drafts.get_mut(self.len) {
            *place = draft;
            self.len += 1;
        }
    }
}
