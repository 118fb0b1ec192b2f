//! Bad input: errors that name the instance or the object, and a scene that is as it was.

use super::support::{assert_same, closest, rays, scene};
use ropewalk::bvh::StackOrder;
use ropewalk::glam::{Affine3A, Vec3};
use ropewalk::two_level::{ChangeError, TopUpdate, TwoLevelOptions};
use ropewalk::{Mesh, NoMonitor, Object, Ray, Scene, Transform, Walk};

#[test]
fn a_change_that_cannot_be_made_changes_nothing() {
    let mut two_level = scene().build_two_level(&TwoLevelOptions::default()).unwrap();
    let rays = rays(1000, 1);
    let walk = Walk::Stack(StackOrder::Ordered);
    let before = closest(&two_level, walk, &rays);
    let nothing = Object::default();
    let points = Object::from(Mesh::new(vec![Vec3::ONE], vec![]));
    let empty = two_level.add_object(&nothing, &NoMonitor).unwrap();
    let gone = two_level.add_object(&scene().objects[0], &NoMonitor).unwrap();
    two_level.remove_object(gone).unwrap();
    let nan = Affine3A::from_translation(Vec3::new(0.0, f32::NAN, 0.0));
    let flat = Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0));
    let tiny = Affine3A::from_scale(Vec3::splat(1e-25));
    let plain = Affine3A::IDENTITY;
    let all = Ray::ALL;
    let errors: Vec<(Result<u32, ChangeError>, &[&str])> = vec![
        (two_level.set_transform(3, nan).map(|()| 0), &["instance 3", "NaN"]),
        (two_level.set_transform(4, flat).map(|()| 0), &["instance 4", "singular"]),
        (two_level.set_transform(5, tiny).map(|()| 0), &["instance 5", "2^-60"]),
        (two_level.set_transform(99, plain).map(|()| 0), &["instance 99", "never added"]),
        (two_level.add_instance(empty, plain, all), &["instance 40", "no triangle"]),
        (two_level.add_instance(gone, plain, all), &["instance 40", "object 5", "removed"]),
        (two_level.add_instance(77, plain, all), &["instance 40", "object 77"]),
        (two_level.add_instance(0, nan, all), &["instance 40", "NaN"]),
        (two_level.replace_object(1, &points, &NoMonitor).map(|()| 0), &["object 1", "no triangle"]),
        (two_level.replace_object(9, &points, &NoMonitor).map(|()| 0), &["object 9"]),
        (two_level.refit_object(1, &points).map(|_| 0), &["object 1"]),
        (two_level.remove_object(2).map(|()| 0), &["object 2", "instance 2"]),
        (two_level.remove_object(gone).map(|()| 0), &["object 5"]),
        (two_level.remove_instance(40).map(|()| 0), &["instance 40"]),
        (two_level.set_mask(40, 1).map(|()| 0), &["instance 40"]),
    ];
    for (result, names) in errors {
        let text = result.unwrap_err().to_string();
        assert!(names.iter().all(|name| text.contains(name)), "{text}: {names:?}");
    }
    two_level.commit(TopUpdate::Rebuild).unwrap();
    two_level.validate().unwrap();
    assert_same(&rays, &closest(&two_level, walk, &rays), &before, "nothing has changed");
    two_level.remove_instance(3).unwrap();
    let text = two_level.remove_instance(3).unwrap_err().to_string();
    assert!(text.contains("instance 3"), "{text}");
}

#[test]
fn a_scene_that_cannot_be_built_is_named() {
    let mut plain = scene();
    plain.instances[2].object = 50;
    let text = plain.build_two_level(&TwoLevelOptions::default()).unwrap_err().to_string();
    assert!(text.contains("instance 2") && text.contains("object 50"), "{text}");
    let mut plain = scene();
    let tiny = Affine3A::from_scale(Vec3::splat(1e-25));
    plain.instances[6].transform = Transform::new(tiny).unwrap();
    let text = plain.build_two_level(&TwoLevelOptions::default()).unwrap_err().to_string();
    assert!(text.contains("instance 6") && text.contains("out of range"), "{text}");
}

#[test]
fn nothing_is_hit_in_nothing() {
    for plain in [Scene::default(), Scene::from_mesh(Mesh::default())] {
        let two_level = plain.build_two_level(&TwoLevelOptions::default()).unwrap();
        two_level.validate().unwrap();
        assert!(two_level.bounds().is_empty() && two_level.top().nodes().is_empty());
        assert!(!two_level.any(&Ray::new(Vec3::ZERO, Vec3::X)));
    }
}

#[test]
fn a_wrong_key_is_answered_with_the_right_ones() {
    let answer = |text: &str| text.parse::<ropewalk::StructureSpec>().unwrap_err().to_string();
    assert!(answer("two-level:bottom=grid").contains("kd-tree, bvh, wide-bvh, list, mixed"));
    assert!(answer("two-level:orientated=yes").contains("bottom, oriented"));
    assert!(answer("two-level:oriented=maybe").contains("yes, no"));
    assert!(answer("two-level:bottom=mixed,max-leaf=3").contains("max-leaf=3"));
    for text in ["two-level", "two-level:oriented=no,max-depth=20", "two-level:bottom=bvh,builder=sbvh"] {
        assert_eq!(text.parse::<ropewalk::StructureSpec>().unwrap().to_string(), text);
    }
}
