//! The leaf-left trick of the blog of 2022, at build time: of two children of which exactly one is a leaf, the
//! leaf comes first. (Swapping at run time, as the blog words it, would cost what it is meant to save.)

use crate::bvh::Node;

/// The same tree with its leaves first, in depth-first order. The triangles stay where they are.
pub(super) fn reorder(nodes: &[Node]) -> Vec<Node> {
    let mut ordered: Vec<Node> = Vec::with_capacity(nodes.len());
    // Subtrees to copy: the old root, and the new parent whose second child it becomes.
    let mut pending: Vec<(usize, Option<usize>)> = Vec::new();
    if !nodes.is_empty() {
        pending.push((0, None));
    }
    while let Some((old, second_of)) = pending.pop() {
        if let Some(parent) = second_of {
            ordered[parent].link = ordered.len() as u32;
        }
        let node = nodes[old];
        let place = ordered.len();
        ordered.push(node);
        if !node.is_leaf() {
            let (mut first, mut second) = (old + 1, node.link as usize);
            if nodes[second].is_leaf() && !nodes[first].is_leaf() {
                (first, second) = (second, first);
            }
            pending.push((second, Some(place)));
            pending.push((first, None));
        }
    }
    ordered
}
