//! The partition of a range at a plane, in place.
//!
//! No branch depends on where a reference goes: of two that are swapped each time, both may be the same (Lomuto's scheme).
//! On the way both sides' centres are measured, so that the next binning needs no pass of its own.

use super::bins::Side;
use super::lanes::Lanes;
use crate::bvh8::build::extent::Extent;
use crate::bvh8::build::reference::Reference;

/// Puts the references below the plane first; tells how many they are, and the boxes of both sides' doubled centres.
#[inline(always)]
pub(super) fn partition<L: Lanes>(
    lanes: L,
    references: &mut [Reference],
    side: Side,
) -> (usize, [Extent; 2]) {
    /// What takes a box out of a minimum, and what does not.
    const OUT: [f32; 2] = [f32::INFINITY, 0.0];
    let mut centers = [lanes.splat(f32::INFINITY); 2];
    let mut low = 0;
    for next in 0..references.len() {
        let below = usize::from(side.is_below(&references[next]));
        let reference = lanes.load(&references[next].0);
        let center = lanes.sub(reference, lanes.swap_halves(reference));
        centers[0] = lanes.min(centers[0], lanes.add(center, lanes.splat(OUT[below])));
        centers[1] = lanes.min(centers[1], lanes.add(center, lanes.splat(OUT[1 - below])));
        // `low` is never beyond `next`.
        let Some(place) = references.get_mut(low) else { break };
        let other = lanes.load(&place.0);
        lanes.store(reference, &mut place.0);
        lanes.store(other, &mut references[next].0);
        low += below;
    }
    let extents = centers.map(|center| {
        let mut extent = Extent::EMPTY;
        lanes.store(center, &mut extent.0);
        extent
    });
    (low, extents)
}
