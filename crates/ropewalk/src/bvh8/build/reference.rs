//! References to triangles: what builders sort instead of the triangles themselves. 32 bytes each.

use super::extent::Extent;
use crate::memory::with_capacity;
use crate::parallel::{extend, map_chunks};
use crate::processor::Processor;
use crate::{Aabb, FlatTriangle};

/// As many references are measured by one thread, some hundredths of a millisecond, without an allocation.
const CHUNK: usize = 1 << 14;

/// A triangle's box, as an [`Extent`], and the index of the triangle.
///
/// The index travels in the free lanes, 22 bits in each, dressed as a number between 2 and 4: bare, a small index would be
/// a subnormal number, and on some processors every product with one takes some hundred cycles.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Reference(pub(crate) [f32; 8]);

impl Reference {
    const INDEX_BITS: u32 = (1 << 22) - 1;

    pub(crate) fn new(bounds: &Aabb, index: u32) -> Self {
        let dress = |bits: u32| f32::from_bits(bits & Self::INDEX_BITS | 2.0_f32.to_bits());
        let ([x, y, z], [to_x, to_y, to_z]) = (bounds.min.to_array(), bounds.max.to_array());
        Self([x, y, z, dress(index), -to_x, -to_y, -to_z, dress(index >> 22)])
    }

    /// The index of the triangle.
    #[inline(always)]
    pub(crate) fn index(&self) -> u32 {
        let bits = |lane: f32| lane.to_bits() & Self::INDEX_BITS;
        bits(self.0[3]) | bits(self.0[7]) << 22
    }

    /// The box.
    #[inline(always)]
    pub(crate) fn extent(&self) -> Extent {
        Extent(self.0)
    }

    /// Twice the centre of the box. The fourth lane means nothing, and is a normal number.
    #[inline(always)]
    pub(crate) fn doubled_center(&self) -> [f32; 4] {
        std::array::from_fn(|lane| self.0[lane] - self.0[lane + 4])
    }

    /// The rank along an axis: by the centre, ties by the index. No two references of different triangles have the same.
    pub(crate) fn key(&self, axis: usize) -> u64 {
        let bits = self.doubled_center()[axis].to_bits();
        // The order of the bits as a number is that of the values once negative ones are turned round.
        let ordered = if bits >> 31 == 0 { bits | 1 << 31 } else { !bits };
        u64::from(ordered) << 32 | u64::from(self.index())
    }
}

/// The references of triangles, in their order.
pub(crate) fn of_triangles(triangles: &[FlatTriangle]) -> Vec<Reference> {
    let mut references = with_capacity(triangles.len());
    extend(&mut references, triangles, |index, triangle| {
        Reference::new(&triangle.triangle().bounds(), index as u32)
    });
    references
}

/// The common box of some references, and the box of their doubled centres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub(crate) bounds: Extent,
    pub(crate) centers: Extent,
}

impl Part {
    pub(crate) const EMPTY: Self = Self { bounds: Extent::EMPTY, centers: Extent::EMPTY };

    pub(crate) fn measure(references: &[Reference]) -> Self {
        let processor = Processor::detect();
        let of_chunk = |chunk: &[Reference]| {
            processor.run(
                #[inline(always)]
                || Self::of_chunk(chunk),
            )
        };
        if references.len() <= CHUNK {
            return of_chunk(references);
        }
        let chunks = map_chunks(references, CHUNK, |_, chunk| of_chunk(chunk));
        chunks.into_iter().fold(Self::EMPTY, |a, b| Self {
            bounds: a.bounds.union(b.bounds),
            centers: a.centers.union(b.centers),
        })
    }

    #[inline(always)]
    fn of_chunk(references: &[Reference]) -> Self {
        let mut part = Self::EMPTY;
        for reference in references {
            part.bounds = part.bounds.union(reference.extent());
            let [x, y, z, rest] = reference.doubled_center();
            part.centers = part.centers.union(Extent([x, y, z, rest, -x, -y, -z, rest]));
        }
        part
    }

    /// The axis along which the centres are spread most.
    pub(crate) fn longest_axis(&self) -> usize {
        let [x, y, z] = self.centers.size();
        if x >= y && x >= z {
            0
        } else if y >= z {
            1
        } else {
            2
        }
    }
}

/// Puts the lower half along the longest axis of the centres first, and tells how many they are. Needs no order of the
/// centres to be there.
#[cold]
pub(crate) fn halve(references: &mut [Reference], part: &Part) -> (usize, [Part; 2]) {
    let middle = references.len() / 2;
    let axis = part.longest_axis();
    if middle > 0 {
        references.select_nth_unstable_by_key(middle, |reference| reference.key(axis));
    }
    let (low, high) = references.split_at(middle);
    (middle, [Part::measure(low), Part::measure(high)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn index_and_box_come_back() {
        for index in [0, 1, (1 << 22) - 1, 1 << 22, 0x7fff_fffe] {
            let bounds = Aabb::new(Vec3::new(-1.0, 2.0, -3.0), Vec3::new(4.0, 5.0, -2.0));
            let reference = Reference::new(&bounds, index);
            assert_eq!((reference.index(), reference.extent().bounds()), (index, bounds));
            assert_eq!(reference.doubled_center()[..3], [3.0, 7.0, -5.0]);
            assert!(!reference.doubled_center()[3].is_subnormal());
        }
    }

    #[test]
    fn halves_are_ordered_and_measured() {
        let point = |index: u32| {
            let x = f32::from((index * 37 % 101) as u8) - 50.0;
            Reference::new(&Aabb::new(Vec3::splat(x), Vec3::splat(x + 1.0)), index)
        };
        let mut references: Vec<_> = (0..101).map(point).collect();
        let part = Part::measure(&references);
        let (middle, parts) = halve(&mut references, &part);
        assert_eq!(middle, 50);
        assert_eq!(parts[0].bounds.bounds(), Aabb::new(Vec3::splat(-50.0), Vec3::splat(0.0)));
        assert_eq!(parts[1].bounds.bounds(), Aabb::new(Vec3::splat(0.0), Vec3::splat(51.0)));
        assert_eq!(parts[1].centers.bounds(), Aabb::new(Vec3::splat(1.0), Vec3::splat(101.0)));
    }
}
