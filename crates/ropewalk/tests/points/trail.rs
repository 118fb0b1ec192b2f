//! The restart trail against the full stack, event by event, for points. Equal answers alone would not show a trail
//! that goes wrong, so the order of nodes is looked at, and trails with known faults must be found out.

use ropewalk::bvh::Node;
use ropewalk::bvh::walk::{ArrayTrail, Trail, TrailU32, TrailU64, Visitor};
use ropewalk::point::walk::{PointRestartTrail, PointStack, PointWalk};
use ropewalk::point::{CollectPoints, KeepClosest, KeepNearest, PreparedPoint, reach};
use ropewalk::{BuildOptions, Builder, Bvh, ClosestPoint, FlatTriangle, Mesh, PointQuery, Scene};
use ropewalk_testkit::meshes;
use ropewalk_testkit::points::{around, awkward};
use std::collections::HashSet;
use std::ops::ControlFlow;

/// What a walk does, in its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Event {
    Inner(u32),
    Leaf(u32),
    Restart,
}

/// Records events, asks the triangles, and stops a walk that does not end.
struct Recorder<'a, C> {
    triangles: &'a [FlatTriangle],
    point: &'a PreparedPoint,
    keep: C,
    events: Vec<Event>,
}

/// More than any walk of these tests takes.
const ENOUGH: usize = 100_000;

impl<C: CollectPoints> Visitor for Recorder<'_, C> {
    fn t_max(&self) -> f32 {
        reach(self.keep.limit())
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
            if let Some(found) = triangle.closest_point(self.point, self.t_max()) {
                self.keep.offer(found);
            }
        }
        if self.events.len() > ENOUGH { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// What is asked for: the nearest one or three.
fn record<W: PointWalk>(bvh: &Bvh, walk: W, query: &PointQuery, k: usize) -> (Vec<ClosestPoint>, Vec<Event>) {
    let point = PreparedPoint::new(query).unwrap();
    let (triangles, nodes): (_, &[Node]) = (bvh.triangles(), bvh.nodes());
    if k == 1 {
        let keep = KeepClosest::new(&point);
        let mut recorder = Recorder { triangles, point: &point, keep, events: Vec::new() };
        walk.walk(nodes, &point, &mut recorder);
        return (vec![recorder.keep.answer()], recorder.events);
    }
    let keep = KeepNearest::new(&point, k);
    let mut recorder = Recorder { triangles, point: &point, keep, events: Vec::new() };
    walk.walk(nodes, &point, &mut recorder);
    let mut found = Vec::new();
    recorder.keep.append_to(&mut found);
    (found, recorder.events)
}

fn leaves(events: &[Event]) -> Vec<Event> {
    events.iter().filter(|event| matches!(event, Event::Leaf(_))).copied().collect()
}

/// The nodes that were visited, each once, in the order of the first visit.
fn first_visits(events: &[Event]) -> Vec<Event> {
    let mut seen = HashSet::new();
    events.iter().filter(|&&event| event != Event::Restart && seen.insert(event)).copied().collect()
}

/// What is wrong with a walk, compared with the full stack on the same query.
fn fault<W: PointWalk>(bvh: &Bvh, walk: W, query: &PointQuery, k: usize) -> Option<&'static str> {
    let (full_found, full) = record(bvh, PointStack, query, k);
    let (found, events) = record(bvh, walk, query, k);
    let entered = leaves(&events);
    let different: HashSet<&Event> = entered.iter().collect();
    if events.len() > ENOUGH {
        Some("it does not end")
    } else if found != full_found {
        Some("another answer")
    } else if different.len() < entered.len() {
        Some("a leaf was entered twice")
    } else if entered != leaves(&full) {
        Some("other leaves, or in another order")
    } else if first_visits(&events) != first_visits(&full) {
        Some("other nodes, or in another order")
    } else if !events.contains(&Event::Restart) && events != full {
        Some("a walk without a restart is not that of the full stack")
    } else {
        None
    }
}

