//! Shapes that strain the triangle test, the boxes, and the depth of a tree.

use super::{Case, Recipe};
use crate::meshes;
use crate::random::Random;
use crate::rays::RayClass;
use glam::{DVec3, Vec3};
use ropewalk::{Mesh, Ray, Scene};

pub(super) const RECIPES: &[Recipe] = &[
    ("soup", |name| Case::new(name, "1,500 random triangles", Scene::from_mesh(meshes::soup(1500, 0.3, 11)))),
    ("big-soup-triangles", |name| {
        Case::new(name, "300 triangles that all overlap", Scene::from_mesh(meshes::soup(300, 2.0, 12)))
    }),
    ("sphere", |name| {
        Case::new(name, "a closed sphere: none escapes", Scene::from_mesh(meshes::icosphere(3)))
            .closed_around(DVec3::ZERO, 0.9)
            .entered_into(DVec3::ZERO, 0.9)
    }),
    ("needles", |name| Case::new(name, "triangles a million times longer than wide", needles())),
    ("flat-fan", |name| {
        Case::new(name, "64 blades about one vertex, in a plane", Scene::from_mesh(meshes::fan(64, 0.0)))
    }),
    ("cone", |name| {
        Case::new(name, "64 blades about one vertex, up and down", Scene::from_mesh(meshes::fan(64, 0.8)))
    }),
    ("boxes", |name| {
        Case::new(name, "a block of touching boxes: rays run along their faces", boxes())
            .closed_around(DVec3::splat(1.5), 0.49)
            .entered_into(DVec3::splat(1.5), 1.4)
    }),
    ("room", |name| {
        Case::new(name, "a box seen from inside, axis-aligned", room()).closed_around(DVec3::splat(0.5), 0.45)
    }),
    ("chain", |name| {
        Case::new(name, "triangles of sizes 2^-k: a tree as deep as it may be", chain())
            .with_rays(RayClass::Random, along_the_chain())
            .with_depth_caps(&[63, 31, 8, 2])
            .with_chains(&[31, 32, 63, 64])
    }),
    ("diagonals", |name| {
        Case::new(name, "rays that see fronts whose normals are of the ray's own sextant", diagonals())
            .with_rays(RayClass::Random, along_diagonals())
    }),
    ("concentric", |name| {
        Case::new(name, "all centres equal: no plane separates them", concentric()).with_depth_caps(&[63, 3])
    }),
];

fn needles() -> Scene {
    let mut random = Random::new(21);
    let mut mesh = Mesh::default();
    for _ in 0..300 {
        let (center, along, across) = (random.in_cube(), random.direction(), random.direction());
        // Half of them point along an axis, where boxes are as thin as they are.
        let along = if random.one_in(2) { random.pick(&[DVec3::X, DVec3::Y, DVec3::Z]) } else { along };
        meshes::push(&mut mesh, [center - along, center + along, center + along + across * 2e-6]);
    }
    Scene::from_mesh(mesh)
}

fn boxes() -> Scene {
    let mut mesh = Mesh::default();
    for index in 0..27 {
        let low = Vec3::new((index % 3) as f32, (index / 3 % 3) as f32, (index / 9) as f32);
        meshes::append(&mut mesh, &meshes::cuboid(low, low + 1.0));
    }
    Scene::from_mesh(mesh)
}

fn room() -> Scene {
    let mut mesh = Mesh::default();
    // Walls of many triangles each; the corners of the cells are the same floats on both sides of an edge.
    for axis in 0..3 {
        for height in [0.0, 1.0] {
            meshes::append(&mut mesh, &meshes::grid(axis, height, 8, 0.125));
        }
    }
    Scene::from_mesh(mesh)
}

fn chain() -> Scene {
    let mut mesh = Mesh::default();
    let mut random = Random::new(31);
    for k in 0..100 {
        let size = 0.5f64.powi(k);
        // Towards zero, which f32 resolves ever finer; each is far from all smaller ones compared with its size.
        let center = DVec3::new(size, 0.3 * size, 0.1 * size);
        meshes::push(&mut mesh, [(); 3].map(|()| center + random.in_cube() * (0.3 * size)));
    }
    Scene::from_mesh(mesh)
}

