//! Scenes that move, seen from outside: small AFF documents, and poses of whole scenes.

mod common;

use common::scene;
use ropewalk::glam::Vec3;
use ropewalk_scene::builtin::{builtin, builtin_animated};
use ropewalk_scene::load::{load, load_animated, load_animated_bytes};
use ropewalk_scene::{Animated, LoadError};
use std::path::Path;

fn aff(text: &str) -> Animated {
    load_animated_bytes(Path::new("x.aff"), text.into()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn what_is_hidden_or_flat_keeps_its_place() {
    let animated = aff("x grows { p 3 0 0 0 1 0 0 0 1 0 }\nx blinks { p 3 0 0 1 1 0 1 0 1 1 }\n\
                        k grows { scale 4 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1 2 2 2 0 0 0 2 2 2 2 0 0 0 }\n\
                        k blinks { visibility 2 0.5 0 2.0 1 }\na 0 2 5");
    let at = |time: f64| animated.pose(time).unwrap();
    assert_eq!(at(0.0).visible, [false, true]);
    assert_eq!(at(0.75).visible, [true, false]);
    assert_eq!(at(2.0).visible, [true, true]);
    assert_eq!(animated.model().scene.instances.len(), 2);
    assert_eq!(animated.model().scene.instances[0].mask, 0);
    for time in [0.0, 0.5, 2.0] {
        assert_eq!(at(time).transforms.len(), 2);
    }
    assert_eq!(at(2.0).transforms[0].transform_point3(Vec3::X), Vec3::X * 2.0);
    assert!(at(f64::NAN).transforms[1].is_finite());
}

#[test]
fn a_file_without_a_span_stands_still() {
    let animated = aff("p 3 0 0 0 1 0 0 0 1 0\nk a { visibility 1 0 0 }");
    assert!(animated.span().is_none() && animated.pose(0.0).is_none());
    let mesh =
        load_animated_bytes(Path::new("x.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".into()).unwrap();
    assert!(mesh.clip().is_none());
    let error = load_animated_bytes(Path::new("x.aff"), "p 2 0 0 0 1 0 0".into()).unwrap_err();
    assert!(matches!(error, LoadError::Malformed { .. }));
}

#[test]
fn models_that_move_are_those_that_do_not() {
    for name in ["bart_robot/Robot.aff", "bart_museum/museum5.aff", "milktruck/CesiumMilkTruck.glb"] {
        let Some(path) = scene(name) else { return };
        let (still, moving) = (load(&path).unwrap(), load_animated(&path).unwrap());
        let moving = moving.model();
        assert_eq!(moving.object_names, still.object_names, "{name}");
        assert_eq!(moving.surfaces.len(), still.surfaces.len(), "{name}");
        assert_eq!(moving.materials, still.materials, "{name}");
        assert_eq!(moving.cameras, still.cameras, "{name}");
        assert_eq!(moving.scene.origin, still.scene.origin);
        assert_eq!(moving.scene.objects, still.scene.objects, "{name}");
        assert_eq!(moving.scene.instances.len(), still.scene.instances.len(), "{name}");
    }
}

#[test]
fn the_assembly_starts_as_it_stands_and_every_part_moves() {
    let still = builtin("assembly").unwrap();
    let animated = builtin_animated("assembly").unwrap();
    assert_eq!(animated.model().scene, still.scene);
    assert_eq!((&animated.model().cameras, &animated.model().lights), (&still.cameras, &still.lights));
    let start = animated.pose(0.0).unwrap().transforms;
    let apart = animated.pose(6.0).unwrap().transforms;
    let ground = start.len() - 1;
    let moved = start.iter().zip(&apart).filter(|(one, other)| one != other).count();
    // Only the trough, the pads and the ground stay.
    assert_eq!((moved, start[ground] == apart[ground]), (start.len() - 6, true));
    // Turning, parts keep their distance from their axes: only what turns moves.
    let turning = animated.pose(1.0).unwrap().transforms;
    let turned = start.iter().zip(&turning).filter(|(one, other)| one != other).count();
    assert!(turned > 50 && turned < 100, "{turned}");
    for name in ["cubes", "forest"] {
        assert!(builtin_animated(name).unwrap().span().is_none());
    }
    assert!(builtin_animated("pyramids").is_err());
}
