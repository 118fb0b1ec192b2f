//! Heads: the element with which a ray may begin of which something is known (Toczek 2010, section 3).
//!
//! A ray that leaves a triangle by its front goes into the half-space above the triangle's plane; a primary ray of a cell of
//! the screen goes into the cell's pyramid. What lies outside of these is missed for certain, and the part of a list that
//! comes before the first element that may be hit need not be walked. That element is the head. There is one for each
//! list, since each has its own order.
//!
//! **Conservative** (ALGORITHMS: T9). An element is passed by only where it lies outside of one half-space as a whole, and by
//! more than all roundings: [`Plane`]. So rays hit what they would hit from the first element on. A head is the target of
//! the last escape, above which nothing is known: it may lie below an ancestor that the ray would have missed.
//!
//! **Above** ([`super::Clearance`]). A ray that begins on a triangle, to within rounding, may hit whatever touches its plane, the
//! triangle itself too. One that begins clearly above cannot, and with heads for such rays these are passed by. Both, rays
//! and heads, are asked for it.
//!
//! Rays that go through the plane, refracted ones, begin with the first element.
//!
//! **Cost.** 4 bytes a list for each triangle or cell.

mod frustum;
mod plane;
mod polygon;
mod search;
mod starts;

pub use frustum::Frustum;
pub use plane::{ABOVE, CLEAR, PAD, Plane};
pub use polygon::{facets, own_share, planes_of};
pub use starts::Starts;

use super::{Heads, TraversalList};
use crate::ValidationError;
use crate::parallel::map_chunks;

/// The head of a list of which no element can be hit.
pub const NO_HEAD: u32 = u32::MAX;

/// Heads: rows of one for each list of each layer, counted from where that list begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HeadTable {
    /// The lengths of the lists that they are of.
    lengths: Vec<u32>,
    heads: Vec<u32>,
}

/// Rows that a thread makes at a time.
const CHUNK: usize = 256;

impl HeadTable {
    /// Takes heads that were found elsewhere, row after row.
    ///
    /// # Errors
    /// When they are no whole rows, or one lies beyond its list.
    pub fn from_heads(list: &TraversalList, heads: Vec<u32>) -> Result<Self, ValidationError> {
        let lengths = lengths(list);
        let wrong = |node: usize, what: &str| Err(ValidationError { node, what: what.to_owned() });
        if !heads.len().is_multiple_of(lengths.len()) {
            return wrong(heads.len(), "the last row of heads is not whole");
        }
        let beyond = |(&head, &length): (&u32, &u32)| head != NO_HEAD && head >= length;
        if let Some(place) = heads.iter().zip(lengths.iter().cycle()).position(beyond) {
            return wrong(place, "this head lies beyond its list");
        }
        Ok(Self { lengths, heads })
    }

    /// Of every triangle, side by side where there are threads.
    pub(super) fn of_polygons(list: &TraversalList, heads: Heads) -> Self {
        let numbers: Vec<u32> = (0..list.identities().len() as u32).collect();
        Self::of_rows(list, &numbers, |&number, index| polygon::head(list, number, heads, index))
    }

    /// A row of each of `rows`, of which `head` finds the head in each list.
    fn of_rows<R: Sync>(
        list: &TraversalList,
        rows: &[R],
        head: impl Fn(&R, search::ListIndex) -> u32 + Sync,
    ) -> Self {
        let lists = list.options().directions.lists();
        let indices: Vec<_> = (0..list.layers())
            .flat_map(|layer| (0..lists).map(move |list| search::ListIndex { layer, list }))
            .collect();
        let parts = map_chunks(rows, CHUNK, |_, rows| {
            rows.iter()
                .flat_map(|row| indices.iter().map(|&index| head(row, index)).collect::<Vec<_>>())
                .collect::<Vec<_>>()
        });
        Self { lengths: lengths(list), heads: parts.concat() }
    }

    /// How many rows there are.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.heads.len().checked_div(self.width()).unwrap_or(0)
    }

    /// Heads a row: one for each list of each layer, the first layer's first.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.lengths.len()
    }

    /// A row.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, row: usize) -> Option<&[u32]> {
        self.heads.get(row * self.width()..)?.get(..self.width())
    }

    /// All heads, row after row.
    #[must_use]
    pub fn heads(&self) -> &[u32] {
        &self.heads
    }

    /// Whether they are of these lists, as far as their lengths tell.
    pub(super) fn is_of(&self, list: &TraversalList) -> bool {
        self.lengths == lengths(list)
    }

    /// Its bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.heads.as_slice())
    }
}

/// The lengths of all lists.
fn lengths(list: &TraversalList) -> Vec<u32> {
    list.starts().windows(2).map(|pair| pair[1] - pair[0]).collect()
}

impl TraversalList {
    /// The heads of rays that leave a triangle by its front, a row a triangle; where [`super::ListOptions::heads`] wants any.
    #[must_use]
    pub const fn polygon_heads(&self) -> Option<&HeadTable> {
        self.heads.as_ref()
    }

    /// The heads of primary rays, a row a cell of the screen, row by row.
    #[must_use]
    pub fn frustum_heads(&self, frustum: &Frustum) -> HeadTable {
        let cells: Vec<[Plane; 4]> = frustum.planes(self.largest_coordinate());
        HeadTable::of_rows(self, &cells, |planes, index| {
            let facets = frustum::facets(self, frustum, index);
            search::head(self, index, planes.iter().chain(&facets))
        })
    }
}