/// Rays along the line on which the triangles lie, both ways, so that many boxes are hit at once.
fn along_the_chain() -> Vec<Ray> {
    let mut random = Random::new(33);
    let line = DVec3::new(1.0, 0.3, 0.1);
    let mut ray = |index: usize| {
        let aside = random.in_cube() * 0.2 * 0.5f64.powi(random.below(40) as i32);
        if index.is_multiple_of(2) {
            Ray::new(Vec3::ZERO, (line + aside).as_vec3())
        } else {
            Ray::new((line * 3.0).as_vec3(), (aside - line * 3.0).as_vec3())
        }
    };
    (0..192).map(&mut ray).collect()
}

/// Normals at the edges of the sets of directions that traversal lists have: a triangle with one of them is seen by some
/// rays of the set to which its normal belongs itself, or by none of them but almost.
const NORMALS: [[i32; 3]; 7] =
    [[1, 1, 1], [10, 9, 9], [3, 2, 2], [2, 1, 1], [201, 100, 100], [1, 1, 0], [1, 0, 0]];

/// Where the triangles of [`diagonals`] are, with their normals. Whole numbers, so that f32 has them exactly.
fn places() -> impl Iterator<Item = (DVec3, DVec3)> {
    let turned = |normal: [i32; 3], turn: usize, signs: usize| {
        let normal = DVec3::from_array(normal.map(f64::from));
        DVec3::from_array(std::array::from_fn(|axis| {
            let sign = if signs >> axis & 1 == 0 { 1.0 } else { -1.0 };
            sign * normal[(axis + turn) % 3]
        }))
    };
    (0..24 * NORMALS.len()).map(move |index| {
        let normal = turned(NORMALS[index / 24], index % 3, index / 3 % 8);
        let place = [index % 6, index / 6 % 6, index / 36].map(|step| 3.0 * step as f64);
        (DVec3::from_array(place), normal)
    })
}

fn diagonals() -> Scene {
    let mut mesh = Mesh::default();
    for (place, normal) in places() {
        // Of the axes the one that is farthest from the normal: the other two edges are whole numbers again.
        let across = normal.cross(if normal.x.abs() < normal.y.abs() { DVec3::X } else { DVec3::Y });
        let along = normal.cross(across);
        let (across, along) = (halved(across), halved(along));
        meshes::push(&mut mesh, [place - across - along, place + across - along, place + along]);
    }
    Scene::from_mesh(mesh)
}

/// Halved until it is no longer than 1, so that nothing is rounded that was exact.
fn halved(mut edge: DVec3) -> DVec3 {
    while edge.length_squared() > 1.0 {
        edge *= 0.5;
    }
    edge
}

/// Rays at the middle of each triangle, along the diagonals of sextants and octants and beside them.
fn along_diagonals() -> Vec<Ray> {
    let mut random = Random::new(34);
    let mut rays = Vec::new();
    for (place, _) in places() {
        for _ in 0..8 {
            let mut dir = DVec3::from_array(std::array::from_fn(|_| {
                random.pick(&[1.0, -1.0, 0.9375, -0.9375, 0.984_375, -0.984_375])
            }));
            if random.one_in(8) {
                dir[random.below(3)] = 0.0;
            }
            // Near, before the next triangle can be in the way.
            rays.push(Ray::new((place - dir * 0.5).as_vec3(), dir.as_vec3()));
        }
    }
    rays
}

fn concentric() -> Scene {
    let mut mesh = Mesh::default();
    let mut random = Random::new(32);
    for _ in 0..150 {
        // The box is -size..size to the bit, whatever lies within: its centre is exactly zero.
        let size = random.in_cube().abs().as_vec3().max(Vec3::splat(0.05)).as_dvec3();
        let inner = (random.in_cube(), random.in_cube());
        let second = DVec3::new(size.x, size.y, size.z * inner.0.z);
        let third = DVec3::new(size.x * inner.1.x, size.y * inner.1.y, size.z);
        meshes::push(&mut mesh, [-size, second, third]);
    }
    Scene::from_mesh(mesh)
}
