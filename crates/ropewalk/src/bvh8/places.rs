//! In which order the children of a node lie in its places: that in which any-hit walks want them, which visit the last one first.
//!
//! Inner nodes before leaves, each by growing area, ties as they were: so what is likely to stop a ray is tried first.

use super::network::sorted;
use super::tree::{TreeNode, WIDTH};

/// The bits of a place, the lowest of a key.
const PLACE: u64 = WIDTH as u64 - 1;
/// Where in a key an area begins.
const AREA: u32 = PLACE.count_ones();
/// Where in a key begins what a child is: 0 for an inner node, 1 for a leaf, 2 for nothing.
const KIND: u32 = AREA + 32;

/// The same node with its places put in order, and how many hold something.
#[inline(always)]
pub(super) fn in_order(node: &TreeNode) -> (TreeNode, usize) {
    let [low_x, low_y, low_z, high_x, high_y, high_z] = &node.bounds;
    let mut keys = [0; WIDTH];
    for place in 0..WIDTH {
        let [x, y, z] =
            [high_x[place] - low_x[place], high_y[place] - low_y[place], high_z[place] - low_z[place]];
        let child = node.children[place];
        let kind = u64::from(child.is_leaf()) | u64::from(child.is_nothing()) << 1;
        // An area is not negative, so that its bits are ordered as it is.
        let area = x * y + y * z + z * x;
        keys[place] = kind << KIND | u64::from(area.to_bits()) << AREA | place as u64;
    }
    let keys = sorted(keys, exchange);
    let mut ordered = TreeNode::EMPTY;
    let mut filled = 0;
    for (place, key) in keys.into_iter().enumerate() {
        let from = (key & PLACE) as usize;
        for row in 0..6 {
            ordered.bounds[row][place] = node.bounds[row][from];
        }
        ordered.children[place] = node.children[from];
        filled += usize::from(!ordered.children[place].is_nothing());
    }
    (ordered, filled)
}

#[inline(always)]
const fn exchange(a: u64, b: u64) -> [u64; 2] {
    if a < b { [a, b] } else { [b, a] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Aabb;
    use crate::bvh8::tree::Child;
    use glam::Vec3;

    #[test]
    fn nodes_come_before_leaves_and_small_ones_before_large_ones() {
        let mut node = TreeNode::EMPTY;
        let sizes = [3.0, 2.0, 5.0, 2.0, 1.0];
        for (place, size) in sizes.into_iter().enumerate() {
            let number = place as u32 + 1;
            let child = if place % 2 == 0 { Child::leaf(number, 3) } else { Child::inner(number) };
            node.set(place, &Aabb::new(Vec3::ZERO, Vec3::splat(size)), child);
        }
        let (ordered, filled) = in_order(&node);
        assert_eq!(filled, sizes.len());
        assert_eq!(ordered.children.map(|child| child.link), [2, 4, 5, 1, 3, 0, 0, 0]);
        for place in 0..filled {
            let before = ordered.children[place].link as usize - 1;
            assert_eq!(ordered.child_bounds(place), node.child_bounds(before));
        }
        assert!((filled..WIDTH).all(|place| ordered.child_bounds(place) == Aabb::EMPTY));
    }
}
