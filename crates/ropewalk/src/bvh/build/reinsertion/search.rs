//! Where a subtree would cost least: branch and bound, from the subtree upwards.
//!
//! Taken out, a subtree takes its parent with it, whose place its sibling fills, and the nodes above shrink. Put in
//! beside another node it needs a new parent there, and the nodes above grow, up to the lowest common ancestor of
//! the old place and the new one. The search climbs from the old place. At each node above it the shrinking below is
//! known, and the subtree that branches off there is searched for the least growth.

use super::super::reference::Extent;
use super::tree::{ROOT, Tree, extent, sibling};
use crate::bvh::Node;

/// Pairs of nodes that a search looks at before it takes the best it has. The mean is 2 to 22, and in the scenes of
/// [`super`] no search needs more; among triangles that all overlap, where bounds prune nothing, it keeps a
/// round's time linear and leaves the cost 0.2 percent higher after 3 rounds.
const LIMIT: u32 = 256;

/// A subtree, and the node beside which it would cost less.
#[derive(Clone, Copy, Debug)]
pub(super) struct Move {
    pub(super) moved: u32,
    pub(super) target: u32,
    /// By how much the sum of the areas of inner nodes would fall.
    pub(super) gain: f32,
}

/// The most that a move of this subtree can gain: what taking it out gains, less its own area, which its new parent
/// has at least.
#[inline(always)]
pub(super) fn promise(tree: &Tree, moved: u32) -> f32 {
    let mut node = tree.parent(moved);
    let mut released = tree.area(node) - tree.area(moved);
    let mut rest = tree.extent(sibling(moved));
    while node != ROOT {
        rest = rest.union(tree.extent(sibling(node)));
        node = tree.parent(node);
        let shrinks = tree.area(node) - rest.half_area();
        // A node that needs no subtree less large has none above that does.
        if shrinks <= 0.0 {
            break;
        }
        released += shrinks;
    }
    released
}

/// A search for one subtree after the other.
pub(super) struct Search<'a> {
    tree: &'a Tree,
    /// Pairs to look at, and by how much the nodes above them, within what is searched, would grow.
    pending: Vec<(u32, f32)>,
}

/// The subtree that is searched for, and what is found.
struct Quest {
    bounds: Extent,
    area: f32,
    /// What the nodes above its old place release, as far as the search has climbed.
    released: f32,
    /// The gain of the best place, or what it must exceed.
    gain: f32,
    target: Option<u32>,
    /// Pairs that may still be looked at.
    left: u32,
}

impl Quest {
    /// Weighs a place that needs `growth` elsewhere and a new parent of this area.
    #[inline(always)]
    fn weigh(&mut self, target: u32, growth: f32, parent_area: f32) {
        let gain = self.released - growth - parent_area;
        if gain > self.gain {
            (self.target, self.gain) = (Some(target), gain);
        }
    }

    /// Whether a place below nodes that grow so much might be better than the best.
    #[inline(always)]
    fn may_gain(&self, growth: f32) -> bool {
        self.released - growth - self.area > self.gain
    }

    /// Weighs the place beside a node, where `growth` happens above it. Tells the growth when the place is below.
    #[inline(always)]
    fn look_at(&mut self, node: &Node, slot: u32, growth: f32) -> f32 {
        let own = extent(node);
        let joined = own.union(self.bounds).half_area();
        self.weigh(slot, growth, joined);
        growth + (joined - own.half_area())
    }
}

impl<'a> Search<'a> {
    pub(super) fn new(tree: &'a Tree) -> Self {
        Self { tree, pending: Vec::new() }
    }

    /// The best place of a subtree, if there is one that gains more than `least`.
    #[inline(always)]
    pub(super) fn best_move(&mut self, moved: u32, least: f32) -> Option<Move> {
        let tree = self.tree;
        let bounds = tree.extent(moved);
        let mut pivot = tree.parent(moved);
        let mut quest = Quest {
            bounds,
            area: bounds.half_area(),
            released: tree.area(pivot),
            gain: least,
            target: None,
            left: LIMIT,
        };
        let mut rest = tree.extent(sibling(moved));
        self.descend(sibling(moved), &mut quest);
        while pivot != ROOT {
            let other = sibling(pivot);
            self.descend(other, &mut quest);
            pivot = tree.parent(pivot);
            rest = rest.union(tree.extent(other));
            let area = tree.area(pivot);
            quest.released += area - rest.half_area();
            // Beside the node above that it has just left.
            quest.weigh(pivot, 0.0, area);
        }
        quest.target.map(|target| Move { moved, target, gain: quest.gain })
    }

    /// Looks for a place in the subtree at `top`, above which nothing grows.
    #[inline(always)]
    fn descend(&mut self, top: u32, quest: &mut Quest) {
        let tree = self.tree;
        if !quest.may_gain(0.0) {
            return;
        }
        let growth = quest.look_at(tree.node(top), top, 0.0);
        self.postpone(tree.node(top), growth, quest);
        while let Some((first, growth)) = self.pending.pop() {
            if quest.left == 0 {
                self.pending.clear();
                return;
            }
            // The best may have become better since.
            if !quest.may_gain(growth) {
                continue;
            }
            quest.left -= 1;
            let [a, b] = tree.children(first);
            let growth_a = quest.look_at(a, first, growth);
            let growth_b = quest.look_at(b, sibling(first), growth);
            // The one that grows less is looked into first: the better the best, the more is pruned.
            if growth_b < growth_a {
                self.postpone(a, growth_a, quest);
                self.postpone(b, growth_b, quest);
            } else {
                self.postpone(b, growth_b, quest);
                self.postpone(a, growth_a, quest);
            }
        }
    }

    #[inline(always)]
    fn postpone(&mut self, node: &Node, growth: f32, quest: &Quest) {
        if !node.is_leaf() && quest.may_gain(growth) {
            self.pending.push((node.link, growth));
        }
    }
}
