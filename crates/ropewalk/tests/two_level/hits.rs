//! Hits: brute force, two loops, one loop; every bottom structure; against a scene that is flattened; the layout.

use super::support::{assert_same, every, rays, scene};
use ropewalk::bvh::{Node, StackOrder};
use ropewalk::glam::{Affine3A, Vec3};
use ropewalk::two_level::{Opening, Placed, SmartStack, TopUpdate, TwoLevelOptions};
use ropewalk::{Answer, BuildOptions, Hit, Mesh, Query, Ray, Scene, TraceOptions, Transform, Walk};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::compare::same_bits;

const ORDERED: Walk = Walk::Stack(StackOrder::Ordered);

/// The walks that are compared with brute force.
fn walks() -> Vec<Walk> {
    let smart = [SmartStack::LEAST_BYTES, 52, SmartStack::MOST_BYTES].map(|bytes| Walk::SmartStack { bytes });
    [ORDERED].into_iter().chain(smart).collect()
}

#[test]
fn every_walk_and_bottom_hits_what_brute_force_hits() {
    let scene = scene();
    let rays = rays(4000, 3);
    for oriented in [false, true] {
        let mut first: Option<Vec<Hit>> = None;
        for options in every().into_iter().filter(|options| options.oriented == oriented) {
            let two_level = scene.build_two_level(&options).unwrap();
            two_level.validate().unwrap();
            for query in Query::EVERY {
                let trace =
                    |walk| two_level.trace(walk, query, &rays, TraceOptions { counters: true }).unwrap();
                let all = trace(Walk::BruteForce);
                let ordered = trace(ORDERED);
                for walk in walks() {
                    let given = trace(walk);
                    let same = same_bits(&rays, &all, &given, false);
                    same.unwrap_or_else(|mismatch| panic!("{options:?} {walk} {query}: {mismatch}"));
                    // One loop does what two do, whatever the ring holds.
                    let same = same_bits(&rays, &ordered, &given, true);
                    same.unwrap_or_else(|mismatch| panic!("{options:?} {walk} {query}: {mismatch}"));
                }
                if let Answer::Closest(hits) = all.answer {
                    assert!(hits.iter().filter(|hit| hit.is_hit()).count() > 2000);
                    let wanted = first.get_or_insert_with(|| hits.clone());
                    assert_same(&rays, &hits, wanted, "another bottom structure");
                }
            }
        }
    }
}

/// A flattened scene rounds triangles, two levels round rays: the same hits but where rays graze, the same `t` up to rounding.
#[test]
fn a_flattened_scene_has_nearly_the_same_hits() {
    let scene = scene();
    let rays = rays(20_000, 8);
    let flat = scene.build(&BuildOptions::default()).unwrap();
    for oriented in [false, true] {
        let options = TwoLevelOptions { oriented, ..TwoLevelOptions::default() };
        let two_level = scene.build_two_level(&options).unwrap();
        let mut others = 0;
        for ray in &rays {
            let (given, wanted) = (two_level.closest(ray), flat.closest(ray));
            let same_id = given.id() == wanted.id();
            let same_t = given.t == wanted.t || (given.t - wanted.t).abs() <= 2e-5 * wanted.t.abs().max(1.0);
            others += usize::from(!(same_id && same_t));
        }
        assert!(others < 10, "{others} of {} rays have another hit", rays.len());
    }
}

/// Where nothing is turned and nothing moved, nothing is rounded: the very bits of the flattened scene.
#[test]
fn what_is_not_moved_is_the_same_to_the_bit() {
    for case in Case::every() {
        let unmoved = |scene: &Scene| scene.instances.iter().all(|it| it.transform == Transform::IDENTITY);
        if !unmoved(&case.scene) {
            continue;
        }
        let flat = case.scene.build(&BuildOptions::default()).unwrap();
        let options = TwoLevelOptions { oriented: false, ..TwoLevelOptions::default() };
        let two_level = case.scene.build_two_level(&options).unwrap();
        for query in Query::EVERY {
            let wanted = flat.trace(ORDERED, query, &case.rays, TraceOptions::default()).unwrap();
            let given = two_level.trace(ORDERED, query, &case.rays, TraceOptions::default()).unwrap();
            let same = same_bits(&case.rays, &wanted, &given, false);
            same.unwrap_or_else(|mismatch| panic!("{} {query}: {mismatch}", case.name));
        }
    }
}

