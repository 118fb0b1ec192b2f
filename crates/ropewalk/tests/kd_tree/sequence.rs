//! Which leaves walks enter, and in which order: equal hits alone would not show a walk that goes astray.

use super::support::{blocks, builds, interior};
use ropewalk::bvh::walk::{AllHits, ArrayTrail, ClosestHit, Collect, Summary, Trail, TrailU64};
use ropewalk::glam::{DVec3, Vec3};
use ropewalk::kd_tree::walk::{
    Backtrack, Course, KdWalk, ReferenceVisitor, Restart, RestartTrail, Ropes, ShortStack, Stack,
};
use ropewalk::{KdTree, NoProbe, PreparedRay, Ray, Scene};
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;
use ropewalk_testkit::recorder::{Events, Recorder};

/// What was collected, what happened, and how the walk ended.
fn record<W: KdWalk, C: Collect>(
    tree: &KdTree,
    walk: W,
    ray: &PreparedRay,
    collect: C,
) -> (C, Events, Course) {
    let mut recorder = Recorder::new(ReferenceVisitor { tree, ray, collect, probe: NoProbe });
    let course = walk.walk(tree, ray, &mut recorder);
    let (visitor, events) = recorder.finish();
    (visitor.collect, events, course)
}

fn closest<W: KdWalk>(tree: &KdTree, walk: W, ray: &PreparedRay) -> ([u32; 7], Events, Course) {
    let (collect, events, course) = record(tree, walk, ray, ClosestHit::new(ray));
    (collect.answer().to_words(), events, course)
}

fn all<W: KdWalk>(tree: &KdTree, walk: W, ray: &PreparedRay) -> (Events, Course) {
    let mut hits = Vec::new();
    let (_, events, course) = record(tree, walk, ray, AllHits::new(ray, &mut hits));
    (events, course)
}

fn rays(seed: u64, count: usize, size: f64) -> Vec<PreparedRay> {
    let mut random = Random::new(seed);
    let mut ray = |index: usize| {
        let target = random.in_cube() * size;
        let dir = if index.is_multiple_of(5) {
            DVec3::AXES[index % 3]
        } else if index.is_multiple_of(7) {
            // Through corners of the blocks.
            DVec3::new(1.0, -1.0, if index.is_multiple_of(2) { 1.0 } else { 0.0 })
        } else {
            random.direction()
        };
        let target = if index.is_multiple_of(7) { target.round() } else { target };
        let origin = target - dir * random.between(0.0, 3.0 * size).round();
        PreparedRay::new(&Ray::new(origin.as_vec3(), dir.as_vec3())).unwrap()
    };
    (0..count).map(&mut ray).collect()
}

fn each(rays_a_tree: usize, mut check: impl FnMut(&str, &KdTree, &[PreparedRay])) {
    let scenes = [
        ("interior", interior(), 4.0),
        ("blocks", blocks(), 5.0),
        ("soup", meshes::soup(900, 0.4, 3), 1.0),
        ("one", meshes::soup(1, 0.5, 1), 1.0),
        ("nothing", meshes::soup(0, 0.5, 1), 1.0),
    ];
    for (name, mesh, size) in scenes {
        let scene = Scene::from_mesh(mesh);
        for options in builds() {
            let tree = scene.build_kd(&options).unwrap();
            check(&format!("{name}, {options:?}"), &tree, &rays(7, rays_a_tree, size));
        }
    }
}

/// With room for all, event for event; with less, the same leaves.
#[test]
fn the_trail_enters_the_leaves_of_the_stack() {
    fn like_the_stack<T: Trail + Sync>(name: &str, tree: &KdTree, ray: &PreparedRay) {
        let full = closest(tree, Stack, ray);
        assert_eq!(closest(tree, RestartTrail::<T, 64>::new(64), ray), full, "{name}");
        for entries in [0, 1, 2, 16] {
            let (words, events, _) = closest(tree, RestartTrail::<T>::new(entries), ray);
            assert_eq!((words, events.leaves()), (full.0, full.1.leaves()), "{name}, {entries}");
            assert_eq!(events.first_visits(), full.1.first_visits(), "{name}, {entries}");
        }
    }
    each(150, |name, tree, rays| {
        for ray in rays {
            like_the_stack::<TrailU64>(name, tree, ray);
            like_the_stack::<ArrayTrail>(name, tree, ray);
        }
    });
}

