//! Subtrees that are built apart, perhaps by several threads, and laid out in depth-first order at the end.

use crate::Aabb;
use crate::bvh::Node;
use crate::parallel::join;
use bytemuck::Zeroable;

/// A subtree on its way.
pub(crate) enum Subtree {
    /// Nodes in depth-first order; the links of inner nodes count from the first of them.
    Whole(Vec<Node>),
    /// Two subtrees under one node.
    Split {
        bounds: Aabb,
        /// Nodes in all, this one included.
        len: usize,
        children: Box<[Subtree; 2]>,
    },
}

impl Subtree {
    pub(crate) fn split(bounds: Aabb, children: [Self; 2]) -> Self {
        let len = 1 + children[0].len() + children[1].len();
        Self::Split { bounds, len, children: Box::new(children) }
    }

    fn len(&self) -> usize {
        match self {
            Self::Whole(nodes) => nodes.len(),
            Self::Split { len, .. } => *len,
        }
    }

    /// All nodes in depth-first order, links counted from the root.
    pub(crate) fn into_nodes(self) -> Vec<Node> {
        match self {
            Self::Whole(nodes) => nodes,
            split @ Self::Split { .. } => {
                let mut nodes = vec![Node::zeroed(); split.len()];
                split.lay_out(&mut nodes, 0);
                nodes
            }
        }
    }

    fn lay_out(self, nodes: &mut [Node], base: u32) {
        match self {
            Self::Whole(mut whole) => {
                for node in whole.iter_mut().filter(|node| !node.is_leaf()) {
                    node.link += base;
                }
                nodes.copy_from_slice(&whole);
            }
            Self::Split { bounds, children, .. } => {
                let [first, second] = *children;
                let second_base = base + 1 + first.len() as u32;
                let (this, below) = nodes.split_at_mut(1);
                this[0] = Node::inner(&bounds, second_base);
                let (near, far) = below.split_at_mut(first.len());
                join(|| first.lay_out(near, base + 1), || second.lay_out(far, second_base));
            }
        }
    }
}
