//! Finding the place from which everything just fits into the picture.
//!
//! **The tight fit.** In the axes of the camera, a point `(x, y, z)` is inside the picture of an eye at
//! `(ex, ey, ez)` when `|x - ex| <= (z - ez) * tan(half angle)`, and likewise for y. Over all points this leaves
//! `max(x - z tan) + ez tan <= ex <= min(x + z tan) - ez tan`: the largest `ez` for which both ends meet is the
//! nearest eye, and the middle between them centres the picture. Exact, one pass over the points, in f64.

use super::{DEFAULT_AZIMUTH_DEGREES, DEFAULT_ELEVATION_DEGREES, DEFAULT_FOV_DEGREES};
use crate::sampling;
use crate::stage::Stage;
use glam::{DVec3, Vec3};
use ropewalk_scene::Camera;

/// From which side everything is framed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framing {
    /// Radians to the right of the front.
    pub azimuth: f32,
    /// Radians above the horizon.
    pub elevation: f32,
    /// The vertical field of view in radians.
    pub vertical_fov: f32,
}

impl Default for Framing {
    /// A three-quarter view from above.
    fn default() -> Self {
        Self {
            azimuth: DEFAULT_AZIMUTH_DEGREES.to_radians(),
            elevation: DEFAULT_ELEVATION_DEGREES.to_radians(),
            vertical_fov: DEFAULT_FOV_DEGREES.to_radians(),
        }
    }
}

/// The share of the picture's half sides that stays free around the object.
const MARGIN: f64 = 0.13;

/// A camera that sees all of the stage's model.
pub(crate) fn frame(stage: &Stage, framing: &Framing, aspect: f32) -> Camera {
    let bounds = stage.bounds();
    let up = stage.up().as_dvec3().normalize();
    let (front, right) = front_and_right(up);
    let (azimuth, elevation) = (f64::from(framing.azimuth), f64::from(framing.elevation));
    let level = front * azimuth.cos() + right * azimuth.sin();
    let forward = -(level * elevation.cos() + up * elevation.sin());
    // From the azimuth and not from `up`, so that it is there when the eye looks straight down.
    let rightwards = right * azimuth.cos() - front * azimuth.sin();
    let center = if bounds.is_empty() { DVec3::ZERO } else { bounds.center().as_dvec3() };
    // Smaller than this the eye could not be told from what it looks at.
    let smallest = (center.abs().max_element() * 1e-4).max(1e-9);
    let extent = bounds.size().as_dvec3().length();
    let size = if extent == 0.0 && center == DVec3::ZERO { 1.0 } else { extent.max(smallest) };
    let mut fit = Fit::new(forward, rightwards, center, f64::from(framing.vertical_fov), f64::from(aspect));
    stage.for_each_point(|point| fit.add(point));
    if fit.is_empty() {
        fit.add(center.as_vec3());
    }
    let position = fit.eye(size);
    Camera {
        name: "frame".into(),
        position: position.as_vec3(),
        forward: forward.as_vec3(),
        up: rightwards.cross(forward).as_vec3(),
        vertical_fov: framing.vertical_fov,
    }
}

/// The direction to the front of a model, and to its right as seen from there. Things that are Y-up face +Z, as
/// glTF demands; things that are Z-up face -Y, as CAD programs have it.
fn front_and_right(up: DVec3) -> (DVec3, DVec3) {
    let front = if up.abs().abs_diff_eq(DVec3::Z, 1e-3) {
        -DVec3::Y
    } else if up.abs().abs_diff_eq(DVec3::X, 1e-3) {
        DVec3::Z
    } else {
        DVec3::Z
            .reject_from_normalized(up)
            .try_normalize()
            .unwrap_or_else(|| sampling::frame(up.as_vec3()).0.as_dvec3())
    };
    (front, up.cross(front))
}

/// The running extremes of the tight fit.
struct Fit {
    axes: [DVec3; 3],
    /// The tangents of the half angles, horizontal and vertical, less the margin.
    tangents: [f64; 2],
    center: DVec3,
    /// `max(x - z tan)`, for x and y.
    low: [f64; 2],
    /// `min(x + z tan)`, for x and y.
    high: [f64; 2],
    nearest: f64,
}

impl Fit {
    fn new(forward: DVec3, right: DVec3, center: DVec3, vertical_fov: f64, aspect: f64) -> Self {
        let vertical = (vertical_fov * 0.5).tan() * (1.0 - MARGIN);
        Self {
            axes: [right, right.cross(forward), forward],
            tangents: [vertical * aspect, vertical],
            center,
            low: [f64::NEG_INFINITY; 2],
            high: [f64::INFINITY; 2],
            nearest: f64::INFINITY,
        }
    }

    fn add(&mut self, point: Vec3) {
        let point = point.as_dvec3() - self.center;
        let depth = point.dot(self.axes[2]);
        self.nearest = self.nearest.min(depth);
        for axis in 0..2 {
            let across = point.dot(self.axes[axis]);
            let reach = depth * self.tangents[axis];
            self.low[axis] = self.low[axis].max(across - reach);
            self.high[axis] = self.high[axis].min(across + reach);
        }
    }

    fn is_empty(&self) -> bool {
        self.nearest == f64::INFINITY
    }