/// What the proof in `walk/certain.rs` says: until a ray is given over, its leaves are those of the stack walk.
#[test]
fn walks_by_t_enter_the_leaves_of_the_stack() {
    fn like_the_stack<W: KdWalk>(name: &str, tree: &KdTree, walk: W, rays: &[PreparedRay]) -> [usize; 2] {
        let mut courses = [0; 2];
        for ray in rays {
            let full = all(tree, Stack, ray).0.leaves();
            let (events, course) = all(tree, walk, ray);
            let leaves = events.leaves();
            match course {
                Course::Own => assert_eq!(leaves, full, "{name}"),
                // The first leaves, and then all from the beginning.
                Course::GivenOver => {
                    let own = leaves.len() - full.len();
                    assert_eq!(leaves[..own], full[..own], "{name}");
                    assert_eq!(leaves[own..], full, "{name}");
                }
            }
            courses[usize::from(course == Course::GivenOver)] += 1;
            let (expected, given) = (closest(tree, Stack, ray), closest(tree, walk, ray));
            assert_eq!(expected.0, given.0, "{name}");
            if given.2 == Course::Own {
                assert_eq!(expected.1.leaves(), given.1.leaves(), "{name}");
            }
        }
        courses
    }
    let mut sum = [[0; 2]; 5];
    each(300, |name, tree, rays| {
        let courses = [
            like_the_stack(name, tree, Restart, rays),
            like_the_stack(name, tree, Backtrack, rays),
            like_the_stack(name, tree, ShortStack { entries: 1 }, rays),
            like_the_stack(name, tree, ShortStack { entries: 16 }, rays),
            like_the_stack(name, tree, Ropes, rays),
        ];
        for (sum, courses) in sum.iter_mut().zip(courses) {
            *sum = [sum[0] + courses[0], sum[1] + courses[1]];
        }
    });
    println!("by themselves and given over: {sum:?}");
    assert!(sum.iter().all(|&[own, over]| own > 2000 && over > 100), "{sum:?}");
}

/// A ring that drops nothing never goes back to the root.
#[test]
fn a_longer_stack_never_costs_visits() {
    each(150, |name, tree, rays| {
        let work = |entries: u32| {
            let (mut visits, mut restarts) = (0, 0);
            for ray in rays {
                let (_, events, course) = closest(tree, ShortStack { entries }, ray);
                visits += events.inner_visits();
                restarts += events.restarts() - usize::from(course == Course::GivenOver) * events.restarts();
            }
            (visits, restarts)
        };
        let of: Vec<_> = [0, 1, 2, 4, 8, 16].map(work).to_vec();
        assert!(of.windows(2).all(|pair| pair[0].0 >= pair[1].0 && pair[0].1 >= pair[1].1), "{name}: {of:?}");
        // By push-down it restarts from deeper nodes than kd-restart.
        let from_root: usize = rays.iter().map(|ray| closest(tree, Restart, ray).1.inner_visits()).sum();
        assert!(of[0].0 <= from_root, "{name}: {} and {from_root}", of[0].0);
    });
}

/// A ray straight through a row of blocks is no doubt to any walk.
#[test]
fn plain_rays_are_not_given_over() {
    let tree = Scene::from_mesh(blocks()).build_kd(&builds()[1]).unwrap();
    let mut random = Random::new(1);
    let mut over = 0;
    for _ in 0..1000 {
        let (origin, dir) = (random.in_cube() * 6.0, random.direction());
        let ray = PreparedRay::new(&Ray::new(origin.as_vec3(), dir.as_vec3())).unwrap();
        over += usize::from(all(&tree, Restart, &ray).1 == Course::GivenOver);
        over += usize::from(all(&tree, Ropes, &ray).1 == Course::GivenOver);
    }
    assert!(over < 20, "{over} of 2000");
    let along = PreparedRay::new(&Ray::new(Vec3::new(-9.0, 0.3, 0.4), Vec3::X)).unwrap();
    for course in [all(&tree, Restart, &along).1, all(&tree, Ropes, &along).1] {
        assert_eq!(course, Course::Own);
    }
}
