//! Scenes with cameras, and the structures in which they are drawn.

use glam::{Affine3A, Quat, Vec3};
use ropewalk::bvh8::{Bvh8Options, Preset};
use ropewalk::kd_tree::KdOptions;
use ropewalk::two_level::{BottomSpec, Bottoms, Opening, TwoLevelOptions};
use ropewalk::{BuildOptions, Builder, ListOptions, Mesh, Scene, StructureSpec, Transform, WideOptions};
use ropewalk_scene::Camera;

/// The structures in which scenes are drawn.
pub(super) fn specs() -> Vec<StructureSpec> {
    let two_level =
        |bottoms, oriented, opening| StructureSpec::TwoLevel(TwoLevelOptions { bottoms, oriented, opening });
    vec![
        StructureSpec::Bvh(BuildOptions { builder: Builder::Sbvh, ..BuildOptions::default() }),
        StructureSpec::WideBvh(WideOptions::default()),
        StructureSpec::List(ListOptions::BEST),
        StructureSpec::KdTree(KdOptions::default()),
        StructureSpec::TwoLevel(TwoLevelOptions::default()),
        two_level(Bottoms::Each(BottomSpec::List(ListOptions::BEST)), true, Opening::Never),
        two_level(Bottoms::Mixed, false, Opening::ByCost(3)),
        // For the CPU alone.
        StructureSpec::Instanced(Bvh8Options { preset: Preset::High, level: None }),
    ]
}

pub(super) fn camera(eye: Vec3, target: Vec3, fov_degrees: f32) -> Camera {
    Camera {
        name: String::new(),
        position: eye,
        forward: target - eye,
        up: Vec3::Y,
        vertical_fov: fov_degrees.to_radians(),
    }
}

/// A ball of triangles, which share their corners.
pub(super) fn ball(rings: u32) -> Mesh {
    let mut points = Vec::new();
    for ring in 0..=rings {
        for step in 0..2 * rings {
            let (a, b) = (
                ring as f32 / rings as f32 * std::f32::consts::PI,
                step as f32 / rings as f32 * std::f32::consts::PI,
            );
            points.push(Vec3::new(a.sin() * b.cos(), a.cos(), a.sin() * b.sin()));
        }
    }
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for step in 0..2 * rings {
            let at = |ring: u32, step: u32| ring * 2 * rings + step % (2 * rings);
            let [a, b, c, d] =
                [at(ring, step), at(ring, step + 1), at(ring + 1, step), at(ring + 1, step + 1)];
            triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    Mesh::new(points, triangles)
}

/// A fixed sequence of numbers from 0 to 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / 16_777_216.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }
}

/// Triangles of all sizes around the origin, through one another.
pub(super) fn litter(count: usize, largest: f32, seed: u64) -> Mesh {
    let mut numbers = Numbers(seed);
    let mut points = Vec::new();
    for _ in 0..count {
        let place = numbers.vector() * 2.0;
        let size = largest * 10.0_f32.powf(-4.0 * numbers.next());
        points.extend([0; 3].map(|_| place + numbers.vector() * size));
    }
    Mesh::new(points, (0..count as u32).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]).collect())
}

/// Several placements of two objects: turned, uneven, mirrored.
pub(super) fn mirrors() -> Scene {
    let mut scene = Scene::default();
    let objects = [scene.add_object(ball(6)), scene.add_object(litter(40, 1.0, 3))];
    let mut numbers = Numbers(11);
    for step in 0..12u8 {
        let sign = if step % 2 == 0 { -1.0 } else { 1.0 };
        let scale = Vec3::new(sign * (0.3 + numbers.next()), 0.2 + numbers.next(), 0.5);
        let turn = Quat::from_euler(glam::EulerRot::XYZ, f32::from(step), numbers.next() * 6.0, 0.3);
        let place = Affine3A::from_scale_rotation_translation(scale, turn, numbers.vector() * 3.0);
        scene.add_instance(objects[usize::from(step % 2)], Transform::new(place).unwrap());
    }
    scene
}

