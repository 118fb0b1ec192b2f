//! A tree that follows its scene is as good as one that is built anew: valid, with the same report of the input, and to the bit
//! with the same answers.

use crate::hits::check;
use crate::scenes::{builds, rays, scenes};
use ropewalk::bvh8::{Preset, SimdLevel};
use ropewalk::glam::{Affine3A, Quat, Vec3};
use ropewalk::{
    Bvh8, Bvh8Options, FlatTriangle, Instance, Mesh, Object, Query, Scene, Transform, UpdateError,
};
use ropewalk_testkit::meshes;

/// The same meshes, every vertex taken elsewhere, those with the same coordinates to the same place.
fn bent(scene: &Scene, phase: f32) -> Scene {
    let mut scene = scene.clone();
    for position in scene
        .objects
        .iter_mut()
        .flat_map(|object| &mut object.geometries)
        .flat_map(|mesh| &mut mesh.positions)
    {
        let p = *position;
        *position += Vec3::new((p.y * 3.0 + phase).sin(), (p.z * 2.0 - phase).cos(), p.x * p.y * phase) * 0.2;
    }
    scene
}

/// A tree of each preset that can be refitted, at each level.
fn packed(scene: &Scene) -> Vec<(Preset, SimdLevel, Bvh8)> {
    crate::packed(scene).into_iter().filter(|(preset, ..)| preset.can_refit()).collect()
}

/// By names and corners, in an order of their own.
fn sorted(mut triangles: Vec<FlatTriangle>) -> Vec<FlatTriangle> {
    triangles.sort_by_key(|triangle| (triangle.instance(), triangle.geometry(), triangle.primitive));
    triangles.dedup();
    triangles
}

fn check_all(name: &str, tree: &Bvh8, scene: &Scene, each: usize) {
    assert_eq!(tree.validate(), Ok(()), "{name}");
    let bvh = scene.build(&builds()[0]).unwrap();
    assert_eq!(tree.report().input, bvh.report().input, "{name}");
    assert_eq!(tree.bounds(), bvh.bounds(), "{name}");
    assert_eq!(sorted(tree.triangles()), scene.flatten().unwrap().triangles, "{name}");
    let rays = rays(scene, each);
    for query in Query::EVERY {
        check(name, &bvh, tree, query, &rays);
    }
}

#[test]
fn refits_of_every_scene_answer_as_a_new_tree() {
    for (name, scene) in scenes() {
        for (preset, level, mut tree) in packed(&scene) {
            let cost = tree.report().sah_cost;
            for phase in [0.4, -1.3] {
                let moved = bent(&scene, phase);
                if moved.flatten().unwrap().triangles.len() == tree.report().triangles {
                    let report = tree.refit(&moved).unwrap();
                    assert_eq!(report.cost, tree.report().sah_cost);
                    check_all(&format!("{name} {preset:?} {level} {phase}"), &tree, &moved, 6);
                }
            }
            let back = tree.refit(&scene).unwrap();
            assert!((back.cost - cost).abs() <= 1e-9 * cost || preset == Preset::High, "{name} {preset:?}");
            check_all(&format!("{name} {preset:?} {level} back"), &tree, &scene, 6);
        }
    }
}

/// So many nodes that threads share them, in trees of every builder and in ones that were built elsewhere, with triangles in several
/// leaves.
#[test]
fn large_trees_are_refitted_in_parts() {
    let scene = Scene::from_mesh(meshes::soup(30_000, 0.05, 8));
    let moved = bent(&scene, 0.7);
    let expected = sorted(moved.flatten().unwrap().triangles);
    let presets = Preset::EVERY.into_iter().filter(|preset| preset.can_refit());
    let built = presets.map(|preset| scene.build_packed(&Bvh8Options { preset, level: None }).unwrap());
    let elsewhere = builds().map(|options| Bvh8::from_bvh(&scene.build(&options).unwrap(), None).unwrap());
    for (index, mut tree) in built.chain(elsewhere).enumerate() {
        let mut twin = tree.clone();
        let report = tree.refit(&moved).unwrap();
        assert_eq!(tree.validate(), Ok(()), "{index}");
        assert_eq!(sorted(tree.triangles()), expected, "{index}");
        // To the bit, however often and from wherever.
        twin.refit(&bent(&scene, -2.0)).unwrap();
        assert_eq!(twin.refit(&moved).unwrap().cost.to_bits(), report.cost.to_bits(), "{index}");
        assert_eq!(twin.triangles(), tree.triangles(), "{index}");
    }
}