/// Trees of all kinds, small enough to be asked much.
fn trees() -> Vec<(String, Bvh, Vec<PointQuery>)> {
    let mut shells = Mesh::default();
    for radius in 1..6 {
        let shell = meshes::mapped(meshes::icosphere(2), |point| point * f64::from(radius) * 0.2);
        meshes::append(&mut shells, &shell);
    }
    let mut twice = meshes::soup(150, 0.8, 4);
    meshes::append(&mut twice, &meshes::soup(150, 0.8, 4));
    let scenes = [
        ("soup", meshes::soup(900, 0.4, 3)),
        ("shells", shells),
        ("twice", twice),
        ("grid", meshes::grid(1, 0.0, 24, 0.1)),
        ("one", meshes::soup(1, 0.5, 1)),
        ("two", meshes::soup(2, 0.5, 1)),
        ("nothing", Mesh::default()),
    ];
    let plain = BuildOptions { max_leaf: 1, ..BuildOptions::default() };
    let builds = [
        BuildOptions::default(),
        plain,
        BuildOptions { builder: Builder::SweepSah, ..plain },
        BuildOptions { max_depth: 5, ..plain },
    ];
    let mut trees = Vec::new();
    for (name, mesh) in scenes {
        let scene = Scene::from_mesh(mesh);
        let flat = scene.flatten().unwrap();
        let mut queries = awkward(&flat, 6, 3);
        queries.extend(around(&scene.bounds(), 60, 4));
        for build in builds {
            trees.push((format!("{name}, {build:?}"), scene.build(&build).unwrap(), queries.clone()));
        }
    }
    trees
}

#[test]
fn the_trail_goes_where_the_stack_goes() {
    for (name, bvh, queries) in trees() {
        for query in &queries {
            for k in [1, 3] {
                for room in [0, 1, 2, 3, 5, 8, 16] {
                    let faults = [
                        fault(&bvh, PointRestartTrail::<ArrayTrail>::new(room), query, k),
                        fault(&bvh, PointRestartTrail::<TrailU32>::new(room), query, k),
                        fault(&bvh, PointRestartTrail::<TrailU64>::new(room), query, k),
                    ];
                    assert_eq!(faults, [None; 3], "{name}, {room} entries, k = {k}, {query:?}");
                }
            }
        }
    }
}

/// With room for every entry there is no restart, and event follows event as with the full stack.
#[test]
fn an_unlimited_short_stack_is_the_full_stack() {
    for (name, bvh, queries) in trees() {
        for query in &queries {
            let full = record(&bvh, PointStack, query, 1);
            assert_eq!(record(&bvh, PointRestartTrail::<TrailU64, 64>::new(64), query, 1), full, "{name}");
            assert_eq!(record(&bvh, PointRestartTrail::<ArrayTrail, 64>::new(64), query, 1), full, "{name}");
        }
    }
}

/// A trail that forgets to which level the last pop led.
#[derive(Clone, Copy)]
struct WithoutPopLevel(TrailU32);

/// The register as the paper prints it. It gives up after a number of steps, because a walk may run in a circle without
/// ever coming to a leaf, where a visitor could stop it.
#[derive(Clone, Copy)]
struct AsPrinted {
    trail: u32,
    level: u32,
    pop_level: u32,
    steps: usize,
}

impl Trail for WithoutPopLevel {
    const LEVELS: u32 = TrailU32::LEVELS;
    fn new() -> Self {
        Self(TrailU32::new())
    }
    fn descend(&mut self) {
        self.0.descend();
    }
    fn is_near_done(&self) -> bool {
        self.0.is_near_done()
    }
    fn set_single(&mut self) {
        self.0.set_single();
    }
    fn is_pop_level(&self) -> bool {
        false
    }
    fn finish(&mut self) -> bool {
        self.0.finish()
    }
    fn restart(&mut self) {
        self.0.restart();
    }
}

impl Trail for AsPrinted {
    const LEVELS: u32 = 31;
    fn new() -> Self {
        Self { trail: 0, level: 1 << 31, pop_level: 0, steps: 0 }
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
        self.level == self.pop_level
    }
    fn finish(&mut self) -> bool {
        self.trail &= !self.level;
        self.trail = self.trail.wrapping_add(self.level);
        let half = self.trail >> 1;
        self.level = (half.wrapping_sub(1) ^ half).wrapping_add(1);
        self.pop_level = self.level;
        self.steps += 1;
        self.trail >> 31 == 0 && self.steps < 2 * ENOUGH
    }
    fn restart(&mut self) {
        self.level = 1 << 31;
    }
}

#[test]
fn broken_trails_are_found_out() {
    let (mut without, mut printed) = (Vec::new(), Vec::new());
    for (_, bvh, queries) in trees() {
        // The printed formulas seldom come to an end before they give up.
        for query in queries.iter().step_by(7) {
            for room in [0, 2] {
                without.extend(fault(&bvh, PointRestartTrail::<WithoutPopLevel>::new(room), query, 1));
                if printed.len() < 50 {
                    printed.extend(fault(&bvh, PointRestartTrail::<AsPrinted>::new(room), query, 1));
                }
            }
        }
    }
    println!("{} without the level of the last pop, {} as printed", without.len(), printed.len());
    assert!(without.contains(&"a leaf was entered twice"), "{without:?}");
    assert!(!without.contains(&"another answer"), "answers alone do not show it");
    assert!(printed.contains(&"it does not end") && printed.len() >= 50, "{printed:?}");
}
