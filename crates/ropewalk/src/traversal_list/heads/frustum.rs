//! The half-spaces of primary rays: cells of the screen.

use super::search::ListIndex;
use super::{PAD, Plane, facets as facets_of};
use crate::traversal_list::{TraversalList, along};
use glam::{DVec3, Vec3};

/// The rays of a camera without a lens: from the eye in the directions `corner + x * right + y * down`, with `x` and `y`
/// from 0 to 1, divided into cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// Where all rays begin.
    pub eye: Vec3,
    /// The direction to the upper left corner of the screen.
    pub corner: Vec3,
    /// From there to the upper right corner.
    pub right: Vec3,
    /// From there to the lower left corner.
    pub down: Vec3,
    /// Cells a side, 1 to [`Frustum::MOST_CELLS`]; what is less or more counts as these.
    pub cells: u32,
}

impl Frustum {
    /// The most cells a side: a million in all.
    pub const MOST_CELLS: u32 = 1024;

    /// Cells a side.
    const fn side(&self) -> u32 {
        match self.cells {
            0 => 1,
            cells if cells > Self::MOST_CELLS => Self::MOST_CELLS,
            cells => cells,
        }
    }

    /// The cell of a place on the screen, `x` and `y` from 0 to 1: the row of its heads.
    #[must_use]
    pub fn cell(&self, x: f32, y: f32) -> u32 {
        let side = self.side();
        let place = |part: f32| ((part * side as f32) as u32).min(side - 1);
        place(y) * side + place(x)
    }

    /// The four sides of each cell's pyramid, row by row, when the largest coordinate of the scene is `largest`. In f64: of
    /// narrow cells the cross product would lose its digits.
    #[must_use]
    pub fn planes(&self, largest: f32) -> Vec<[Plane; 4]> {
        let (eye, count) = (self.eye.as_dvec3(), self.side());
        let reach = f64::from(largest) + eye.abs().max_element();
        let dir = |x: u32, y: u32| {
            let part = |index: u32| f64::from(index) / f64::from(count);
            self.corner.as_dvec3() + self.right.as_dvec3() * part(x) + self.down.as_dvec3() * part(y)
        };
        let cell = |index: u32| {
            let (x, y) = (index % count, index / count);
            let corners = [dir(x, y), dir(x + 1, y), dir(x + 1, y + 1), dir(x, y + 1)];
            let middle: DVec3 = corners.into_iter().sum();
            std::array::from_fn(|side| {
                let normal = corners[side].cross(corners[(side + 1) % 4]);
                let inwards = if normal.dot(middle) < 0.0 { -normal } else { normal };
                // A pyramid without room inside is no reason to pass anything by.
                let normal = inwards / inwards.abs().max_element();
                let normal = if normal.is_finite() { normal } else { DVec3::ZERO };
                let pad = normal.abs().element_sum() * f64::from(PAD) * reach;
                Plane {
                    normal: normal.as_vec3(),
                    offset: (normal.dot(eye) - pad) as f32,
                    length: normal.length() as f32,
                }
            })
        };
        (0..count * count).map(cell).collect()
    }
}

/// The half-spaces that hold all rays of a list that begin at the eye.
pub(super) fn facets(lists: &TraversalList, frustum: &Frustum, index: ListIndex) -> Vec<Plane> {
    let directions = lists.options().directions;
    let reach = lists.largest_coordinate().max(frustum.eye.abs().max_element());
    facets_of(directions, along(directions)[index.list])
        .into_iter()
        .map(|normal| Plane::from_first_of(normal, [frustum.eye; 3], reach))
        .collect()
}
