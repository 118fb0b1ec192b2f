//! Triangles at the same place, or almost: what order and culling must not decide.

use super::{Case, Recipe};
use crate::meshes;
use crate::random::Random;
use crate::rays::RayClass;
use glam::{DVec3, Vec3};
use ropewalk::{Mesh, Ray, Scene, Transform};

pub(super) const RECIPES: &[Recipe] = &[
    ("coplanar-pair", |name| Case::new(name, "two slanted triangles overlap in one plane", coplanar_pair())),
    ("duplicates", |name| Case::new(name, "twelve instances of one object at one place", duplicates())),
    ("coplanar-axis", |name| {
        Case::new(
            name,
            "overlapping grids in one axis-aligned plane: boxes without thickness",
            coplanar_axis(),
        )
    }),
    ("reversed-ids", |name| {
        Case::new(name, "overlapping triangles whose ids fall where the walk goes first", reversed_ids())
            .with_rays(RayClass::OnSurface, on_the_plane())
    }),
    ("sheets", |name| Case::new(name, "axis-aligned sheets one float apart", sheets())),
    ("duplicate-soup", |name| {
        Case::new(name, "a soup in which every triangle is there three times", duplicate_soup())
    }),
];

fn coplanar_pair() -> Scene {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.3 * x + 0.7 * y + 0.1);
    let mut mesh = Mesh::default();
    meshes::push(&mut mesh, [corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)]);
    meshes::push(&mut mesh, [corner(-0.1, 0.0), corner(1.1, 0.1), corner(0.1, 1.3)]);
    Scene::from_mesh(mesh)
}

fn duplicates() -> Scene {
    let mut scene = Scene::default();
    let object = scene.add_object(meshes::icosphere(1));
    for _ in 0..12 {
        scene.add_instance(object, Transform::from_translation(Vec3::new(0.3, -0.2, 0.1)));
    }
    scene
}

/// Three grids of different cells and a soup of triangles, all in the plane y = 0.7, which no f32 holds exactly:
/// `t` of neighbours differ by a float or two, and the boxes of all nodes are flat.
fn coplanar_axis() -> Scene {
    let mut mesh = meshes::grid(1, 0.7, 7, 0.3);
    meshes::append(&mut mesh, &meshes::grid(1, 0.7, 5, 0.41));
    meshes::append(&mut mesh, &meshes::grid(1, 0.7, 11, 0.19));
    let soup =
        meshes::mapped(meshes::soup(150, 0.8, 51), |point| DVec3::new(point.x + 1.0, 0.7, point.z + 1.0));
    meshes::append(&mut mesh, &soup);
    Scene::from_mesh(mesh)
}

/// Triangles in the plane z = 0 that overlap in the middle, the first of them farthest up the x axis: a builder
/// puts low x first, so a walk meets large ids first and must still find the smallest at equal `t`.
fn reversed_ids() -> Scene {
    let mut mesh = Mesh::default();
    for index in 0..32 {
        let x = f64::from(31 - index) * 0.0625;
        let corner = |dx: f64, y: f64| DVec3::new(x + dx, y, 0.0);
        meshes::push(&mut mesh, [corner(-4.0, -4.0), corner(4.0, -4.0), corner(0.0, 4.0)]);
    }
    Scene::from_mesh(mesh)
}

/// Rays from the plane z = 0: every triangle there is at t = 0, and so is the entry into every box.
fn on_the_plane() -> Vec<Ray> {
    let mut random = Random::new(61);
    (0..96)
        .map(|index| {
            // Sixteenths and a direction along z are exact, so every hit is at exactly 0.
            let place = |n: usize| n as f32 / 16.0 - 0.5;
            let origin = Vec3::new(place(random.below(32)), place(random.below(16)), 0.0);
            let ray = Ray::new(origin, if index % 2 == 0 { Vec3::Z } else { Vec3::NEG_Z });
            // And rays that come from above, whose window begins at the plane.
            if index % 4 < 2 {
                ray
            } else {
                let back = origin - ray.dir;
                Ray { origin: back, ..ray }.window(1.0, 2.0)
            }
        })
        .collect()
}

fn sheets() -> Scene {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        let mut height = 0.9f32;
        for _ in 0..12 {
            meshes::append(&mut mesh, &meshes::grid(axis, f64::from(height), 2, 0.5));
            height = height.next_up();
        }
    }
    Scene::from_mesh(mesh)
}

fn duplicate_soup() -> Scene {
    let soup = meshes::soup(200, 0.6, 71);
    let mut mesh = soup.clone();
    meshes::append(&mut mesh, &soup);
    let mut scene = Scene::from_mesh(mesh);
    let again = scene.add_object(soup);
    scene.add_instance(again, Transform::IDENTITY);
    scene
}
