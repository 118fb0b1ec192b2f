//! Nothing, little, and damaged input; instances of every kind.

use super::{Case, Recipe, rotation};
use crate::meshes;
use crate::random::Random;
use glam::{Affine3A, DVec3, Mat3A, Vec3};
use ropewalk::{Mesh, Object, Scene, Transform};

pub(super) const RECIPES: &[Recipe] = &[
    ("empty", |name| Case::new(name, "no object at all", Scene::default())),
    ("empty-objects", |name| {
        Case::new(name, "instances of nothing, and of a mesh without triangles", empty_objects())
    }),
    ("one-triangle", |name| Case::new(name, "the root is a leaf", one_triangle())),
    ("bad-input", |name| Case {
        skipped: SKIPPED,
        ..Case::new(name, "NaN, infinite, huge, degenerate, out of range", bad())
    }),
    ("placed", |name| Case::new(name, "instances that turn, stretch, shear and mirror", placed())),
    ("masks", |name| Case::new(name, "instances with masks of every kind", masks())),
    ("parts", |name| Case::new(name, "objects of several geometries", parts())),
];

fn empty_objects() -> Scene {
    let mut scene = Scene::default();
    let nothing = scene.add_object(Object::default());
    let points = scene.add_object(Mesh::new(vec![Vec3::ONE], vec![]));
    for object in [nothing, points, nothing] {
        scene.add_instance(object, Transform::IDENTITY);
    }
    scene
}

fn one_triangle() -> Scene {
    let corners = vec![Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.3, 0.1, 0.5), Vec3::new(0.4, 1.7, 0.9)];
    Scene::from_mesh(Mesh::new(corners, vec![[0, 1, 2]]))
}

/// Bad triangles in [`bad`], of which one in ten is kept: it has no area, but three different vertices.
const BAD: u32 = 300;
const SKIPPED: usize = (BAD - BAD / 10) as usize;

/// A soup of which every other triangle is damaged in one way or another.
fn bad() -> Scene {
    let mut mesh = meshes::soup(2 * BAD, 0.7, 41);
    let out_of_range = mesh.positions.len() as u32;
    for (index, triangle) in mesh.triangles.iter_mut().enumerate().filter(|(index, _)| index % 2 == 0) {
        let first = triangle[0] as usize;
        let corners = &mut mesh.positions[first..first + 3];
        match index / 2 % 10 {
            0 => corners[0].x = f32::NAN,
            1 => corners[1].y = f32::INFINITY,
            2 => corners[2].z = f32::NEG_INFINITY,
            3 => corners[1] = Vec3::splat(1e13),
            4 => corners[2] = corners[0],
            5 => corners.fill(Vec3::splat(0.25)),
            6 => {
                // Three points on a line, exactly.
                (corners[0], corners[1], corners[2]) = (Vec3::ZERO, Vec3::splat(0.5), Vec3::ONE);
            }
            7 => triangle[1] = out_of_range,
            8 => triangle[2] = u32::MAX,
            _ => triangle[2] = triangle[0],
        }
    }
    Scene::from_mesh(mesh)
}

fn placed() -> Scene {
    let mut scene = Scene::default();
    let object = scene.add_object(meshes::icosphere(1));
    let mut random = Random::new(5);
    for index in 0..12 {
        let scale = match index % 4 {
            0 => Vec3::ONE,
            1 => Vec3::new(-1.0, 1.0, 1.0),
            2 => Vec3::new(2.0, 0.2, 1.0),
            _ => Vec3::new(-0.5, -3.0, -0.7),
        };
        let turn = Affine3A::from_quat(rotation(&mut random).as_quat());
        let mut shear = Mat3A::IDENTITY;
        if index % 3 == 0 {
            (shear.y_axis.x, shear.z_axis.y) = (0.8, -0.6);
        }
        let place = Affine3A::from_translation((random.in_cube() * 4.0).as_vec3());
        let map = place * turn * Affine3A::from_mat3(shear.into()) * Affine3A::from_scale(scale);
        if let Ok(transform) = Transform::new(map) {
            scene.add_instance(object, transform);
        }
    }
    scene
}

fn masks() -> Scene {
    let mut scene = Scene::default();
    let sphere = scene.add_object(meshes::icosphere(1));
    // 0x1ff has a ninth bit, which does not count.
    for (index, mask) in [0x01, 0x02, 0x04, 0x80, 0x00, 0xff, 0x81, 0x1ff, 0x100].into_iter().enumerate() {
        let offset = DVec3::new((index % 3) as f64, (index / 3) as f64, 0.3 * index as f64) * 1.2;
        scene.add_instance(sphere, Transform::from_translation(offset.as_vec3()));
        scene.instances[index].mask = mask;
    }
    scene
}

fn parts() -> Scene {
    let mut scene = Scene::default();
    let shifted = |mesh: Mesh, x: f64| meshes::mapped(mesh, |point| point + DVec3::new(x, 0.0, 0.0));
    let first = scene.add_object(Object {
        geometries: vec![
            shifted(meshes::icosphere(1), 0.0),
            Mesh::default(),
            shifted(meshes::icosphere(1), 1.5),
            // The same as the first part: ties by geometry.
            shifted(meshes::icosphere(1), 0.0),
        ],
    });
    let second = scene.add_object(meshes::cuboid(Vec3::splat(-0.9), Vec3::splat(0.7)));
    for (object, z) in [(second, 0.0), (first, 0.0), (first, 1.0), (second, 3.0), (first, 0.0)] {
        scene.add_instance(object, Transform::from_translation(Vec3::new(0.0, 0.0, z)));
    }
    scene
}