#[test]
fn the_layout_is_the_papers() {
    assert_eq!((size_of::<Node>(), size_of::<Placed>()), (32, 96));
    let two_level = scene().build_two_level(&TwoLevelOptions::default()).unwrap();
    let nodes = two_level.top().nodes();
    assert_eq!((two_level.placed().len(), nodes.len()), (40, 79));
    assert!(nodes.iter().filter(|node| node.is_leaf()).all(|leaf| leaf.count == 1));
    // The first child lies beside its parent, so links go to second children: each node but the root is reached once.
    let mut reached = vec![0; nodes.len()];
    for (index, node) in nodes.iter().enumerate().filter(|(_, node)| !node.is_leaf()) {
        reached[index + 1] += 1;
        reached[node.link as usize] += 1;
    }
    assert_eq!(reached[0], 0);
    assert!(reached[1..].iter().all(|&times| times == 1));
}

/// A direction that an object's scale makes shorter or longer than a ray's may be.
#[test]
fn extreme_scales_lose_no_hit() {
    let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    for (scale, length) in [(1e-16, 1e-16), (1e-16, 1.0), (1e-16, 1e16), (1e11, 1e-16), (1e11, 1e16)] {
        let mut scene = Scene::default();
        let object = scene.add_object(mesh.clone());
        scene.add_instance(object, Transform::new(Affine3A::from_scale(Vec3::splat(scale))).unwrap());
        for options in every() {
            let two_level = scene.build_two_level(&options).unwrap();
            let ray = Ray::new(Vec3::new(0.2, 0.2, 2.0) * scale, -Vec3::Z * length);
            let t = two_level.closest(&ray).t;
            assert!((t / (2.0 * scale / length) - 1.0).abs() < 1e-5, "{scale} {length} {options:?}: {t}");
        }
    }
}

/// Turned boxes are smaller in their own frames, so rays enter fewer objects.
#[test]
fn oriented_boxes_keep_rays_out() {
    let entered = |oriented| {
        let options = TwoLevelOptions { oriented, ..TwoLevelOptions::default() };
        let two_level = scene().build_two_level(&options).unwrap();
        let counted = TraceOptions { counters: true };
        let traced = two_level.trace(ORDERED, Query::Closest, &rays(4000, 5), counted).unwrap();
        traced.totals().unwrap().objects_entered
    };
    let (with, without) = (entered(true), entered(false));
    assert!(with < without, "{with} objects are entered with oriented boxes, {without} without");
}

/// Whether large objects are opened or not, and however: the same bits, near and far, and after a move.
#[test]
fn opened_objects_have_the_same_hits() {
    let mut plain = scene();
    // A room around everything: what opening is for.
    let room = ropewalk_testkit::meshes::mapped(ropewalk_testkit::meshes::icosphere(3), |point| point * 9.0);
    let object = plain.add_object(room);
    plain.add_instance(object, Transform::IDENTITY);
    let mut rays = rays(6000, 11);
    let far = |ray: &Ray, times: f32| Ray::new(ray.origin - ray.dir * times, ray.dir);
    rays.extend(rays.clone().iter().enumerate().map(|(index, ray)| far(ray, 10f32.powi(index as i32 % 6))));
    for options in every() {
        let whole = plain.build_two_level(&options).unwrap();
        let wanted = whole.trace(ORDERED, Query::All, &rays, TraceOptions::default()).unwrap();
        for opening in [Opening::ByCost(3), Opening::ByCost(16), Opening::Blindly(8)] {
            let mut opened = plain.build_two_level(&TwoLevelOptions { opening, ..options }).unwrap();
            opened.validate().unwrap();
            for walk in [ORDERED, Walk::SmartStack { bytes: 24 }] {
                let given = opened.trace(walk, Query::All, &rays, TraceOptions::default()).unwrap();
                let same = same_bits(&rays, &wanted, &given, false);
                same.unwrap_or_else(|mismatch| panic!("{options:?} {opening:?} {walk}: {mismatch}"));
            }
            let to_world = Affine3A::from_translation(Vec3::new(0.3, -0.2, 5.0));
            opened.set_transform(40, to_world).unwrap();
            opened.commit(TopUpdate::Refit).unwrap();
            opened.validate().unwrap();
            let mut moved = plain.clone();
            moved.instances[40].transform = Transform::new(to_world).unwrap();
            let moved = moved.build_two_level(&options).unwrap();
            for ray in rays.iter().step_by(7) {
                let (given, wanted) = (opened.closest(ray), moved.closest(ray));
                assert_eq!(given.to_words(), wanted.to_words(), "{options:?} {opening:?} {ray:?}");
            }
        }
    }
    // The room's tree is opened, so there are more entries than instances.
    let opened = TwoLevelOptions { opening: Opening::Blindly(8), ..TwoLevelOptions::default() };
    let opened = plain.build_two_level(&opened).unwrap();
    assert_eq!((opened.placed().len(), opened.entries().len()), (41, 48));
}
