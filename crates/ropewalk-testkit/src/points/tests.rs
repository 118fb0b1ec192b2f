//! The comparators, fed with wrong answers of every kind.

use super::*;
use crate::meshes;
use glam::{Vec2, Vec3};
use ropewalk::{
    BuildOptions, Bvh, ClosestPoint, Counters, Hit, NearestLists, PointAnswers, PointQuery, Scene, Status,
    TraceOptions, Transform, Walk,
};

/// Two instances of one soup at the same place, the second one seen by few, and a third one elsewhere.
fn scene() -> Scene {
    let mut scene = Scene::default();
    let soup = scene.add_object(meshes::soup(60, 0.3, 8));
    scene.add_instance(soup, Transform::IDENTITY);
    scene.add_instance(soup, Transform::IDENTITY);
    scene.add_instance(soup, Transform::from_translation(Vec3::splat(2.0)));
    scene.instances[2].mask = 0x02;
    scene
}

fn answer(bvh: &Bvh, query: &PointQuery) -> ClosestPoint {
    let found = bvh.closest_point(query);
    assert!(found.is_found());
    found
}

#[test]
fn every_kind_of_wrong_closest_point_is_found_out() {
    let scene = scene();
    let (bvh, oracle) =
        (scene.build(&BuildOptions::default()).unwrap(), PointOracle::of_scene(&scene).unwrap());
    let mut kinds = 0;
    for query in around(&bvh.bounds(), 50, 3) {
        let right = answer(&bvh, &query);
        assert_eq!(oracle.closest_objection(&query, &right), None, "{query:?}");
        let objects = |what: &str, query: &PointQuery, wrong: ClosestPoint| {
            let objection = oracle.closest_objection(query, &wrong);
            assert!(objection.is_some(), "{what} passed: {query:?} {wrong:?}");
        };
        objects("a miss", &query, ClosestPoint::NONE);
        objects("a distance too far", &query, ClosestPoint { distance: right.distance * 1.001, ..right });
        objects("a distance too near", &query, ClosestPoint { distance: right.distance * 0.999, ..right });
        objects("no number", &query, ClosestPoint { distance: f32::NAN, ..right });
        objects("the twin", &query, ClosestPoint { instance_index: right.instance_index + 1, ..right });
        objects(
            "another primitive",
            &query,
            ClosestPoint { primitive_index: (right.primitive_index + 1) % 60, ..right },
        );
        objects("no such primitive", &query, ClosestPoint { primitive_index: 60, ..right });
        objects("no such geometry", &query, ClosestPoint { geometry_index: 1, ..right });
        objects("another point", &query, ClosestPoint { point: right.point + Vec3::X * 1e-3, ..right });
        objects("no point", &query, ClosestPoint { point: Vec3::NAN, ..right });
        let [u, v] = right.barycentrics.to_array();
        if (u - v).abs() > 1e-3 {
            objects("exchanged weights", &query, ClosestPoint { barycentrics: Vec2::new(v, u), ..right });
            kinds += 1;
        }
        objects("weights of no point", &query, ClosestPoint { barycentrics: Vec2::new(-0.1, u), ..right });
        objects("beyond the radius", &query.within(right.distance.next_down()), right);
        objects("a miss at the radius", &query.within(right.distance * 1.001), ClosestPoint::NONE);
        objects("what is not seen", &query.with_mask(0), right);
        objects("an answer to no question", &query.within(-1.0), right);
        let left_over = ClosestPoint { primitive_index: Hit::NONE, ..right };
        objects("what is left over", &query.with_mask(0), left_over);
        assert_eq!(oracle.closest_objection(&query.with_mask(0), &ClosestPoint::NONE), None);
        assert_eq!(oracle.closest_objection(&query.within(-1.0), &ClosestPoint::NONE), None);
        // The second nearest shape, described rightly, is still wrong.
        let mut nearest = Vec::new();
        bvh.nearest(&query, 5, &mut nearest);
        let second = nearest.iter().find(|other| other.distance > right.distance * 1.001);
        objects("the second nearest", &query, *second.unwrap());
    }
    assert!(kinds > 25);
}

