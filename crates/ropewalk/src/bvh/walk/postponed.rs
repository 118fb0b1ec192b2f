//! The iterative stack walk of the blog of 2022 in its three stages: plain, with boxes behind the closest hit
//! culled, and with the nearer inner child first. A leaf is handled at its parent, the second child is postponed.
//!
//! The blog's loop never ends (it pops an empty stack) and tests both boxes before the first leaf shortens the
//! ray (ALGORITHMS: C5). Here the empty stack ends the walk, and with culling the second child is looked at again
//! after the first one's leaf. The twin is `walk_bvh_postponed.wgsl`.

use super::{BvhWalk, Seeker, Visitor};
use crate::PreparedRay;
use crate::bvh::{MAX_DEPTH, Node};

/// The walk. `CULL` ignores boxes behind the closest hit; `SORT`, only with `CULL`, goes to the nearer of two
/// inner children first.
#[derive(Clone, Copy, Debug)]
pub struct Postponed<const CULL: bool, const SORT: bool>;

impl<const CULL: bool, const SORT: bool> BvhWalk for Postponed<CULL, SORT> {
    #[inline(always)]
    fn walk<V: Visitor>(self, nodes: &[Node], ray: &PreparedRay, visitor: &mut V) {
        let Some(root) = nodes.first() else { return };
        if root.is_leaf() {
            let _ = visitor.leaf(root.link, root.count);
            return;
        }
        let mut stack = [0; MAX_DEPTH as usize];
        let mut entries = 0;
        let mut current = 0;
        loop {
            visitor.inner_visit(current);
            let limit = if CULL { visitor.t_max() } else { ray.t_max };
            let (first, second) = (current + 1, nodes[current as usize].link);
            let (node_a, node_b) = (&nodes[first as usize], &nodes[second as usize]);
            let (a, b) = (ray.approach(node_a, limit), ray.approach(node_b, limit));
            let mut enter_a = a.is_hit();
            if enter_a && node_a.is_leaf() {
                if visitor.leaf(node_a.link, node_a.count).is_break() {
                    return;
                }
                enter_a = false;
            }
            let mut enter_b = b.is_hit() && (!CULL || b.entry <= visitor.t_max());
            if enter_b && node_b.is_leaf() {
                if visitor.leaf(node_b.link, node_b.count).is_break() {
                    return;
                }
                enter_b = false;
            }
            // The second one's leaf may have shortened the ray for the first child.
            let enter_a = enter_a && (!CULL || a.entry <= visitor.t_max());
            match (enter_a, enter_b) {
                (true, true) => {
                    let second_first = SORT && b.entry < a.entry;
                    let (next, later) = if second_first { (second, first) } else { (first, second) };
                    stack[entries] = later;
                    entries += 1;
                    visitor.stack_depth(entries);
                    current = next;
                }
                (true, false) => current = first,
                (false, true) => current = second,
                (false, false) => {
                    if entries == 0 {
                        return;
                    }
                    entries -= 1;
                    current = stack[entries];
                }
            }
        }
    }
}
