//! Instances, geometries, mirrors and masks: what a packed triangle is called and who sees it.

use crate::packed;
use glam::{Affine3A, Vec3};
use ropewalk::{BuildOptions, Object, Query, Ray, Scene, TraceOptions, Transform, Walk, glam};
use ropewalk_testkit::compare::same_bits;
use ropewalk_testkit::meshes;

/// Three instances of two objects of two geometries, one mirrored, in part in the same place, with masks of their own.
pub(crate) fn scene(masks: [u32; 3]) -> Scene {
    let mut scene = Scene::default();
    let parts =
        |seed| Object { geometries: vec![meshes::soup(40, 0.5, seed), meshes::soup(25, 0.7, seed + 1)] };
    let (first, second) = (scene.add_object(parts(3)), scene.add_object(parts(9)));
    let mirror = Transform::new(Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0))).unwrap();
    scene.add_instance(second, Transform::IDENTITY);
    scene.add_instance(first, mirror);
    scene.add_instance(second, Transform::IDENTITY);
    for (instance, mask) in scene.instances.iter_mut().zip(masks) {
        instance.mask = mask;
    }
    scene
}

#[test]
fn names_sides_and_masks_are_kept() {
    for masks in [[0xff; 3], [0x81, 0x02, 0x82], [0x10; 3], [0, 1, 0]] {
        let scene = scene(masks);
        let bvh = scene.build(&BuildOptions::default()).unwrap();
        let rays: Vec<Ray> = crate::scenes::rays(&scene, 20)
            .into_iter()
            .flat_map(|ray| [Ray::ALL, 0x80, 0x02, 0x10, 0].map(|mask| ray.with_mask(mask)))
            .collect();
        let mut by_id = bvh.triangles().to_vec();
        by_id.sort_by_key(|triangle| (triangle.instance(), triangle.geometry(), triangle.primitive));
        for (_, level, tree) in packed(&scene) {
            let mut own = tree.triangles();
            own.sort_by_key(|triangle| (triangle.instance(), triangle.geometry(), triangle.primitive));
            assert_eq!(own, by_id);
            for query in Query::EVERY {
                let expected = bvh.trace(Walk::default(), query, &rays, TraceOptions::default()).unwrap();
                let given = tree.trace(Walk::default(), query, &rays, TraceOptions::default()).unwrap();
                let same = same_bits(&rays, &expected, &given, false);
                assert!(same.is_ok(), "{masks:?} {level} {query}: {same:?}");
            }
        }
    }
}
