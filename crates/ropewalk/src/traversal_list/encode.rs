//! From a hierarchy to a list: its nodes depth first, the children of each in the order of the list's direction, without
//! what the list leaves out.
//!
//! **Pruning.** A node of which nothing is left is left out, and one of which one child is left is replaced by that child:
//! its own test could only cost. So no inner node gets the escape index 1, which means a triangle (ALGORITHMS: C1).

use super::cull::Hidden;
use super::hierarchy::{Child, Group};
use super::packed_box::Grid;
use super::{Bounds, ChildOrder, Element};
use crate::FlatTriangle;
use glam::Vec3;

/// The place of a group that is not in a list.
pub(super) const PRUNED: u32 = u32::MAX;

/// How one list is made.
pub(super) struct Encoder<'a> {
    pub(super) triangles: &'a [FlatTriangle],
    /// The vertices of each triangle among those that all lists share.
    pub(super) corners: &'a [[u32; 3]],
    pub(super) bounds: Bounds,
    pub(super) grid: &'a Grid,
    /// The direction of the list.
    pub(super) along: Vec3,
    pub(super) order: ChildOrder,
    /// What it leaves out.
    pub(super) hidden: Hidden,
}

/// A list, and where its groups are.
#[derive(Default)]
pub(super) struct Encoded {
    pub(super) elements: Vec<Element>,
    /// The place of each group, or [`PRUNED`].
    pub(super) places: Vec<u32>,
}

impl Encoder<'_> {
    /// The list of a hierarchy of so many groups.
    pub(super) fn encode(&self, root: Option<&Child>, groups: usize) -> Encoded {
        let mut encoded = Encoded { elements: Vec::new(), places: vec![PRUNED; groups] };
        let mut left = vec![0; groups];
        if let Some(root) = root
            && self.count(root, &mut left) > 0
        {
            self.append(root, &left, &mut encoded);
        }
        // What escapes from the end of the list leads nowhere.
        let len = encoded.elements.len();
        for (index, element) in encoded.elements.iter_mut().enumerate() {
            if element.escape as usize + index == len {
                element.escape = if element.is_triangle() { 0 } else { Element::NOWHERE };
            }
        }
        encoded
    }

    /// How many children of each group have something left. Gives back whether this one has, as 1 or 0.
    fn count(&self, child: &Child, left: &mut [u32]) -> u32 {
        match child {
            Child::Triangle(number) => u32::from(!self.hidden.hides(&self.triangles[*number as usize])),
            Child::Group(group) => {
                let sum = group.children.iter().map(|child| self.count(child, left)).sum();
                left[group.number as usize] = sum;
                sum.min(1)
            }
        }
    }

    fn is_left(&self, child: &Child, left: &[u32]) -> bool {
        match child {
            Child::Triangle(number) => !self.hidden.hides(&self.triangles[*number as usize]),
            Child::Group(group) => left[group.number as usize] > 0,
        }
    }

    /// Appends what is left of a child, of which something is. No deeper than the hierarchy.
    fn append(&self, child: &Child, left: &[u32], encoded: &mut Encoded) {
        match child {
            Child::Triangle(number) => {
                encoded.elements.push(Element::of_triangle(self.corners[*number as usize], *number));
            }
            Child::Group(group) => {
                let is_alone = left[group.number as usize] == 1;
                let place = encoded.elements.len();
                if !is_alone {
                    encoded.places[group.number as usize] = place as u32;
                    encoded.elements.push(self.inner(group));
                }
                let rest = group.children.iter().filter(|child| self.is_left(child, left));
                let mut children: Vec<(f32, &Child)> = rest.map(|child| (self.key(child), child)).collect();
                // Stable: of equals the one that the builder made first.
                children.sort_by(|a, b| a.0.total_cmp(&b.0));
                children.into_iter().for_each(|(_, child)| self.append(child, left, encoded));
                if !is_alone {
                    encoded.elements[place].escape = (encoded.elements.len() - place) as i32;
                }
            }
        }
    }

    fn inner(&self, group: &Group) -> Element {
        match self.bounds {
            Bounds::Sphere => Element::of_sphere(&group.sphere),
            Bounds::Aabb => Element::of_box(self.grid.pack(&group.bounds)),
        }
    }

    /// Where a child begins or ends along the direction.
    fn key(&self, child: &Child) -> f32 {
        let (bounds, sphere) = child.extent(self.triangles);
        let [first, last] = match (self.bounds, sphere, child) {
            (Bounds::Sphere, Some(sphere), _) => {
                let (middle, reach) = (sphere.center.dot(self.along), sphere.radius * self.along.length());
                [middle - reach, middle + reach]
            }
            (_, _, Child::Triangle(number)) => {
                let along =
                    self.triangles[*number as usize].triangle().vertices.map(|vertex| vertex.dot(self.along));
                [
                    along.into_iter().fold(f32::INFINITY, f32::min),
                    along.into_iter().fold(f32::NEG_INFINITY, f32::max),
                ]
            }
            _ => {
                let (middle, half) =
                    (bounds.center().dot(self.along), bounds.size().dot(self.along.abs()) * 0.5);
                [middle - half, middle + half]
            }
        };
        match self.order {
            ChildOrder::EarliestFirst => first,
            ChildOrder::LatestLast => last,
        }
    }
}
