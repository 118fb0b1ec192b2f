//! The recursive walk of the blog of 2022: the simplest one, with the machine's own stack, and the yardstick of
//! the others. It has no twin: WGSL has no recursion.

use super::{BvhWalk, Seeker, Visitor};
use crate::PreparedRay;
use crate::bvh::Node;
use std::ops::ControlFlow;

/// The walk. At most [`super::super::MAX_DEPTH`] calls deep.
#[derive(Clone, Copy, Debug)]
pub struct Recursive;

impl BvhWalk for Recursive {
    #[inline(always)]
    fn walk<V: Visitor>(self, nodes: &[Node], ray: &PreparedRay, visitor: &mut V) {
        if let Some(root) = nodes.first() {
            let _ = if root.is_leaf() {
                visitor.leaf(root.link, root.count)
            } else {
                traverse(nodes, ray, visitor, 0)
            };
        }
    }
}

fn traverse<V: Visitor>(nodes: &[Node], ray: &PreparedRay, visitor: &mut V, current: u32) -> ControlFlow<()> {
    visitor.inner_visit(current);
    for child in [current + 1, nodes[current as usize].link] {
        let node = &nodes[child as usize];
        if ray.approach(node, ray.t_max).is_hit() {
            if node.is_leaf() {
                visitor.leaf(node.link, node.count)?;
            } else {
                traverse(nodes, ray, visitor, child)?;
            }
        }
    }
    ControlFlow::Continue(())
}
