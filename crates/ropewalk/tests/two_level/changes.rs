//! Scenes that change: each frame equals a scene that is built from scratch.

use super::support::{assert_same, closest, every, placement, rays, scene, shapes};
use ropewalk::bvh::StackOrder;
use ropewalk::glam::Vec3;
use ropewalk::two_level::{BottomSpec, Bottoms, TopUpdate, TwoLevelOptions};
use ropewalk::{BuildOptions, Hit, Mesh, NoMonitor, Object, Ray, Scene, Transform, TwoLevel, Walk};
use ropewalk_testkit::random::Random;

const ORDERED: Walk = Walk::Stack(StackOrder::Ordered);

/// The hits of the same scene, built from scratch. Instances keep their indices: those that were removed are hidden by a
/// mask that no ray has.
fn from_scratch(scene: &Scene, options: &TwoLevelOptions, rays: &[Ray]) -> Vec<Hit> {
    closest(&scene.build_two_level(options).unwrap(), ORDERED, rays)
}

#[test]
fn every_frame_is_as_if_built_anew() {
    for options in every() {
        let mut plain = scene();
        let mut two_level = plain.build_two_level(&options).unwrap();
        let mut random = Random::new(6);
        for frame in 0..24 {
            for _ in 0..4 {
                let instance = random.below(40);
                let to_world = placement(&mut random);
                two_level.set_transform(instance as u32, to_world).unwrap();
                plain.instances[instance].transform = Transform::new(to_world).unwrap();
            }
            let update = [TopUpdate::Rebuild, TopUpdate::Refit, TopUpdate::Restructure][frame % 3];
            let report = two_level.commit(update).unwrap();
            assert_eq!(report.is_rebuilt, update == TopUpdate::Rebuild);
            assert!((1..=4).contains(&report.placed) && report.cost > 0.0);
            two_level.validate().unwrap();
            let rays = rays(500, frame as u64);
            let given = closest(&two_level, ORDERED, &rays);
            assert_same(&rays, &given, &from_scratch(&plain, &options, &rays), "a frame");
        }
    }
}

#[test]
fn objects_and_instances_come_and_go() {
    let options = TwoLevelOptions::default();
    let mut plain = scene();
    let mut two_level = plain.build_two_level(&options).unwrap();
    let rays = rays(2000, 4);
    let check = |two_level: &TwoLevel, plain: &Scene, what: &str| {
        two_level.validate().unwrap();
        let given = closest(two_level, ORDERED, &rays);
        assert_same(&rays, &given, &from_scratch(plain, &options, &rays), what);
    };
    // Nothing is seen before the commit.
    let before = closest(&two_level, ORDERED, &rays);
    for instance in [3, 11, 12] {
        two_level.remove_instance(instance).unwrap();
        plain.instances[instance as usize].mask = 0;
    }
    assert_same(&rays, &closest(&two_level, ORDERED, &rays), &before, "not committed");
    two_level.commit(TopUpdate::Refit).unwrap();
    assert_eq!(two_level.top().nodes().len(), 2 * 37 - 1);
    check(&two_level, &plain, "instances went");

    let mut random = Random::new(2);
    let object: Object = ropewalk_testkit::meshes::soup(150, 0.5, 9).into();
    let index = two_level.add_object(&object, &NoMonitor).unwrap();
    assert_eq!(index, plain.add_object(object));
    for _ in 0..5 {
        let to_world = placement(&mut random);
        let instance = two_level.add_instance(index, to_world, Ray::ALL).unwrap();
        assert_eq!(instance, plain.add_instance(index, Transform::new(to_world).unwrap()));
    }
    two_level.commit(TopUpdate::Rebuild).unwrap();
    check(&two_level, &plain, "an object came");

    let shape: Object = shapes().swap_remove(2).into();
    two_level.replace_object(0, &shape, &NoMonitor).unwrap();
    plain.objects[0] = shape;
    two_level.commit(TopUpdate::Restructure).unwrap();
    check(&two_level, &plain, "an object has another shape");
    assert_eq!(two_level.objects().len(), 5);

    for instance in 40..45 {
        two_level.remove_instance(instance).unwrap();
        plain.instances[instance as usize].mask = 0;
    }
    two_level.remove_object(index).unwrap();
    two_level.set_mask(1, 0).unwrap();
    plain.instances[1].mask = 0;
    two_level.commit(TopUpdate::Rebuild).unwrap();
    check(&two_level, &plain, "an object went");
    assert!(two_level.objects()[index as usize].is_none());
}

/// The boxes of a tree follow an object that deforms; how much worse they fit is said.
#[test]
fn a_deforming_object_is_refitted() {
    for bottom in every().into_iter().filter(|options| options.bottoms != Bottoms::Mixed) {
        let mut plain = scene();
        let mut two_level = plain.build_two_level(&bottom).unwrap();
        let mut shape = plain.objects[2].clone();
        for position in &mut shape.geometries[0].positions {
            *position += Vec3::new(0.0, 0.4 * (position.x * 7.0).sin(), 0.0);
        }
        let refitted = two_level.refit_object(2, &shape);
        if let Bottoms::Each(BottomSpec::KdTree(_)) = bottom.bottoms {
            let text = refitted.unwrap_err().to_string();
            assert!(text.contains("object 2") && text.contains("kd-tree"), "{text}");
            continue;
        }
        let report = refitted.unwrap();
        assert!(report.drift() >= 1.0, "{report:?}");
        two_level.commit(TopUpdate::Refit).unwrap();
        two_level.validate().unwrap();
        plain.objects[2] = shape;
        // Another frame may be the best for the new shape, so these are compared without.
        if !bottom.oriented {
            let rays = rays(2000, 9);
            let given = closest(&two_level, ORDERED, &rays);
            assert_same(&rays, &given, &from_scratch(&plain, &bottom, &rays), "a deformed object");
        }
    }
}

#[test]
fn a_tree_that_fits_badly_says_so() {
    let grid = |height: f32| {
        let mut mesh = ropewalk_testkit::meshes::grid(1, 0.0, 24, 0.1);
        for (index, position) in mesh.positions.iter_mut().enumerate() {
            position.y += height * (index % 7) as f32;
        }
        mesh
    };
    let mut bvh = Scene::from_mesh(grid(0.0)).build(&BuildOptions::default()).unwrap();
    let mut moved: Mesh = grid(0.0);
    let count = moved.positions.len();
    // Every vertex goes to the place of another one far away.
    let places: Vec<Vec3> = (0..count).map(|index| moved.positions[index * 37 % count]).collect();
    moved.positions = places;
    if let Ok(report) = bvh.refit(&Scene::from_mesh(moved)) {
        assert!(report.drift() > 2.0, "{report:?}");
    }
    let report = bvh.refit(&Scene::from_mesh(grid(0.5))).unwrap();
    assert!(report.cost > 0.0);
    bvh.validate().unwrap();
}
