//! The surface area heuristic of a whole tree, and its depth. In `f64`: sums of very different areas.

use crate::bvh::Node;

/// The areas of all nodes over that of the root; 0 without nodes.
pub(super) fn of(nodes: &[Node]) -> f64 {
    let Some(root) = nodes.first() else { return 0.0 };
    let root = half_area(root);
    let sum: f64 = nodes.iter().map(half_area).sum();
    // Of a tree whose root has no area all costs are the same: that of going everywhere.
    if root > 0.0 { sum / root } else { nodes.len() as f64 }
}

/// Half the surface area of a node's box, which is not empty.
#[inline(always)]
pub(super) fn half_area(node: &Node) -> f64 {
    let [min, max] = node.corners();
    let size = max.as_dvec4().truncate() - min.as_dvec4().truncate();
    size.x * size.y + size.y * size.z + size.z * size.x
}

/// The depth of the deepest leaf.
pub(super) fn depth(nodes: &[Node]) -> u32 {
    // The depths of second children that are still to come.
    let mut pending: Vec<u32> = Vec::new();
    let (mut depth, mut deepest) = (0, 0);
    for node in nodes {
        if node.is_leaf() {
            deepest = deepest.max(depth);
            depth = pending.pop().unwrap_or(0);
        } else {
            depth += 1;
            pending.push(depth);
        }
    }
    deepest
}
