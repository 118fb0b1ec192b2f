//! Instances of packed trees: to the bit the answers of the two-level structure whose objects lie in their own spaces.

use crate::levels;
use crate::support::{assert_same, placement, rays, scene};
use ropewalk::bvh::StackOrder;
use ropewalk::bvh8::{Instanced, Preset, SimdLevel};
use ropewalk::glam::{Affine3A, Quat, Vec3};
use ropewalk::two_level::TwoLevelOptions;
use ropewalk::{
    Answer, BuildError, BuildOptions, Bvh8Options, Hit, Instance, Mesh, Query, Ray, Scene, SceneError,
    TraceOptions, Transform, TransformError, TwoLevel, Walk,
};
use ropewalk_testkit::compare::same_bits;
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;

const ORDERED: Walk = Walk::Stack(StackOrder::Ordered);

/// The structure that tells what is right.
fn two_level(scene: &Scene) -> TwoLevel {
    scene.build_two_level(&TwoLevelOptions { oriented: false, ..TwoLevelOptions::default() }).unwrap()
}

fn instanced(scene: &Scene, preset: Preset) -> Instanced {
    let instanced = scene.build_instanced(&Bvh8Options { preset, level: None }).unwrap();
    assert_eq!(instanced.validate(), Ok(()));
    instanced
}

fn check(name: &str, scene: &Scene, given: &Instanced, rays: &[Ray]) {
    let two_level = two_level(scene);
    assert_eq!(given.bounds(), two_level.bounds(), "{name}");
    assert_eq!(given.report().input, two_level.report().input, "{name}");
    let plain = TraceOptions::default();
    for query in Query::EVERY {
        let expected = two_level.trace(Walk::BruteForce, query, rays, plain).unwrap();
        for (walk, options) in
            [(ORDERED, plain), (ORDERED, TraceOptions { counters: true }), (Walk::BruteForce, plain)]
        {
            let traced = given.trace(walk, query, rays, options).unwrap();
            if let Err(mismatch) = same_bits(rays, &expected, &traced, false) {
                panic!("{name}, {}, {walk}, {query}, {options:?}: {mismatch}", given.level());
            }
        }
    }
}

/// Turned, uneven, mirrored, sheared, and one that few rays see.
#[test]
fn instances_answer_as_two_levels_do() {
    let scene = scene();
    let mut rays = rays(3000, 3);
    for (index, ray) in rays.iter_mut().enumerate() {
        match index % 5 {
            0 => ray.mask = 1,
            1 => ray.mask = 2,
            2 => *ray = ray.window(0.3, 0.9),
            _ => {}
        }
    }
    rays[17] = Ray::new(Vec3::ZERO, Vec3::ZERO);
    for preset in Preset::EVERY {
        let mut tree = instanced(&scene, preset);
        for level in levels() {
            tree = tree.at(level);
            assert_eq!(tree.level(), level);
            check(&format!("{preset:?}"), &scene, &tree, &rays);
        }
    }
}

/// A flattened scene rounds triangles, instances round rays: the same hits but where rays graze.
#[test]
fn a_flattened_scene_has_nearly_the_same_hits() {
    let scene = scene();
    let rays = rays(10_000, 8);
    let (flat, tree) = (scene.build(&BuildOptions::default()).unwrap(), instanced(&scene, Preset::Balanced));
    let (mut hits, mut others) = (0, 0);
    for ray in &rays {
        let (expected, given) = (flat.closest(ray), tree.closest(ray));
        let is_same = expected.id() == given.id()
            && expected.front_face == given.front_face
            && (!expected.is_hit() || (expected.t - given.t).abs() <= 1e-4 * (1.0 + expected.t));
        others += usize::from(!is_same);
        hits += usize::from(expected.is_hit());
    }
    assert!(hits > 4000 && others < 10, "{others} of {hits}");
}

