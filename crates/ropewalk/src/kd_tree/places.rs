//! Places: of each node its parent and its cell, for walks that go from leaf to leaf.

use super::KdNode;
use super::cells::cells;
use crate::Aabb;
use bytemuck::{Pod, Zeroable};
use glam::Vec4;

/// Where a node is. 32 bytes, eight little-endian words.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct KdPlace {
    /// The smallest corner of the cell: the scene's box, cut by the planes above.
    pub min: [f32; 3],
    /// The parent; [`KdPlace::NONE`] for the root.
    pub parent: u32,
    /// The largest corner of the cell.
    pub max: [f32; 3],
    /// A leaf's number in depth-first order; [`KdPlace::NONE`] for an inner node.
    pub leaf: u32,
}

impl KdPlace {
    /// No node, or no leaf.
    pub const NONE: u32 = u32::MAX;

    /// The cell.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::new(self.min.into(), self.max.into())
    }

    /// The corners as vectors, in two loads of 16 bytes. The fourth lanes are `parent` and `leaf`.
    #[inline(always)]
    #[must_use]
    pub fn corners(&self) -> [Vec4; 2] {
        bytemuck::cast(*self)
    }
}

/// The places of the nodes of a valid tree.
pub(super) fn places(nodes: &[KdNode], bounds: &Aabb) -> Vec<KdPlace> {
    let mut leaves = 0;
    let place = |visited: super::cells::Visited| {
        let mut leaf = KdPlace::NONE;
        if visited.node.is_leaf() {
            leaf = leaves;
            leaves += 1;
        }
        let (min, max) = (visited.cell.min.into(), visited.cell.max.into());
        KdPlace { min, parent: visited.parent, max, leaf }
    };
    cells(nodes, bounds).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_place_is_32_bytes_and_says_where() {
        assert_eq!((size_of::<KdPlace>(), align_of::<KdPlace>()), (32, 16));
        let nodes = [
            KdNode::inner(0, 1.0, 2),
            KdNode::leaf(0, 1),
            KdNode::inner(2, 3.0, 4),
            KdNode::leaf(1, 1),
            KdNode::leaf(2, 0),
        ];
        let places = places(&nodes, &Aabb::new(Vec3::ZERO, Vec3::splat(4.0)));
        let parents: Vec<u32> = places.iter().map(|place| place.parent).collect();
        assert_eq!(parents, [u32::MAX, 0, 0, 2, 2]);
        let leaves: Vec<u32> = places.iter().map(|place| place.leaf).collect();
        assert_eq!(leaves, [u32::MAX, 0, u32::MAX, 1, 2]);
        assert_eq!(places[4].bounds(), Aabb::new(Vec3::new(1.0, 0.0, 3.0), Vec3::splat(4.0)));
        assert_eq!(places[1].bounds(), Aabb::new(Vec3::ZERO, Vec3::new(1.0, 4.0, 4.0)));
    }
}
