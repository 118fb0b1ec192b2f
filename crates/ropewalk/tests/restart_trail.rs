//! The restart trail against the full stack, event by event. Equal hits alone would not show a trail that goes wrong:
//! without the level of the last pop, for one, all hits stay right and leaves are entered twice. So the order of the
//! leaves, the visits between them and the restarts are looked at, and trails with known faults must be found out.

use glam::Vec3;
use ropewalk::bvh::walk::{
    ArrayTrail, BvhWalk, ClosestHit, Ordered, RestartTrail, Summary, Trail, TrailU32, TrailU64,
    TriangleVisitor,
};
use ropewalk::bvh::{MAX_DEPTH, Node};
use ropewalk::catalogue::{TrailOptions, TrailRegister};
use ropewalk::{
    BuildOptions, Builder, Bvh, Counters, FlatTriangle, Mesh, NoProbe, PreparedRay, Query, Ray, Scene,
    TraceError, TraceOptions, Walk, glam,
};
use ropewalk_testkit::faulty_trail::{Faulty, NO_POP_LEVEL, PRINTED_CLEARING, PRINTED_LOWEST_BIT, SOUND};
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;
use ropewalk_testkit::recorder::{Events, Fault, Recorder};

/// The words of the closest hit, and what happened on the way to it.
fn record<W: BvhWalk>(bvh: &Bvh, walk: W, ray: &PreparedRay) -> ([u32; 7], Events) {
    let mut recorder = Recorder::new(TriangleVisitor {
        triangles: bvh.triangles(),
        ray,
        collect: ClosestHit::new(ray),
        probe: NoProbe,
    });
    walk.walk(bvh.nodes(), ray, &mut recorder);
    let (visitor, events) = recorder.finish();
    (visitor.collect.answer().to_words(), events)
}

/// What is wrong with a walk, compared with the full stack on the same ray.
fn faults<W: BvhWalk>(bvh: &Bvh, walk: W, ray: &PreparedRay) -> Vec<Fault> {
    Events::faults(&record(bvh, Ordered, ray), &record(bvh, walk, ray), false)
}

/// Scenes in which rays meet many boxes that overlap, with rays through them.
fn scenes() -> Vec<(&'static str, Scene)> {
    let mut shells = Mesh::default();
    for radius in 1..6 {
        meshes::append(
            &mut shells,
            &meshes::mapped(meshes::icosphere(2), |point| point * f64::from(radius) * 0.2),
        );
    }
    let mut twice = meshes::soup(150, 0.8, 4);
    meshes::append(&mut twice, &meshes::soup(150, 0.8, 4));
    vec![
        ("soup", Scene::from_mesh(meshes::soup(900, 0.4, 3))),
        ("shells", Scene::from_mesh(shells)),
        ("twice", Scene::from_mesh(twice)),
        ("grid", Scene::from_mesh(meshes::grid(1, 0.0, 24, 0.1))),
        ("one", Scene::from_mesh(meshes::soup(1, 0.5, 1))),
        ("two", Scene::from_mesh(meshes::soup(2, 0.5, 1))),
        ("nothing", Scene::from_mesh(Mesh::default())),
    ]
}

fn builds() -> Vec<BuildOptions> {
    let plain = BuildOptions::default();
    let one = BuildOptions { max_leaf: 1, ..plain };
    vec![
        plain,
        one,
        BuildOptions { builder: Builder::SweepSah, ..one },
        BuildOptions { builder: Builder::Sbvh, ..one },
        BuildOptions { reinsertion: 2, ..one },
        BuildOptions { max_depth: 5, ..one },
    ]
}

fn rays(seed: u64, count: usize) -> Vec<PreparedRay> {
    let mut random = Random::new(seed);
    let mut ray = |index: usize| {
        let (origin, target) = (random.direction() * 3.0, random.in_cube());
        let dir = target - origin;
        // Every third along an axis, where boxes are entered together.
        let dir =
            if index.is_multiple_of(3) { glam::DVec3::AXES[index % 9 / 3] * -origin.signum() } else { dir };
        let origin = if index.is_multiple_of(3) { target - 3.0 * dir } else { origin };
        PreparedRay::new(&Ray::new(origin.as_vec3(), dir.as_vec3())).unwrap()
    };
    (0..count).map(&mut ray).collect()
}