/// The scenes of all tests, each with a camera.
pub(super) fn scenes() -> Vec<(&'static str, Scene, Camera)> {
    let from = |z: f32| camera(Vec3::new(0.3, 0.4, z), Vec3::ZERO, 40.0);
    let floor = Mesh::new(
        vec![
            Vec3::new(-1e4, -1.0, -1e4),
            Vec3::new(-1e4, -1.0, 1e4),
            Vec3::new(1e4, -1.0, 1e4),
            Vec3::new(1e4, -1.0, -1e4),
        ],
        vec![[0, 1, 2], [0, 2, 3]],
    );
    let mut apart = Scene::from_mesh(ball(10));
    let far = apart.add_object(litter(60, 0.5, 9));
    apart.add_instance(far, Transform::from_translation(Vec3::new(4e5, 0.0, -2e5)));
    let tiny = Transform::new(Affine3A::from_scale(Vec3::splat(1e-6))).unwrap();
    let mut small = Scene::default();
    let object = small.add_object(mirrors().objects.swap_remove(1));
    small.add_instance(object, tiny);
    vec![
        ("closed", Scene::from_mesh(ball(24)), from(3.0)),
        ("within", Scene::from_mesh(ball(24)), camera(Vec3::new(0.2, 0.1, 0.3), Vec3::Z, 100.0)),
        ("at a corner", Scene::from_mesh(ball(8)), camera(Vec3::Y, Vec3::ZERO, 90.0)),
        ("on an edge", Scene::from_mesh(ball(8)), camera(Vec3::Y * 0.5, Vec3::Y, 170.0)),
        ("floor", Scene::from_mesh(floor), camera(Vec3::ZERO, Vec3::new(1.0, -0.1, 0.4), 90.0)),
        (
            "litter",
            Scene::from_mesh(litter(3000, 3.0, 1)),
            camera(Vec3::ZERO, Vec3::new(0.1, 0.2, -1.0), 80.0),
        ),
        ("litter from outside", Scene::from_mesh(litter(3000, 1.0, 2)), from(9.0)),
        ("mirrors", mirrors(), from(8.0)),
        ("among mirrors", mirrors(), camera(Vec3::new(0.1, 0.0, 0.2), Vec3::new(-1.0, 0.3, -0.5), 130.0)),
        ("huge", Scene::from_mesh(litter(100, 1e9, 5)), camera(Vec3::ZERO, Vec3::NEG_Z, 60.0)),
        ("tiny", small, camera(Vec3::new(0.0, 0.0, 4e-6), Vec3::ZERO, 40.0)),
        ("far apart", apart.clone(), from(4.0)),
        ("far away", apart, camera(Vec3::new(4e5, 1.0, -2e5 + 3.0), Vec3::new(4e5, 0.0, -2e5), 40.0)),
        ("nothing", Scene::default(), from(1.0)),
        ("behind", Scene::from_mesh(ball(8)), camera(Vec3::Z * 3.0, Vec3::Z * 9.0, 40.0)),
    ]
}

/// Squares whose corners lie where the samples of a picture of 61 rows do, as near as rounding lets them: every ray meets an edge
/// or a corner.
pub(super) fn grid() -> (Scene, Camera) {
    let side = 64_u16;
    let place = |step: u16| (f32::from(step) - 32.0) * (2.0 / 61.0);
    let points =
        (0..side).flat_map(|y| (0..side).map(move |x| Vec3::new(place(x), place(y), -1.0))).collect();
    let mut triangles = Vec::new();
    for y in 0..u32::from(side) - 1 {
        for x in 0..u32::from(side) - 1 {
            let at = |x: u32, y: u32| y * u32::from(side) + x;
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)];
            triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    (Scene::from_mesh(Mesh::new(points, triangles)), camera(Vec3::ZERO, Vec3::NEG_Z, 90.0))
}
