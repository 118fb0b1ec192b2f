//! With the processor's flush-to-zero and denormals-are-zero on, which renderers that embed a ray tracer often are: trees are built,
//! and rays find what they found without.

#![cfg(target_arch = "x86_64")]

use crate::many::kitchen;
use crate::packed;
use crate::scenes::{rays, scene};
use ropewalk::{Hit, Ray};
use ropewalk_testkit::rays::{RayClass, RayMaker};
use std::arch::asm;

/// Runs something with both modes on, on this thread.
fn flushed<R>(work: impl FnOnce() -> R) -> R {
    struct Restore(u32);
    impl Drop for Restore {
        fn drop(&mut self) {
            // SAFETY: the word was read from the register.
            unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const self.0) };
        }
    }
    let mut before = 0u32;
    // SAFETY: stores the control word.
    unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut before) };
    let restore = Restore(before);
    let both = before | 0x8040;
    // SAFETY: two mode bits are set that change how numbers below the smallest normal one are taken; no code here depends on
    // them, and they are set back.
    unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const both) };
    let result = work();
    drop(restore);
    result
}

#[test]
fn flushing_changes_no_hit_of_ordinary_scenes() {
    for name in ["soup", "shells", "sticks", "grid"] {
        let scene = scene(name);
        let rays = rays(&scene, 60);
        let bvh = scene.build(&Default::default()).unwrap();
        // What the scalar walk finds under the same mode.
        let expected: Vec<Hit> = flushed(|| rays.iter().map(|ray| bvh.closest(ray)).collect());
        for (preset, level, before) in packed(&scene) {
            let again = flushed(|| {
                scene.build_packed(&ropewalk::Bvh8Options { preset, level: Some(level) }).unwrap()
            });
            assert_eq!(again.validate(), Ok(()));
            for tree in [&before, &again] {
                for (ray, expected) in rays.iter().zip(&expected) {
                    let (closest, any) = flushed(|| (tree.closest(ray), tree.any(ray)));
                    assert_eq!(closest.to_words(), expected.to_words(), "{name} {preset:?} {level}: {ray:?}");
                    assert_eq!(any, expected.is_hit());
                }
            }
        }
    }
}

#[test]
fn flushing_changes_no_hit_in_a_kitchen() {
    let Some(scene) = kitchen() else {
        println!("skipped: the kitchen is not there");
        return;
    };
    let bvh = scene.build(&Default::default()).unwrap();
    let flat = scene.flatten().unwrap();
    let closest = |rays: &[Ray]| rays.iter().map(|ray| bvh.closest(ray)).collect::<Vec<Hit>>();
    let trees = packed(&scene);
    for class in RayClass::EVERY {
        let rays = RayMaker::new(&flat, 7).make(class, 2_000, &closest);
        let expected = flushed(|| closest(&rays));
        for (preset, level, tree) in &trees {
            let mut hits = vec![Hit::MISS; rays.len()];
            // In this thread, where the mode is on.
            flushed(|| rays.iter().zip(&mut hits).for_each(|(ray, hit)| *hit = tree.closest(ray)));
            for ((ray, hit), expected) in rays.iter().zip(&hits).zip(&expected) {
                assert_eq!(hit.to_words(), expected.to_words(), "{class} {preset:?} {level}: {ray:?}");
            }
        }
    }
}