/// Objects so small and so large that directions are scaled on the way into them.
#[test]
fn tiny_and_huge_instances_are_hit() {
    let mut scene = Scene::default();
    scene.add_object(meshes::mapped(meshes::icosphere(1), |point| point * 1e-9));
    scene.add_object(meshes::mapped(meshes::icosphere(1), |point| point * 1e9));
    let mut random = Random::new(3);
    for index in 0..12u8 {
        let scale = if index % 2 == 0 { 1e9 } else { 1e-9 };
        let place = Vec3::new(f32::from(index), 0.3 * f32::from(index), 0.0);
        let turn = Quat::from_rotation_z(f32::from(index));
        let place = Affine3A::from_scale_rotation_translation(Vec3::splat(scale), turn, place);
        scene.add_instance(u32::from(index % 2), Transform::new(place).unwrap());
    }
    let mut rays = Vec::new();
    for index in 0..1500u16 {
        let target =
            Vec3::new(f32::from(index % 13), 0.3 * f32::from(index % 13), 0.0) + random.in_cube().as_vec3();
        let origin = (random.direction() * 20.0).as_vec3();
        let length = [1.0, 1e-16, 1e16][usize::from(index % 3)];
        rays.push(Ray::new(origin, (target - origin) * length));
    }
    let tree = instanced(&scene, Preset::Balanced);
    check("tiny and huge", &scene, &tree, &rays);
    assert!(rays.iter().filter(|ray| tree.any(ray)).count() > 500);
}

#[test]
fn one_ray_is_answered_like_a_batch() {
    let scene = scene();
    let mut rays = rays(5000, 6);
    for place in [0, 7, 8, 100, 4095, 4096] {
        rays[place] = Ray::new(Vec3::ZERO, Vec3::ZERO);
    }
    for level in levels() {
        let tree = instanced(&scene, Preset::Balanced).at(level);
        let single: Vec<Hit> = rays.iter().map(|ray| tree.closest(ray)).collect();
        let mut all = vec![Hit::MISS];
        for (ray, closest) in rays.iter().zip(&single).take(1000) {
            tree.all(ray, &mut all);
            assert_eq!(all.first().copied().unwrap_or(Hit::MISS).to_words(), closest.to_words());
            assert_eq!(all.len(), tree.count(ray) as usize);
        }
        for length in (0..20).chain([4095, 4096, 4097, rays.len()]) {
            let (mut hits, mut any) = (vec![Hit::MISS; length], vec![true; length]);
            tree.closest_batch(&rays, &mut hits);
            tree.any_batch(&rays, &mut any);
            assert_same(&rays, &hits, &single[..length], "a batch");
            for (index, any) in any.into_iter().enumerate() {
                assert_eq!(
                    (any, tree.any(&rays[index])),
                    (single[index].is_hit(), any),
                    "{index} of {length}"
                );
            }
        }
    }
}

#[test]
fn what_is_filtered_is_not_there() {
    let scene = scene();
    let rays = rays(800, 9);
    let (tree, expected) = (instanced(&scene, Preset::Fast), two_level(&scene));
    let keep = |hit: &Hit| !(hit.primitive_index + hit.instance_index).is_multiple_of(3);
    for query in Query::EVERY {
        let expected =
            expected.trace_filtered(ORDERED, query, &rays, TraceOptions::default(), &keep).unwrap();
        let given = tree.trace_filtered(ORDERED, query, &rays, TraceOptions::default(), &keep).unwrap();
        same_bits(&rays, &expected, &given, false).unwrap_or_else(|mismatch| panic!("{query}: {mismatch}"));
    }
}

