//! The hierarchy that lists are made of, with as many children a node as its builder likes.

use super::Reach;
use crate::bvh::Node;
use crate::{Aabb, FlatTriangle, Sphere};

/// An inner node.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// Its number among all groups of the hierarchy, depth first.
    pub(super) number: u32,
    /// Around all triangles below; where triangles are split, around their parts.
    pub(super) bounds: Aabb,
    /// The same.
    pub(super) sphere: Sphere,
    /// At least two.
    pub(super) children: Vec<Child>,
}

/// A child of an inner node.
#[derive(Clone, Debug)]
pub(super) enum Child {
    /// An inner node.
    Group(Box<Group>),
    /// A triangle, by its number.
    Triangle(u32),
}

impl Child {
    /// Its box and, for an inner node, its sphere.
    pub(super) fn extent<'a>(&'a self, triangles: &[FlatTriangle]) -> (Aabb, Option<&'a Sphere>) {
        match self {
            Self::Group(group) => (group.bounds, Some(&group.sphere)),
            Self::Triangle(number) => (triangles[*number as usize].triangle().bounds(), None),
        }
    }

    /// The depth of the deepest triangle below.
    pub(super) fn depth(&self) -> u32 {
        match self {
            Self::Triangle(_) => 0,
            Self::Group(group) => 1 + group.children.iter().map(Self::depth).max().unwrap_or(0),
        }
    }

    /// What rays cost by the surface area heuristic, by boxes, weighed by half areas: 1 for each element that is tested
    /// because its parent is hit.
    pub(super) fn weighted_cost(&self) -> f64 {
        match self {
            Self::Triangle(_) => 0.0,
            Self::Group(group) => {
                let tested = f64::from(group.bounds.half_area()) * group.children.len() as f64;
                tested + group.children.iter().map(Self::weighted_cost).sum::<f64>()
            }
        }
    }
}

/// A hierarchy over some of the triangles of a scene.
pub(super) struct Hierarchy {
    /// `None` where there are no triangles.
    pub(super) root: Option<Child>,
    /// How many groups there are.
    pub(super) groups: usize,
    /// How many places of triangles there are: more than triangles where some are split.
    pub(super) references: usize,
}

impl Hierarchy {
    /// Counts and numbers what is below a root. Triangles move to `first` and on.
    pub(super) fn new(mut root: Option<Child>, first: u32) -> Self {
        let (mut groups, mut references) = (0, 0);
        if let Some(root) = &mut root {
            number(root, first, &mut groups, &mut references);
        }
        Self { root, groups, references }
    }
}

fn number(child: &mut Child, first: u32, groups: &mut usize, references: &mut usize) {
    match child {
        Child::Triangle(number) => {
            *number += first;
            *references += 1;
        }
        Child::Group(group) => {
            group.number = *groups as u32;
            *groups += 1;
            group.children.iter_mut().for_each(|child| number(child, first, groups, references));
        }
    }
}

/// A binary tree, with the index of the triangle in each place of its leaves.
pub(super) struct BinaryTree<'a> {
    pub(super) nodes: &'a [Node],
    pub(super) order: &'a [u32],
    pub(super) triangles: &'a [FlatTriangle],
    /// Whether triangles may be split.
    pub(super) has_repeats: bool,
    pub(super) reach: Reach,
}

impl BinaryTree<'_> {
    /// The hierarchy; `None` where it is empty. A leaf of one triangle becomes the triangle itself.
    pub(super) fn hierarchy(&self) -> Option<Child> {
        (!self.nodes.is_empty()).then(|| self.of_node(0).0)
    }

    /// A node, and the places below it, which stand beside each other. No deeper than [`crate::bvh::MAX_DEPTH`] calls.
    fn of_node(&self, index: u32) -> (Child, std::ops::Range<u32>) {
        let node = &self.nodes[index as usize];
        let (children, places) = if node.is_leaf() {
            let range = node.link..node.link + node.count;
            let triangle = |place: u32| self.order[place as usize];
            if node.count == 1 {
                return (Child::Triangle(triangle(node.link)), range);
            }
            (range.clone().map(|place| Child::Triangle(triangle(place))).collect(), range)
        } else {
            let ((first, before), (second, behind)) = (self.of_node(index + 1), self.of_node(node.link));
            (vec![first, second], before.start.min(behind.start)..before.end.max(behind.end))
        };
        let sphere = self.sphere(node, places.clone());
        let group = Group { number: 0, bounds: node.bounds(), sphere, children };
        (Child::Group(Box::new(group)), places)
    }

    /// Around the triangles, or where these are split, around the node's own, which holds the parts.
    fn sphere(&self, node: &Node, places: std::ops::Range<u32>) -> Sphere {
        let bounds = node.bounds();
        if self.has_repeats {
            return Sphere::about(bounds.center(), std::iter::once(bounds));
        }
        let places = self.order[places.start as usize..places.end as usize].iter();
        let triangles = places.map(|&index| self.triangles[index as usize].triangle());
        let boxes = triangles.clone().map(|triangle| triangle.bounds());
        self.reach.sphere(bounds.center(), boxes, triangles.flat_map(|triangle| triangle.vertices))
    }
}
