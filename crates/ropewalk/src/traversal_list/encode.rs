//! From a hierarchy to a list: its nodes depth first, the children of each in the order of the list's direction.

use super::hierarchy::Child;
use super::packed_box::Grid;
use super::{Bounds, ChildOrder, Element};
use crate::FlatTriangle;
use glam::Vec3;

/// How one list is made.
#[derive(Clone, Copy)]
pub(super) struct Encoder<'a> {
    pub(super) triangles: &'a [FlatTriangle],
    /// The vertices of each triangle among those that all lists share.
    pub(super) corners: &'a [[u32; 3]],
    pub(super) bounds: Bounds,
    pub(super) grid: &'a Grid,
    /// The direction of the list.
    pub(super) along: Vec3,
    pub(super) order: ChildOrder,
}

impl Encoder<'_> {
    /// The list of a hierarchy.
    pub(super) fn encode(&self, root: &Child) -> Vec<Element> {
        let mut list = Vec::new();
        self.append(root, &mut list);
        // What escapes from the end of the list leads nowhere.
        let len = list.len();
        for (index, element) in list.iter_mut().enumerate() {
            if element.escape as usize + index == len {
                element.escape = if element.is_triangle() { 0 } else { Element::NOWHERE };
            }
        }
        list
    }

    /// No deeper than the hierarchy.
    fn append(&self, child: &Child, list: &mut Vec<Element>) {
        match child {
            Child::Triangle(index) => {
                list.push(Element::of_triangle(self.corners[*index as usize], *index));
            }
            Child::Group(group) => {
                let place = list.len();
                list.push(match self.bounds {
                    Bounds::Sphere => Element::of_sphere(&group.sphere),
                    Bounds::Aabb => Element::of_box(self.grid.pack(&group.bounds)),
                });
                let mut children: Vec<(f32, &Child)> =
                    group.children.iter().map(|child| (self.key(child), child)).collect();
                // Stable: of equals the one that the builder made first.
                children.sort_by(|a, b| a.0.total_cmp(&b.0));
                children.into_iter().for_each(|(_, child)| self.append(child, list));
                list[place].escape = (list.len() - place) as i32;
            }
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
            (_, _, Child::Triangle(index)) => {
                let along =
                    self.triangles[*index as usize].triangle().vertices.map(|vertex| vertex.dot(self.along));
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
