//! The stack walk: nearer child first, leaves included, and a last look before a postponed child is entered.

use super::{Entry, PointWalk, children};
use crate::bvh::walk::Visitor;
use crate::bvh::{MAX_DEPTH, Node};
use crate::point::PreparedPoint;

/// The walk.
#[derive(Clone, Copy, Debug)]
pub struct PointStack;

impl PointWalk for PointStack {
    #[inline(always)]
    fn walk<V: Visitor>(self, nodes: &[Node], point: &PreparedPoint, visitor: &mut V) {
        if nodes.is_empty() {
            return;
        }
        let mut stack = [Entry::default(); MAX_DEPTH as usize];
        let mut entries = 0;
        let mut current = 0;
        loop {
            let node = &nodes[current as usize];
            if node.is_leaf() {
                if visitor.leaf(node.link, node.count).is_break() {
                    return;
                }
            } else {
                visitor.inner_visit(current);
                let (near, far) = children(nodes, current, point);
                // The far child is within reach only where the near one is.
                if near.square <= visitor.t_max() {
                    if far.square <= visitor.t_max() {
                        stack[entries] = far;
                        entries += 1;
                        visitor.stack_depth(entries);
                    }
                    current = near.node;
                    continue;
                }
            }
            loop {
                if entries == 0 {
                    return;
                }
                entries -= 1;
                let postponed = stack[entries];
                // Closed: at equal distance a smaller id may still win.
                if postponed.square <= visitor.t_max() {
                    current = postponed.node;
                    break;
                }
            }
        }
    }
}
