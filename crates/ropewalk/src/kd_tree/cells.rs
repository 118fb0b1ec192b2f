//! The cells of nodes, one node after the other: what the order of the nodes says of the tree.

use super::KdNode;
use crate::Aabb;

/// A node, and where it is in the tree.
#[derive(Clone, Copy)]
pub(super) struct Visited {
    pub(super) index: usize,
    pub(super) node: KdNode,
    pub(super) cell: Aabb,
    /// `u32::MAX` for the root.
    pub(super) parent: u32,
    pub(super) depth: u32,
}

/// The lower and the upper part of a cell that a node splits.
pub(super) fn parts(node: &KdNode, cell: &Aabb) -> [Aabb; 2] {
    let (mut low, mut high) = (*cell, *cell);
    let axis = node.axis().min(2);
    low.max[axis] = node.split();
    high.min[axis] = node.split();
    [low, high]
}

/// Every node in its order. Goes by the order alone, not by where nodes say their upper child is, so that a damaged tree
/// cannot lead it astray; it ends where no node waits for a child any more.
pub(super) fn cells<'a>(nodes: &'a [KdNode], bounds: &Aabb) -> impl Iterator<Item = Visited> + 'a {
    // Parents of upper children to come, with their cells.
    let mut pending: Vec<(Aabb, u32, u32)> = Vec::new();
    let mut next = Some((*bounds, u32::MAX, 0));
    nodes.iter().enumerate().map_while(move |(index, &node)| {
        let (cell, parent, depth) = next?;
        next = if node.is_leaf() {
            pending.pop()
        } else {
            let [low, high] = parts(&node, &cell);
            pending.push((high, index as u32, depth + 1));
            Some((low, index as u32, depth + 1))
        };
        Some(Visited { index, node, cell, parent, depth })
    })
}
