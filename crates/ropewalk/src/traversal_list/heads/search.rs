//! From half-spaces to the head of a list (ALGORITHMS: C1).

use super::{NO_HEAD, Plane};
use crate::Aabb;
use crate::traversal_list::{Bounds, Element, TraversalList};

/// Which list is meant.
#[derive(Clone, Copy, Debug)]
pub(in crate::traversal_list) struct ListIndex {
    pub(super) layer: usize,
    pub(super) list: usize,
}

/// The head of a list for rays that stay within all half-spaces.
pub(super) fn head<'a>(
    lists: &TraversalList,
    index: ListIndex,
    planes: impl Iterator<Item = &'a Plane> + Clone,
) -> u32 {
    let elements = lists.list_of_layer(index.layer, index.list);
    let (mut at, mut head) = (0, 0);
    while let Some(element) = elements.get(at) {
        if planes.clone().any(|plane| excludes(lists, index.layer, plane, element)) {
            if element.escape <= 0 {
                return NO_HEAD;
            }
            at += element.escape as usize;
            // Not the triangle that the search ends with: what it passed on the way down must be asked again.
            head = at;
        } else if element.is_triangle() {
            return head as u32;
        } else {
            at += 1;
        }
    }
    NO_HEAD
}

fn excludes(lists: &TraversalList, layer: usize, plane: &Plane, element: &Element) -> bool {
    if element.is_triangle() {
        return plane.excludes_triangle(&lists.triangle(element).triangle().vertices);
    }
    match lists.options().bounds {
        Bounds::Sphere => plane.excludes_sphere(&element.sphere()),
        Bounds::Aabb => {
            let [min, max] = element.packed_box().corners(&lists.layers[layer].grid);
            plane.excludes_box(&Aabb::new(min.truncate(), max.truncate()))
        }
    }
}
