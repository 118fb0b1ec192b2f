//! Structures that are built while frames go on.
//!
//! What threads share is one flag and one place behind a lock (see `two_level/background.rs`); these tests stress it: a
//! frame sees the old structure or the new one, whole, whatever the timing.

use super::support::{assert_same, closest, rays, scene};
use ropewalk::bvh::StackOrder;
use ropewalk::two_level::{BackgroundBuild, BottomSpec, TopUpdate, TwoLevelOptions};
use ropewalk::{Hit, Object, Walk};
use ropewalk_testkit::meshes;

const ORDERED: Walk = Walk::Stack(StackOrder::Ordered);

/// A shape that is another one for each number.
fn shape(number: u64) -> Object {
    meshes::soup(300, 0.4, number).into()
}

#[test]
fn a_frame_sees_one_version_whole() {
    let options = TwoLevelOptions::default();
    let mut plain = scene();
    let mut two_level = plain.build_two_level(&options).unwrap();
    let rays = rays(400, 2);
    let (mut version, mut swaps, mut frames) = (0, 0, 0);
    let mut wanted: Vec<Hit> = closest(&two_level, ORDERED, &rays);
    let mut build: Option<BackgroundBuild> = None;
    while swaps < 40 {
        frames += 1;
        assert!(frames < 2_000_000, "the build never ends");
        match &mut build {
            None => {
                version += 1;
                build = Some(BackgroundBuild::start(shape(version), BottomSpec::default(), options.oriented));
            }
            Some(running) => {
                if let Some(built) = running.poll() {
                    two_level.adopt_object(0, built.unwrap()).unwrap();
                    two_level.commit(TopUpdate::Refit).unwrap();
                    plain.objects[0] = shape(version);
                    wanted = closest(&plain.build_two_level(&options).unwrap(), ORDERED, &rays);
                    build = None;
                    swaps += 1;
                }
            }
        }
        assert_same(&rays, &closest(&two_level, ORDERED, &rays), &wanted, "a frame between two swaps");
    }
}

/// Many builds at once, most of which are given up at any moment: none blocks, none comes into another's place.
#[test]
fn builds_that_are_given_up_leave_nothing_behind() {
    let mut kept = Vec::new();
    for number in 0..200 {
        let build = BackgroundBuild::start(shape(number), BottomSpec::default(), number % 2 == 0);
        if number % 20 == 0 {
            kept.push((number, build));
        }
    }
    for (number, mut build) in kept {
        let structure = loop {
            if let Some(built) = build.poll() {
                break built.unwrap();
            }
            std::thread::yield_now();
        };
        assert_eq!(structure.report().triangles, 300, "{number}");
        assert!(build.poll().is_none(), "a result comes once");
    }
}
