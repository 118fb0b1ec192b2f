//! Which heads the rays of a batch begin with.

use super::polygon::own_plane;
use super::{CLEAR, HeadTable};
use crate::traversal_list::{Clearance, TraversalList};
use crate::{PreparedRay, Ray};

/// Heads, and which row of them each ray of a batch begins with.
#[derive(Clone, Copy, Debug)]
pub struct Starts<'a> {
    /// The heads.
    pub table: &'a HeadTable,
    /// A row for each ray, or [`Starts::FROM_THE_FIRST`].
    pub rows: &'a [u32],
}

impl<'a> Starts<'a> {
    /// The row of a ray of which nothing is known: it begins with the first element of each list.
    pub const FROM_THE_FIRST: u32 = u32::MAX;

    /// The heads of a ray of the batch; `None` where it begins with the first element.
    #[must_use]
    pub fn of(&self, ray: usize) -> Option<&'a [u32]> {
        self.table.row(*self.rows.get(ray)? as usize)
    }
}

impl TraversalList {
    /// The rows of heads of rays that begin on triangles, given by their numbers, of which any that there is not means none.
    ///
    /// A ray that does not leave its triangle by the front begins with the first element. So does, with
    /// [`Clearance::Above`], one whose first point, at `t_min`, is not above the triangle's plane by a few millionths of the
    /// scene's largest coordinate ([`super::CLEAR`]). It is for the caller to see to it that the ray's first point is one of
    /// the triangle's, off by no more than a hundred-thousandth of that coordinate.
    #[must_use]
    pub fn polygon_starts(&self, rays: &[Ray], triangles: &[u32]) -> Vec<u32> {
        let row = |(ray, &number): (&Ray, &u32)| {
            let is_there = (number as usize) < self.identities().len();
            let leaves = is_there && self.leaves(ray, number);
            if leaves { number } else { Starts::FROM_THE_FIRST }
        };
        rays.iter().zip(triangles).map(row).collect()
    }
}

impl TraversalList {
    /// Whether a ray goes from a triangle's front, and from above it where it must.
    fn leaves(&self, ray: &Ray, number: u32) -> bool {
        let triangle = self.triangle_at(number);
        let is_clear = match self.options().clearance {
            Clearance::Surface => true,
            // Outside of the half-space that begins so far above is what begins below.
            Clearance::Above => own_plane(&triangle, -CLEAR, self.largest_coordinate())
                .is_some_and(|plane| plane.normal.dot(ray.at(ray.t_min)) >= plane.offset),
        };
        is_clear && PreparedRay::new(ray).is_some_and(|ray| triangle.is_left_by(&ray))
    }
}
