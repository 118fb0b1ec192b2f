//! The half-spaces of rays that leave a triangle by its front.

use super::plane::ABOVE;
use super::search::{ListIndex, head as search};
use super::{NO_HEAD, PAD, Plane};
use crate::FlatTriangle;
use crate::traversal_list::cull::goes_with_all;
use crate::traversal_list::{Clearance, Directions, Heads, ListOptions, TraversalList, along};
use glam::Vec3;

/// The normals of the half-spaces that hold all directions of a list: those of the cone's facets, and for six lists the
/// axis, which the four facets imply but loosely.
#[must_use]
pub fn facets(directions: Directions, along: Vec3) -> Vec<Vec3> {
    match directions {
        Directions::One => vec![],
        Directions::Two => vec![along],
        Directions::Six => {
            let others = Vec3::AXES.into_iter().filter(|axis| axis.dot(along) == 0.0);
            others.flat_map(|other| [along + other, along - other]).chain([along]).collect()
        }
        Directions::Eight => vec![Vec3::X * along.x, Vec3::Y * along.y, Vec3::Z * along.z],
    }
}

/// The share by which a triangle's own half-space is moved outwards.
#[must_use]
pub const fn own_share(clearance: Clearance) -> f32 {
    match clearance {
        Clearance::Surface => PAD,
        Clearance::Above => -ABOVE,
    }
}

/// The half-space above a triangle, moved outwards by a share; `None` where the triangle has no normal.
pub(super) fn own_plane(triangle: &FlatTriangle, share: f32, largest: f32) -> Option<Plane> {
    let normal = triangle.front();
    let size = normal.abs().max_element();
    (size > 0.0 && size.is_finite())
        .then(|| Plane::moved_outwards(normal / size, triangle.triangle().vertices, share, largest))
}

/// The half-spaces of a triangle's rays of a list: the triangle's own first, where it has a normal, then, for regular heads,
/// the facets of the cone of directions from the triangle on. `largest` is the largest coordinate of the scene.
#[must_use]
pub fn planes_of(
    triangle: &FlatTriangle,
    heads: Heads,
    clearance: Clearance,
    directions: Directions,
    along: Vec3,
    largest: f32,
) -> Vec<Plane> {
    let vertices = triangle.triangle().vertices;
    let mut planes = Vec::with_capacity(6);
    planes.extend(own_plane(triangle, own_share(clearance), largest));
    if heads == Heads::Regular {
        let facet = |normal| Plane::from_first_of(normal, vertices, largest);
        planes.extend(facets(directions, along).into_iter().map(facet));
    }
    planes
}

/// The head of a triangle in a list.
pub(super) fn head(lists: &TraversalList, number: u32, heads: Heads, index: ListIndex) -> u32 {
    let ListOptions { directions, clearance, .. } = *lists.options();
    let (triangle, along) = (lists.triangle_at(number), along(directions)[index.list]);
    // No direction of the list leaves the triangle by its front.
    if goes_with_all(directions, along, -triangle.front()) {
        return NO_HEAD;
    }
    let planes = planes_of(&triangle, heads, clearance, directions, along, lists.largest_coordinate());
    search(lists, index, planes.iter())
}
