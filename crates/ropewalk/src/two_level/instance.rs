//! An object in its place.

use super::ObjectStructure;
use crate::aabb::{Interval, larger, slab_span, smaller};
use crate::{
    Aabb, FlatTriangle, LARGEST_DIRECTION, PreparedRay, Ray, SMALLEST_DIRECTION, Transform, TransformError,
};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// An instance as walks have it: 24 little-endian words, the same on the CPU and in a GPU buffer.
///
/// The map leads from the scene to the frame of the object: `x * axis_x + y * axis_y + z * axis_z + origin`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Placed {
    /// The image of the scene's x axis.
    pub axis_x: [f32; 3],
    /// The object.
    pub object: u32,
    /// The image of the scene's y axis.
    pub axis_y: [f32; 3],
    /// The instance's index in the low 24 bits, its mask in the top 8, as [`FlatTriangle::instance_and_mask`] has them.
    pub instance_and_mask: u32,
    /// The image of the scene's z axis.
    pub axis_z: [f32; 3],
    /// Zero.
    pub reserved_0: u32,
    /// The image of the scene's origin.
    pub origin: [f32; 3],
    /// Zero.
    pub reserved_1: u32,
    /// The smallest corner of the box in the scene.
    pub min: [f32; 3],
    /// Zero.
    pub reserved_2: u32,
    /// The largest corner of the box in the scene.
    pub max: [f32; 3],
    /// Zero.
    pub reserved_3: u32,
}

/// `2^64`: what a direction is scaled by where its image is too short for a ray, and its inverse where it is too long.
pub const DIRECTION_STEP: f32 = f32::from_bits((127 + 64) << 23);

/// A ray in the frame of an object.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalRay {
    pub(crate) ray: PreparedRay,
    /// A `t` there, times this, is the same `t` in the scene: 1, but where the direction's image would be too long or too
    /// short for a ray. A power of two, so nothing is rounded.
    pub(crate) scale: f32,
}

impl Placed {
    /// Places an object. It must not be empty.
    ///
    /// # Errors
    /// When the transform shrinks or magnifies so much that no ray could be taken to the object's frame.
    pub fn new(
        instance: u32,
        object: u32,
        mask: u32,
        transform: &Transform,
        structure: &ObjectStructure,
    ) -> Result<Self, TransformError> {
        Self::of_map(instance, object, mask, structure.local(transform), &structure.world_bounds(transform))
    }

    /// Of the map from the scene to the object's frame, and the box in the scene.
    pub(crate) fn of_map(
        instance: u32,
        object: u32,
        mask: u32,
        [x, y, z, origin]: [Vec3; 4],
        world: &Aabb,
    ) -> Result<Self, TransformError> {
        let size = x.abs().max(y.abs()).max(z.abs()).max_element();
        let is_usual = (SMALLEST_DIRECTION..=LARGEST_DIRECTION).contains(&size)
            && origin.is_finite()
            && world.min.is_finite()
            && world.max.is_finite();
        if !is_usual {
            return Err(TransformError::OutOfRange);
        }
        Ok(Self {
            axis_x: x.into(),
            object,
            axis_y: y.into(),
            instance_and_mask: instance & (FlatTriangle::INSTANCE_LIMIT as u32 - 1) | mask << 24,
            axis_z: z.into(),
            reserved_0: 0,
            origin: origin.into(),
            reserved_1: 0,
            min: world.min.into(),
            reserved_2: 0,
            max: world.max.into(),
            reserved_3: 0,
        })
    }

    /// The instance's index within the scene.
    #[must_use]
    pub const fn instance(&self) -> u32 {
        self.instance_and_mask & (FlatTriangle::INSTANCE_LIMIT as u32 - 1)
    }

    /// The box in the scene.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::new(self.min.into(), self.max.into())
    }

    /// Where a ray of the scene is in the box, or `None` where it is not, or does not see the instance.
    #[inline(always)]
    pub(crate) fn span(&self, ray: &PreparedRay) -> Option<Interval> {
        if self.instance_and_mask & ray.mask == 0 {
            return None;
        }
        let bounds = self.bounds();
        let span = slab_span(ray, bounds.min.extend(1.0), bounds.max.extend(1.0));
        let entry = larger(span.entry, ray.t_min);
        (entry <= smaller(span.exit, ray.t_max)).then_some(Interval { entry, exit: span.exit })
    }

    /// The ray in the object's frame. Its direction is not renormalised, so `t` means the same there. `None` where all of the
    /// direction is lost to rounding.
    #[inline(always)]
    pub(crate) fn local(&self, ray: &Ray) -> Option<LocalRay> {
        let [x, y, z, origin] = [self.axis_x, self.axis_y, self.axis_z, self.origin].map(Vec3::from);
        let map = |v: Vec3| x * v.x + y * v.y + z * v.z;
        let mut local = Ray { origin: map(ray.origin) + origin, dir: map(ray.dir), mask: Ray::ALL, ..*ray };
        let size = local.dir.abs().max_element();
        let mut scale = 1.0;
        if !(SMALLEST_DIRECTION..=LARGEST_DIRECTION).contains(&size) {
            scale = if size < 1.0 { DIRECTION_STEP } else { 1.0 / DIRECTION_STEP };
            local.dir *= scale;
            local.t_min /= scale;
            local.t_max /= scale;
        }
        PreparedRay::new(&local).map(|ray| LocalRay { ray, scale })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_placed_object_is_96_bytes() {
        assert_eq!(size_of::<Placed>(), 96);
    }
}
