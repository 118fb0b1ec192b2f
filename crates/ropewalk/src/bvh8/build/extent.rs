//! Boxes in the making: eight lanes, of which one minimum joins all.
//!
//! The largest coordinates are kept negated, so that the box around two boxes is the lane-wise minimum of eight numbers:
//! one instruction with AVX, two with SSE or NEON. Lanes 3 and 7 are free, and mean nothing here.

use crate::Aabb;
use crate::aabb::smaller;
use glam::Vec3;

/// A box: smallest x, y, z, anything, and largest x, y, z negated, anything.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Extent(pub(crate) [f32; 8]);

impl Extent {
    /// Contains nothing, and any box grows it.
    pub(crate) const EMPTY: Self = Self([f32::INFINITY; 8]);

    /// The box around both.
    #[inline(always)]
    pub(crate) fn union(self, other: Self) -> Self {
        // The order of operands makes this one instruction, and a NaN in `other` leaves the lane as it is.
        Self(std::array::from_fn(|lane| smaller(other.0[lane], self.0[lane])))
    }

    /// The lengths of the edges.
    #[inline(always)]
    pub(crate) fn size(&self) -> [f32; 3] {
        std::array::from_fn(|axis| -(self.0[axis] + self.0[axis + 4]))
    }

    /// Smallest x, y, z and largest x, y, z.
    #[inline(always)]
    pub(crate) fn corners(&self) -> [f32; 6] {
        let lanes = &self.0;
        [lanes[0], lanes[1], lanes[2], -lanes[4], -lanes[5], -lanes[6]]
    }

    /// The same as a box of two corners.
    pub(crate) fn bounds(&self) -> Aabb {
        let [x, y, z, to_x, to_y, to_z] = self.corners();
        Aabb::new(Vec3::new(x, y, z), Vec3::new(to_x, to_y, to_z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent(from: [f32; 3], to: [f32; 3]) -> Extent {
        Extent([from[0], from[1], from[2], 7.0, -to[0], -to[1], -to[2], 9.0])
    }

    #[test]
    fn the_union_contains_both() {
        let (a, b) = (extent([0.0, 1.0, 2.0], [1.0, 2.0, 5.0]), extent([-1.0, 1.5, 2.0], [0.5, 4.0, 3.0]));
        let both = a.union(b);
        assert_eq!(both.bounds(), a.bounds().union(b.bounds()));
        assert_eq!(both.size(), both.bounds().size().to_array());
        assert_eq!(Extent::EMPTY.union(a).bounds(), a.bounds());
    }

    #[test]
    fn a_lane_that_is_no_number_adds_nothing() {
        let a = extent([0.0, 1.0, 2.0], [1.0, 2.0, 5.0]);
        assert_eq!(a.union(Extent([f32::NAN; 8])).bounds(), a.bounds());
    }
}
