//! kd-restart (Foley and Sugerman 2005): after each leaf back to the root, and down to the leaf that begins where that one ended.
//!
//! No memory but one number. On the way down the near child is finished where it ends no later than the last leaf; where
//! that is not certain the ray is given over to the restart trail ([`super::certain`]). The twin is `walk_kd_restart.wgsl`.

use super::certain::{Fork, is_behind};
use super::crossing::{RayPlanes, whole_tree};
use super::{Course, KdWalk, give_over};
use crate::PreparedRay;
use crate::bvh::walk::Visitor;
use crate::kd_tree::KdTree;

/// The walk.
#[derive(Clone, Copy, Debug)]
pub struct Restart;

impl KdWalk for Restart {
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
        // Where the last leaf ended.
        let mut done = f32::NEG_INFINITY;
        let (mut current, mut cell) = (0, whole);
        loop {
            let node = &nodes[current as usize];
            if !node.is_leaf() {
                visitor.inner_visit(current);
                let crossing = planes.crossing(current, node);
                (current, cell) = match Fork::of(&crossing, cell) {
                    Fork::Near => (crossing.near, cell),
                    Fork::Far => (crossing.far, cell),
                    Fork::Both if crossing.near_exit <= done => (crossing.far, crossing.far_part(cell)),
                    Fork::Both => (crossing.near, crossing.near_part(cell)),
                    Fork::Undecided => return give_over(tree, ray, visitor),
                };
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
            visitor.restart();
            (current, cell) = (0, whole);
        }
    }
}
