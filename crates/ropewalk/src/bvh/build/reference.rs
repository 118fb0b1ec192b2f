//! References to primitives: what builders sort instead of the primitives themselves. 32 bytes each.

use crate::parallel::fill_chunks;
use crate::{Aabb, FlatTriangle};
use glam::{Vec3, Vec4};

/// A primitive's box and index. The index travels in the fourth lanes, 22 bits in each, dressed as a number
/// between 2 and 4: bare, a small index would be a subnormal number, and every product with it would take some
/// hundred cycles (half of the build time of the Stanford bunny).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reference {
    low: Vec4,
    high: Vec4,
}

impl Reference {
    const INDEX_BITS: u32 = (1 << 22) - 1;

    pub(crate) fn new(bounds: &Aabb, index: u32) -> Self {
        let dress = |bits: u32| f32::from_bits(bits & Self::INDEX_BITS | 2.0_f32.to_bits());
        Self { low: bounds.min.extend(dress(index)), high: bounds.max.extend(dress(index >> 22)) }
    }

    pub(crate) fn index(&self) -> usize {
        let bits = |lane: f32| lane.to_bits() & Self::INDEX_BITS;
        (bits(self.low.w) | bits(self.high.w) << 22) as usize
    }

    /// Where the box begins and ends along an axis.
    #[inline(always)]
    pub(crate) fn span(&self, axis: usize) -> [f32; 2] {
        [self.low[axis], self.high[axis]]
    }

    /// The corners of the box. The fourth lanes are numbers and mean nothing.
    #[inline(always)]
    pub(crate) fn corners(&self) -> Extent {
        Extent { low: self.low, high: self.high }
    }

    /// The parts of the box below a plane across `axis` and above it. The plane belongs to both.
    #[inline(always)]
    pub(crate) fn cut(&self, axis: usize, plane: f32) -> [Self; 2] {
        let (mut below, mut above) = (*self, *self);
        below.high[axis] = plane;
        above.low[axis] = plane;
        [below, above]
    }

    /// The rank along an axis: by the centre, ties by the index. No two references of different primitives have the
    /// same, so that every sort is deterministic.
    #[inline(always)]
    pub(crate) fn key(&self, axis: usize) -> u64 {
        let bits = self.doubled_center()[axis].to_bits();
        // The order of the bits as a number is that of the values once negative ones are turned round.
        let ordered = if bits >> 31 == 0 { bits | 1 << 31 } else { !bits };
        u64::from(ordered) << 32 | self.index() as u64
    }

    /// Twice the centre of the box. The fourth lane means nothing.
    #[inline(always)]
    pub(crate) fn doubled_center(&self) -> Vec4 {
        self.low + self.high
    }
}

/// A box in the making, for SIMD registers. The fourth lanes mean nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) low: Vec4,
    pub(crate) high: Vec4,
}

impl Extent {
    pub(crate) const EMPTY: Self = Self { low: Vec4::INFINITY, high: Vec4::NEG_INFINITY };

    /// The box around some references.
    pub(crate) fn of(references: &[Reference]) -> Self {
        let mut extent = Self::EMPTY;
        references.iter().for_each(|reference| extent.add(reference));
        extent
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, reference: &Reference) {
        self.low = self.low.min(reference.low);
        self.high = self.high.max(reference.high);
    }

    #[inline(always)]
    pub(crate) fn add_point(&mut self, point: Vec4) {
        self.low = self.low.min(point);
        self.high = self.high.max(point);
    }

    /// What both contain; of negative size where that is nothing.
    #[inline(always)]
    pub(crate) fn intersection(self, other: Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    /// Whether there is no point in the box: not even one of a flat box.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.low.cmple(self.high).bitmask() & 0b111 != 0b111
    }

    #[inline(always)]
    pub(crate) fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Half the surface area; NaN or infinite for an empty extent, which no caller asks.
    #[inline(always)]
    pub(crate) fn half_area(&self) -> f32 {
        let size = self.high - self.low;
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    pub(crate) fn bounds(&self) -> Aabb {
        Aabb::new(self.low.truncate(), self.high.truncate())
    }
}

/// The references of triangles, in their order.
pub(crate) fn of_triangles(triangles: &[FlatTriangle]) -> Vec<Reference> {
    let nothing = Reference::new(&Aabb::new(Vec3::ZERO, Vec3::ZERO), 0);
    let mut references = vec![nothing; triangles.len()];
    fill_chunks(&mut references, 1 << 14, |first, part| {
        for (offset, place) in part.iter_mut().enumerate() {
            let index = first + offset;
            *place = Reference::new(&triangles[index].triangle().bounds(), index as u32);
        }
    });
    references
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_index_comes_back() {
        for index in [0, 1, (1 << 22) - 1, 1 << 22, 0x7fff_fffe] {
            let reference = Reference::new(&Aabb::new(Vec3::ZERO, Vec3::ONE), index);
            assert_eq!(reference.index(), index as usize);
            assert!(reference.low.is_finite() && reference.doubled_center().w >= 4.0);
        }
    }
}
