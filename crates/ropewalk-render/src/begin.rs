//! Where rays begin, and what a structure with heads makes of it: the element of a traversal list before which such a ray
//! can hit nothing (Toczek 2010, section 3).

use glam::Vec2;
use rayon::prelude::*;
use ropewalk::traversal_list::{Frustum, HeadTable, Starts};
use ropewalk::{Ray, Structure, Walk};
use std::borrow::Cow;

/// Where the rays of a batch begin.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Begin<'a> {
    /// At the eye.
    AtEye {
        /// The whole screen as one cell.
        screen: &'a Frustum,
        /// Where on the screen each ray goes through, from 0 to 1.
        places: &'a [Vec2],
    },
    /// On triangles: for each ray the indices of instance, geometry and primitive. `None` for one that does not begin on a
    /// triangle but elsewhere.
    OnTriangles(&'a [Option<(u32, u32, u32)>]),
}

/// The heads of a batch.
pub(crate) struct BatchHeads<'a> {
    table: Cow<'a, HeadTable>,
    rows: Vec<u32>,
}

impl BatchHeads<'_> {
    pub(crate) fn starts(&self) -> Starts<'_> {
        Starts { table: &self.table, rows: &self.rows }
    }
}

/// The heads with which rays may begin; `None` where the structure has none for them, or the walk makes no use of any.
pub(crate) fn heads<'a>(
    structure: &'a Structure,
    walk: Walk,
    rays: &[Ray],
    begin: &Begin<'_>,
) -> Option<BatchHeads<'a>> {
    let (Structure::List(list), Walk::List) = (structure, walk) else { return None };
    match *begin {
        Begin::AtEye { screen, places } => {
            let cells = list.options().frustum_grid;
            if cells == 0 || places.len() != rays.len() {
                return None;
            }
            let frustum = Frustum { cells, ..*screen };
            let rows = places.iter().map(|place| frustum.cell(place.x, place.y)).collect();
            Some(BatchHeads { table: Cow::Owned(list.frustum_heads(&frustum)), rows })
        }
        Begin::OnTriangles(triangles) => {
            let table = list.polygon_heads()?;
            if triangles.len() != rays.len() {
                return None;
            }
            let number =
                |id: &Option<(u32, u32, u32)>| id.and_then(|id| list.number_of(id)).unwrap_or(u32::MAX);
            let numbers: Vec<u32> = triangles.par_iter().with_min_len(1024).map(number).collect();
            Some(BatchHeads { table: Cow::Borrowed(table), rows: list.polygon_starts(rays, &numbers) })
        }
    }
}
