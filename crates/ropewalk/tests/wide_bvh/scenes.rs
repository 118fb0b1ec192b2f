//! Scenes, trees and rays of these tests.

use glam::{DVec3, Vec3};
use ropewalk::wide_bvh::{Collapse, Width};
use ropewalk::{BuildOptions, Builder, Bvh, FlatTriangle, Hit, Mesh, Ray, Scene, WideBvh, glam};
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;
use ropewalk_testkit::rays::{RayClass, RayMaker};

/// Every shape that a binary tree may be collapsed to.
pub(crate) const SHAPES: [(Width, Collapse); 4] = [
    (Width::Four, Collapse::Area),
    (Width::Four, Collapse::Sah),
    (Width::Eight, Collapse::Area),
    (Width::Eight, Collapse::Sah),
];

/// Every builder, with large and with small leaves.
pub(crate) fn builds() -> [BuildOptions; 5] {
    let plain = BuildOptions::default();
    let one = BuildOptions { max_leaf: 1, ..plain };
    [
        plain,
        one,
        BuildOptions { builder: Builder::SweepSah, ..one },
        BuildOptions { builder: Builder::Sbvh, duplication: 100, ..one },
        BuildOptions { reinsertion: 2, ..plain },
    ]
}

/// Scenes in which rays meet many boxes that overlap, and ones with next to nothing in them.
pub(crate) fn scenes() -> Vec<(&'static str, Scene)> {
    let mut shells = Mesh::default();
    for radius in 1..6 {
        let radius = f64::from(radius) * 0.2;
        meshes::append(&mut shells, &meshes::mapped(meshes::icosphere(2), |point| point * radius));
    }
    let mut twice = meshes::soup(150, 0.8, 4);
    meshes::append(&mut twice, &meshes::soup(150, 0.8, 4));
    let mut chain = Mesh::default();
    let mut random = Random::new(31);
    for k in 0..60 {
        let size = 0.5f64.powi(k);
        let center = DVec3::new(size, 0.3 * size, 0.1 * size);
        meshes::push(&mut chain, [(); 3].map(|()| center + random.in_cube() * (0.3 * size)));
    }
    let mut room = meshes::cuboid(Vec3::ZERO, Vec3::ONE);
    meshes::append(&mut room, &meshes::mapped(meshes::cuboid(Vec3::ZERO, Vec3::ONE), |p| p * 0.3 + 0.2));
    let mut concentric = Mesh::default();
    for _ in 0..120 {
        let size = random.in_cube().abs() + 0.05;
        meshes::push(&mut concentric, [-size, DVec3::new(size.x, size.y, -size.z), size]);
    }
    // Long and slanted: what spatial splits are for.
    let mut sticks = Mesh::default();
    for _ in 0..250 {
        let (center, along, across) = (random.in_cube(), random.direction(), random.direction());
        meshes::push(&mut sticks, [center - along, center + along, center + along + across * 0.02]);
    }
    [
        ("soup", meshes::soup(900, 0.4, 3)),
        ("shells", shells),
        ("twice", twice),
        ("chain", chain),
        ("room", room),
        ("concentric", concentric),
        ("sticks", sticks),
        ("grid", meshes::grid(1, 0.0, 24, 0.1)),
        ("one", meshes::soup(1, 0.5, 1)),
        ("six", meshes::soup(6, 0.5, 1)),
        ("nothing", Mesh::default()),
    ]
    .map(|(name, mesh)| (name, Scene::from_mesh(mesh)))
    .into()
}

/// The scene of a name.
pub(crate) fn scene(name: &str) -> Scene {
    scenes().into_iter().find(|(other, _)| *other == name).expect("a scene of that name").1
}

/// Rays of every class, `each` of a class.
pub(crate) fn rays(scene: &Scene, each: usize) -> Vec<Ray> {
    let flat = scene.flatten().unwrap();
    let closest = |rays: &[Ray]| {
        let bvh = scene.build(&BuildOptions::default()).unwrap();
        rays.iter().map(|ray| bvh.closest(ray)).collect::<Vec<Hit>>()
    };
    let maker = RayMaker::new(&flat, 5);
    RayClass::EVERY.into_iter().flat_map(|class| maker.make(class, each, &closest)).collect()
}

/// The binary tree, and the wide ones that are collapsed from it.
pub(crate) fn collapsed(scene: &Scene, options: &BuildOptions) -> (Bvh, Vec<WideBvh>) {
    let bvh = scene.build(options).unwrap();
    let wide = SHAPES.map(|(width, how)| WideBvh::from_bvh(&bvh, width, how)).into();
    (bvh, wide)
}

/// A triangle across the x axis at `x`.
pub(crate) fn across(x: f32, primitive: u32) -> FlatTriangle {
    FlatTriangle {
        v0: [x, -1.0, -1.0],
        primitive,
        v1: [x, 1.0, -1.0],
        geometry_and_mirror: 0,
        v2: [x, 0.0, 1.0],
        instance_and_mask: 0xff00_0000,
    }
}
