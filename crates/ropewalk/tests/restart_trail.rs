//! The restart trail against the full stack, event by event. Equal hits alone would not show a trail that goes wrong:
//! without the level of the last pop, for one, all hits stay right and leaves are entered twice. So the order of the
//! leaves, the visits between them and the restarts are looked at, and trails with known faults must be found out.

use glam::Vec3;
use ropewalk::bvh::walk::{
    ArrayTrail, BvhWalk, ClosestHit, Collect, Ordered, RestartTrail, Summary, Trail, TrailU32, TrailU64,
    Visitor,
};
use ropewalk::bvh::{MAX_DEPTH, Node};
use ropewalk::catalogue::{TrailOptions, TrailRegister};
use ropewalk::{
    BuildOptions, Builder, Bvh, Counters, FlatTriangle, Mesh, PreparedRay, Query, Ray, Scene, TraceError,
    TraceOptions, Walk, glam,
};
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;
use std::ops::ControlFlow;

/// What a walk does, in its order.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Event {
    Inner(u32),
    Leaf(u32),
    Restart,
}

/// Records events, tests the triangles, and stops a walk that does not end.
struct Recorder<'a> {
    triangles: &'a [FlatTriangle],
    ray: &'a PreparedRay,
    closest: ClosestHit,
    events: Vec<Event>,
}

/// More than any walk of these tests takes.
const ENOUGH: usize = 200_000;

