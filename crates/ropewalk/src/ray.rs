//! Rays: what a caller asks with, and what a walk needs ready for every box and triangle.
//!
//! A [`Ray`] keeps the caller's own parameter: `t` counts in units of `dir`, which may have any length but
//! zero and is never renormalised, so a hit of an instance needs no conversion.
//!
//! A [`PreparedRay`] holds the constants of two tests that run millions of times: the padded slab test
//! ([`crate::aabb`]) and the watertight triangle test ([`crate::triangle`]). It is 96 bytes and is made once a
//! ray. The GPU's twin is `prepare_ray` in `shared/ray.wgsl`: same operations, same order, same bits.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

/// A half-line with a window `[t_min, t_max]`, closed at both ends.
///
/// Nine little-endian words, the same on the CPU, in a GPU buffer and in a file.
///
/// ```
/// use ropewalk::Ray;
/// use ropewalk::glam::Vec3;
/// let ray = Ray::new(Vec3::ZERO, Vec3::Z).window(0.5, 100.0);
/// assert!(ray.is_valid());
/// assert!(!Ray::new(Vec3::ZERO, Vec3::ZERO).is_valid());
/// ```
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Ray {
    /// Where the ray starts.
    pub origin: Vec3,
    /// The smallest `t` that counts as a hit; at least 0.
    pub t_min: f32,
    /// The direction; any length but zero. A hit point is `origin + t * dir`.
    pub dir: Vec3,
    /// The largest `t` that counts as a hit; may be infinite.
    pub t_max: f32,
    /// An instance is seen only when `mask & instance.mask` has a bit. The low 8 bits count.
    pub mask: u32,
}

impl Ray {
    /// The mask that sees every instance.
    pub const ALL: u32 = 0xff;

    /// A ray over all `t >= 0` that sees every instance.
    #[inline]
    #[must_use]
    pub const fn new(origin: Vec3, dir: Vec3) -> Self {
        Self { origin, t_min: 0.0, dir, t_max: f32::INFINITY, mask: Self::ALL }
    }

    /// The same ray with another window.
    #[inline]
    #[must_use]
    pub const fn window(self, t_min: f32, t_max: f32) -> Self {
        Self { t_min, t_max, ..self }
    }

    /// The same ray with another mask.
    #[inline]
    #[must_use]
    pub const fn with_mask(self, mask: u32) -> Self {
        Self { mask, ..self }
    }

    /// The point at `t`.
    #[inline]
    #[must_use]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.dir * t
    }

    /// Whether the ray can be traced: a finite origin, a finite direction whose largest component lies in
    /// `[2^-60, 2^60]`, `t_min >= 0`, and no NaN in the window. `t_min > t_max` is valid and hits nothing.
    ///
    /// A ray that is not valid is answered with a miss and
    /// [`Status::INVALID_RAY`](crate::Status::INVALID_RAY).
    #[inline]
    #[must_use]
    pub fn is_valid(&self) -> bool {
        // One comparison of three lanes also refuses NaN, which the maximum behind it might overlook.
        let [origin, dir] = self.lanes();
        let size = dir.abs();
        let (near, short) =
            (origin.abs().cmple(Vec4::splat(f32::MAX)), size.cmple(Vec4::splat(LARGEST_DIRECTION)));
        near.bitmask() & short.bitmask() & 0b111 == 0b111
            && size.truncate().max_element() >= SMALLEST_DIRECTION
            && self.t_min >= 0.0
            && !self.t_max.is_nan()
    }

    /// The origin and `t_min`, the direction and `t_max`: as they lie in memory.
    #[inline(always)]
    fn lanes(&self) -> [Vec4; 2] {
        let numbers: &[f32; 9] = bytemuck::cast_ref(self);
        [Vec4::from_slice(&numbers[..4]), Vec4::from_slice(&numbers[4..8])]
    }
}

