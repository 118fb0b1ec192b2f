//! Morton codes: 11 bits an axis of the centre of a triangle's box, interleaved, with the triangle's index below them in
//! one word. So equal codes are ordered, and no two words are the same.
//!
//! The cells are cubes: the longest axis of the scene has 2048 of them.

use crate::FlatTriangle;
use crate::bvh::build::reference::Extent;
use crate::memory::with_capacity;
use crate::parallel::{extend, map_chunks};
use glam::Vec4;

/// Bits of the index, enough for every triangle that a scene may have.
pub(super) const INDEX_BITS: u32 = 31;
/// Bits of a code.
pub(super) const CODE_BITS: u32 = 33;
/// Triangles that a thread takes at a time.
const CHUNK: usize = 1 << 13;
/// Adding this to a small number leaves the number, rounded, in the low bits of the sum.
const ROUND_TO_BITS: f32 = 8_388_608.0;

/// The corners of the box of a triangle. The fourth lanes are 0.
#[inline(always)]
pub(super) fn corners(triangle: &FlatTriangle) -> Extent {
    let [a, b, c] = [triangle.v0, triangle.v1, triangle.v2].map(|[x, y, z]| Vec4::new(x, y, z, 0.0));
    Extent { low: a.min(b).min(c), high: a.max(b).max(c) }
}

/// Twice the centre of the box of a triangle.
#[inline(always)]
fn doubled_center(triangle: &FlatTriangle) -> Vec4 {
    let corners = corners(triangle);
    corners.low + corners.high
}

/// The triangle of a word.
#[inline(always)]
pub(super) const fn index(key: u64) -> u32 {
    (key & ((1 << INDEX_BITS) - 1)) as u32
}

/// A word for each triangle: its code above, its index below.
pub(super) fn keys(triangles: &[FlatTriangle]) -> Vec<u64> {
    let centers = map_chunks(triangles, CHUNK, |_, chunk| {
        let mut extent = Extent::EMPTY;
        chunk.iter().for_each(|triangle| extent.add_point(doubled_center(triangle)));
        extent
    })
    .into_iter()
    .fold(Extent::EMPTY, Extent::union);
    let size = (centers.high - centers.low).truncate().max_element();
    let scale = 2048.0 / size;
    // No extent at all, or so little that the division overflows: one cell.
    let scale = Vec4::splat(if scale.is_finite() { scale } else { 0.0 });
    let mut keys = with_capacity(triangles.len());
    extend(&mut keys, triangles, |index, triangle| {
        let position = (doubled_center(triangle) - centers.low) * scale;
        let position = position.min(Vec4::splat(2047.25)) - 0.5;
        let cell = (position.max(Vec4::ZERO) + ROUND_TO_BITS).to_array();
        let [x, y, z, _] = cell.map(|lane| spread(lane.to_bits() & 2047));
        (x | y << 1 | z << 2) << INDEX_BITS | index as u64
    });
    keys
}

/// Puts two zero bits behind each of 11 bits.
#[inline(always)]
const fn spread(cell: u32) -> u64 {
    let cell = cell as u64;
    let cell = (cell | cell << 16) & 0x0700_00ff;
    let cell = (cell | cell << 8) & 0x0700_f00f;
    let cell = (cell | cell << 4) & 0x430c_30c3;
    (cell | cell << 2) & 0x4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh8::build::reinserted::tests::flat;
    use glam::Vec3;

    #[test]
    fn bits_are_spread() {
        for cell in 0..2048_u32 {
            let expected = (0..11).map(|bit| u64::from(cell >> bit & 1) << (3 * bit)).sum::<u64>();
            assert_eq!(spread(cell), expected, "{cell}");
        }
    }

    #[test]
    fn codes_follow_the_centres() {
        let at = |p: Vec3| [p, p + Vec3::X * 1e-3, p + Vec3::Y * 1e-3];
        let corners: Vec<Vec3> = (0..8)
            .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32) * 5.0)
            .collect();
        let triangles = flat(corners.into_iter().flat_map(at).collect());
        let keys = keys(&triangles);
        for (i, key) in keys.iter().enumerate() {
            assert_eq!(index(*key), i as u32);
            // Every bit of an axis is that of the corner.
            let all = (0..11).map(|bit| 1 << (3 * bit)).sum::<u64>();
            let expected = (0..3).filter(|axis| i >> axis & 1 == 1).map(|axis| all << axis).sum::<u64>();
            assert_eq!(key >> INDEX_BITS, expected, "{i}");
        }
        assert!(keys.is_sorted());
        assert_eq!(super::keys(&triangles[..1]), [0]);
        assert!(super::keys(&[]).is_empty());
    }
}
