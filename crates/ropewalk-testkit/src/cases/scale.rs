//! Numbers that are large, small, or both at once.

use super::{Case, Recipe};
use crate::meshes;
use glam::DVec3;
use ropewalk::{Mesh, Scene};

pub(super) const RECIPES: &[Recipe] = &[
    ("far-1e6", |name| {
        Case::new(name, "a sphere of radius 100 a million away", sphere(100.0, far(1e6)))
            .closed_around(far(1e6), 80.0)
    }),
    ("far-1e9", |name| {
        Case::new(name, "a sphere of radius 100,000 a thousand million away", sphere(1e5, far(1e9)))
            .closed_around(far(1e9), 8e4)
    }),
    ("huge-1e9", |name| Case::new(name, "a soup a thousand million large", soup(1e9))),
    ("tiny-1e-9", |name| {
        Case::new(name, "a sphere of a thousand millionth", sphere(1e-9, DVec3::ZERO))
            .closed_around(DVec3::ZERO, 9e-10)
    }),
    ("tiny-soup-1e-15", |name| {
        Case::new(name, "a soup so small that products of three coordinates vanish", soup(1e-15))
    }),
    ("mixed-scale", |name| Case::new(name, "details of 1e-3 on a ground of 1e5", mixed())),
];

fn sphere(scale: f64, offset: DVec3) -> Scene {
    Scene::from_mesh(meshes::mapped(meshes::icosphere(2), |point| point * scale + offset))
}

fn soup(scale: f64) -> Scene {
    Scene::from_mesh(meshes::mapped(meshes::soup(300, 0.6, 81), |point| point * scale))
}

fn far(distance: f64) -> DVec3 {
    DVec3::new(distance, -distance, 0.5 * distance)
}

fn mixed() -> Scene {
    let mut mesh = meshes::mapped(meshes::grid(1, 0.0, 4, 5e4), |point| point - DVec3::new(1e5, 0.0, 1e5));
    for index in 0..6 {
        let scale = 10f64.powi(index - 3);
        let place = DVec3::new(scale * 3.0, scale, -scale * 2.0);
        let sphere = meshes::mapped(meshes::icosphere(1), |point| point * scale + place);
        meshes::append(&mut mesh, &sphere);
    }
    let mut far_triangle = Mesh::default();
    meshes::push(
        &mut far_triangle,
        [DVec3::splat(1e5), DVec3::splat(1e5) + DVec3::X, DVec3::splat(1e5) + DVec3::Y],
    );
    meshes::append(&mut mesh, &far_triangle);
    Scene::from_mesh(mesh)
}