/// The smallest magnitude, `2^-60`, that the largest component of a direction may have.
pub const SMALLEST_DIRECTION: f32 = f32::from_bits((127 - 60) << 23);
/// The largest magnitude, `2^60`, that the largest component of a direction may have.
pub const LARGEST_DIRECTION: f32 = f32::from_bits((127 + 60) << 23);
/// A component below `2^-64` of the largest one runs parallel to its slab, for the box test.
pub const PARALLEL: f32 = f32::from_bits((127 - 64) << 23);
/// `2^86`: over the largest component, this is the inverse of a parallel axis...
pub const PARALLEL_INVERSE: f32 = f32::from_bits((127 + 86) << 23);
/// ... but at most `2^126`, so that it is finite.
pub const LARGEST_INVERSE: f32 = f32::from_bits((127 + 126) << 23);
/// `2^-45`, the least step outwards along a parallel axis: times the inverse it is `2^41`, which is twice the
/// largest coordinate, over the largest component of the direction.
pub const LEAST_OUTWARDS: f32 = f32::from_bits((127 - 45) << 23);
/// `2^-85`: over the largest component, the same for short directions, of which the inverse is cut off.
pub const LEAST_OUTWARDS_SHORT: f32 = f32::from_bits((127 - 85) << 23);

/// A [`Ray`] with everything worked out that its box and triangle tests share.
///
/// **Slabs.** With `inverse = 1 / dir`, the ray meets the planes of a slab at `(min - origin_low) * inverse`
/// and `(max - origin_high) * inverse`. Both origins are the ray's own, except on an axis along which the ray
/// is parallel to the slab (a component below `2^-64` of the largest one). There `inverse` is a large finite
/// number, and the two origins are the ray's moved outwards, so that a ray that runs exactly in a face lies inside
/// the slab. The step outwards is one float, but at least so long that its product with `inverse` exceeds every
/// `t` at which geometry can be (a float near zero is too short for that: a face at 0 would be lost). Within
/// [`Scene::LARGEST_COORDINATE`](crate::Scene::LARGEST_COORDINATE) and for directions of usual length no infinity
/// and no NaN takes part, which WGSL would not define.
///
/// **Triangles.** The direction's largest component becomes the axis `kz`; `kx` and `ky` follow it cyclically,
/// so that the permutation keeps the orientation and [`PreparedRay::forward`] tells whether the shear mirrors it.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct PreparedRay {
    /// The origin for planes of the lower side. The fourth lanes of these three are 1: a node's fourth lanes are
    /// its link and count, subnormal as numbers, and a product with a subnormal number takes long.
    pub origin_low: Vec4,
    /// The origin for planes of the upper side.
    pub origin_high: Vec4,
    /// One over the direction, finite.
    pub inverse: Vec4,
    /// The origin, for the triangle test.
    pub origin: [f32; 3],
    /// The lower end of the window.
    pub t_min: f32,
    /// `dir[kx] / dir[kz]`, `dir[ky] / dir[kz]`, `1 / dir[kz]`.
    pub shear: [f32; 3],
    /// The upper end of the window, finite.
    pub t_max: f32,
    /// The axes `kx`, `ky`, `kz` of the shear.
    pub axes: [u8; 3],
    /// Whether `dir[kz]` is positive.
    pub forward: bool,
    /// The ray's mask, in the top 8 bits, as [`crate::triangle::FlatTriangle`] keeps that of its instance.
    pub mask: u32,
}

/// The two axes that follow each, cyclically.
static FOLLOWING: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

