//! The restart trail against the full stack, event by event, for points. Equal answers alone would not show a trail
//! that goes wrong, so the order of nodes is looked at, and trails with known faults must be found out.

use crate::splits::in_parts;
use ropewalk::bvh::walk::{ArrayTrail, BvhWalk, Ordered, RestartTrail, TrailU32, TrailU64};
use ropewalk::glam::{DQuat, DVec3};
use ropewalk::point::{CollectPoints, KeepClosest, KeepNearest, PointVisitor, PreparedPoint};
use ropewalk::{BuildOptions, Builder, Bvh, ClosestPoint, Mesh, NoProbe, PointQuery, Scene};
use ropewalk_testkit::faulty_trail::{Faulty, LAST_POP_LEVEL, NO_POP_LEVEL, PRINTED_CLEARING};
use ropewalk_testkit::meshes;
use ropewalk_testkit::points::{around, awkward};
use ropewalk_testkit::recorder::{Events, Fault, Recorder};

/// The words of the `k` nearest triangles' points, and what happened on the way to them.
fn record<W: BvhWalk<PreparedPoint>>(
    bvh: &Bvh,
    walk: W,
    query: &PointQuery,
    k: usize,
) -> (Vec<[u32; 9]>, Events) {
    fn events<W: BvhWalk<PreparedPoint>, C: CollectPoints>(
        bvh: &Bvh,
        walk: W,
        point: &PreparedPoint,
        keep: C,
    ) -> (C, Events) {
        let mut recorder = Recorder::new(PointVisitor::new(bvh, point, keep, NoProbe));
        walk.walk(bvh.nodes(), point, &mut recorder);
        let (visitor, events) = recorder.finish();
        (visitor.collect, events)
    }
    let point = PreparedPoint::new(query).unwrap();
    let mut found = Vec::new();
    let events = if k == 1 {
        let (keep, events) = events(bvh, walk, &point, KeepClosest::new(&point));
        found.push(keep.answer());
        events
    } else {
        let (keep, events) = events(bvh, walk, &point, KeepNearest::new(&point, k));
        keep.append_to(&mut found);
        events
    };
    (found.iter().map(ClosestPoint::to_words).collect(), events)
}

/// What is wrong with a walk, compared with the full stack on the same query.
fn faults<W: BvhWalk<PreparedPoint>>(bvh: &Bvh, walk: W, query: &PointQuery, k: usize) -> Vec<Fault> {
    Events::faults(&record(bvh, Ordered, query, k), &record(bvh, walk, query, k), false)
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
                    let found = [
                        faults(&bvh, RestartTrail::<ArrayTrail>::new(room), query, k),
                        faults(&bvh, RestartTrail::<TrailU32>::new(room), query, k),
                        faults(&bvh, RestartTrail::<TrailU64>::new(room), query, k),
                    ];
                    assert_eq!(found, [[]; 3], "{name}, {room} entries, k = {k}, {query:?}");
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
            let full = record(&bvh, Ordered, query, 1);
            assert_eq!(record(&bvh, RestartTrail::<TrailU64, 64>::new(64), query, 1), full, "{name}");
            assert_eq!(record(&bvh, RestartTrail::<ArrayTrail, 64>::new(64), query, 1), full, "{name}");
        }
    }
}

/// Leaning splinters in parts, a part a leaf: the point that a part's triangle has may be nearer than the part's box.
fn splinters_in_parts() -> (Bvh, Vec<PointQuery>) {
    let lean = DQuat::from_xyzw(0.3, -0.2, 0.5, 0.7).normalize();
    let mesh = meshes::mapped(meshes::soup(400, 0.4, 21), |point| lean * (point * DVec3::new(8.0, 0.5, 0.5)));
    let scene = Scene::from_mesh(mesh);
    let bvh = in_parts(&scene.flatten().unwrap().triangles, 6);
    assert!(bvh.report().references > bvh.report().triangles);
    (bvh, around(&scene.bounds(), 600, 6))
}

/// The paper's memory of the last pop alone is not enough there.
#[test]
fn with_spatial_splits_every_far_level_counts() {
    let (bvh, queries) = splinters_in_parts();
    let (mut twice, mut others) = (0, 0);
    for query in &queries {
        for k in [1, 3] {
            for room in [0, 1, 2, 4] {
                let found = [
                    faults(&bvh, RestartTrail::<ArrayTrail>::new(room), query, k),
                    faults(&bvh, RestartTrail::<TrailU64>::new(room), query, k),
                ];
                assert_eq!(found, [[]; 2], "{room} entries, k = {k}, {query:?}");
            }
            let last = faults(&bvh, RestartTrail::<Faulty<LAST_POP_LEVEL>>::new(0), query, k);
            twice += usize::from(last.contains(&Fault::LeafTwice));
            others += usize::from(last.contains(&Fault::AnotherAnswer));
        }
    }
    println!("{twice} searches enter a leaf twice, {others} answer otherwise");
    assert!(twice > 0 && others == 0, "{twice} {others}");
}

#[test]
fn broken_trails_are_found_out() {
    let (mut without, mut printed) = (Vec::new(), Vec::new());
    for (_, bvh, queries) in trees() {
        // The printed formulas seldom come to an end before they give up.
        for query in queries.iter().step_by(7) {
            for room in [0, 2] {
                without.extend(faults(&bvh, RestartTrail::<Faulty<NO_POP_LEVEL>>::new(room), query, 1));
                if printed.len() < 50 {
                    printed.extend(faults(
                        &bvh,
                        RestartTrail::<Faulty<PRINTED_CLEARING>>::new(room),
                        query,
                        1,
                    ));
                }
            }
        }
    }
    println!("{} without the level of the last pop, {} as printed", without.len(), printed.len());
    assert!(without.contains(&Fault::LeafTwice), "{without:?}");
    assert!(!without.contains(&Fault::AnotherAnswer), "answers alone do not show it");
    assert!(printed.contains(&Fault::DoesNotEnd) && printed.len() >= 50, "{printed:?}");
}
