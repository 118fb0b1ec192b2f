//! A pinhole camera, just enough to make primary rays.

use glam::{DVec3, Vec3};
use ropewalk::{Aabb, Ray};

/// A pinhole camera with a square picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    eye: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
}

impl View {
    /// From `eye` at `target`; the picture is `2 * half_width` wide at distance 1. Looking at oneself looks
    /// along -z.
    #[must_use]
    pub fn look_at(eye: Vec3, target: Vec3, half_width: f64) -> Self {
        let eye = eye.as_dvec3();
        let forward = (target.as_dvec3() - eye).try_normalize().unwrap_or(DVec3::NEG_Z);
        let upright = if forward.y.abs() > 0.99 { DVec3::Z } else { DVec3::Y };
        let right = forward.cross(upright).normalize();
        Self { eye, forward, right: right * half_width, up: right.cross(forward) * half_width }
    }

    /// The whole of a box, from outside, from the front above.
    #[must_use]
    pub fn of_bounds(bounds: &Aabb) -> Self {
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let (center, diagonal) = ((low + high) * 0.5, (high - low).length());
        let eye = center + DVec3::new(0.48, 0.36, 0.8) * diagonal * 1.1;
        Self::look_at(eye.as_vec3(), center.as_vec3(), 0.5)
    }

    /// Where the camera is.
    #[must_use]
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The directions at the upper left of the picture, and from there to its right and down: a ray at `x`, `y` of the
    /// picture, both 0 to 1, goes along the first and so many of the others.
    #[must_use]
    pub fn picture(&self) -> [Vec3; 3] {
        [self.forward - self.right + self.up, self.right * 2.0, self.up * -2.0].map(DVec3::as_vec3)
    }

    /// The first `count` rays, row by row, of the smallest square picture that has as many pixels.
    #[must_use]
    pub fn rays(&self, count: usize) -> Vec<Ray> {
        let width = (1..).find(|width: &usize| width.saturating_mul(*width) >= count).unwrap_or(1);
        let place = |pixel: usize| (pixel as f64 + 0.5) / width as f64 * 2.0 - 1.0;
        let pixels = (0..count).map(|index| (place(index % width), place(index / width)));
        pixels
            .map(|(x, y)| {
                let dir = (self.forward + self.right * x - self.up * y).normalize();
                Ray::new(self.eye.as_vec3(), dir.as_vec3())
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_pixel_looks_at_the_target() {
        let view = View::look_at(Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 2.0, -9.0), 1.0);
        let rays = view.rays(9);
        assert_eq!(rays.len(), 9);
        assert_eq!((rays[4].origin, rays[4].dir), (Vec3::new(1.0, 2.0, 3.0), Vec3::NEG_Z));
        assert!(rays[0].dir.x < 0.0 && rays[0].dir.y > 0.0, "the first pixel is at the upper left");
        let [corner, right, down] = view.picture();
        let middle = (corner + right * 0.5 + down * 0.5).normalize();
        assert!((middle - Vec3::NEG_Z).length() < 1e-6 && corner.x < 0.0 && corner.y > 0.0);
        assert!(View::look_at(Vec3::ZERO, Vec3::Y, 1.0).rays(1)[0].is_valid());
        assert!(View::look_at(Vec3::ONE, Vec3::ONE, 1.0).rays(1)[0].is_valid());
    }
}
