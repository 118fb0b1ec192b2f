//! What a frame must be, on easy and on hard objects.

use super::*;
use crate::{Aabb, Mesh, Object, Scene, Transform};
use glam::{Affine3A, EulerRot};

fn turned(step: u32) -> Mat3 {
    let angle = step as f32;
    Mat3::from_euler(EulerRot::ZXY, 0.9 * angle + 0.2, 2.1 * angle + 0.4, 1.3 * angle - 0.1)
}

/// The triangles of a box of this size around zero, turned.
fn block(size: Vec3, turn: Mat3) -> Mesh {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32) - 0.5;
    let positions = (0..8).map(|i| turn * (corner(i) * size)).collect();
    let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new(positions, triangles)
}

fn flat(mesh: Mesh) -> Vec<FlatTriangle> {
    Scene::from_mesh(mesh).flatten().unwrap().triangles
}

fn of_vertices(triangles: &[[Vec3; 3]]) -> Vec<FlatTriangle> {
    let flat = |&[a, b, c]: &[Vec3; 3]| FlatTriangle {
        v0: a.into(),
        primitive: 0,
        v1: b.into(),
        geometry_and_mirror: 0,
        v2: c.into(),
        instance_and_mask: 1 << 24,
    };
    triangles.iter().map(flat).collect()
}

fn bounds_in(frame: Mat3, triangles: &[FlatTriangle]) -> Aabb {
    let vertices = triangles.iter().flat_map(|triangle| triangle.triangle().vertices);
    Aabb::of_points(vertices.filter(|vertex| vertex.is_finite()).map(|vertex| frame * vertex))
}

fn assert_is_rotation(frame: Mat3) {
    assert!(frame.is_finite());
    assert!((frame.as_dmat3().determinant() - 1.0).abs() < 1e-5, "{frame}");
    assert!((frame * frame.transpose()).abs_diff_eq(Mat3::IDENTITY, 1e-5), "{frame}");
}

#[test]
fn thin_boxes_are_found() {
    for size in [Vec3::new(10.0, 1.0, 0.1), Vec3::new(5.0, 4.0, 0.01), Vec3::new(8.0, 0.1, 0.1), Vec3::ONE] {
        for step in 0..40 {
            let triangles = flat(block(size, turned(step)));
            let frame = frame_of(&triangles);
            assert_is_rotation(frame);
            let area = bounds_in(frame, &triangles).half_area();
            let expected = Aabb::new(Vec3::ZERO, size).half_area();
            assert!((area / expected - 1.0).abs() < 0.01, "{size} {step}: {area} instead of {expected}");
        }
    }
}

#[test]
fn what_is_aligned_stays_so() {
    for size in [Vec3::ONE, Vec3::new(3.0, 1.0, 0.0), Vec3::new(1.0, 20.0, 0.3)] {
        assert_eq!(frame_of(&flat(block(size, Mat3::IDENTITY))), Mat3::IDENTITY);
    }
    // A ball has no axes.
    let at = |u: f32, v: f32| Vec3::new(u.sin() * v.cos(), u.cos(), u.sin() * v.sin());
    let patch = |i: usize| [(i / 60) as f32 * 0.05, (i % 60) as f32 * 0.105];
    let ball = (0..3780).map(patch).map(|[u, v]| [at(u, v), at(u + 0.05, v), at(u, v + 0.105)]);
    assert_eq!(frame_of(&of_vertices(&ball.collect::<Vec<_>>())), Mat3::IDENTITY);
}

#[test]
fn objects_with_little_to_measure_have_frames() {
    let nan = Vec3::splat(f32::NAN);
    let (a, b, c) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, -1.0, 5.0), Vec3::new(0.5, 0.25, 9.0));
    let on_line = |i: f32| a + (b - a) * i;
    let none: [&[[Vec3; 3]]; 5] =
        [&[], &[[a; 3]], &[[nan; 3]], &[[a, b, nan]], &[[Vec3::splat(f32::INFINITY); 3]]];
    for triangles in none {
        assert_eq!(frame_of(&of_vertices(triangles)), Mat3::IDENTITY, "{triangles:?}");
    }
    let some: [&[[Vec3; 3]]; 6] = [
        &[[a, b, c]],
        &[[a, b, c], [nan, b, c]],
        &[[a, b, b]],
        &[[on_line(0.0), on_line(0.5), on_line(1.0)], [on_line(2.0), on_line(3.0), on_line(7.0)]],
        &[[a * 1e30, b * 1e30, c * 1e30]],
        &[[a * 1e-30, b * 1e-30, c * 1e-30]],
    ];
    for triangles in some {
        let triangles = of_vertices(triangles);
        let frame = frame_of(&triangles);
        assert_is_rotation(frame);
        assert_ne!(frame, Mat3::IDENTITY);
        let [turned, own] =
            [frame, Mat3::IDENTITY].map(|frame| bounds_in(frame, &triangles).size().as_dvec3());
        assert!(refine::half_area(turned) < refine::half_area(own), "{triangles:?}");
    }
    let largest = of_vertices(&[[Vec3::MAX, Vec3::MIN, Vec3::new(f32::MAX, 0.0, 0.0)]]);
    assert_is_rotation(frame_of(&largest));
    let smallest = of_vertices(&[[Vec3::ZERO, Vec3::splat(1e-45), Vec3::X * 3e-45]]);
    assert_is_rotation(frame_of(&smallest));
}

/// The search goes by few points; what it promises must hold for all.
#[test]
fn a_frame_is_never_worse_than_none() {
    for step in 0..60_u32 {
        // A bent and twisted band with a thick end.
        let at = |i: u32, j: u32| {
            let (along, across) = (i as f32 * 0.1, j as f32 * 0.2);
            let twist = Mat3::from_rotation_x(along * 0.3);
            turned(step) * (twist * Vec3::new(0.0, across, (along * 0.7).sin() * 0.3) + Vec3::X * along)
        };
        let band = (0..120 + step).map(|i| [at(i % 60, 0), at(i % 60 + 1, i / 60), at(i % 60, 2)]);
        let triangles = of_vertices(&band.collect::<Vec<_>>());
        let frame = frame_of(&triangles);
        assert_is_rotation(frame);
        let [area, own] = [frame, Mat3::IDENTITY].map(|frame| bounds_in(frame, &triangles).half_area());
        assert!(area < own || frame == Mat3::IDENTITY, "{step}: {area} {own}");
    }
}

/// Parts that lie askew in their own space, placed as they are: the boxes in the scene shrink.
#[test]
fn boxes_in_the_scene_shrink() {
    let mut areas = [0.0; 2];
    for step in 0..79 {
        let size = Vec3::new(4.0, 0.4 + 0.01 * step as f32, 0.2);
        let object = Object::from(block(size, turned(step)));
        let triangles = flat(object.geometries[0].clone());
        let frame = frame_of(&triangles);
        // Some of the places undo the part's turn by chance, some do the opposite.
        let place = if step % 2 == 0 { turned(step).transpose() } else { turned(7 * step) };
        let own = Transform::new(Affine3A::from_mat3(place)).unwrap().bounds(&object.bounds());
        let from_frame = Transform::new(Affine3A::from_mat3(place * frame.transpose())).unwrap();
        let turned = from_frame.bounds(&bounds_in(frame, &triangles));
        let both = Aabb::new(own.min.max(turned.min), own.max.min(turned.max));
        areas[0] += own.half_area();
        areas[1] += both.half_area();
    }
    assert!(areas[1] < 0.6 * areas[0], "{areas:?}");
}
