//! The restart trail (Laine 2010) on a kd-tree: a bit a level leads back after a restart at the root, so that the stack may
//! be of any size, or none.
//!
//! What the trail builds on is at hand without any test: which child is near depends on the direction alone, whether it is
//! open on the interval alone, and what is found culls no near child that has a far one. The far child alone may be
//! culled between two visits; then its level is a far level, and the node is finished, as in
//! [`crate::bvh::walk::RestartTrail`]. So this walk enters the leaves of the stack walk in its order, for every ray. The
//! walks that find their way by `t` alone give their undecided rays over to it. The twin is `walk_kd_restart_trail.wgsl`.

use super::crossing::{RayPlanes, whole_tree};
use super::stack::Postponed;
use super::{Course, KdWalk};
use crate::PreparedRay;
use crate::bvh::walk::short_stack::ShortStack;
use crate::bvh::walk::{Trail, TrailU64, Visitor};
use crate::kd_tree::KdTree;
use std::marker::PhantomData;

/// The walk, with a trail of type `T` and a short stack in a ring of `ROOM` places.
#[derive(Clone, Copy, Debug)]
pub struct RestartTrail<T = TrailU64, const ROOM: usize = 16> {
    capacity: usize,
    trail: PhantomData<fn() -> T>,
}

impl<T: Trail, const ROOM: usize> RestartTrail<T, ROOM> {
    /// A walk whose stack holds the last `min(short_stack, ROOM)` entries. The tree must be no deeper than the trail's
    /// [`Trail::LEVELS`].
    #[must_use]
    pub const fn new(short_stack: u32) -> Self {
        Self { capacity: short_stack as usize, trail: PhantomData }
    }
}

impl<T: Trail, const ROOM: usize> KdWalk for RestartTrail<T, ROOM> {
    #[inline(always)]
    fn walk<V: Visitor>(self, tree: &KdTree, ray: &PreparedRay, visitor: &mut V) -> Course {
        let nodes = tree.nodes();
        if nodes.is_empty() {
            return Course::Own;
        }
        let planes = RayPlanes::of(ray);
        let mut cell = whole_tree(tree, ray, visitor.t_max());
        if !cell.is_hit() {
            return Course::Own;
        }
        let mut trail = T::new();
        let mut stack = ShortStack::<Postponed, ROOM>::new(self.capacity);
        let mut current = 0;
        loop {
            let node = &nodes[current as usize];
            if node.is_leaf() {
                if visitor.leaf(node.first(), node.count()).is_break() {
                    return Course::Own;
                }
            } else {
                visitor.inner_visit(current);
                let crossing = planes.crossing(current, node);
                let (near, far) = (crossing.near_part(cell), crossing.far_part(cell));
                match (near.is_hit(), far.is_hit()) {
                    (true, true) => {
                        trail.descend();
                        if trail.is_near_done() {
                            (current, cell) = (crossing.far, far);
                        } else {
                            if self.capacity > 0 {
                                visitor.stack_depth(stack.push(Postponed::new(crossing.far, far)));
                            }
                            (current, cell) = (crossing.near, near);
                        }
                        continue;
                    }
                    (true, false) | (false, true) => {
                        trail.descend();
                        if !trail.is_far_level() {
                            trail.set_single();
                            (current, cell) =
                                if near.is_hit() { (crossing.near, near) } else { (crossing.far, far) };
                            continue;
                        }
                        // Both were open when the walk came by first, and the near one is finished: the hits since then
                        // cull the far one.
                    }
                    // The hits since the walk came by first cull the node itself.
                    (false, false) => {}
                }
            }
            loop {
                if !trail.finish() {
                    return Course::Own;
                }
                match stack.pop() {
                    None => {
                        trail.restart();
                        visitor.restart();
                        current = 0;
                        cell = whole_tree(tree, ray, visitor.t_max());
                        break;
                    }
                    // Closed: at equal t a smaller id may still win.
                    Some(far) if far.enter <= visitor.t_max() => {
                        current = far.node;
                        cell = far.part(visitor.t_max());
                        break;
                    }
                    // Culled. It has its own bit of the trail, which the next round sets.
                    Some(_) => {}
                }
            }
        }
    }
}