/// Calls `check` with every tree and its rays.
fn each(rays_a_tree: usize, mut check: impl FnMut(&str, &Bvh, &[PreparedRay])) {
    for (name, scene) in scenes() {
        for options in builds() {
            let bvh = scene.build(&options).unwrap();
            check(&format!("{name}, {options:?}"), &bvh, &rays(7, rays_a_tree));
        }
    }
}

#[test]
fn every_stack_and_register_walks_like_the_full_stack() {
    each(120, |name, bvh, rays| {
        for ray in rays {
            for short_stack in 0..=16 {
                assert_eq!(faults(bvh, RestartTrail::<ArrayTrail>::new(short_stack), ray), [], "{name}");
                assert_eq!(faults(bvh, RestartTrail::<TrailU64>::new(short_stack), ray), [], "{name}");
                if bvh.report().depth <= TrailU32::LEVELS {
                    assert_eq!(faults(bvh, RestartTrail::<TrailU32>::new(short_stack), ray), [], "{name}");
                }
            }
        }
    });
}

/// Node for node, not only each for the first time.
#[test]
fn with_an_unlimited_stack_the_sequence_is_that_of_the_full_stack() {
    let mut events = 0;
    each(200, |name, bvh, rays| {
        for ray in rays {
            let (_, full) = record(bvh, Ordered, ray);
            let (_, trail) = record(bvh, RestartTrail::<TrailU64, 64>::new(64), ray);
            assert_eq!(trail, full, "{name}");
            let (_, trail) = record(bvh, RestartTrail::<ArrayTrail, 64>::new(64), ray);
            assert_eq!(trail, full, "{name}");
            events += full.0.len();
        }
    });
    assert!(events > 100_000, "only {events} events were compared");
}

/// The visits of all rays fall with each further entry, and the registers agree on every count.
#[test]
fn a_longer_stack_never_costs_visits() {
    each(200, |name, bvh, rays| {
        let work = |short_stack: u32| {
            let walk = RestartTrail::<ArrayTrail>::new(short_stack);
            let mut total = Counters::default();
            for ray in rays {
                let (_, counted) = bvh.visit(walk, ray, ClosestHit::new(ray), Counters::default());
                let register = RestartTrail::<TrailU64>::new(short_stack);
                let same = bvh.visit(register, ray, ClosestHit::new(ray), Counters::default()).1;
                assert_eq!(counted, same, "{name}");
                assert!(counted.stack_depth <= short_stack);
                total.inner_visits += counted.inner_visits;
                total.restarts += counted.restarts;
            }
            (total.inner_visits, total.restarts)
        };
        let of: Vec<_> = (0..=16).map(work).collect();
        assert!(of.windows(2).all(|pair| pair[0].0 >= pair[1].0 && pair[0].1 >= pair[1].1), "{name}: {of:?}");
    });
}

/// How many rays of all trees show a fault.
fn rays_at_fault<T: Trail + Sync>(short_stack: u32) -> usize {
    let mut count = 0;
    each(40, |_, bvh, rays| {
        count += rays
            .iter()
            .filter(|ray| !faults(bvh, RestartTrail::<T>::new(short_stack), ray).is_empty())
            .count();
    });
    count
}

#[test]
fn trails_with_known_faults_are_found_out() {
    assert_eq!(rays_at_fault::<Faulty<SOUND>>(2), 0, "the scaffold itself is sound");
    for short_stack in [0, 1, 2] {
        assert!(rays_at_fault::<Faulty<NO_POP_LEVEL>>(short_stack) > 0, "popLevel, {short_stack}");
        assert!(rays_at_fault::<Faulty<PRINTED_CLEARING>>(short_stack) > 100, "clearing, {short_stack}");
    }
}

