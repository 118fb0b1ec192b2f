//! Scenes that move: an update answers as a new build does, or refuses.

use super::support::{every, placed, rays};
use ropewalk::glam::{Affine3A, Quat, Vec3};
use ropewalk::traversal_list::{Cull, Heads, ListOptions, Starts};
use ropewalk::{Query, Scene, TraceOptions, Transform, TraversalList, UpdateError, Walk};

/// The scene a while later: its vertices have moved, and an instance has turned.
fn later(scene: &Scene, time: f32) -> Scene {
    let mut scene = scene.clone();
    for mesh in scene.objects.iter_mut().flat_map(|object| &mut object.geometries) {
        for position in &mut mesh.positions {
            *position +=
                Vec3::new((position.y * 5.0 + time).sin(), (position.z * 3.0).cos() * time, time) * 0.1;
        }
    }
    let turn = Affine3A::from_rotation_translation(Quat::from_rotation_y(time), Vec3::X * time * 0.2);
    scene.instances[1].transform = Transform::new(turn).unwrap();
    scene
}

#[test]
fn an_update_answers_as_a_new_build() {
    let start = placed();
    let rays = rays(400);
    for options in every() {
        let options = ListOptions { moving: Some(1), heads: Heads::Regular, ..options };
        let mut list = start.build_list(&options).unwrap();
        let order = |list: &TraversalList| -> Vec<i32> {
            list.elements().iter().map(|element| element.escape).collect()
        };
        let before = order(&list);
        for time in [0.3, 2.0, 0.0] {
            let scene = later(&start, time);
            let report = list.update(&scene).unwrap();
            list.validate().unwrap();
            assert!(report.moved > 1000 && report.nodes > 0);
            assert_eq!(order(&list), before, "the order of the lists stays");
            let fresh = scene.build_list(&options).unwrap();
            assert_eq!(list.bounds(), fresh.bounds());
            for query in Query::EVERY {
                let trace =
                    |list: &TraversalList| list.trace(Walk::List, query, &rays, TraceOptions::default());
                assert_eq!(trace(&list), trace(&fresh), "{query}, {options:?}, {time}");
            }
            // The heads have followed.
            let numbers: Vec<u32> = (0..rays.len() as u32).collect();
            let from: Vec<_> = numbers
                .iter()
                .zip(&rays)
                .map(|(&number, ray)| ropewalk::Ray {
                    origin: list.triangle_at(number).triangle().vertices[0],
                    ..*ray
                })
                .collect();
            let rows = list.polygon_starts(&from, &numbers);
            let starts = Starts { table: list.polygon_heads().unwrap(), rows: &rows };
            let options = TraceOptions::default();
            let started = list.trace_from(Query::Closest, &from, starts, options).unwrap();
            assert_eq!(started, list.trace(Walk::List, Query::Closest, &from, options).unwrap());
        }
        let report = list.update(&later(&start, 0.0)).unwrap();
        assert_eq!(report.moved, 0, "nothing has moved since");
    }
}

#[test]
fn what_cannot_follow_is_refused_and_stays_as_it_was() {
    let scene = placed();
    let mut list = scene.build_list(&ListOptions::default()).unwrap();
    let rays = rays(100);
    let trace = |list: &TraversalList| list.trace(Walk::List, Query::Closest, &rays, TraceOptions::default());
    let before = trace(&list);
    let mut changed = |change: &dyn Fn(&mut Scene)| {
        let mut scene = scene.clone();
        change(&mut scene);
        let error = list.update(&scene).unwrap_err();
        assert_eq!(trace(&list), before, "{error}");
        error
    };
    let fewer = changed(&|scene| scene.objects[0].geometries[0].triangles.truncate(100));
    assert!(matches!(fewer, UpdateError::OtherCount { .. }), "{fewer}");
    let flat = changed(&|scene| scene.objects[0].geometries[0].positions[0] = Vec3::NAN);
    assert!(matches!(flat, UpdateError::OtherCount { .. }), "{flat}");
    let torn = changed(&|scene| scene.objects[0].geometries[0].triangles.last_mut().unwrap()[0] = 0);
    assert!(matches!(torn, UpdateError::OtherTriangle { .. }), "{torn}");
    let gone = changed(&|scene| scene.instances[1].object = 77);
    assert!(matches!(gone, UpdateError::Scene(_)), "{gone}");
    let masked = changed(&|scene| scene.instances[2].mask = 1);
    assert!(matches!(masked, UpdateError::OtherTriangle { .. }), "{masked}");
    let one_sided = ListOptions { cull: Cull::Exact, ..ListOptions::default() };
    let mut one_sided = scene.build_list(&one_sided).unwrap();
    assert!(one_sided.update(&scene).unwrap_err().to_string().contains("cull=none"));
}
