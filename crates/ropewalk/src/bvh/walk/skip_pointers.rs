//! The walk of traversal lists over an ordinary BVH: on by one node, or past a subtree (Toczek 2010, section 2.1; skip
//! pointers, Smits 1998). No stack, and nothing to remember but a place; children come in the order in which the builder
//! put them, whatever the ray.
//!
//! The nodes are in depth-first order already; what they lack is where a leaf or a missed subtree leads: 4 bytes a node,
//! worked out when the walk is first asked for.

use super::{BvhWalk, Seeker, Visitor};
use crate::bvh::Node;

/// The walk, with where each node's subtree ends.
#[derive(Clone, Copy, Debug)]
pub struct SkipPointers<'a>(pub &'a [u32]);

/// Where each node's subtree ends: the place of what comes after it, or the number of nodes.
#[must_use]
pub(in crate::bvh) fn skip_pointers(nodes: &[Node]) -> Vec<u32> {
    let mut skips = vec![nodes.len() as u32; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        if !node.is_leaf() {
            skips[index + 1] = node.link;
            skips[node.link as usize] = skips[index];
        }
    }
    skips
}

impl<S: Seeker> BvhWalk<S> for SkipPointers<'_> {
    #[inline(always)]
    fn walk<V: Visitor>(self, nodes: &[Node], seeker: &S, visitor: &mut V) {
        let mut at = 0;
        while let Some(node) = nodes.get(at) {
            // As in all walks the root is not asked.
            if at > 0 && !seeker.approach(node, visitor.t_max()).is_hit() {
                at = self.0[at] as usize;
            } else if node.is_leaf() {
                if visitor.leaf(node.link, node.count).is_break() {
                    return;
                }
                at = self.0[at] as usize;
            } else {
                visitor.inner_visit(at as u32);
                at += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BuildOptions, Mesh, Scene, glam::Vec3};

    #[test]
    fn each_subtree_ends_where_the_next_begins() {
        let mut mesh = Mesh::default();
        for index in 0..50_u32 {
            let place = Vec3::new((index * 7 % 50) as f32, (index % 3) as f32, 0.0);
            mesh.positions.extend([place, place + Vec3::X, place + Vec3::Y]);
            mesh.triangles.push([3 * index, 3 * index + 1, 3 * index + 2]);
        }
        let bvh =
            Scene::from_mesh(mesh).build(&BuildOptions { max_leaf: 1, ..BuildOptions::default() }).unwrap();
        let (nodes, skips) = (bvh.nodes(), skip_pointers(bvh.nodes()));
        // Going past every child of a node leads to where its own subtree ends.
        for (index, node) in nodes.iter().enumerate() {
            let end = if node.is_leaf() { index + 1 } else { skips[skips[index + 1] as usize] as usize };
            assert_eq!(skips[index] as usize, end);
        }
        assert_eq!(skips[0] as usize, nodes.len());
        assert!(skip_pointers(&[]).is_empty());
    }
}