/// Without the level of the last pop every hit is still right: only the leaves that are entered twice tell.
#[test]
fn without_the_pop_level_leaves_are_entered_twice() {
    let (mut twice, mut other_hits) = (0, 0);
    each(120, |_, bvh, rays| {
        for ray in rays {
            let (hit, events) = record(bvh, RestartTrail::<Faulty<NO_POP_LEVEL>>::new(0), ray);
            twice += usize::from(events.enters_a_leaf_twice());
            other_hits += usize::from(hit != record(bvh, Ordered, ray).0);
        }
    });
    assert!(twice > 10, "{twice} rays entered a leaf twice");
    assert_eq!(other_hits, 0);
}

/// A tree in which every inner node has a leaf, as its first child or as its second one, down to `depth`. All boxes are
/// the same, so that nothing is culled before its turn and the first child is always the near one: with the leaves
/// second every level waits until the deepest leaf is done.
fn chain(depth: u32, leaf_first: bool) -> Bvh {
    let corner = |index: u32, x: f32, y: f32| [x, y, -1.0 - (index % 7) as f32];
    let triangles: Vec<FlatTriangle> = (0..=depth)
        .map(|index| FlatTriangle {
            v0: corner(index, -2.0, -2.0),
            primitive: index,
            v1: corner(index, 2.0, -2.0),
            geometry_and_mirror: 0,
            v2: corner(index, 0.0, 3.0),
            instance_and_mask: 0xff00_0000,
        })
        .collect();
    let bounds = ropewalk::Aabb::new(Vec3::new(-2.0, -2.0, -8.0), Vec3::new(2.0, 3.0, -1.0));
    let leaf = |level: u32| Node::leaf(&bounds, level, 1);
    let mut nodes = Vec::new();
    if leaf_first {
        for level in 0..depth {
            nodes.push(Node::inner(&bounds, 2 * level + 2));
            nodes.push(leaf(level));
        }
        nodes.push(leaf(depth));
    } else {
        nodes.extend((0..depth).map(|level| Node::inner(&bounds, 2 * depth - level)));
        nodes.extend((0..=depth).rev().map(leaf));
    }
    Bvh::from_parts(nodes, triangles).unwrap()
}

/// The printed way to the lowest bit loses bit 0, which is the level of the deepest leaves.
#[test]
fn the_deepest_level_of_a_register_counts() {
    let ray = PreparedRay::new(&Ray::new(Vec3::ZERO, Vec3::NEG_Z)).unwrap();
    for depth in [1, 2, 30, 31, 62, 63, MAX_DEPTH] {
        for leaf_first in [false, true] {
            let bvh = chain(depth, leaf_first);
            assert_eq!(bvh.report().depth, depth);
            for short_stack in 0..=16 {
                assert_eq!(faults(&bvh, RestartTrail::<ArrayTrail>::new(short_stack), &ray), [], "{depth}");
                if depth <= TrailU32::LEVELS {
                    assert_eq!(faults(&bvh, RestartTrail::<TrailU32>::new(short_stack), &ray), [], "{depth}");
                }
                if depth <= TrailU64::LEVELS {
                    assert_eq!(faults(&bvh, RestartTrail::<TrailU64>::new(short_stack), &ray), [], "{depth}");
                }
            }
        }
    }
    let printed = RestartTrail::<Faulty<PRINTED_LOWEST_BIT>>::new(1);
    assert_ne!(faults(&chain(63, false), printed, &ray), []);
    assert_eq!(faults(&chain(62, false), printed, &ray), []);
}

/// A register that is too short is refused, and the refusal says what to do; the automatic choice always serves.
#[test]
fn a_tree_too_deep_for_a_register_is_an_error() {
    let rays = [Ray::new(Vec3::ZERO, Vec3::NEG_Z)];
    for depth in [31, 32, 63, 64] {
        let bvh = chain(depth, false);
        let trace = |register| {
            let walk = Walk::RestartTrail(TrailOptions { register, ..TrailOptions::default() });
            bvh.trace(walk, Query::Closest, &rays, TraceOptions::default())
        };
        let full = bvh.trace(Walk::default(), Query::Closest, &rays, TraceOptions::default()).unwrap();
        for (register, limit) in [(TrailRegister::U32, 31), (TrailRegister::U64, 63)] {
            match trace(register) {
                Ok(traced) => assert_eq!((traced, depth <= limit), (full.clone(), true)),
                Err(error @ TraceError::TooDeep { .. }) => {
                    assert!(depth > limit);
                    let text = error.to_string();
                    assert!(text.contains(&format!("max-depth={limit}")), "{text}");
                    assert!(text.contains(&format!("this one has {depth}")), "{text}");
                }
                Err(other) => panic!("{other}"),
            }
        }
        for register in [TrailRegister::Auto, TrailRegister::Array] {
            assert_eq!(trace(register).unwrap(), full);
        }
    }
}

