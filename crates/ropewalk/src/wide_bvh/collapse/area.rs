//! The greedy collapse: of the children so far, the inner one of largest area is replaced by its two children, until
//! there is no room or no inner child. What is most likely to be hit is opened first.

use super::Cut;
use crate::bvh::Node;

/// The cut. At equal areas the first child is opened.
pub(super) struct LargestArea<'a> {
    pub(super) nodes: &'a [Node],
    pub(super) width: usize,
}

impl Cut for LargestArea<'_> {
    fn choose(&self, root: u32, cut: &mut Vec<u32>) {
        let node = |index: u32| &self.nodes[index as usize];
        cut.clear();
        cut.extend([root + 1, node(root).link]);
        while cut.len() < self.width {
            let inner = cut.iter().enumerate().filter(|&(_, &child)| !node(child).is_leaf());
            let areas = inner.map(|(slot, &child)| (slot, node(child).bounds().half_area()));
            let largest = areas.reduce(|best, other| if other.1 > best.1 { other } else { best });
            let Some((slot, _)) = largest else { return };
            let opened = cut[slot];
            cut[slot] = opened + 1;
            cut.insert(slot + 1, node(opened).link);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Aabb;
    use glam::Vec3;

    fn leaf(size: f32) -> Node {
        Node::leaf(&Aabb::new(Vec3::ZERO, Vec3::splat(size)), 0, 1)
    }

    fn inner(size: f32, second: u32) -> Node {
        Node::inner(&Aabb::new(Vec3::ZERO, Vec3::splat(size)), second)
    }

    fn cut(nodes: &[Node], width: usize) -> Vec<u32> {
        let mut cut = vec![77];
        LargestArea { nodes, width }.choose(0, &mut cut);
        cut
    }

    #[test]
    fn the_largest_inner_child_is_opened_first() {
        let nodes = [
            inner(9.0, 4),
            inner(2.0, 3), // 1
            leaf(1.0),
            leaf(1.0),
            inner(8.0, 8), // 4
            inner(3.0, 7), // 5
            leaf(1.0),
            leaf(1.0),
            leaf(7.0), // 8
        ];
        assert_eq!(cut(&nodes, 2), [1, 4]);
        assert_eq!(cut(&nodes, 3), [1, 5, 8]);
        assert_eq!(cut(&nodes, 4), [1, 6, 7, 8]);
        assert_eq!(cut(&nodes, 8), [2, 3, 6, 7, 8], "no inner child is left");
    }

    #[test]
    fn of_equals_the_first_is_opened() {
        let nodes = [inner(9.0, 4), inner(2.0, 3), leaf(1.0), leaf(1.0), inner(2.0, 6), leaf(1.0), leaf(1.0)];
        assert_eq!(cut(&nodes, 3), [2, 3, 4]);
    }
}