/// Instances, geometries, left out triangles, and a geometry and an instance that have none.
fn crowd() -> Scene {
    let mut holey = meshes::soup(40, 0.5, 2);
    let out_of_range = holey.positions.len() as u32;
    holey.triangles.insert(0, [0, 0, 1]);
    holey.triangles.insert(9, [0, 1, out_of_range]);
    holey.triangles.push([2, 2, 2]);
    let mut flat =
        Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::Y], vec![[0, 1, 2], [0, 2, 1], [0, 1, 3]]);
    flat.positions.push(Vec3::splat(f32::NAN));
    let nothing = Mesh::new(vec![Vec3::ZERO, Vec3::X], vec![[0, 1, 1]]);
    let mut scene = Scene::default();
    scene.add_object(Object { geometries: vec![nothing.clone(), holey, Mesh::default(), flat] });
    scene.add_object(nothing);
    scene.add_object(meshes::icosphere(1));
    for (index, object) in [0, 1, 2, 2, 0].into_iter().enumerate() {
        let scale = Vec3::new(1.0 + index as f32 * 0.1, if index == 3 { -0.5 } else { 0.7 }, 1.0);
        let place = Affine3A::from_scale_rotation_translation(
            scale,
            Quat::from_rotation_y(index as f32),
            Vec3::new(index as f32 * 0.4, 0.1, 0.0),
        );
        let transform = Transform::new(place).unwrap();
        scene.instances.push(Instance { object, transform, mask: 1 << index | 0x80 });
    }
    scene
}

#[test]
fn instances_move_are_mirrored_and_get_other_masks() {
    let scene = crowd();
    for (preset, level, mut tree) in packed(&scene) {
        let mut moved = bent(&scene, 0.2);
        let mirror = Affine3A::from_scale(Vec3::new(1.0, 1.0, -1.3));
        moved.instances[0].transform = Transform::new(mirror).unwrap();
        moved.instances[4].mask = 0x70;
        tree.refit(&moved).unwrap();
        check_all(&format!("crowd {preset:?} {level}"), &tree, &moved, 20);
        // One mask for all, which walks know of.
        moved.instances.iter_mut().for_each(|instance| instance.mask = 2);
        tree.refit(&moved).unwrap();
        check_all(&format!("crowd of one mask {preset:?} {level}"), &tree, &moved, 20);
    }
}

#[test]
fn other_triangles_are_refused_and_nothing_changes() {
    let scene = crowd();
    let tree = scene.build_packed(&Bvh8Options::default()).unwrap();
    let count = tree.report().triangles;
    let spoilt = |spoil: &dyn Fn(&mut Scene)| {
        let mut other = bent(&scene, 0.2);
        spoil(&mut other);
        let mut spared = tree.clone();
        let why = spared.refit(&other).unwrap_err();
        assert_eq!((spared.triangles(), spared.report()), (tree.triangles(), tree.report()));
        check_all("refused", &spared, &scene, 3);
        why
    };
    // A triangle more, one less, one that has become a point, none at all.
    let more = spoilt(&|scene| scene.objects[2].geometries[0].triangles.push([0, 1, 2]));
    assert_eq!(more, UpdateError::OtherCount { was: count, is: count + 2 });
    let fewer = spoilt(&|scene| scene.objects[2].geometries[0].triangles.truncate(79));
    assert_eq!(fewer, UpdateError::OtherCount { was: count, is: count - 2 });
    let point = spoilt(&|scene| {
        let mesh = &mut scene.objects[0].geometries[3];
        mesh.positions[3] = mesh.positions[0];
    });
    assert_eq!(point, UpdateError::OtherCount { was: count, is: count - 2 });
    assert!(matches!(spoilt(&|scene| *scene = Scene::default()), UpdateError::OtherCount { is: 0, .. }));
    // As many, but others: one that was left out is there and another is not; a longer mesh instead of another; another instance.
    let others: [&dyn Fn(&mut Scene); 4] = [
        &|scene| scene.objects[0].geometries[1].triangles.swap(0, 1),
        &|scene| scene.objects[0].geometries[1].triangles.swap(5, 9),
        &|scene| scene.objects[0].geometries.swap(2, 3),
        &|scene| {
            let last = scene.objects[0].geometries[3].triangles.pop().unwrap();
            scene.objects[0].geometries[1].triangles[0] = last;
        },
    ];
    for (index, spoil) in others.into_iter().enumerate() {
        let why = spoilt(spoil);
        assert!(matches!(why, UpdateError::OtherTriangle { .. }), "{index}: {why}");
    }
    let no_object = spoilt(&|scene| scene.instances[1].object = 9);
    assert!(matches!(no_object, UpdateError::Scene(_)), "{no_object}");
}
