//! A room with scans standing in it: large flat triangles beside very many small ones.
//!
//! The builder knows nothing of the room but its triangles, and no chance takes part: the scans stand on the floor under the
//! places with most air, the first at the best, each a third as high as the room is there, turned by its number. Where they do not
//! fit in without touching walls or each other, all are made smaller.

use ropewalk::glam::{Affine3A, Quat, Vec3};
use ropewalk::{Aabb, BuildError, BuildOptions, Bvh, Ray, Scene, Transform};
use thiserror::Error;

/// Why there is no such scene.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MixError {
    /// The room cannot be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// There is no floor to stand on.
    #[error(
        "the room has room for {places} of {scans} scans: no more places with a floor below and a ceiling above"
    )]
    NoPlace {
        /// Places that were found.
        places: usize,
        /// Scans that need one.
        scans: usize,
    },
    /// A scan has no size.
    #[error("scan {scan} is empty or flat: it cannot stand anywhere")]
    Flat {
        /// Which, from 0.
        scan: usize,
    },
}

/// The share of the height between floor and ceiling that a scan takes.
const HEIGHT: f32 = 0.33;
/// How much smaller all scans are made where they do not fit, and how often.
const SHRINK: f32 = 0.8;
/// At a fifth of the size a scan is no furniture any more.
const STEPS: i32 = 8;
/// Places a side that are tried.
const GRID: usize = 24;

/// A place to stand: the floor, the height above it, and how much air is around.
#[derive(Clone, Copy, Debug)]
struct Place {
    floor: Vec3,
    height: f32,
    air: f32,
}

/// The room with the scans in it, the first scan at the best place. Objects and instances of the room come first.
///
/// # Errors
/// When the room cannot be built or has too few places.
pub fn mixed(room: &Scene, scans: &[Scene]) -> Result<Scene, MixError> {
    let bvh = room.build(&BuildOptions::default())?;
    let mut places = places(&bvh);
    places.sort_by(|a, b| b.air.total_cmp(&a.air));
    let bounds: Vec<Aabb> = scans.iter().map(Scene::bounds).collect();
    if let Some(scan) = bounds.iter().position(|it| it.is_empty() || (it.max - it.min).min_element() <= 0.0) {
        return Err(MixError::Flat { scan });
    }
    let stands = (0..STEPS)
        .find_map(|step| stands(&places, &bounds, HEIGHT * SHRINK.powi(step)))
        .ok_or(MixError::NoPlace { places: places.len(), scans: scans.len() })?;
    let mut scene = room.clone();
    for (number, (scan, stand)) in scans.iter().zip(stands).enumerate() {
        let first = scene.objects.len() as u32;
        scene.objects.extend(scan.objects.iter().cloned());
        for instance in &scan.instances {
            let Ok(transform) = Transform::new(stand * *instance.transform.to_world()) else {
                return Err(MixError::Flat { scan: number });
            };
            scene.add_instance(first + instance.object, transform);
        }
    }
    Ok(scene)
}

/// Where each of some bodies stands if it is `height` as high as the room; `None` where they do not fit.
fn stands(places: &[Place], bodies: &[Aabb], height: f32) -> Option<Vec<Affine3A>> {
    let mut taken: Vec<Aabb> = Vec::new();
    let mut stands = Vec::new();
    for (number, body) in bodies.iter().enumerate() {
        let size = body.max - body.min;
        let scale = |place: &Place| height * place.height / size.y;
        // A turned box is at most as wide as its diagonal.
        let half = |place: &Place| 0.5 * scale(place) * size.x.hypot(size.z);
        let around = |place: &Place| {
            let reach = Vec3::new(half(place), 0.0, half(place));
            Aabb::new(place.floor - reach, place.floor + reach + Vec3::Y * (scale(place) * size.y))
        };
        let is_free = |place: &&Place| {
            let wanted = around(place);
            let meets = |other: &Aabb| other.min.cmple(wanted.max).all() && wanted.min.cmple(other.max).all();
            place.air > half(place) && !taken.iter().any(meets)
        };
        let place = places.iter().find(is_free)?;
        taken.push(around(place));
        let foot = Vec3::new(body.center().x, body.min.y, body.center().z);
        // Of whole numbers: the same turn on every machine.
        let turn = Quat::from_xyzw(0.0, 1.0, 0.0, 1.0 + number as f32).normalize();
        let stand = Affine3A::from_translation(place.floor)
            * Affine3A::from_quat(turn)
            * Affine3A::from_scale(Vec3::splat(scale(place)))
            * Affine3A::from_translation(-foot);
        stands.push(stand);
    }
    Some(stands)
}