#[test]
fn every_kind_of_wrong_list_is_found_out() {
    let scene = scene();
    let (bvh, oracle) =
        (scene.build(&BuildOptions::default()).unwrap(), PointOracle::of_scene(&scene).unwrap());
    for (index, query) in around(&bvh.bounds(), 40, 4).into_iter().enumerate() {
        let k = 1 + index % 9;
        let mut right = Vec::new();
        bvh.nearest(&query, k, &mut right);
        assert_eq!(right.len(), k);
        assert_eq!(oracle.nearest_objection(&query, k, &right), None, "{query:?}");
        let objects = |what: &str, k: usize, wrong: &[ClosestPoint]| {
            assert!(oracle.nearest_objection(&query, k, wrong).is_some(), "{what} passed: {query:?}");
        };
        objects("one too few", k, &right[1..]);
        objects("one too many", k - 1, &right);
        let mut wrong = right.clone();
        wrong.insert(0, right[0]);
        objects("one twice", k + 1, &wrong);
        let mut all = Vec::new();
        bvh.nearest(&query, usize::MAX, &mut all);
        assert_eq!(all.len(), 180);
        assert_eq!(oracle.nearest_objection(&query, usize::MAX, &all), None);
        wrong.clone_from(&right);
        wrong[k - 1] = all[170];
        objects("a farther one", k, &wrong);
        if k > 1 {
            wrong.clone_from(&right);
            wrong.swap(0, k - 1);
            objects("out of order", k, &wrong);
        }
        wrong.clone_from(&right);
        wrong[0].distance *= 0.99;
        objects("a wrong distance", k, &wrong);
        // Of twins the one with the smaller id must be there.
        let last = right[k - 1];
        if k % 2 == 1 && all[k].distance == last.distance {
            wrong.clone_from(&right);
            wrong[k - 1] = all[k];
            objects("the later twin alone", k, &wrong);
        }
        assert_eq!(oracle.nearest_objection(&query.with_mask(0), k, &[]), None);
        assert!(oracle.nearest_objection(&query.within(f32::NAN), k, &right).is_some());
    }
}

#[test]
fn the_blocks_leave_nothing_out() {
    let scene = Scene::from_mesh(meshes::soup(700, 0.1, 5));
    let flat = scene.flatten().unwrap();
    let oracle = PointOracle::new(&flat);
    for query in awkward(&flat, 60, 6).into_iter().filter(|query| query.mask & 0xff == 0xff) {
        let distances = flat.triangles.iter().map(|triangle| {
            Measured::new(query.point.as_dvec3(), &triangle.triangle().vertices.map(Vec3::as_dvec3)).high
        });
        assert_eq!(oracle.certain_within(&query), distances.fold(f64::INFINITY, f64::min), "{query:?}");
    }
}

#[test]
fn batches_are_compared_word_by_word() {
    let scene = scene();
    let bvh = scene.build(&BuildOptions::default()).unwrap();
    let oracle = PointOracle::of_scene(&scene).unwrap();
    let mut queries = around(&bvh.bounds(), 20, 5);
    queries.extend(invalid());
    let options = TraceOptions { counters: true };
    let right = bvh.closest_points(Walk::default(), &queries, options).unwrap();
    let lists = bvh.nearest_points(Walk::default(), 3, &queries, options).unwrap();
    assert_eq!(same_closest_points(&queries, &right, &right, true), Ok(()));
    assert_eq!(same_nearest_points(&queries, &lists, &lists, true), Ok(()));
    assert_eq!(closest_against_oracle(&oracle, &queries, &right), Ok(()));
    assert_eq!(nearest_against_oracle(&oracle, 3, &queries, &lists), Ok(()));

    let spoil = |change: &dyn Fn(&mut PointAnswers<Vec<ClosestPoint>>)| {
        let mut wrong = right.clone();
        change(&mut wrong);
        assert!(same_closest_points(&queries, &right, &wrong, true).is_err());
        closest_against_oracle(&oracle, &queries, &wrong).is_err()
    };
    assert!(spoil(&|wrong| wrong.points.truncate(1)));
    assert!(spoil(&|wrong| wrong.status[2] = Status::INVALID_RAY));
    assert!(spoil(&|wrong| wrong.status[20] = Status::COMPLETE));
    assert!(spoil(&|wrong| wrong.points[4] = ClosestPoint::NONE));
    assert!(spoil(&|wrong| wrong.points[21].distance = 0.0));
    assert!(
        !spoil(&|wrong| wrong.points[4].distance = wrong.points[4].distance.next_up()),
        "one float is no error"
    );
    assert!(!spoil(&|wrong| wrong.counters = None));
    assert!(!spoil(&|wrong| {
        let counters = wrong.counters.as_mut().unwrap();
        counters[3] = Counters { restarts: 1, ..counters[3] };
    }));
    assert!(spoil(&|wrong| wrong.counters = Some(Vec::new())));

    let spoil = |change: &dyn Fn(&mut NearestLists)| {
        let mut wrong = lists.clone();
        change(&mut wrong.points);
        assert!(same_nearest_points(&queries, &lists, &wrong, true).is_err());
        assert!(nearest_against_oracle(&oracle, 3, &queries, &wrong).is_err());
    };
    spoil(&|wrong| wrong.offsets[1] -= 1);
    spoil(&|wrong| wrong.offsets[3] = 1);
    spoil(&|wrong| wrong.points.truncate(5));
    spoil(&|wrong| wrong.offsets.clear());
    spoil(&|wrong| wrong.points[7] = ClosestPoint::NONE);
    let text = closest_against_oracle(
        &oracle,
        &queries,
        &PointAnswers { points: vec![ClosestPoint::NONE; queries.len()], ..right.clone() },
    )
    .unwrap_err()
    .to_string();
    assert!(text.starts_with("query 0 (point [") && text.contains("mask 0xff"), "{text}");
}
