//! A ray as the vectors take it.

use crate::PreparedRay;
use crate::aabb::{PAD_ENTRY, PAD_EXIT};
use glam::Vec4;

/// The pads of [`crate::aabb`] and a little more, for they are put into the inverse and not into the product: four roundings
/// more, of 2^-24 each. So a box is entered no later and left no earlier than by the scalar test, and no triangle behind one is lost.
pub(super) const NEAR: f32 = PAD_ENTRY - MORE;
pub(super) const FAR: f32 = PAD_EXIT + MORE;
/// 2^-21.
const MORE: f32 = f32::from_bits((127 - 21) << 23);

/// A ray with what the box test wants, and as the triangle test takes it.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(in super::super) struct WalkRay {
    pub(super) slabs: Slabs,
    pub(super) prepared: PreparedRay,
}

impl WalkRay {
    #[inline(always)]
    pub(super) fn new(ray: &PreparedRay) -> Self {
        Self { slabs: Slabs::new(ray), prepared: *ray }
    }
}

/// The box test's constants: which rows of a node are near and far, and the origins and inverses that belong to them. Fourth lanes
/// mean nothing.
///
/// Near and far follow from the signs of the inverses, so that the test needs no minimum and maximum of each pair.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(in super::super) struct Slabs {
    pub(super) near: [f32; 4],
    pub(super) far: [f32; 4],
    pub(super) near_inverse: [f32; 4],
    pub(super) far_inverse: [f32; 4],
    /// **Invariant**: one of [`OCTANTS`].
    pub(super) octant: Octant,
    pub(super) t_min: f32,
}

impl Slabs {
    /// Of no ray.
    pub(super) const NONE: Self = Self {
        near: [0.0; 4],
        far: [0.0; 4],
        near_inverse: [0.0; 4],
        far_inverse: [0.0; 4],
        octant: OCTANTS[0],
        t_min: 0.0,
    };

    #[inline(always)]
    pub(in super::super) fn new(ray: &PreparedRay) -> Self {
        let backwards = ray.inverse.cmplt(Vec4::ZERO);
        Self {
            near: Vec4::select(backwards, ray.origin_high, ray.origin_low).to_array(),
            far: Vec4::select(backwards, ray.origin_low, ray.origin_high).to_array(),
            near_inverse: (ray.inverse * NEAR).to_array(),
            far_inverse: (ray.inverse * FAR).to_array(),
            octant: OCTANTS[backwards.bitmask() as usize % 8],
            t_min: ray.t_min,
        }
    }
}

/// Where a node has what rays of an octant of directions want.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(in super::super) struct Octant {
    /// The first bytes of the near rows of [`super::super::node::PackedNode`].
    pub(super) near_rows: [u32; 3],
    /// Where in the words of its order the octant stands.
    pub(super) shift: u32,
    /// The first bytes of the far rows.
    pub(super) far_rows: [u32; 3],
    _unused: u32,
}

/// By the signs of the inverses, x in the lowest bit.
pub(super) static OCTANTS: [Octant; 8] = octants();

const fn octants() -> [Octant; 8] {
    const ROW: u32 = 32;
    let none = Octant { near_rows: [0; 3], shift: 0, far_rows: [0; 3], _unused: 0 };
    let mut octants = [none; 8];
    let mut octant = 0;
    while octant < 8 {
        octants[octant].shift = 3 * octant as u32;
        let mut axis = 0;
        while axis < 3 {
            let (low, high) = (ROW * axis as u32, ROW * (axis as u32 + 3));
            let backwards = octant >> axis & 1 != 0;
            octants[octant].near_rows[axis] = if backwards { high } else { low };
            octants[octant].far_rows[axis] = if backwards { low } else { high };
            axis += 1;
        }
        octant += 1;
    }
    octants
}
