//! Whole trees: the kernel's light and counts are those of the recursion, over any structure.

use super::machine::exact_tracer;
use super::scene::Set;
use crate::Ground;
use crate::gpu::TreeKernel;
use crate::integrator::{TreeOrder, TreeSettings};
use crate::ray_tree::{Followed, Root, Tally, follow};
use crate::stage::{Stage, StageOptions};
use crate::tracing::Tracing;
use glam::Vec3;
use ropewalk::two_level::TwoLevelOptions;
use ropewalk::{BuildOptions, KdOptions, Scene, Structure, Walk, WideOptions};
use ropewalk_gpu::Tracer;
use ropewalk_scene::Camera;
use ropewalk_scene::builtin::builtin;
use ropewalk_scene::load::load;
use std::path::Path;

/// What the CPU gives.
pub(super) fn by_recursion(set: &Set, structure: &Structure, roots: &[Root]) -> (Vec<Followed>, Tally) {
    let tracing = Tracing { tracer: structure, walk: Walk::default(), looks: Some(&set.looks) };
    follow(&set.tree(), &tracing, TreeOrder::Recursive, roots).unwrap()
}

/// What differs, if anything does.
pub(super) fn difference(
    (expected, tally): &(Vec<Followed>, Tally),
    (found, counted): &(Vec<Followed>, Tally),
) -> Option<String> {
    let bits = |one: &Followed| one.color.to_array().map(f32::to_bits);
    let differ =
        |(_, (a, b)): &(usize, (&Followed, &Followed))| bits(a) != bits(b) || a.is_broken != b.is_broken;
    let mut differing = expected.iter().zip(found).enumerate().filter(differ);
    if let Some((index, (a, b))) = differing.next() {
        let count = 1 + differing.count();
        return Some(format!("{count} of {} differ, number {index}: {a:?} and {b:?}", expected.len()));
    }
    if expected.len() != found.len() {
        return Some("another number of samples".into());
    }
    (tally != counted).then(|| format!("{tally:?}\nis not\n{counted:?}"))
}

/// Every kind of structure that a kernel goes through.
const EVERY: [&str; 4] = ["bvh", "wide-bvh", "kd-tree", "two-level"];

fn structure(scene: &Scene, kind: &str) -> Structure {
    match kind {
        "bvh" => Structure::Bvh(scene.build(&BuildOptions::default()).unwrap()),
        "wide-bvh" => Structure::WideBvh(scene.build_wide(&WideOptions::default()).unwrap()),
        "kd-tree" => Structure::KdTree(scene.build_kd(&KdOptions::default()).unwrap()),
        _ => Structure::TwoLevel(scene.build_two_level(&TwoLevelOptions::default()).unwrap()),
    }
}

/// Fails where a kernel gives other trees than the recursion over the same structure. What the first of them count.
fn demand_same(name: &str, tracer: &Tracer, set: &Set, size: [u32; 2], kinds: &[&str]) -> Tally {
    let mut first = Tally::default();
    let walk = Walk::default();
    for (index, kind) in kinds.iter().enumerate() {
        let structure = structure(set.stage.scene(), kind);
        // Two levels find hits in the objects' spaces, which rounds in another way: each structure has its own trees.
        let roots = set.roots(&structure, walk, size);
        let expected = by_recursion(set, &structure, &roots);
        if index == 0 {
            first = expected.1;
        }
        let kernel = TreeKernel::new(tracer, &set.looks, set.most_waiting()).unwrap();
        let uploaded = tracer.upload(&structure).unwrap();
        // The first kernel is told what the primary rays find, the others find it themselves.
        let found = kernel.follow(&uploaded, walk, &roots, index == 0).unwrap();
        if let Some(difference) = difference(&expected, &found) {
            panic!("{name}, {kind}: {difference}");
        }
    }
    first
}

#[test]
fn the_kernel_follows_trees_as_the_recursion() {
    let Some(tracer) = exact_tracer() else { return };
    for (is_studio, ground) in [(true, Ground::On), (false, Ground::Off)] {
        let set = Set::new(is_studio, TreeSettings::default(), ground);
        let tally = demand_same(
            "the small scene",
            tracer,
            &set,
            [48, 36],
            if is_studio { &EVERY } else { &EVERY[..1] },
        );
        assert_eq!(tally.incomplete.rays, 0);
        assert!(
            tally.shadow_rays > 2000 && tally.reflected_rays > 500 && tally.refracted_rays > 300,
            "{tally:?}"
        );
        assert!(tally.cut_by_depth > 0 && tally.cut_by_weight > 0, "{tally:?}");
        assert_eq!(tally.sky_rays > 1000, is_studio, "{tally:?}");
    }
}

#[test]
fn what_is_not_asked_for_is_not_followed_there_either() {
    let Some(tracer) = exact_tracer() else { return };
    let all = TreeSettings { bounces: 2, ..TreeSettings::default() };
    for tree in [
        TreeSettings { shadows: false, ..all },
        TreeSettings { reflections: false, ..all },
        TreeSettings { refractions: false, ..all },
        TreeSettings { bounces: 0, ..all },
        TreeSettings { smallest_weight: 0.2, ..all },
    ] {
        let set = Set::new(true, tree, Ground::On);
        demand_same(&format!("{tree:?}"), tracer, &set, [32, 24], &EVERY[..1]);
    }
}

/// The scenes of the project's folder, as their files light them and look at them, tiny.
#[test]
fn scenes_of_files_are_followed_as_by_the_recursion() {
    let Some(tracer) = exact_tracer() else { return };
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes"));
    // With two levels, as they are rendered, and the smallest one with every structure.
    for (name, kinds) in [
        ("cornell_box/tinyobj/cornell_box.obj", &EVERY[..]),
        ("builtin:assembly", &EVERY[3..]),
        ("bart_robot/Robot.aff", &EVERY[3..]),
        ("bart_kitchen/kitchen.aff", &EVERY[3..]),
        ("bart_museum/museum5.aff", &EVERY[3..]),
    ] {
        let path = folder.join(name);
        let model = if let Some(name) = name.strip_prefix("builtin:") {
            builtin(name).unwrap()
        } else if path.exists() {
            load(&path).unwrap()
        } else {
            println!("skipped: there is no {}", path.display());
            continue;
        };
        let stage = Stage::new(model.clone(), &StageOptions::default());
        let (middle, size) = (stage.bounds().center(), stage.bounds().size().length());
        let outside = Camera {
            name: String::new(),
            position: middle + Vec3::new(0.1, 0.2, 1.0) * size,
            forward: Vec3::new(-0.1, -0.2, -1.0),
            up: Vec3::Y,
            vertical_fov: 0.8,
        };
        let camera = model.cameras.first().cloned().unwrap_or(outside);
        let set = Set::of(model, camera, TreeSettings::default(), Ground::Off);
        let tally = demand_same(name, tracer, &set, [48, 27], kinds);
        println!("{name}: {tally:?}");
        assert!(tally.shadow_rays + tally.sky_rays > 100, "{name}: {tally:?}");
        assert_eq!(tally.incomplete.rays, 0, "{name}");
    }
}
