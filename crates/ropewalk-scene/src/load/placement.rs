//! From the f64 coordinates of a file to the f32 of a scene: as they are, or relative to an origin near the mesh.
//!
//! A f32 has 24 bits. Where a mesh lies 64 times its extent away from zero, six of them are spent on where it is, and
//! its vertices snap to a grid of 2⁻¹⁷ of its extent, which shadows and normals of small parts begin to show. From
//! there on, f64 are stored relative to an origin. Nearer, that would gain too little to be worth an origin that every
//! user must add.

use glam::{DVec3, Vec3};

/// The largest coordinate, in extents, that is stored as it is.
const FARTHEST: f64 = 64.0;

/// Where a file's coordinates end up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placement {
    /// Becomes [`ropewalk::Scene::origin`].
    pub(crate) origin: DVec3,
}

impl Placement {
    /// The placement of a mesh of these vertices. Those that are not finite have no say.
    pub(crate) fn of(vertices: impl Iterator<Item = DVec3>) -> Self {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (min, max) = vertices
            .filter(|vertex| vertex.is_finite())
            .fold(empty, |(min, max), vertex| (min.min(vertex), max.max(vertex)));
        let (largest, extent) = (min.abs().max(max.abs()).max_element(), (max - min).max_element());
        // A point has no extent to lose; without any vertex the extent is not finite.
        if !(extent > 0.0 && extent.is_finite() && largest > FARTHEST * extent) {
            return Self { origin: DVec3::ZERO };
        }
        // The middle, rounded so that it has few digits: they are shown to people, and short decimals stay short.
        let step = extent.log2().floor().exp2();
        let origin = ((min + (max - min) / 2.0) / step).round() * step;
        Self { origin: if origin.is_finite() { origin } else { DVec3::ZERO } }
    }

    /// A vertex in the scene. With an origin of zero it is the nearest f32, bit for bit.
    pub(crate) fn place(&self, vertex: DVec3) -> Vec3 {
        (vertex - self.origin).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_meshes_stay_bit_for_bit() {
        let vertices =
            [DVec3::splat(-3.3), DVec3::new(63.7, 0.1, -0.0), DVec3::splat(f64::NAN), DVec3::INFINITY];
        let placement = Placement::of(vertices.into_iter());
        assert_eq!(placement.origin, DVec3::ZERO);
        let placed = placement.place(vertices[1]);
        assert_eq!(placed.to_array().map(f32::to_bits), [63.7f32, 0.1, -0.0].map(f32::to_bits));
        assert_eq!(Placement::of(std::iter::empty()).origin, DVec3::ZERO);
    }

    #[test]
    fn far_meshes_move() {
        let far = DVec3::new(4_000_000.0, -500_000.0, 12.0);
        let vertices = [far, far + DVec3::new(0.5, 0.25, 0.001), far + DVec3::new(0.0, 0.0, 0.003)];
        let placement = Placement::of(vertices.into_iter());
        assert_eq!(placement.origin, DVec3::new(4_000_000.5, -500_000.0, 12.0));
        assert_eq!(placement.place(vertices[1]), Vec3::new(0.0, 0.25, 0.001));
    }

    #[test]
    fn the_farthest_that_stays_is_64_extents() {
        let pair = |at: f64| [DVec3::X * (at - 1.0), DVec3::X * at].into_iter();
        assert_eq!(Placement::of(pair(64.0)).origin, DVec3::ZERO);
        assert_eq!(Placement::of(pair(65.0)).origin, DVec3::new(65.0, 0.0, 0.0));
    }

    #[test]
    fn points_and_giants_stay() {
        for vertices in [[DVec3::splat(1e6); 2], [DVec3::MIN, DVec3::MAX]] {
            assert_eq!(Placement::of(vertices.into_iter()).origin, DVec3::ZERO);
        }
        let tiny = [DVec3::ONE, DVec3::ONE + f64::EPSILON];
        assert!(Placement::of(tiny.into_iter()).origin.is_finite());
    }
}
