//! The ordered stack walk: hit children nearest first, leaves included, and a last look before a postponed child is
//! entered. The other walks visit what it visits, in its order, where they have as large a stack.

use super::{HitChildren, Target, Waiting, WideNodes, WideWalk};
use crate::PreparedRay;
use crate::bvh::walk::Visitor;

/// The walk.
#[derive(Clone, Copy, Debug)]
pub struct Ordered;

/// Entries that the stack keeps in place; the few rays that need more ask for memory. All of these places are written
/// before a ray meets anything. A place for every entry that a tree may ask for ([`WideNodes::stack_entries`], 93 in a
/// kitchen where no ray needed more than 22) made the walk some percent slower for rays that meet little.
const INLINE: usize = 32;

/// The children that wait, however many.
struct Stack {
    first: [Waiting; INLINE],
    more: Vec<Waiting>,
    entries: usize,
}

impl Stack {
    #[inline(always)]
    fn new() -> Self {
        Self { first: [Waiting::default(); INLINE], more: Vec::new(), entries: 0 }
    }

    #[inline(always)]
    fn push(&mut self, child: Waiting) {
        match self.first.get_mut(self.entries) {
            Some(place) => *place = child,
            None => self.more.push(child),
        }
        self.entries += 1;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Waiting> {
        self.entries = self.entries.checked_sub(1)?;
        match self.first.get(self.entries) {
            Some(child) => Some(*child),
            None => self.more.pop(),
        }
    }
}

impl WideWalk for Ordered {
    #[inline(always)]
    fn walk<const WIDTH: usize, V: Visitor>(
        self,
        tree: WideNodes<'_, WIDTH>,
        ray: &PreparedRay,
        visitor: &mut V,
    ) {
        if tree.nodes.is_empty() {
            return;
        }
        let mut stack = Stack::new();
        let mut current = Target::ROOT;
        loop {
            if current.is_leaf() {
                if visitor.leaf(current.link, current.count).is_break() {
                    return;
                }
            } else {
                visitor.inner_visit(current.link);
                let hit = HitChildren::of(&tree.nodes[current.link as usize], ray, visitor.t_max());
                if let [nearest, farther @ ..] = hit.sorted() {
                    for child in farther.iter().rev() {
                        stack.push(*child);
                    }
                    if !farther.is_empty() {
                        visitor.stack_depth(stack.entries);
                    }
                    current = nearest.target;
                    continue;
                }
            }
            loop {
                let Some(postponed) = stack.pop() else { return };
                // Closed: at equal t a smaller id may still win.
                if postponed.entry <= visitor.t_max() {
                    current = postponed.target;
                    break;
                }
            }
        }
    }
}