impl PreparedRay {
    /// Prepares a ray, or `None` when it is not [valid](Ray::is_valid).
    ///
    /// Vectors throughout, no branch but the rare one, and inlined, so that the lanes stay in registers: a ray that
    /// meets little takes most of its time here.
    #[inline(always)]
    #[must_use]
    pub fn new(ray: &Ray) -> Option<Self> {
        if !ray.is_valid() {
            return None;
        }
        let size = ray.dir.abs();
        let (larger_of_two, of_two) = if size.y > size.x { (size.y, 1) } else { (size.x, 0) };
        let (largest, kz) = if size.z > larger_of_two { (size.z, 2) } else { (larger_of_two, of_two) };
        let [kx, ky] = FOLLOWING[kz];
        // From where the ray lies: choosing among registers would take branches that nobody can foresee.
        let numbers: &[f32; 9] = bytemuck::cast_ref(ray);
        let [along_x, along_y, along_z] =
            [numbers[4 + (kx & 3)], numbers[4 + (ky & 3)], numbers[4 + (kz & 3)]];
        let [origin, dir] = ray.lanes();
        let (origin, dir) = (origin.with_w(1.0), dir.with_w(1.0));
        let mut slabs = Slabs { low: origin, high: origin, inverse: Vec4::ONE / dir };
        if size.min_element() <= largest * PARALLEL {
            slabs.widen(ray, largest);
        }
        Some(Self {
            origin_low: slabs.low,
            origin_high: slabs.high,
            inverse: slabs.inverse,
            origin: ray.origin.to_array(),
            t_min: ray.t_min,
            shear: [along_x / along_z, along_y / along_z, 1.0 / along_z],
            // Infinity is the t of a miss, so no hit may have it.
            t_max: ray.t_max.min(f32::MAX),
            axes: [kx as u8, ky as u8, kz as u8],
            forward: along_z > 0.0,
            mask: ray.mask << 24,
        })
    }
}

impl PreparedRay {
    /// Along which axes the ray runs backwards. Not along one to which it is parallel for the slab test.
    #[inline(always)]
    #[must_use]
    pub fn negative(&self) -> [bool; 3] {
        [self.inverse.x < 0.0, self.inverse.y < 0.0, self.inverse.z < 0.0]
    }
}

/// What the slab test takes of a ray.
struct Slabs {
    low: Vec4,
    high: Vec4,
    inverse: Vec4,
}

impl Slabs {
    /// Moves the origins outwards along the axes to which the ray is parallel.
    #[cold]
    fn widen(&mut self, ray: &Ray, largest: f32) {
        let parallel_inverse = (PARALLEL_INVERSE / largest).min(LARGEST_INVERSE);
        let outwards = (LEAST_OUTWARDS_SHORT / largest).max(LEAST_OUTWARDS);
        for axis in 0..3 {
            if ray.dir[axis].abs() <= largest * PARALLEL {
                let origin = ray.origin[axis];
                self.inverse[axis] = parallel_inverse;
                self.low[axis] = (origin + outwards).max(origin.next_up());
                self.high[axis] = (origin - outwards).min(origin.next_down());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_is_nine_words() {
        assert_eq!(size_of::<Ray>(), 36);
        assert_eq!(size_of::<PreparedRay>(), 96);
    }

    #[test]
    fn bad_rays_are_not_prepared() {
        let good = Ray::new(Vec3::ZERO, Vec3::X);
        assert!(PreparedRay::new(&good).is_some());
        for bad in [
            Ray { dir: Vec3::ZERO, ..good },
            Ray { dir: Vec3::new(f32::NAN, 1.0, 0.0), ..good },
            Ray { dir: Vec3::new(f32::INFINITY, 1.0, 0.0), ..good },
            Ray { dir: Vec3::new(1e-30, 0.0, 0.0), ..good },
            Ray { origin: Vec3::new(0.0, f32::NAN, 0.0), ..good },
            Ray { t_min: -1.0, ..good },
            Ray { t_min: f32::NAN, ..good },
            Ray { t_max: f32::NAN, ..good },
        ] {
            assert!(PreparedRay::new(&bad).is_none(), "{bad:?}");
        }
        assert!(good.window(2.0, 1.0).is_valid(), "an empty window is a question with the answer no");
    }

    #[test]
    fn a_parallel_axis_has_a_finite_inverse() {
        let prepared = PreparedRay::new(&Ray::new(Vec3::ONE, Vec3::new(0.0, -0.0, -2.0))).unwrap();
        assert!(prepared.inverse.is_finite());
        assert!(prepared.origin_low.x > 1.0 && prepared.origin_high.x < 1.0);
        assert_eq!(prepared.origin_low.z, 1.0);
        assert_eq!(prepared.axes, [0, 1, 2]);
        assert!(!prepared.forward);
    }
}
