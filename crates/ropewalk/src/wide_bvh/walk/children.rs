//! The children of a wide node that a ray hits, nearest first.

use super::is_empty;
use crate::PreparedRay;
use crate::bvh::Node;
use crate::bvh::walk::Seeker;

/// Where a walk goes: a leaf, or an inner node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Target {
    /// Leaf: its first triangle. Inner node: the index of its wide node.
    pub link: u32,
    /// Leaf: its triangles. Inner node: 0.
    pub count: u32,
}

impl Target {
    /// The root, which is always an inner node.
    pub const ROOT: Self = Self { link: 0, count: 0 };

    /// Whether it is a leaf.
    #[inline(always)]
    #[must_use]
    pub const fn is_leaf(self) -> bool {
        self.count != 0
    }
}

/// A child that waits for its turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Waiting {
    /// What it is.
    pub target: Target,
    /// Where the ray enters it.
    pub entry: f32,
    /// Whether none of its node's children waits for its turn after it. Only the restart trail asks.
    pub last: bool,
}

/// The hit children of one wide node, nearest first; of equals the one in the earlier place.
#[derive(Clone, Copy, Debug)]
pub struct HitChildren<const WIDTH: usize> {
    sorted: [Waiting; WIDTH],
    len: usize,
}

impl<const WIDTH: usize> HitChildren<WIDTH> {
    /// Tests all children up to `t_max`, closed: a child that is entered there is hit.
    #[inline(always)]
    #[must_use]
    pub fn of(node: &[Node; WIDTH], ray: &PreparedRay, t_max: f32) -> Self {
        let mut sorted = [Waiting::default(); WIDTH];
        let mut len = 0;
        for child in node {
            if is_empty(child) {
                break;
            }
            let interval = ray.approach(child, t_max);
            let target = Target { link: child.link, count: child.count };
            // Written in any case, kept where it is hit: no branch that nobody can foresee.
            sorted[len % WIDTH] = Waiting { target, entry: interval.entry, last: false };
            len += usize::from(interval.is_hit());
        }
        sort(&mut sorted[..len]);
        Self { sorted, len }
    }

    /// The children, nearest first.
    #[inline(always)]
    #[must_use]
    pub fn sorted(&self) -> &[Waiting] {
        &self.sorted[..self.len]
    }
}

/// By entry; equals keep their order.
#[inline(always)]
fn sort(children: &mut [Waiting]) {
    for end in 1..children.len() {
        let child = children[end];
        let mut place = end;
        while place > 0 && children[place - 1].entry > child.entry {
            children[place] = children[place - 1];
            place -= 1;
        }
        children[place] = child;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Aabb, Ray};
    use bytemuck::Zeroable;
    use glam::Vec3;

    fn slab(from: f32, to: f32, link: u32) -> Node {
        Node::leaf(&Aabb::new(Vec3::new(from, -1.0, -1.0), Vec3::new(to, 1.0, 1.0)), link, 1)
    }

    fn links(node: [Node; 8], t_max: f32) -> Vec<u32> {
        let ray = PreparedRay::new(&Ray::new(Vec3::ZERO, Vec3::X)).unwrap();
        HitChildren::of(&node, &ray, t_max).sorted().iter().map(|child| child.target.link).collect()
    }

    #[test]
    fn they_are_sorted_by_entry_and_then_by_place() {
        let nothing = Node::zeroed();
        let beside = Node::leaf(&Aabb::new(Vec3::new(0.0, 2.0, 0.0), Vec3::new(1.0, 3.0, 1.0)), 9, 1);
        let (far, near, same) = (slab(5.0, 6.0, 1), slab(2.0, 9.0, 2), slab(5.0, 7.0, 3));
        // Two that the ray starts in: both are entered at t_min.
        let (here, there) = (slab(-3.0, 1.0, 4), slab(-1.0, 2.0, 5));
        let node = [far, near, beside, same, here, there, nothing, nothing];
        assert_eq!(links(node, f32::INFINITY), [4, 5, 2, 1, 3]);
        let swapped = [same, there, near, far, beside, here, nothing, nothing];
        assert_eq!(links(swapped, f32::INFINITY), [5, 4, 2, 3, 1]);
        assert_eq!(links([nothing; 8], 1.0), []);
    }

    /// What the restart trail builds on.
    #[test]
    fn a_shorter_ray_hits_a_prefix() {
        let entries = [3.0, 1.0, 7.0, 5.0, 1.0, 2.0, 5.0, 4.0];
        let node: [Node; 8] = std::array::from_fn(|i| slab(entries[i], 20.0, i as u32));
        let all = links(node, f32::INFINITY);
        assert_eq!(all, [1, 4, 5, 0, 7, 3, 6, 2]);
        for step in 0..=80 {
            let hit = links(node, step as f32 * 0.1);
            assert_eq!(hit, all[..hit.len()]);
        }
        // Closed, and padded towards the ray.
        assert_eq!(links(node, 5.0).len(), 7);
        assert_eq!(links(node, 4.9999).len(), 5);
    }
}