impl Visitor for Recorder<'_> {
    fn t_max(&self) -> f32 {
        self.closest.t_max()
    }

    fn inner_visit(&mut self, node: u32) {
        self.events.push(Event::Inner(node));
    }

    fn stack_depth(&mut self, _entries: usize) {}

    fn restart(&mut self) {
        self.events.push(Event::Restart);
    }

    fn leaf(&mut self, first: u32, count: u32) -> ControlFlow<()> {
        self.events.push(Event::Leaf(first));
        for triangle in &self.triangles[first as usize..][..count as usize] {
            if let Some(hit) = triangle.intersect(self.ray, self.closest.t_max()) {
                self.closest.offer(hit)?;
            }
        }
        if self.events.len() > ENOUGH { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

fn record<W: BvhWalk>(bvh: &Bvh, walk: W, ray: &PreparedRay) -> (ropewalk::Hit, Vec<Event>) {
    let mut recorder =
        Recorder { triangles: bvh.triangles(), ray, closest: ClosestHit::new(ray), events: Vec::new() };
    walk.walk(bvh.nodes(), ray, &mut recorder);
    (recorder.closest.answer(), recorder.events)
}

/// The leaves, in the order in which they were entered.
fn leaves(events: &[Event]) -> Vec<u32> {
    let leaf = |event: &Event| if let Event::Leaf(first) = event { Some(*first) } else { None };
    events.iter().filter_map(leaf).collect()
}

/// The nodes that were visited, each once, in the order of the first visit.
fn first_visits(events: &[Event]) -> Vec<Event> {
    let mut seen = std::collections::HashSet::new();
    let is_new = |event: &&Event| match event {
        Event::Inner(node) => seen.insert(*node),
        Event::Leaf(_) => true,
        Event::Restart => false,
    };
    events.iter().filter(is_new).copied().collect()
}

fn has_twice(leaves: &[u32]) -> bool {
    let mut sorted = leaves.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).any(|pair| pair[0] == pair[1])
}

/// What is wrong with a walk, compared with the full stack on the same ray.
fn fault<W: BvhWalk>(bvh: &Bvh, walk: W, ray: &PreparedRay) -> Option<&'static str> {
    let (full_hit, full) = record(bvh, Ordered, ray);
    let (hit, events) = record(bvh, walk, ray);
    if events.len() > ENOUGH {
        Some("it does not end")
    } else if hit.to_words() != full_hit.to_words() {
        Some("another hit")
    } else if has_twice(&leaves(&events)) {
        Some("a leaf was entered twice")
    } else if leaves(&events) != leaves(&full) {
        Some("other leaves, or in another order")
    } else if first_visits(&events) != first_visits(&full) {
        Some("other nodes, or in another order")
    } else if !events.contains(&Event::Restart) && events != full {
        Some("a walk without a restart is not that of the full stack")
    } else {
        None
    }
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
                assert_eq!(fault(bvh, RestartTrail::<ArrayTrail>::new(short_stack), ray), None, "{name}");
                assert_eq!(fault(bvh, RestartTrail::<TrailU64>::new(short_stack), ray), None, "{name}");
                if bvh.report().depth <= TrailU32::LEVELS {
                    assert_eq!(fault(bvh, RestartTrail::<TrailU32>::new(short_stack), ray), None, "{name}");
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
            events += full.len();
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

/// A register trail with a fault, by [`Faulty::FAULT`].
#[derive(Clone, Copy)]
struct Faulty<const FAULT: u8> {
    trail: u64,
    level: u64,
    pop_level: u64,
    pops: u32,
}

const NO_POP_LEVEL: u8 = 0;
const PRINTED_CLEARING: u8 = 1;
const PRINTED_LOWEST_BIT: u8 = 2;
const SOUND: u8 = 3;

impl<const FAULT: u8> Trail for Faulty<FAULT> {
    const LEVELS: u32 = 63;

    fn new() -> Self {
        Self { trail: 0, level: 1 << 63, pop_level: 0, pops: 0 }
    }

    fn descend(&mut self) {
        self.level >>= 1;
    }

    fn is_near_done(&self) -> bool {
        self.trail & self.level != 0
    }

    fn set_single(&mut self) {
        self.trail |= self.level;
    }

    fn is_pop_level(&self) -> bool {
        FAULT != NO_POP_LEVEL && self.level == self.pop_level
    }

    fn finish(&mut self) -> bool {
        self.trail = match FAULT {
            PRINTED_CLEARING => (self.trail & !self.level).wrapping_add(self.level),
            _ => (self.trail & self.level.wrapping_neg()).wrapping_add(self.level),
        };
        self.level = if FAULT == PRINTED_LOWEST_BIT {
            let half = self.trail >> 1;
            (half.wrapping_sub(1) ^ half).wrapping_add(1)
        } else {
            self.trail & self.trail.wrapping_neg()
        };
        self.pop_level = self.level;
        // A trail that leads in circles is to end some time.
        self.pops += 1;
        self.trail >> 63 == 0 && (self.pops as usize) < ENOUGH / 20
    }

    fn restart(&mut self) {
        self.level = 1 << 63;
    }
}

/// How many rays of all trees show a fault.
fn rays_at_fault<T: Trail + Sync>(short_stack: u32) -> usize {
    let mut count = 0;
    each(40, |_, bvh, rays| {
        count +=
            rays.iter().filter(|ray| fault(bvh, RestartTrail::<T>::new(short_stack), ray).is_some()).count();
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
            twice += usize::from(has_twice(&leaves(&events)));
            other_hits += usize::from(hit.to_words() != record(bvh, Ordered, ray).0.to_words());
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
                assert_eq!(fault(&bvh, RestartTrail::<ArrayTrail>::new(short_stack), &ray), None, "{depth}");
                if depth <= TrailU32::LEVELS {
                    assert_eq!(
                        fault(&bvh, RestartTrail::<TrailU32>::new(short_stack), &ray),
                        None,
                        "{depth}"
                    );
                }
                if depth <= TrailU64::LEVELS {
                    assert_eq!(
                        fault(&bvh, RestartTrail::<TrailU64>::new(short_stack), &ray),
                        None,
                        "{depth}"
                    );
                }
            }
        }
    }
    let printed = RestartTrail::<Faulty<PRINTED_LOWEST_BIT>>::new(1);
    assert!(fault(&chain(63, false), printed, &ray).is_some());
    assert!(fault(&chain(62, false), printed, &ray).is_none());
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
                    assert_eq!(fault(&bvh, walk, &ray), None, "{options:?}");
                    if max_depth == 31 {
                        let walk = RestartTrail::<TrailU32>::new(0);
                        assert_eq!(fault(&bvh, walk, &ray), None, "{options:?}");
                    }
                }
            }
        }
    }
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
