//! With the processor's flush-to-zero and denormals-are-zero on, which renderers that embed a ray tracer often are: trees are built,
//! and rays find what they found without.

#![cfg(target_arch = "x86_64")]

use crate::packed;
use crate::scenes::{rays, scene};
use ropewalk::Hit;
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
