//! Ropes: of each leaf what lies beyond its six faces (Popov et al. 2007).
//!
//! A rope leads to the smallest node whose cell covers the face from outside: on the way down a node takes over its
//! parent's ropes, but for the face that the parent's plane makes, beyond which the other child lies; and each is pushed down
//! as long as one child covers the face.

use super::{KdNode, KdPlace};

/// Nothing lies beyond the face.
pub const OUTSIDE: u32 = u32::MAX;

/// The ropes of the leaves of a valid tree.
pub(super) fn ropes(nodes: &[KdNode], places: &[KdPlace]) -> Vec<[u32; 6]> {
    let mut all = Vec::with_capacity(nodes.len() / 2 + 1);
    // Of upper children to come: depth-first order needs no more.
    let mut pending: Vec<[u32; 6]> = Vec::new();
    let mut ropes = [OUTSIDE; 6];
    for (index, (node, place)) in (0..).zip(nodes.iter().zip(places)) {
        for (face, rope) in ropes.iter_mut().enumerate() {
            *rope = pushed_down(*rope, face, place, nodes);
        }
        if node.is_leaf() {
            all.push(ropes);
            ropes = pending.pop().unwrap_or([OUTSIDE; 6]);
        } else {
            let mut upper = ropes;
            upper[2 * node.axis()] = index + 1;
            pending.push(upper);
            ropes[2 * node.axis() + 1] = node.upper();
        }
    }
    all
}

/// The smallest node at or below `rope` that covers a face of a cell.
fn pushed_down(mut rope: u32, face: usize, place: &KdPlace, nodes: &[KdNode]) -> u32 {
    while let Some(node) = nodes.get(rope as usize)
        && !node.is_leaf()
    {
        let (axis, split, lower) = (node.axis(), node.split(), rope + 1);
        rope = if axis == face / 2 {
            // Beyond the lower face the upper child is the one that touches it.
            if face.is_multiple_of(2) { node.upper() } else { lower }
        } else if place.max[axis] <= split {
            lower
        } else if place.min[axis] >= split {
            node.upper()
        } else {
            break;
        };
    }
    rope
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Aabb;
    use crate::glam::Vec3;
    use crate::kd_tree::places::places;

    /// ```text
    /// y 4 +---+-------+
    ///     |   |   6   |     0: x = 1; 1 is below
    ///     | 1 +---+---+     2: y = 2, above it
    ///     |   | 4 | 5 |     3: x = 2, below that
    ///   0 +---+---+---+
    ///     0   1   2   4 x
    /// ```
    #[test]
    fn ropes_lead_to_the_smallest_node() {
        let nodes = [
            KdNode::inner(0, 1.0, 2),
            KdNode::leaf(0, 0),
            KdNode::inner(1, 2.0, 6),
            KdNode::inner(0, 2.0, 5),
            KdNode::leaf(0, 0),
            KdNode::leaf(0, 0),
            KdNode::leaf(0, 0),
        ];
        let places = places(&nodes, &Aabb::new(Vec3::ZERO, Vec3::splat(4.0)));
        const NO: u32 = OUTSIDE;
        let expected =
            [[NO, 2, NO, NO, NO, NO], [1, 5, NO, 6, NO, NO], [4, NO, NO, 6, NO, NO], [1, NO, 3, NO, NO, NO]];
        assert_eq!(ropes(&nodes, &places), expected);
        assert!(ropes(&[], &[]).is_empty());
    }
}
