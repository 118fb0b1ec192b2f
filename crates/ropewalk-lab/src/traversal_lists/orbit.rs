//! Six views around a scene, and one point light.
//!
//! The reference measurements (ALGORITHMS: 4.2) were made with six views in a circle; where they and the light were is not
//! said. The numbers here were found by trying, with spheres about the vertices of triangles, as the reference has them: then
//! 55 of its 60 cells of two-sided lists without heads come within 5 percent, and the others within 8. What they are is
//! visible in the counts: how much of a picture the scene's root sphere covers, how many rays see the ground, and from
//! where shadow rays come. Spheres about the triangles' boxes, which the lists have, make some percent more.

use glam::{DVec3, Vec3};
use ropewalk::traversal_list::Frustum;
use ropewalk::{Aabb, Ray};
use std::f64::consts::TAU;

/// Views in a circle.
const VIEWS: usize = 6;
/// How far the eye is from the middle, in units of half the scene's diagonal.
const DISTANCE: f64 = 2.6;
/// How far it stands above the horizon.
const ELEVATION: f64 = 0.35;
/// Half the picture's width at distance 1: the picture is as wide as the sphere around the scene's box, nearly.
const HALF_WIDTH: f64 = 0.334;
/// The turn of the first view.
const TURN: f64 = 0.35;
/// Where the light is, from the middle, in units of half the diagonal.
const LIGHT: DVec3 = DVec3::new(1.37, 1.67, 0.48);
/// How far off the surface rays start, as a share of the scene's largest coordinate. Heads of rays that begin above their
/// triangle want more than [`CLEAR`](ropewalk::traversal_list::heads::CLEAR) times the sum of the magnitudes of a unit
/// normal's components, 1.74 at most, and less than [`PAD`](ropewalk::traversal_list::heads::PAD).
const OFF: f64 = 6e-6;

/// The views and the light of a scene.
#[derive(Clone, Debug)]
pub(super) struct Orbit {
    /// Each view's picture.
    pub(super) frustums: Vec<Frustum>,
    /// The point light.
    pub(super) light: DVec3,
    /// How far rays that start on a surface are moved off it: clearly above it, too little to be seen.
    pub(super) off: f64,
}

impl Orbit {
    /// Around a box, with pictures of so many cells a side. `whole` is the box of all that there is, the ground too.
    pub(super) fn around(bounds: &Aabb, whole: &Aabb, cells: u32) -> Self {
        let largest = whole.min.abs().max(whole.max.abs()).max_element();
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let center = (low + high) * 0.5;
        let radius = Some((high - low).length() * 0.5).filter(|radius| *radius > 0.0).unwrap_or(1.0);
        let frustum = |view: usize| {
            let angle = TURN + TAU * view as f64 / VIEWS as f64;
            let aside = DVec3::new(angle.cos(), 0.0, angle.sin());
            let back = aside * ELEVATION.cos() + DVec3::Y * ELEVATION.sin();
            let right = DVec3::Y.cross(back).normalize();
            let (right, up) = (right * HALF_WIDTH, back.cross(right) * HALF_WIDTH);
            Frustum {
                eye: (center + back * (DISTANCE * radius)).as_vec3(),
                corner: (up - back - right).as_vec3(),
                right: (right * 2.0).as_vec3(),
                down: (up * -2.0).as_vec3(),
                cells,
            }
        };
        Self {
            frustums: (0..VIEWS).map(frustum).collect(),
            light: center + LIGHT * radius,
            off: if whole.is_empty() { 0.0 } else { OFF * f64::from(largest) },
        }
    }
}

/// The rays of a square picture, row by row, each through the middle of its pixel, and the cell of each.
pub(super) fn picture(frustum: &Frustum, side: usize) -> (Vec<Ray>, Vec<u32>) {
    let place = |index: usize| (index as f32 + 0.5) / side as f32;
    (0..side * side)
        .map(|pixel| {
            let (x, y) = (place(pixel % side), place(pixel / side));
            let dir: Vec3 = frustum.corner + frustum.right * x + frustum.down * y;
            (Ray::new(frustum.eye, dir), frustum.cell(x, y))
        })
        .unzip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_views_look_at_the_middle() {
        let bounds = Aabb::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(3.0, 4.0, 7.0));
        let orbit = Orbit::around(&bounds, &bounds, 4);
        assert_eq!(orbit.frustums.len(), 6);
        for frustum in &orbit.frustums {
            let ahead = frustum.corner + (frustum.right + frustum.down) * 0.5;
            let aim = frustum.eye + ahead * frustum.eye.distance(bounds.center());
            assert!(aim.distance(bounds.center()) < 1e-4, "{aim}");
            assert!(frustum.eye.y > 4.0 && frustum.down.y < 0.0);
            let (rays, cells) = picture(frustum, 8);
            assert_eq!((rays.len(), cells.len()), (64, 64));
            assert_eq!((cells[0], cells[7], cells[56], cells[63]), (0, 3, 12, 15));
            assert!(rays.iter().all(Ray::is_valid));
            // The first pixel is at the upper left.
            assert!(rays[0].dir.dot(frustum.down) < 0.0 && rays[0].dir.dot(frustum.right) < 0.0);
        }
        let first = orbit.frustums[0].eye;
        assert!(orbit.frustums[1..].iter().all(|frustum| frustum.eye.distance(first) > 1.0));
        // A box without a size has views too.
        let place = Aabb::new(Vec3::ONE, Vec3::ONE);
        let point = Orbit::around(&place, &place, 1);
        assert!(point.frustums.iter().all(|frustum| frustum.eye.is_finite() && frustum.eye != Vec3::ONE));
    }
}
