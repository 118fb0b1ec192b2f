//! The short stack (Horn et al. 2007): a ring of the youngest entries; where it is exhausted, a restart as in kd-restart, but from
//! the deepest node that holds all that is left of the ray ("push-down").
//!
//! That node goes down with the ray as long as one child alone is open, or the near one is finished. Where the next leaf is
//! not certain the ray is given over to the restart trail ([`super::certain`]). The twin is `walk_kd_short_stack.wgsl`.

use super::certain::{Fork, is_behind};
use super::crossing::{RayPlanes, whole_tree};
use super::stack::Postponed;
use super::{Course, KdWalk, give_over};
use crate::PreparedRay;
use crate::bvh::walk::Visitor;
use crate::bvh::walk::short_stack::ShortStack as Ring;
use crate::kd_tree::KdTree;

/// The walk.
#[derive(Clone, Copy, Debug)]
pub struct ShortStack {
    /// Entries of the ring, [`ShortStack::MOST`] at most.
    pub entries: u32,
}

impl ShortStack {
    /// The most entries of the ring.
    pub const MOST: u32 = 16;
}

impl KdWalk for ShortStack {
    const SHOWS_AGAIN: bool = true;

    #[inline(always)]
    fn walk<V: Visitor>(self, tree: &KdTree, ray: &PreparedRay, visitor: &mut V) -> Course {
        let nodes = tree.nodes();
        if nodes.is_empty() {
            return Course::Own;
        }
        let planes = RayPlanes::of(ray);
        let whole = whole_tree(tree, ray, visitor.t_max());
        if !whole.is_hit() {
            return Course::Own;
        }
        let mut stack = Ring::<Postponed, { Self::MOST as usize }>::new(self.entries as usize);
        // Where the last leaf ended.
        let mut done = f32::NEG_INFINITY;
        // The node that holds all that is left, and whether the walk has come straight down from it.
        let mut base = (0, whole);
        let mut is_base = true;
        let (mut current, mut cell) = base;
        loop {
            let node = &nodes[current as usize];
            if !node.is_leaf() {
                visitor.inner_visit(current);
                let crossing = planes.crossing(current, node);
                (current, cell) = match Fork::of(&crossing, cell) {
                    Fork::Near => (crossing.near, cell),
                    Fork::Far => (crossing.far, cell),
                    Fork::Both if crossing.near_exit <= done => (crossing.far, crossing.far_part(cell)),
                    Fork::Both => {
                        is_base = false;
                        if self.entries > 0 {
                            let far = Postponed::new(crossing.far, crossing.far_part(cell));
                            visitor.stack_depth(stack.push(far));
                        }
                        (crossing.near, crossing.near_part(cell))
                    }
                    Fork::Undecided => return give_over(tree, ray, visitor),
                };
                if is_base {
                    base = (current, cell);
                }
                continue;
            }
            // All that comes after begins later still.
            if cell.entry > visitor.t_max() || visitor.leaf(node.first(), node.count()).is_break() {
                return Course::Own;
            }
            done = cell.exit;
            // The next leaf begins no further before `done` than the pads.
            if done >= whole.exit || is_behind(done, visitor.t_max()) {
                return Course::Own;
            }
            if let Some(far) = stack.pop() {
                (current, cell) = (far.node, far.part(f32::INFINITY));
                continue;
            }
            // Where the base itself is finished, nothing is left.
            if done >= base.1.exit {
                return Course::Own;
            }
            visitor.restart();
            (current, cell) = base;
            is_base = true;
        }
    }
}
