//! From where a scene is looked at, and where its light is, found by the scene's own triangles so that nobody has to choose.
//!
//! A scene in which most rays from inside its box hit something, and hit the front of it, is a room: the camera stands in
//! it, where there is most air, and looks where it sees farthest; the light hangs above it. From the inside of a body, a
//! scan say, one sees the backs of its faces: it and any other scene is looked at from outside.

use ropewalk::glam::{DVec3, Vec3};
use ropewalk::{Aabb, Hit, Ray};
use ropewalk_testkit::random::Random;
use ropewalk_testkit::rays::{Closest, View};

/// A camera and a point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// The camera.
    pub view: View,
    /// The light.
    pub light: DVec3,
}

/// Half the width of the picture at distance 1: as wide as rooms need (67 degrees).
const INSIDE: f64 = 2.0 / 3.0;
/// Rays that tell what surrounds a place.
const FEELERS: usize = 128;
/// Places a side of the grid in which the camera looks for air.
const PLACES: usize = 5;
/// A room: the share of rays that hit something. A room may have windows and an open door, Sponza an open roof.
const ENCLOSED: f64 = 0.7;
/// A room: the share of hits that see the front of a face.
const FRONTS: f64 = 0.5;

impl Viewpoint {
    /// From a place at another, with a light.
    #[must_use]
    pub fn new(view: View, light: DVec3) -> Self {
        Self { view, light }
    }

    /// The best place of a scene that is `closest`'s.
    #[must_use]
    pub fn of_scene(bounds: &Aabb, closest: &Closest<'_>) -> Self {
        Self::inside(bounds, closest).unwrap_or_else(|| Self::outside(bounds))
    }

    /// From the front above, all of it in sight, with the light far away above.
    #[must_use]
    pub fn outside(bounds: &Aabb) -> Self {
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let light = (low + high) * 0.5 + DVec3::new(-0.6, 1.0, 0.4) * (high - low).length();
        Self { view: View::of_bounds(bounds), light }
    }

    fn inside(bounds: &Aabb, closest: &Closest<'_>) -> Option<Self> {
        let (low, size) = (bounds.min.as_dvec3(), (bounds.max - bounds.min).as_dvec3());
        let mut random = Random::new(11);
        let feelers: Vec<DVec3> = (0..FEELERS).map(|_| random.direction()).collect();
        // Of the places in the middle part of the box, the one with most air: the mean of the distances that are seen.
        let part = |index: usize| 0.25 + 0.5 * index as f64 / (PLACES - 1) as f64;
        let mut best: Option<(f64, DVec3, Vec<f64>)> = None;
        for place in 0..PLACES * PLACES * PLACES {
            let at = DVec3::new(
                part(place % PLACES),
                part(place / PLACES % PLACES),
                part(place / PLACES / PLACES),
            );
            let eye = low + at * size;
            let Some(seen) = distances(eye, &feelers, closest) else { continue };
            let air = seen.iter().sum::<f64>() / seen.len() as f64;
            if best.as_ref().is_none_or(|(most, ..)| air > *most) {
                best = Some((air, eye, seen));
            }
        }
        let (air, eye, seen) = best?;
        // The inside of a body is as narrow as the body: a room has air for a good part of its box.
        if air < 0.15 * size.min_element() {
            return None;
        }
        // Along the widest view that is nearly level: the mean distance of the feelers within 45 degrees.
        let width = |direction: &DVec3| {
            let near = feelers.iter().zip(&seen).filter(|(other, _)| other.dot(*direction) > 0.7);
            near.clone().map(|(_, distance)| distance).sum::<f64>() / near.count().max(1) as f64
        };
        let level = feelers.iter().filter(|direction| direction.y.abs() < 0.35);
        let forward = level.max_by(|a, b| width(a).total_cmp(&width(b)))?;
        // Under the ceiling, a little aside, so that no shadow ray runs back along its primary ray.
        let above = closest(&[Ray::new(eye.as_vec3(), Vec3::Y)]);
        let up = above.first().filter(|hit| hit.is_hit()).map_or(0.0, |hit| f64::from(hit.t));
        let light = eye + DVec3::Y * (0.7 * up) + forward.cross(DVec3::Y) * (0.2 * up);
        let target = eye + *forward;
        Some(Self { view: View::look_at(eye.as_vec3(), target.as_vec3(), INSIDE), light })
    }
}

/// How far it is to what is seen along each feeler, 0 where nothing is seen; `None` where this is no room.
fn distances(eye: DVec3, feelers: &[DVec3], closest: &Closest<'_>) -> Option<Vec<f64>> {
    let rays: Vec<Ray> =
        feelers.iter().map(|direction| Ray::new(eye.as_vec3(), direction.as_vec3())).collect();
    let hits = closest(&rays);
    let share = |of: &dyn Fn(&&Hit) -> bool| hits.iter().filter(of).count() as f64;
    let seen = share(&|hit| hit.is_hit());
    let fronts = share(&|hit| hit.is_hit() && hit.front_face);
    if seen < ENCLOSED * feelers.len() as f64 || fronts < FRONTS * seen {
        return None;
    }
    Some(hits.iter().map(|hit| if hit.is_hit() { f64::from(hit.t) } else { 0.0 }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::{BuildOptions, Mesh, Scene};
    use ropewalk_testkit::meshes;

    fn viewpoint(mesh: Mesh) -> (Viewpoint, Aabb) {
        let bvh = Scene::from_mesh(mesh).build(&BuildOptions::default()).unwrap();
        let closest = |rays: &[Ray]| rays.iter().map(|ray| bvh.closest(ray)).collect();
        (Viewpoint::of_scene(&bvh.bounds(), &closest), bvh.bounds())
    }

    fn holds(bounds: &Aabb, point: Vec3) -> bool {
        point.cmpge(bounds.min).all() && point.cmple(bounds.max).all()
    }

    #[test]
    fn a_room_is_seen_from_inside_and_a_body_from_outside() {
        let mut room = meshes::icosphere(3);
        room.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        let (inside, bounds) = viewpoint(room);
        assert!(holds(&bounds, inside.view.eye().as_vec3()), "{inside:?}");
        assert!(holds(&bounds, inside.light.as_vec3()), "{inside:?}");
        let (outside, bounds) = viewpoint(meshes::icosphere(3));
        assert!(!holds(&bounds, outside.view.eye().as_vec3()), "{outside:?}");
    }

    #[test]
    fn a_field_is_seen_from_outside() {
        let (viewpoint, bounds) = viewpoint(meshes::soup(40, 0.1, 3));
        assert!(!holds(&bounds, viewpoint.view.eye().as_vec3()), "{viewpoint:?}");
    }
}
