//! Packed trees: the answers of every preset at every level of vector instructions against the binary tree's, one ray and
//! batches, with names, masks and repeats, after refits, and with the processor's flush-to-zero on.

mod compact;
mod flush;
mod hits;
mod instanced;
mod many;
mod names;
mod packets;
mod refit;
#[path = "../wide_bvh/scenes.rs"]
#[expect(dead_code, reason = "the wide trees' tests use all of it")]
mod scenes;
mod small;
#[path = "../two_level/support.rs"]
#[expect(dead_code, reason = "the two levels' tests use all of it")]
mod support;

use ropewalk::bvh8::{Preset, SimdLevel};
use ropewalk::{Bvh8, Bvh8Options, Scene};

/// The levels that this machine has.
fn levels() -> Vec<SimdLevel> {
    SimdLevel::EVERY.into_iter().filter(|level| level.is_available()).collect()
}

/// A tree of each preset at each level.
fn packed(scene: &Scene) -> Vec<(Preset, SimdLevel, Bvh8)> {
    let trees = Preset::EVERY.into_iter().map(|preset| {
        let tree = scene.build_packed(&Bvh8Options { preset, level: None }).expect("a tree");
        assert_eq!(tree.validate(), Ok(()), "{preset:?}");
        (preset, tree)
    });
    trees
        .flat_map(|(preset, tree)| {
            levels().into_iter().map(move |level| (preset, level, tree.clone().at(level)))
        })
        .collect()
}