/// Input that would go deeper than the cap: right answers from a tree that keeps it.
#[test]
fn capped_builders_serve_the_registers() {
    let mut mesh = Mesh::default();
    let mut random = Random::new(31);
    for k in 0..120 {
        let size = 0.5f64.powi(k);
        let center = glam::DVec3::new(size, 0.3 * size, 0.1 * size);
        meshes::push(&mut mesh, [(); 3].map(|()| center + random.in_cube() * (0.3 * size)));
    }
    let scene = Scene::from_mesh(mesh);
    let uncapped = BuildOptions { max_leaf: 1, max_depth: MAX_DEPTH, ..BuildOptions::default() };
    assert!(scene.build(&uncapped).unwrap().report().depth > 31, "the input wants to go deeper");
    for builder in [Builder::BinnedSah, Builder::SweepSah, Builder::Sbvh] {
        for reinsertion in [0, 2] {
            for max_depth in [31, 63] {
                let options = BuildOptions { builder, reinsertion, max_depth, ..uncapped };
                let bvh = scene.build(&options).unwrap();
                assert!(bvh.report().depth <= max_depth);
                for ray in rays(9, 300) {
                    let walk = RestartTrail::<TrailU64>::new(1);
                    assert_eq!(faults(&bvh, walk, &ray), [], "{options:?}");
                    if max_depth == 31 {
                        let walk = RestartTrail::<TrailU32>::new(0);
                        assert_eq!(faults(&bvh, walk, &ray), [], "{options:?}");
                    }
                }
            }
        }
    }
}

/// Culling at pop spares visits and changes no hit.
#[test]
fn without_culling_at_pop_the_hits_are_the_same() {
    let (mut with, mut without) = (0, 0);
    each(120, |name, bvh, rays| {
        for ray in rays {
            let (hit, events) = record(bvh, Ordered, ray);
            with += events.inner_visits();
            for short_stack in [0, 1, 3, 64] {
                let walk = RestartTrail::<ArrayTrail, 64, false>::new(short_stack);
                let (other, events) = record(bvh, walk, ray);
                assert_eq!(other, hit, "{name}, {short_stack} entries");
                assert!(events.ends() && !events.enters_a_leaf_twice(), "{name}, {short_stack} entries");
                if short_stack == 64 {
                    without += events.inner_visits();
                }
            }
        }
    });
    assert!(with < without, "{with} visits with culling at pop, {without} without");
}

/// All four queries, counted and plain, through the catalogue's own door.
#[test]
fn every_query_gives_the_answers_of_the_full_stack() {
    for (name, scene) in scenes() {
        for options in builds() {
            let bvh = scene.build(&options).unwrap();
            let mut random = Random::new(5);
            let ray = |_| Ray::new((random.direction() * 2.0).as_vec3(), random.in_cube().as_vec3());
            let rays: Vec<Ray> = (0..200).map(ray).collect();
            for query in Query::EVERY {
                let full = bvh.trace(Walk::default(), query, &rays, TraceOptions::default()).unwrap();
                for short_stack in [0, 1, 3, 16] {
                    let walk = Walk::RestartTrail(TrailOptions { short_stack, ..TrailOptions::default() });
                    let plain = bvh.trace(walk, query, &rays, TraceOptions::default()).unwrap();
                    assert_eq!(plain, full, "{name} {query} {walk}");
                    let counted = bvh.trace(walk, query, &rays, TraceOptions { counters: true }).unwrap();
                    assert_eq!(counted.answer, full.answer, "{name} {query} {walk}");
                }
            }
        }
    }
}
