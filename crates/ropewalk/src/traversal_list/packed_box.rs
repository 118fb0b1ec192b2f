//! Boxes in 128 bits, the room that an element has for a sphere: six planes of 21 bits each.
//!
//! The planes lie on a grid over the box of everything ([`Grid`]), 2^21 steps along each axis at most, and a step is a power
//! of two. So a plane's distance from the grid's corner is exact, its place is rounded once, the same on every device, and
//! a box is rounded outwards by no more than a step: half a millionth of the scene.

use crate::Aabb;
use glam::{Vec3, Vec4};

/// Bits a plane.
const BITS: u32 = 21;
const MASK: u32 = (1 << BITS) - 1;
/// Steps that a scene is divided into at most. Two less than there are numbers, so that rounding outwards stays within.
const STEPS: f32 = (MASK - 2) as f32;

/// The grid on which the planes of all boxes of a structure lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// The corner at which it begins. The fourth lane means nothing.
    pub origin: Vec4,
    /// The length of a step along each axis: powers of two. The fourth lane means nothing.
    pub step: Vec4,
}

impl Grid {
    /// The grid over a box.
    #[must_use]
    pub fn over(bounds: &Aabb) -> Self {
        let bounds = if bounds.is_empty() { Aabb::new(Vec3::ZERO, Vec3::ZERO) } else { *bounds };
        // The smallest power of two that is large enough; where the box is flat, any.
        let step = |size: f32| match size / STEPS {
            step if step < f32::MIN_POSITIVE => f32::MIN_POSITIVE,
            step => f32::from_bits(((step.to_bits() >> 23) + 1) << 23),
        };
        Self {
            origin: bounds.min.extend(1.0),
            step: Vec3::from_array(bounds.size().to_array().map(step)).extend(1.0),
        }
    }

    #[inline(always)]
    fn plane(&self, axis: usize, steps: u32) -> f32 {
        self.origin[axis] + steps as f32 * self.step[axis]
    }

    /// The last plane that is not above `place`, which must lie within the grid.
    fn below(&self, axis: usize, place: f32) -> u32 {
        let mut steps = (((place - self.origin[axis]) / self.step[axis]) as u32).min(MASK);
        while steps > 0 && self.plane(axis, steps) > place {
            steps -= 1;
        }
        steps
    }

    /// The first plane that is not below `place`, which must lie within the grid.
    fn above(&self, axis: usize, place: f32) -> u32 {
        let mut steps = self.below(axis, place);
        while steps < MASK && self.plane(axis, steps) < place {
            steps += 1;
        }
        steps
    }

    /// A box that contains this one.
    #[must_use]
    pub fn pack(&self, bounds: &Aabb) -> PackedBox {
        let mut bits = 0u128;
        for axis in 0..3 {
            let (low, high) = (self.below(axis, bounds.min[axis]), self.above(axis, bounds.max[axis]));
            bits |= u128::from(low) << (BITS * axis as u32) | u128::from(high) << (BITS * (axis as u32 + 3));
        }
        PackedBox { words: [0, 32, 64, 96].map(|shift| (bits >> shift) as u32) }
    }
}

/// A box of six planes of a [`Grid`]: the three lower ones, then the three upper ones, from the lowest bit on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PackedBox {
    /// The words, the lowest first.
    pub words: [u32; 4],
}

impl PackedBox {
    /// Its corners. The fourth lanes are those of the grid.
    #[inline(always)]
    #[must_use]
    pub fn corners(&self, grid: &Grid) -> [Vec4; 2] {
        let [a, b, c, d] = self.words;
        let steps = |x: u32, y: u32, z: u32| {
            let steps = Vec4::new((x & MASK) as f32, (y & MASK) as f32, (z & MASK) as f32, 0.0);
            grid.origin + steps * grid.step
        };
        [steps(a, a >> 21 | b << 11, b >> 10), steps(b >> 31 | c << 1, c >> 20 | d << 12, d >> 9)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_packed_box_contains_its_box_and_little_more() {
        let mut state = 3u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        for scale in [1e-30, 1e-3, 1.0, 1e9] {
            let low = Vec3::new(-3.0, 1.0, 1000.0) * scale;
            let size = Vec3::new(7.0, 0.001, 1.0) * scale;
            let everything = Aabb::new(low, low + size);
            let grid = Grid::over(&everything);
            for _ in 0..2000 {
                let mut point = || (low + size * Vec3::new(next(), next(), next())).min(low + size);
                let bounds = Aabb::of_points([point(), point()]);
                let [min, max] = grid.pack(&bounds).corners(&grid);
                assert!(min.truncate().cmple(bounds.min).all() && max.truncate().cmpge(bounds.max).all());
                // A step, and the float that a place is rounded to.
                let slack = grid.step.truncate() * 1.01 + low.abs() * 2.4e-7;
                assert!((bounds.min - min.truncate()).cmple(slack).all(), "{bounds:?} {min}");
                assert!((max.truncate() - bounds.max).cmple(slack).all(), "{bounds:?} {max}");
            }
            let [min, max] = grid.pack(&everything).corners(&grid);
            assert!(min.truncate() == low && max.truncate().cmpge(low + size).all());
        }
    }

    #[test]
    fn flat_scenes_have_a_grid() {
        for bounds in [Aabb::EMPTY, Aabb::new(Vec3::ONE, Vec3::ONE), Aabb::new(Vec3::ZERO, Vec3::X)] {
            let grid = Grid::over(&bounds);
            assert!(grid.step.cmpgt(Vec4::ZERO).all() && grid.origin.is_finite());
            if !bounds.is_empty() {
                let [min, max] = grid.pack(&bounds).corners(&grid);
                assert!(min.truncate().cmple(bounds.min).all() && max.truncate().cmpge(bounds.max).all());
            }
        }
    }
}
