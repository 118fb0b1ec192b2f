//! Lists in every way, a scene of everything, and rays of all kinds.

use ropewalk::glam::{Affine3A, DVec3, Vec3};
use ropewalk::traversal_list::{Bounds, ChildOrder, Directions, ListOptions, Source};
use ropewalk::{FlatTriangle, Hit, Mesh, PreparedRay, Ray, Scene, Transform};
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;

/// Every combination of what can be chosen.
pub(crate) fn every() -> Vec<ListOptions> {
    let mut every = Vec::new();
    for &(_, source) in Source::NAMES {
        for &(_, bounds) in Bounds::NAMES {
            for &(_, directions) in Directions::NAMES {
                for &(_, order) in ChildOrder::NAMES {
                    let plain = ListOptions::default();
                    every.push(ListOptions { source, bounds, directions, order, ..plain });
                }
            }
        }
    }
    every
}

/// Big and small triangles through each other, some of them twice.
pub(crate) fn mixed() -> Scene {
    let mut mesh = meshes::soup(400, 0.2, 3);
    meshes::append(&mut mesh, &meshes::soup(20, 2.0, 4));
    meshes::append(&mut mesh, &meshes::soup(20, 2.0, 4));
    meshes::append(&mut mesh, &meshes::mapped(meshes::icosphere(3), |point| point * 0.7));
    Scene::from_mesh(mesh)
}

pub(crate) fn rays(count: usize) -> Vec<Ray> {
    let mut random = Random::new(12);
    let ray = |index: usize| {
        let target = random.in_cube();
        let origin = if index.is_multiple_of(3) { random.in_cube() } else { random.direction() * 4.0 };
        // Every fourth along an axis.
        let axis = DVec3::AXES[index % 3] * if index.is_multiple_of(8) { -1.0 } else { 1.0 };
        let dir = if index.is_multiple_of(4) { axis } else { target - origin };
        Ray::new(origin.as_vec3(), dir.as_vec3())
    };
    (0..count).map(ray).collect()
}

/// The same, and instances, one of them mirrored, of boxes along the axes, of which lists leave out the most.
pub(crate) fn placed() -> Scene {
    let mut scene = mixed();
    let mut boxes = Mesh::default();
    for index in 0..27 {
        let low =
            DVec3::new(f64::from(index % 3), f64::from(index / 3 % 3), f64::from(index / 9)) * 0.6 - 0.9;
        add_box(&mut boxes, low, low + 0.25);
    }
    let object = scene.add_object(boxes);
    scene.add_instance(object, Transform::IDENTITY);
    let mirror = Affine3A::from_scale(Vec3::new(-0.5, 0.5, 0.5));
    scene.add_instance(object, Transform::new(mirror).unwrap());
    scene
}

/// A box whose faces look outwards.
fn add_box(mesh: &mut Mesh, low: DVec3, high: DVec3) {
    for axis in 0..3 {
        for outwards in [false, true] {
            let corner = |u: bool, v: bool| {
                let (mut point, [a, b]) = (low, [(axis + 1) % 3, (axis + 2) % 3]);
                if outwards {
                    point[axis] = high[axis];
                }
                if u {
                    point[a] = high[a];
                }
                if v {
                    point[b] = high[b];
                }
                point
            };
            let [a, b, c, d] =
                [corner(false, false), corner(true, false), corner(true, true), corner(false, true)];
            let faces = if outwards { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
            faces.into_iter().for_each(|face| meshes::push(mesh, face));
        }
    }
}

/// The nearest hit of a front, by brute force.
pub(crate) fn closest_front(triangles: &[FlatTriangle], ray: &Ray) -> Hit {
    let Some(prepared) = PreparedRay::new(ray) else { return Hit::MISS };
    let hits = triangles.iter().filter_map(|triangle| triangle.intersect_front(&prepared, prepared.t_max));
    hits.fold(Hit::MISS, |best, hit| if hit.precedes(&best) { hit } else { best })
}
