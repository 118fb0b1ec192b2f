//! The hierarchy that lists are made of, with as many children a node as its builder likes.

use crate::bvh::{Bvh, Node};
use crate::{Aabb, FlatTriangle, Sphere};

/// An inner node.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// Around all triangles below; where triangles are split, around their parts.
    pub(super) bounds: Aabb,
    /// The same.
    pub(super) sphere: Sphere,
    /// At least one.
    pub(super) children: Vec<Child>,
}

/// A child of an inner node.
#[derive(Clone, Debug)]
pub(super) enum Child {
    /// An inner node.
    Group(Box<Group>),
    /// A triangle, by its index.
    Triangle(u32),
}

impl Child {
    /// Its box and, for an inner node, its sphere.
    pub(super) fn extent<'a>(&'a self, triangles: &[FlatTriangle]) -> (Aabb, Option<&'a Sphere>) {
        match self {
            Self::Group(group) => (group.bounds, Some(&group.sphere)),
            Self::Triangle(index) => (triangles[*index as usize].triangle().bounds(), None),
        }
    }
}

/// The hierarchy of a binary tree; `None` where it is empty. A leaf of one triangle becomes the triangle itself.
pub(super) fn of_bvh(bvh: &Bvh) -> Option<Child> {
    (!bvh.nodes().is_empty()).then(|| of_node(bvh, 0).0)
}

/// A node, and the triangles below it, which stand beside each other. No deeper than [`crate::bvh::MAX_DEPTH`] calls.
fn of_node(bvh: &Bvh, index: u32) -> (Child, std::ops::Range<u32>) {
    let node = &bvh.nodes()[index as usize];
    let (children, triangles) = if node.is_leaf() {
        let range = node.link..node.link + node.count;
        (range.clone().map(Child::Triangle).collect(), range)
    } else {
        let ((first, before), (second, behind)) = (of_node(bvh, index + 1), of_node(bvh, node.link));
        (vec![first, second], before.start.min(behind.start)..before.end.max(behind.end))
    };
    if let [Child::Triangle(_)] = children.as_slice() {
        return (children.into_iter().next().unwrap_or(Child::Triangle(triangles.start)), triangles);
    }
    let sphere = sphere(bvh, node, triangles.clone());
    (Child::Group(Box::new(Group { bounds: node.bounds(), sphere, children })), triangles)
}

/// Around the boxes of the triangles, or where these are cut, around the node's own, which holds the parts.
fn sphere(bvh: &Bvh, node: &Node, triangles: std::ops::Range<u32>) -> Sphere {
    let bounds = node.bounds();
    if bvh.has_repeats() {
        return Sphere::about(bounds.center(), std::iter::once(bounds));
    }
    let boxes = bvh.triangles()[triangles.start as usize..triangles.end as usize].iter();
    Sphere::about(bounds.center(), boxes.map(|triangle| triangle.triangle().bounds()))
}
