//! The pinhole camera: a picture plane at distance one, and a ray through each of its points.
//!
//! Directions are not normalised: their part along the view is exactly the plane's distance, 1, so that a hit's
//! `t` is its depth.

use crate::error::RenderError;
use glam::{Vec2, Vec3};
use ropewalk::traversal_list::Frustum;
use ropewalk::{Ray, Scene};
use ropewalk_scene::Camera;

/// A camera with its picture plane laid out in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pinhole {
    position: Vec3,
    /// To the upper left corner of the picture plane.
    corner: Vec3,
    /// One pixel to the right, on the picture plane.
    right: Vec3,
    /// One pixel down.
    down: Vec3,
    /// The picture's width and height in pixels.
    size: Vec2,
    mask: u32,
}

impl Pinhole {
    /// Lays out the picture plane of a camera.
    ///
    /// # Errors
    /// When a number of the camera is none, is out of range, or it looks nowhere.
    pub(crate) fn new(camera: &Camera, width: u32, height: u32) -> Result<Self, RenderError> {
        let wrong = |what: String| Err(RenderError::Camera(what));
        let fov = f64::from(camera.vertical_fov);
        if !(1e-4..=3.1).contains(&fov) {
            return wrong(format!(
                "a vertical field of view of {} degrees cannot be drawn",
                fov.to_degrees()
            ));
        }
        // `max_element` may drop a NaN among numbers.
        let position = camera.position;
        if !position.is_finite() || position.abs().max_element() > Scene::LARGEST_COORDINATE {
            return wrong(format!("the eye is at {position}; coordinates must be within 1e12"));
        }
        // In f64, where no square of an f32 overflows or vanishes.
        let Some(forward) = camera.forward.as_dvec3().try_normalize() else {
            return wrong(format!(
                "it looks along {}, which is no direction: eye and target must differ",
                camera.forward
            ));
        };
        let up = camera.up.as_dvec3().normalize_or_zero();
        let side = forward.cross(up);
        // Looking straight along "up": any side will do, and picture and light stay well defined.
        let right =
            if side.length_squared() < 1e-12 { forward.any_orthonormal_vector() } else { side.normalize() };
        let pixel = 2.0 * (fov * 0.5).tan() / f64::from(height);
        let down = forward.cross(right) * pixel;
        let right = right * pixel;
        let corner = forward - right * (f64::from(width) * 0.5) - down * (f64::from(height) * 0.5);
        Ok(Self {
            position,
            corner: corner.as_vec3(),
            right: right.as_vec3(),
            down: down.as_vec3(),
            size: Vec2::new(width as f32, height as f32),
            mask: Ray::ALL,
        })
    }

    /// The same camera with rays that see other instances.
    pub(crate) fn with_mask(self, mask: u32) -> Self {
        Self { mask, ..self }
    }

    /// All rays through the picture.
    pub(crate) fn screen(&self) -> Frustum {
        Frustum {
            eye: self.position,
            corner: self.corner,
            right: self.right * self.size.x,
            down: self.down * self.size.y,
            cells: 1,
        }
    }

    /// The picture plane as it is laid out: the eye; and from it to the upper left corner, one pixel right, one pixel down.
    pub(crate) const fn plane(&self) -> [Vec3; 4] {
        [self.position, self.corner, self.right, self.down]
    }

    /// Which instances the rays see.
    pub(crate) const fn mask(&self) -> u32 {
        self.mask
    }

    /// A point of the picture, in pixels, as parts of its width and height.
    pub(crate) fn part(&self, place: Vec2) -> Vec2 {
        place / self.size
    }

    /// The ray through a point of the picture, in pixels from the upper left corner.
    #[inline]
    pub(crate) fn ray(&self, place: Vec2) -> Ray {
        Ray::new(self.position, self.corner + self.right * place.x + self.down * place.y).with_mask(self.mask)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            name: String::new(),
            position: Vec3::new(1.0, 2.0, 3.0),
            forward: Vec3::NEG_Z * 7.0,
            up: Vec3::Y,
            vertical_fov: std::f32::consts::FRAC_PI_2,
        }
    }

    #[test]
    fn the_picture_is_upright_and_square_on() {
        let pinhole = Pinhole::new(&camera(), 200, 100).unwrap();
        let close = |place: Vec2, dir: Vec3| {
            let ray = pinhole.ray(place);
            assert_eq!(ray.origin, Vec3::new(1.0, 2.0, 3.0));
            assert!(ray.dir.distance(dir) < 1e-5, "{place} looks along {}", ray.dir);
        };
        close(Vec2::new(100.0, 50.0), Vec3::NEG_Z);
        close(Vec2::new(0.0, 0.0), Vec3::new(-2.0, 1.0, -1.0));
        close(Vec2::new(200.0, 100.0), Vec3::new(2.0, -1.0, -1.0));
    }

    #[test]
    fn looking_along_up_still_gives_a_picture() {
        for forward in [Vec3::Y, Vec3::NEG_Y, Vec3::new(0.0, -1.0, 1e-9)] {
            let pinhole = Pinhole::new(&Camera { forward, ..camera() }, 4, 4).unwrap();
            let (a, b) = (pinhole.ray(Vec2::ZERO).dir, pinhole.ray(Vec2::new(4.0, 0.0)).dir);
            assert!(a.is_finite() && (a.distance(b) - 2.0).abs() < 1e-5);
        }
        let flat = Pinhole::new(&Camera { up: Vec3::ZERO, ..camera() }, 4, 4).unwrap();
        assert!(flat.ray(Vec2::ZERO).dir.is_finite());
    }

    #[test]
    fn a_camera_that_is_none_is_refused() {
        let refused = |camera: Camera| Pinhole::new(&camera, 4, 4).unwrap_err().to_string();
        for forward in [Vec3::ZERO, Vec3::NAN, Vec3::new(f32::INFINITY, 0.0, 0.0)] {
            assert!(refused(Camera { forward, ..camera() }).contains("no direction"));
        }
        for position in [Vec3::NAN, Vec3::splat(1e30), Vec3::new(0.0, f32::NAN, 0.0)] {
            assert!(refused(Camera { position, ..camera() }).contains("the eye"));
        }
        for vertical_fov in [0.0, -1.0, 3.2, f32::NAN] {
            assert!(refused(Camera { vertical_fov, ..camera() }).contains("field of view"));
        }
    }
}
