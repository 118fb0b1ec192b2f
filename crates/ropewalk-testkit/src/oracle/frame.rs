//! A ray in f64, prepared for many triangles, and the quick rejection of what it plainly misses.

use super::Corners;
use glam::DVec3;
use ropewalk::Ray;

/// One half unit in the last place of a f32, relative: the most that one correctly rounded operation errs.
const HALF_ULP: f64 = 1.0 / 16_777_216.0;
/// The smallest normal f32: what a device that flushes denormals may lose.
pub(super) const FLUSHED: f64 = f32::MIN_POSITIVE as f64;

/// By how much the contract pads both ends of a ray's stay in a box, relative: see [`ropewalk::aabb`].
const PADDING: f64 = ropewalk::aabb::PAD_EXIT as f64 - 1.0;
/// Below this share of its largest component a ray counts as parallel to a slab: 2^-64.
const PARALLEL: f64 = 1.0 / ((1u128 << 64) as f64);

/// How far outside of a parallel slab a ray may run and count as inside: 2^-45.
const OUTWARDS: f64 = 1.0 / ((1u64 << 45) as f64);
/// The same for short directions, times the length: 2^-85.
const OUTWARDS_SHORT: f64 = 1.0 / ((1u128 << 85) as f64);

/// The space in which the ray is the z axis, as [`ropewalk::triangle`] uses it, in f64.
#[derive(Clone, Debug)]
pub(super) struct RayFrame {
    pub(super) origin: DVec3,
    pub(super) dir: DVec3,
    pub(super) window: (f64, f64),
    pub(super) axes: [usize; 3],
    pub(super) shear: DVec3,
    /// What one f32 operation may err, relative.
    pub(super) unit: f64,
    /// How far a vertex may lie from its place: 0 where neither it nor the ray was moved.
    pub(super) shift: f64,
    /// By how many times the radius of a triangle its box reaches out, where that is the box in another space: 0 where it is not.
    pub(super) spread: f64,
}

/// A vertex in that space, with how far the one in f32 may lie from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sheared {
    pub(super) x: f64,
    pub(super) y: f64,
    /// In units of `t`.
    pub(super) z: f64,
    pub(super) x_error: f64,
    pub(super) y_error: f64,
}

impl RayFrame {
    pub(super) fn new(ray: &Ray, rounding: f64) -> Option<Self> {
        if !ray.is_valid() {
            return None;
        }
        let dir = ray.dir.as_dvec3();
        let size = dir.abs();
        let kz = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
        Some(Self {
            origin: ray.origin.as_dvec3(),
            dir,
            window: (f64::from(ray.t_min), f64::from(ray.t_max)),
            axes: [kx, ky, kz],
            shear: DVec3::new(dir[kx] / dir[kz], dir[ky] / dir[kz], 1.0 / dir[kz]),
            // A little more than the unit covers the products of errors.
            unit: HALF_ULP * rounding * 1.001,
            shift: 0.0,
            spread: 0.0,
        })
    }

    /// Lets each vertex lie elsewhere by so many units of a length.
    pub(super) fn set_shift(&mut self, units: f64, length: f64) {
        self.shift = HALF_ULP * units * length;
    }

    /// What is around a triangle's box, in whatever space that is.
    pub(super) fn around(&self, corners: &Corners) -> (DVec3, DVec3) {
        let low = corners[0].min(corners[1]).min(corners[2]);
        let high = corners[0].max(corners[1]).max(corners[2]);
        if self.spread == 0.0 {
            return (low, high);
        }
        let center = (low + high) * 0.5;
        let radius = corners.iter().map(|corner| (*corner - center).length()).fold(0.0, f64::max);
        let reach = DVec3::splat(radius * self.spread);
        (low.min(center - reach), high.max(center + reach))
    }

