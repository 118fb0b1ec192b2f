//! From where a scene is seen, and by what it is lit.

use glam::{DVec3, Vec3};
use ropewalk::Ray;

/// A pinhole camera with a square picture, and a point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    eye: Vec3,
    /// To the upper left corner of the picture.
    corner: DVec3,
    /// The whole width.
    right: DVec3,
    /// The whole height.
    down: DVec3,
    light: Vec3,
}

impl Sight {
    /// From `eye` along `forward`; `vertical_fov` is the angle between the picture's lower and upper edge, in radians. `None` where
    /// the numbers are none, `forward` is no direction, or the angle is not between 0 and 3.1.
    #[must_use]
    pub fn new(eye: Vec3, forward: Vec3, up: Vec3, vertical_fov: f32, light: Vec3) -> Option<Self> {
        if !eye.is_finite() || !light.is_finite() || !(1e-4..=3.1).contains(&vertical_fov) {
            return None;
        }
        let ahead = forward.as_dvec3().try_normalize()?;
        let aside = ahead.cross(up.as_dvec3().normalize_or_zero());
        // Looking straight along "up": any side will do.
        let aside =
            if aside.length_squared() > 1e-12 { aside.normalize() } else { ahead.any_orthonormal_vector() };
        let half = (f64::from(vertical_fov) * 0.5).tan();
        let (right, down) = (aside * (2.0 * half), ahead.cross(aside) * (2.0 * half));
        Some(Self { eye, corner: ahead - (right + down) * 0.5, right, down, light })
    }

    /// Where the light is.
    #[must_use]
    pub fn light(&self) -> Vec3 {
        self.light
    }

    /// The rays of a picture so many pixels wide and high, row by row, each through the middle of its pixel.
    #[must_use]
    pub fn picture(&self, side: usize) -> Vec<Ray> {
        let place = |index: usize| (index as f64 + 0.5) / side as f64;
        let ray = |pixel: usize| {
            let dir = self.corner + self.right * place(pixel % side) + self.down * place(pixel / side);
            Ray::new(self.eye, dir.as_vec3())
        };
        (0..side * side).map(ray).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    #[test]
    fn the_picture_is_upright() {
        let sight = Sight::new(Vec3::ONE, Vec3::NEG_Y * 3.0, Vec3::Z, FRAC_PI_2, Vec3::ZERO).unwrap();
        let rays = sight.picture(3);
        assert_eq!(rays.len(), 9);
        assert!(rays.iter().all(|ray| ray.origin == Vec3::ONE && ray.is_valid()));
        assert!(rays[4].dir.distance(Vec3::NEG_Y) < 1e-6);
        // The first pixel is at the upper left; whoever looks along -y has x on the left.
        assert!(rays[0].dir.distance(Vec3::new(2.0 / 3.0, -1.0, 2.0 / 3.0)) < 1e-6, "{}", rays[0].dir);
        assert_eq!(sight.light(), Vec3::ZERO);
    }

    #[test]
    fn numbers_that_make_no_camera_are_refused() {
        let sight = |eye, forward, fov| Sight::new(eye, forward, Vec3::Y, fov, Vec3::ZERO);
        assert!(sight(Vec3::ZERO, Vec3::Y, 1.0).is_some_and(|it| it.picture(2).iter().all(Ray::is_valid)));
        assert!(sight(Vec3::NAN, Vec3::Y, 1.0).is_none());
        assert!(sight(Vec3::ZERO, Vec3::ZERO, 1.0).is_none());
        for fov in [0.0, -1.0, 3.2, f32::NAN] {
            assert!(sight(Vec3::ZERO, Vec3::X, fov).is_none());
        }
    }
}
