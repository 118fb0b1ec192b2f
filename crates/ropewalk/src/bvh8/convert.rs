//! A wide tree of plain nodes as the tree that is packed.

use super::tree::{Child, LARGEST_LEAF, Tree, TreeNode, WIDTH};
use crate::Aabb;
use crate::wide_bvh::{WideBvh, is_empty};

/// The same tree. Leaves of more triangles than a vector takes, which only a depth cap makes, are divided; with four children a node half of the
/// places stay empty.
pub(super) fn tree_of(wide: &WideBvh) -> Tree {
    let width = wide.width().children();
    let count = wide.children().len() / width;
    let mut tree =
        Tree { nodes: vec![TreeNode::EMPTY; count], order: (0..wide.triangles().len() as u32).collect() };
    for (index, children) in wide.children().chunks_exact(width).enumerate() {
        for (place, child) in children.iter().take_while(|child| !is_empty(child)).enumerate() {
            let bounds = child.bounds();
            let to = if child.count == 0 {
                Child::inner(child.link)
            } else {
                divided(&mut tree, &bounds, child.link, child.count)
            };
            tree.nodes[index].set(place, &bounds, to);
        }
    }
    tree
}

/// A leaf, or a node of eight parts of a leaf that is too large. At most as many calls deep as 255 triangles have parts of
/// parts.
fn divided(tree: &mut Tree, bounds: &Aabb, first: u32, count: u32) -> Child {
    if count <= LARGEST_LEAF {
        return Child::leaf(first, count);
    }
    let node = tree.nodes.len();
    tree.nodes.push(TreeNode::EMPTY);
    let share = count.div_ceil(WIDTH as u32).max(LARGEST_LEAF);
    for (place, from) in (0..count).step_by(share as usize).enumerate() {
        let child = divided(tree, bounds, first + from, share.min(count - from));
        tree.nodes[node].set(place, bounds, child);
    }
    Child::inner(node as u32)
}