/// Where one can stand, in the order of a grid.
fn places(bvh: &Bvh) -> Vec<Place> {
    let bounds = bvh.bounds();
    if bounds.is_empty() {
        return Vec::new();
    }
    let size = bounds.max - bounds.min;
    let mut places = Vec::new();
    for index in 0..GRID * GRID {
        // Off the middle of the cells: furniture likes round numbers.
        let at = |cell: usize| (cell as f32 + 0.43) / GRID as f32;
        let over = bounds.min + size * Vec3::new(at(index % GRID), 0.5, at(index / GRID));
        let down = bvh.closest(&Ray::new(over, Vec3::NEG_Y));
        let up = bvh.closest(&Ray::new(over, Vec3::Y));
        if !down.is_hit() || !up.is_hit() {
            continue;
        }
        // On the floor, and not on a table.
        if down.t < 0.4 * size.y {
            continue;
        }
        let floor = over - Vec3::Y * down.t;
        let height = down.t + up.t;
        let waist = floor + Vec3::Y * (0.2 * height);
        let sides =
            [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z, Vec3::new(1.0, 0.0, 1.0), Vec3::new(-1.0, 0.0, 1.0)];
        let air = sides
            .iter()
            .map(|&side| bvh.closest(&Ray::new(waist, side.normalize())))
            .map(|hit| if hit.is_hit() { hit.t } else { 0.0 })
            .fold(f32::INFINITY, f32::min);
        places.push(Place { floor, height, air });
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::Mesh;
    use ropewalk_testkit::meshes;

    /// A box from -2 to 2, seen from inside.
    fn room() -> Scene {
        let corner = |index: u32| {
            let side = |bit: u32| if index >> bit & 1 == 0 { -2.0 } else { 2.0 };
            Vec3::new(side(0), side(1), side(2))
        };
        let quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
        let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        Scene::from_mesh(Mesh::new((0..8).map(corner).collect(), triangles))
    }

    #[test]
    fn scans_stand_on_the_floor_beside_each_other() {
        let ball = Scene::from_mesh(meshes::icosphere(2));
        let scene = mixed(&room(), &[ball.clone(), ball]).unwrap();
        assert_eq!((scene.instances.len(), scene.bounds()), (3, room().bounds()));
        let foot = |instance: usize| {
            let mut alone = scene.clone();
            alone.instances = vec![scene.instances[instance]];
            alone.bounds()
        };
        let (one, two) = (foot(1), foot(2));
        for bounds in [one, two] {
            assert!((bounds.min.y + 2.0).abs() < 1e-4 && bounds.max.y < -2.0 + 4.1 * HEIGHT, "{bounds:?}");
        }
        assert!(
            one.max.x < two.min.x || two.max.x < one.min.x || one.max.z < two.min.z || two.max.z < one.min.z
        );
        assert_eq!(mixed(&room(), &[]).unwrap().instances.len(), 1);
    }

    #[test]
    fn what_does_not_fit_is_an_error() {
        let ball = Scene::from_mesh(meshes::icosphere(1));
        let many = vec![ball.clone(); 400];
        assert!(matches!(mixed(&room(), &many), Err(MixError::NoPlace { scans: 400, .. })));
        assert!(matches!(mixed(&Scene::default(), &[ball]), Err(MixError::NoPlace { places: 0, .. })));
        let flat = Scene::from_mesh(Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]));
        assert_eq!(mixed(&room(), &[flat]), Err(MixError::Flat { scan: 0 }));
        assert_eq!(mixed(&room(), &[Scene::default()]), Err(MixError::Flat { scan: 0 }));
    }
}
