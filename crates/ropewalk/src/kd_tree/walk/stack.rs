//! The stack walk: the near child first, the far one postponed with its interval. An entry is 12 bytes.
//!
//! An entry that begins beyond what has been found is skipped, and the walk goes on with the one below: where a ray runs in
//! a plane both children have the same interval, so the first hit ends nothing (ALGORITHMS: C6). The twin is
//! `walk_kd_stack.wgsl`.

use super::crossing::{RayPlanes, cell_of};
use super::{Course, KdWalk};
use crate::PreparedRay;
use crate::aabb::{Interval, smaller};
use crate::bvh::walk::Visitor;
use crate::kd_tree::{KdTree, MAX_DEPTH};

/// The walk.
#[derive(Clone, Copy, Debug)]
pub struct Stack;

/// The same walk through the subtree of a node, whose cell [`KdTree::places`] has.
#[derive(Clone, Copy, Debug)]
pub struct StackFrom(
    /// The node.
    pub u32,
);

/// A node that waits, and where the ray is in it.
#[derive(Clone, Copy, Default)]
pub(super) struct Postponed {
    pub(super) node: u32,
    pub(super) enter: f32,
    pub(super) exit: f32,
}

impl Postponed {
    #[inline(always)]
    pub(super) const fn new(node: u32, part: Interval) -> Self {
        Self { node, enter: part.entry, exit: part.exit }
    }

    /// The interval, up to `limit`.
    #[inline(always)]
    pub(super) fn part(&self, limit: f32) -> Interval {
        Interval { entry: self.enter, exit: smaller(self.exit, limit) }
    }
}

impl KdWalk for Stack {
    #[inline(always)]
    fn walk<V: Visitor>(self, tree: &KdTree, ray: &PreparedRay, visitor: &mut V) -> Course {
        StackFrom(0).walk(tree, ray, visitor)
    }
}

impl KdWalk for StackFrom {
    #[inline(always)]
    fn walk<V: Visitor>(self, tree: &KdTree, ray: &PreparedRay, visitor: &mut V) -> Course {
        let nodes = tree.nodes();
        if nodes.is_empty() {
            return Course::Own;
        }
        let planes = RayPlanes::of(ray);
        let mut cell = cell_of(tree, self.0, ray, visitor.t_max());
        if !cell.is_hit() {
            return Course::Own;
        }
        let mut stack = [Postponed::default(); MAX_DEPTH as usize];
        let mut entries = 0;
        let mut current = self.0;
        loop {
            let node = &nodes[current as usize];
            if node.is_leaf() {
                if visitor.leaf(node.first(), node.count()).is_break() {
                    return Course::Own;
                }
                loop {
                    if entries == 0 {
                        return Course::Own;
                    }
                    entries -= 1;
                    let postponed = stack[entries];
                    // Closed: at equal t a smaller id may still win.
                    if postponed.enter <= visitor.t_max() {
                        current = postponed.node;
                        cell = postponed.part(visitor.t_max());
                        break;
                    }
                }
                continue;
            }
            visitor.inner_visit(current);
            let crossing = planes.crossing(current, node);
            let (near, far) = (crossing.near_part(cell), crossing.far_part(cell));
            // One of the two is always open.
            if !near.is_hit() {
                (current, cell) = (crossing.far, far);
                continue;
            }
            if far.is_hit() {
                stack[entries] = Postponed::new(crossing.far, far);
                entries += 1;
                visitor.stack_depth(entries);
            }
            (current, cell) = (crossing.near, near);
        }
    }
}
