//! Scenes, trees and rays.

use ropewalk::catalogue::TrailOptions;
use ropewalk::glam::{DQuat, DVec3, Vec3};
use ropewalk::kd_tree::{Depth, KdOptions};
use ropewalk::{Mesh, Ray, Scene, Walk};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;

/// A room with slanted beams and many small things: boxes that are much larger than what is in them.
pub(crate) fn interior() -> Mesh {
    let mut random = Random::new(31);
    let mut mesh = meshes::cuboid(Vec3::new(-5.0, -1.0, -4.0), Vec3::new(5.0, 3.0, 4.0));
    for _ in 0..24 {
        let turn = DQuat::from_axis_angle(random.direction(), random.between(0.0, 3.0));
        let place =
            DVec3::new(random.between(-4.0, 4.0), random.between(0.0, 2.0), random.between(-3.0, 3.0));
        let beam = meshes::cuboid(Vec3::new(-3.0, -0.05, -0.1), Vec3::new(3.0, 0.05, 0.1));
        meshes::append(&mut mesh, &meshes::mapped(beam, |point| turn * point + place));
    }
    for _ in 0..30 {
        let place =
            DVec3::new(random.between(-4.5, 4.5), random.between(-0.9, 2.5), random.between(-3.5, 3.5));
        let size = random.between(0.05, 0.25);
        let ball = meshes::mapped(meshes::icosphere(2), |point| point * size + place);
        meshes::append(&mut mesh, &ball);
    }
    mesh
}

/// Boxes along the axes on a grid: every plane of the tree is the face of many, and rays meet planes together.
pub(crate) fn blocks() -> Mesh {
    let mut mesh = Mesh::default();
    for index in 0..125_u8 {
        let place = [index % 5, index / 5 % 5, index / 25].map(f32::from);
        let low = Vec3::from(place) * 2.0 - 5.0;
        meshes::append(&mut mesh, &meshes::cuboid(low, low + 1.0));
    }
    mesh
}

/// Everything odd: the cases of the conformance suite, and what is hard for trees of planes.
pub(crate) fn scenes() -> Vec<(&'static str, Scene)> {
    let mut scenes: Vec<(&str, Scene)> =
        Case::every().into_iter().map(|case| (case.name, case.scene)).collect();
    scenes.push(("interior", Scene::from_mesh(interior())));
    scenes.push(("blocks", Scene::from_mesh(blocks())));
    for (name, size) in [("huge interior", 1e11), ("tiny interior", 1e-30)] {
        scenes.push((name, Scene::from_mesh(meshes::mapped(interior(), |point| point * size))));
    }
    let mut random = Random::new(12);
    let one = [DVec3::ZERO, DVec3::X, DVec3::new(0.3, 1.0, 0.4)];
    let mut add = |name, triangles: Vec<[DVec3; 3]>| {
        let mut mesh = Mesh::default();
        triangles.into_iter().for_each(|triangle| meshes::push(&mut mesh, triangle));
        scenes.push((name, Scene::from_mesh(mesh)));
    };
    add("the same triangle 2,000 times", vec![one; 2000]);
    add("halving sizes at one point", (0..100).map(|k| one.map(|corner| corner * 0.5f64.powi(k))).collect());
    add(
        "concentric",
        (1..200).map(|k| one.map(|corner| (corner - DVec3::splat(0.3)) * f64::from(k))).collect(),
    );
    let needle = |_| {
        let (from, along) = (random.in_cube(), random.direction() * 3.0);
        [from, from + along, from + along * 0.5 + random.in_cube() * 1e-4]
    };
    add("needles", (0..500).map(needle).collect());
    scenes
}

/// The ways to build that differ most.
pub(crate) fn builds() -> Vec<KdOptions> {
    let plain = KdOptions::default();
    vec![
        plain,
        // Leaves as small as they get.
        KdOptions { intersection_cost: 10_000, traversal_cost: 100, ..plain },
        KdOptions { max_depth: Depth::Cap(3), ..plain },
        KdOptions { empty_bonus: 90, duplication: 2, ..plain },
    ]
}

/// Every walk through the cells.
pub(crate) fn walks() -> Vec<Walk> {
    let trail = |short_stack| Walk::RestartTrail(TrailOptions { short_stack, ..TrailOptions::default() });
    let short = |entries| Walk::ShortStack { entries };
    vec![
        Walk::default(),
        trail(0),
        trail(1),
        trail(4),
        Walk::KdRestart,
        Walk::KdBacktrack,
        short(1),
        short(3),
        short(16),
        Walk::Ropes,
    ]
}

/// Rays at random, every fourth along an axis.
pub(crate) fn rays(seed: u64, count: usize) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let mut ray = |index: usize| {
        let target = random.in_cube();
        let origin = if index.is_multiple_of(3) { random.in_cube() } else { random.direction() * 4.0 };
        let axis = DVec3::AXES[index % 3] * if index.is_multiple_of(8) { -1.0 } else { 1.0 };
        let dir = if index.is_multiple_of(4) { axis } else { target - origin };
        Ray::new(origin.as_vec3(), dir.as_vec3())
    };
    (0..count).map(&mut ray).collect()
}