/// Frame after frame, more and fewer, with objects without triangles among them: as if built anew.
#[test]
fn placing_is_as_good_as_building() {
    let mut scene = scene();
    let nothing = scene.add_object(Mesh::new(vec![Vec3::ZERO], vec![[0, 0, 0]]));
    let mut tree = instanced(&scene, Preset::Balanced);
    let mut random = Random::new(12);
    for (frame, count) in [40, 3, 0, 1, 700, 9, 20_000, 5].into_iter().enumerate() {
        scene.instances = (0..count)
            .map(|index| {
                let object = if index % 11 == 7 { nothing } else { index % 4 };
                let mask = if index % 13 == 5 { 0x10 } else { Ray::ALL };
                let spread = Affine3A::from_scale(Vec3::splat((count as f32).cbrt() * 0.3 + 0.1));
                let transform = Transform::new(spread * placement(&mut random)).unwrap();
                Instance { object, transform, mask }
            })
            .collect();
        tree.place(&scene.instances).unwrap();
        assert_eq!(tree.validate(), Ok(()), "{count}");
        assert_eq!(tree.instances(), scene.instances);
        let placed = scene.instances.iter().filter(|instance| instance.object != nothing).count();
        assert_eq!(tree.placed().len(), placed);
        let rays = rays(if count > 1000 { 60 } else { 400 }, frame as u64);
        check(&format!("{count} instances"), &scene, &tree, &rays);
        let anew = instanced(&scene, Preset::Balanced);
        assert_eq!((anew.report().nodes, anew.report().bytes), (tree.report().nodes, tree.report().bytes));
    }
}

/// All in one place: nothing to split by.
#[test]
fn instances_in_one_place_go_to_the_first() {
    let mut scene = Scene::from_mesh(meshes::icosphere(2));
    scene.instances = vec![Instance::new(0, Transform::IDENTITY); 3000];
    let tree = instanced(&scene, Preset::Balanced);
    for ray in rays(200, 2) {
        let hit = tree.closest(&ray);
        assert!(!hit.is_hit() || hit.instance_index == 0);
        assert_eq!(tree.count(&ray) % 3000, 0);
    }
}

#[test]
fn what_cannot_be_placed_is_refused_and_nothing_changes() {
    let scene = scene();
    let mut tree = instanced(&scene, Preset::Balanced);
    let before = (*tree.report(), tree.instances().to_vec());
    let tiny = Transform::new(Affine3A::from_scale(Vec3::splat(1e-25))).unwrap();
    let mut spoilt = scene.instances.clone();
    spoilt[5].transform = tiny;
    let transform = SceneError::Transform { instance: 5, why: TransformError::OutOfRange };
    assert_eq!(tree.place(&spoilt), Err(BuildError::Scene(transform)));
    spoilt = scene.instances.clone();
    spoilt[2].object = 4;
    let object = SceneError::NoSuchObject { instance: 2, object: 4, objects: 4 };
    assert_eq!(tree.place(&spoilt), Err(BuildError::Scene(object)));
    assert_eq!((*tree.report(), tree.instances().to_vec()), before);
    check("refused", &scene, &tree, &rays(200, 1));
}

#[test]
fn nothing_is_hit_where_there_is_nothing() {
    let rays = rays(20, 1);
    let mut nothing = Scene::default();
    nothing.add_object(Mesh::default());
    nothing.add_instance(0, Transform::IDENTITY);
    for scene in [Scene::default(), nothing] {
        let tree = instanced(&scene, Preset::Balanced);
        check("nothing", &scene, &tree, &rays);
        let mut hits = vec![Hit { t: 1.0, ..Hit::MISS }; 20];
        tree.closest_batch(&rays, &mut hits);
        assert!(hits.iter().all(|hit| hit.to_words() == Hit::MISS.to_words()));
    }
    let tree = instanced(&scene(), Preset::Fast);
    let answer = tree.trace(ORDERED, Query::Any, &[], TraceOptions::default()).unwrap().answer;
    assert!(matches!(answer, Answer::Any(hits) if hits.is_empty()));
    let why = tree.trace(Walk::Recursive, Query::Any, &rays, TraceOptions::default()).unwrap_err();
    assert!(why.to_string().contains("stack"), "{why}");
    let best = tree.at(SimdLevel::Portable).level();
    assert_eq!(best, SimdLevel::Portable);
}