    /// Whether the ray's line passes the triangle by more than any rounding of f32 could bridge.
    #[inline(always)]
    pub(super) fn surely_misses(&self, corners: &Corners) -> bool {
        let mut size = 0.0f64;
        let [a, b, c] = corners.map(|corner| {
            let moved = corner - self.origin;
            let (x, y, z) = (moved[self.axes[0]], moved[self.axes[1]], moved[self.axes[2]]);
            let (from_x, from_y) = (self.shear.x * z, self.shear.y * z);
            size = size.max((x.abs() + from_x.abs()).max(y.abs() + from_y.abs()));
            (x - from_x, y - from_y)
        });
        let u = c.0 * b.1 - c.1 * b.0;
        let v = a.0 * c.1 - a.1 * c.0;
        let w = b.0 * a.1 - b.1 * a.0;
        // An edge function sums two products of coordinates of at most `size`, each with an error of at most
        // 4 units of it: 2 * (2 * 4) + 2 * 2 = 20 units of size squared; 24 leaves room for products of errors.
        // Shifted vertices are shifted in both products, and the shear, at most 1, doubles that.
        let shifted = 16.0 * self.shift * (size + self.shift);
        let error = self.unit * 24.0 * size * size + shifted + self.flushed_product(size);
        u.max(v).max(w) > error && u.min(v).min(w) < -error
    }

    /// What flushing may take from a product with a factor of this size.
    #[inline(always)]
    pub(super) fn flushed_product(&self, size: f64) -> f64 {
        FLUSHED * 8.0 * (1.0 + size) * (1.0 + size * self.shear.z.abs())
    }

    pub(super) fn shear(&self, corner: DVec3) -> Sheared {
        let moved = corner - self.origin;
        let (x, y, z) = (moved[self.axes[0]], moved[self.axes[1]], moved[self.axes[2]]);
        let (from_x, from_y) = (self.shear.x * z, self.shear.y * z);
        // In f32: one rounding for `moved`, three for the product (the shear, the factor, the product itself),
        // one for the difference, which is at most the sum of both.
        let error = |moved: f64, from: f64| {
            self.unit * (2.0 * moved.abs() + 4.0 * from.abs())
                + 2.0 * self.shift
                + FLUSHED * (1.0 + z.abs() + (z * self.shear.z).abs())
        };
        Sheared {
            x: x - from_x,
            y: y - from_y,
            z: self.shear.z * z,
            x_error: error(x, from_x),
            y_error: error(y, from_y),
        }
    }

    /// Where the ray enters and leaves a triangle's box at the utmost: with the padding that the contract gives it,
    /// and what f32 errs. `None` when it misses even that.
    pub(super) fn span(&self, low: DVec3, high: DVec3) -> Option<(f64, f64)> {
        // The padding, and four roundings: a difference, one over the direction, two products.
        let slack = PADDING + 4.0 * self.unit;
        let (mut entry, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let (low, high) = (low[axis] - self.shift, high[axis] + self.shift);
            let origin = self.origin[axis];
            if self.is_parallel(axis) {
                // What lies a little outside counts as inside: see `ropewalk::PreparedRay`.
                let largest = self.dir.abs().max_element();
                let outwards = OUTWARDS.max(OUTWARDS_SHORT / largest) * 1.001;
                let slack = outwards.max(2.0 * self.unit * origin.abs());
                if origin < low - slack || origin > high + slack {
                    return None;
                }
            } else {
                let planes = [low, high].map(|plane| (plane - origin) / self.dir[axis]);
                entry = entry.max(planes[0].min(planes[1]));
                exit = exit.min(planes[0].max(planes[1]));
            }
        }
        let (entry, exit) = (entry - slack * entry.abs() - FLUSHED, exit + slack * exit.abs() + FLUSHED);
        (entry <= exit).then_some((entry, exit))
    }

    /// Whether the box test takes the ray for parallel to the slab of an axis.
    pub(super) fn is_parallel(&self, axis: usize) -> bool {
        let largest = self.dir.abs().max_element();
        self.dir[axis].abs() <= largest * PARALLEL
    }
}