    /// The eye for an object of about this size.
    fn eye(&self, size: f64) -> DVec3 {
        let fits = |axis: usize| (self.high[axis] - self.low[axis]) / (2.0 * self.tangents[axis]);
        // The eye keeps off what it looks at: a thing of no width seen end-on would otherwise be touched by it.
        let depth = fits(0).min(fits(1)).min(self.nearest - 0.01 * size);
        let across = |axis: usize| 0.5 * (self.low[axis] + self.high[axis]);
        self.center + self.axes[0] * across(0) + self.axes[1] * across(1) + self.axes[2] * depth
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Pinhole;
    use crate::stage::StageOptions;
    use crate::{Ground, Stage};
    use glam::Vec2;
    use ropewalk::{Aabb, Mesh, Scene};
    use ropewalk_scene::Model;

    fn corners(bounds: &Aabb) -> Vec<Vec3> {
        (0..8)
            .map(|corner| {
                let pick =
                    |axis: usize| if corner >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] };
                Vec3::new(pick(0), pick(1), pick(2))
            })
            .collect()
    }

    fn stage(bounds: &Aabb, up: Option<Vec3>) -> Stage {
        let triangles = vec![[0, 1, 2], [1, 3, 2], [4, 5, 6], [5, 7, 6]];
        let scene = Scene::from_mesh(Mesh::new(corners(bounds), triangles));
        let options = StageOptions { ground: Ground::Off, up, ..StageOptions::default() };
        Stage::new(Model { scene, ..Model::default() }, &options)
    }

    /// Where a point lands in the picture, from -1 to 1 both ways.
    fn project(camera: &Camera, aspect: f64, point: Vec3) -> [f64; 2] {
        let forward = camera.forward.as_dvec3().normalize();
        let right = forward.cross(camera.up.as_dvec3()).normalize();
        let offset = point.as_dvec3() - camera.position.as_dvec3();
        let depth = offset.dot(forward);
        assert!(depth > 0.0, "{point} is behind the eye {}", camera.position);
        let tangent = (f64::from(camera.vertical_fov) * 0.5).tan();
        [offset.dot(right) / (depth * tangent * aspect), offset.dot(right.cross(forward)) / (depth * tangent)]
    }

    #[test]
    fn every_corner_is_in_the_picture_and_fills_it() {
        let boxes = [
            (Vec3::ZERO, Vec3::ONE),
            (Vec3::splat(-1e-6), Vec3::splat(1e-6)),
            (Vec3::ZERO, Vec3::new(1000.0, 1.0, 1.0)),
            (Vec3::ZERO, Vec3::new(1.0, 0.0, 1.0)),
            (Vec3::ZERO, Vec3::new(0.0, 3.0, 2.0)),
            (Vec3::splat(1e6), Vec3::splat(1e6 + 50.0)),
            (Vec3::new(-3e9, 0.0, 0.0), Vec3::new(2e9, 1e9, 1.0)),
        ];
        for (min, max) in boxes {
            let bounds = Aabb::new(min, max);
            for up in [None, Some(Vec3::Z), Some(Vec3::X), Some(Vec3::NEG_Y), Some(Vec3::new(1.0, 2.0, -0.5))]
            {
                let stage = stage(&bounds, up);
                for aspect in [16.0 / 9.0, 1.0, 0.25, 40.0] {
                    for degrees in [0.0_f32, 30.0, 90.0, -60.0] {
                        let framing = Framing { elevation: degrees.to_radians(), ..Framing::default() };
                        let camera = frame(&stage, &framing, aspect);
                        let places: Vec<[f64; 2]> = corners(&bounds)
                            .into_iter()
                            .map(|corner| project(&camera, f64::from(aspect), corner))
                            .collect();
                        let reach =
                            places.iter().flatten().fold(0.0_f64, |reach, place| reach.max(place.abs()));
                        assert!(
                            reach <= 1.0 - MARGIN + 1e-2,
                            "{bounds:?} {up:?} {aspect} {degrees}: {reach}"
                        );
                        assert!(reach > 0.05, "{bounds:?} {up:?} {aspect} {degrees}: only {reach}");
                        assert!(Pinhole::new(&camera, 64, 64).is_ok());
                    }
                }
            }
        }
    }

    #[test]
    fn a_point_and_nothing_at_all_have_a_camera() {
        for bounds in [Aabb::new(Vec3::ZERO, Vec3::ZERO), Aabb::new(Vec3::splat(5e5), Vec3::splat(5e5))] {
            let camera = frame(&stage(&bounds, None), &Framing::default(), 1.5);
            let [x, y] = project(&camera, 1.5, bounds.min);
            assert!(x.abs() < 0.1 && y.abs() < 0.1, "{x} {y}");
        }
        let empty = Stage::new(Model::default(), &StageOptions::default());
        let camera = frame(&empty, &Framing::default(), 1.5);
        let pinhole = Pinhole::new(&camera, 8, 8).unwrap();
        assert!(pinhole.ray(Vec2::splat(4.0)).is_valid());
    }

    #[test]
    fn the_front_is_to_the_right_hand() {
        let (front, right) = front_and_right(DVec3::Y);
        assert_eq!((front, right), (DVec3::Z, DVec3::X));
        let (front, right) = front_and_right(DVec3::Z);
        assert_eq!((front, right), (-DVec3::Y, DVec3::X));
    }
}
