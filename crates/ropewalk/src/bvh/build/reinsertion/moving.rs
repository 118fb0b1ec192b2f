//! Moving subtrees, one after the other, where it still gains what the search saw.

use super::super::reference::Extent;
use super::search::Move;
use super::tree::{ROOT, Tree, sibling};

/// Makes moves, or refuses them.
pub(super) struct Mover {
    max_depth: u32,
    /// A move must gain more than this.
    least: f64,
    /// The nodes above the subtree, upwards; kept, as the next two are, for its memory.
    from: Vec<u32>,
    /// The nodes above its new place, upwards.
    to: Vec<u32>,
    /// The boxes that change.
    boxes: Vec<(u32, Extent)>,
}

impl Mover {
    pub(super) fn new(max_depth: u32, least: f64) -> Self {
        Self { max_depth, least, from: Vec::new(), to: Vec::new(), boxes: Vec::new() }
    }

    /// Makes a move and tells what it gains; refuses one that gains too little on the tree as it is, or would make
    /// a leaf too deep. The slots of the move may have got other nodes since the search: then it is another move,
    /// to be judged like any.
    #[inline(always)]
    pub(super) fn apply(&mut self, tree: &mut Tree, Move { moved, target, .. }: Move) -> Option<f64> {
        climb(tree, moved, &mut self.from);
        climb(tree, target, &mut self.to);
        let above = *self.from.first()?;
        // A subtree cannot be put into itself; beside its sibling or its parent it is already.
        if target == moved || self.to.contains(&moved) || target == sibling(moved) || target == above {
            return None;
        }
        // Where the parent is above the new place too, that place rises by a level when the parent goes.
        let depth = self.to.len() as u32 - u32::from(self.to.contains(&above));
        if depth + 1 + tree.height(moved).max(tree.height(target)) > self.max_depth {
            return None;
        }
        // Common ancestors hold the subtree before and after.
        let common = self.from.iter().rev().zip(self.to.iter().rev()).take_while(|(a, b)| a == b).count();
        self.from.truncate(self.from.len() - common);
        self.to.truncate(self.to.len() - common);
        let (joined, gain) = self.weigh(tree, moved, target);
        if gain > self.least {
            for (slot, bounds) in &self.boxes {
                tree.set_bounds(*slot, bounds);
            }
            tree.reinsert(moved, target);
            tree.set_bounds(target, &joined);
            Some(gain)
        } else {
            None
        }
    }

    /// The box of the new parent, and what the move gains; notes the boxes that change. In f64 over areas in f32, as
    /// the report adds them up.
    #[inline(always)]
    fn weigh(&mut self, tree: &Tree, moved: u32, target: u32) -> (Extent, f64) {
        let bounds = tree.extent(moved);
        let area = |extent: &Extent| f64::from(extent.half_area());
        let mut gain = area(&tree.extent(tree.parent(moved)));
        self.boxes.clear();
        let mut rest = tree.extent(sibling(moved));
        for child_and_parent in self.from.windows(2) {
            let &[child, parent] = child_and_parent else { continue };
            rest = rest.union(tree.extent(sibling(child)));
            gain += area(&tree.extent(parent)) - area(&rest);
            self.boxes.push((parent, rest));
        }
        // The target may be the last of the nodes that shrink.
        let shrunk = self.boxes.last().filter(|(slot, _)| *slot == target);
        let joined = shrunk.map_or_else(|| tree.extent(target), |(_, extent)| *extent).union(bounds);
        gain -= area(&joined);
        for &slot in &self.to {
            let old = tree.extent(slot);
            let grown = old.union(bounds);
            gain -= area(&grown) - area(&old);
            self.boxes.push((slot, grown));
        }
        (joined, gain)
    }
}

/// The nodes above a node, upwards.
#[inline(always)]
fn climb(tree: &Tree, mut slot: u32, path: &mut Vec<u32>) {
    path.clear();
    while slot != ROOT {
        slot = tree.parent(slot);
        path.push(slot);
    }
}
