//! Every row of the catalogue of points, over every hard case and every builder.

use ropewalk::bvh::LeafOrder;
use ropewalk::catalogue::TrailOptions;
use ropewalk::point::catalogue;
use ropewalk::{BuildOptions, Builder, DeviceKind, PointQuery, PointSearch, TraceError, TraceOptions, Walk};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::points::{
    PointOracle, around, awkward, closest_against_oracle, invalid, nearest_against_oracle,
    same_closest_points, same_nearest_points,
};

const COUNTED: TraceOptions = TraceOptions { counters: true };

fn builds(case: &Case) -> Vec<BuildOptions> {
    let plain = BuildOptions::default();
    let sbvh = BuildOptions { builder: Builder::Sbvh, ..plain };
    let mut builds = vec![
        plain,
        BuildOptions { leaf_order: LeafOrder::Left, max_leaf: 1, ..plain },
        BuildOptions { builder: Builder::SweepSah, ..plain },
        BuildOptions { reinsertion: 2, ..plain },
        sbvh,
        BuildOptions { max_leaf: 1, duplication: 400, ..sbvh },
    ];
    builds.extend(case.depth_caps.iter().map(|&max_depth| BuildOptions { max_depth, max_leaf: 1, ..plain }));
    builds
}

#[test]
fn every_row_conforms() {
    let (mut asked, mut repeats) = (0, 0);
    for case in Case::every() {
        let flat = case.scene.flatten().unwrap();
        let oracle = PointOracle::new(&flat);
        let mut queries = awkward(&flat, 12, 1);
        queries.extend(invalid());
        let sizes = [0, 1, 3, 20, flat.triangles.len() + 5];
        let first = case.scene.build(&BuildOptions::default()).unwrap();
        let closest = first.closest_points(Walk::BruteForce, &queries, COUNTED).unwrap();
        closest_against_oracle(&oracle, &queries, &closest)
            .unwrap_or_else(|wrong| panic!("{}: {wrong}", case.name));
        let nearest = sizes.map(|k| {
            // Fewer where long lists are made of every triangle.
            let queries: Vec<PointQuery> =
                queries.iter().step_by(if k > 20 { 16 } else { 4 }).copied().collect();
            let lists = first.nearest_points(Walk::BruteForce, k, &queries, COUNTED).unwrap();
            nearest_against_oracle(&oracle, k, &queries, &lists)
                .unwrap_or_else(|wrong| panic!("{}, k = {k}: {wrong}", case.name));
            (k, queries, lists)
        });
        for build in builds(&case) {
            let bvh = case.scene.build(&build).unwrap();
            repeats += usize::from(bvh.has_repeats());
            for row in catalogue::rows().into_iter().filter(|row| row.device == DeviceKind::Cpu) {
                if let Err(TraceError::TooDeep { limit, .. }) = bvh.closest_points(row.walk, &[], COUNTED) {
                    assert!(bvh.report().depth > limit && limit >= 31);
                    continue;
                }
                let what = || format!("{}, {build:?}, {}, {}", case.name, row.walk, row.search);
                match row.search {
                    PointSearch::Closest => {
                        let given = bvh.closest_points(row.walk, &queries, COUNTED).unwrap();
                        same_closest_points(&queries, &closest, &given, false)
                            .unwrap_or_else(|wrong| panic!("{}: {wrong}", what()));
                        asked += queries.len();
                    }
                    PointSearch::Nearest => {
                        for (k, queries, lists) in &nearest {
                            let given = bvh.nearest_points(row.walk, *k, queries, COUNTED).unwrap();
                            same_nearest_points(queries, lists, &given, false)
                                .unwrap_or_else(|wrong| panic!("{}, k = {k}: {wrong}", what()));
                            asked += queries.len();
                        }
                    }
                }
            }
        }
    }
    println!("{asked} queries; {repeats} trees have a triangle in several leaves");
}

/// Each size of the short stack, single queries, and batches without counters.
#[test]
fn every_way_to_ask_is_the_same() {
    for name in ["soup", "placed", "far-1e6", "masks"] {
        let case = Case::named(name).unwrap();
        let flat = case.scene.flatten().unwrap();
        let bvh = case.scene.build(&BuildOptions { max_leaf: 1, ..BuildOptions::default() }).unwrap();
        let mut queries = awkward(&flat, 30, 2);
        queries.extend(invalid());
        let plain = TraceOptions::default();
        let closest = bvh.closest_points(Walk::default(), &queries, plain).unwrap();
        let nearest = bvh.nearest_points(Walk::default(), 5, &queries, plain).unwrap();
        assert!(closest.counters.is_none() && nearest.counters.is_none());
        for short_stack in 0..=TrailOptions::MAX_SHORT_STACK {
            let walk = Walk::RestartTrail(TrailOptions { short_stack, ..TrailOptions::default() });
            let given = bvh.closest_points(walk, &queries, plain).unwrap();
            same_closest_points(&queries, &closest, &given, true).unwrap();
            let given = bvh.nearest_points(walk, 5, &queries, plain).unwrap();
            same_nearest_points(&queries, &nearest, &given, true).unwrap();
        }
        let mut batch = vec![Default::default(); queries.len()];
        bvh.closest_point_batch(&queries, &mut batch);
        let mut list = Vec::new();
        for (index, query) in queries.iter().enumerate() {
            let alone = bvh.closest_point(query);
            assert_eq!(alone.to_words(), closest.points[index].to_words(), "{query:?}");
            assert_eq!(alone.to_words(), batch[index].to_words(), "{query:?}");
            bvh.nearest(query, 5, &mut list);
            assert_eq!(list, nearest.points.of(index), "{query:?}");
            assert!(list.first().is_none_or(|first| first.to_words() == alone.to_words()), "{query:?}");
        }
    }
}

/// The counters follow the one convention: brute force asks every triangle of every leaf, and so on.
#[test]
fn the_work_is_counted() {
    let case = Case::named("soup").unwrap();
    let bvh = case.scene.build(&BuildOptions::default()).unwrap();
    let report = bvh.report();
    let queries = around(&bvh.bounds(), 300, 3);
    let count =
        |walk: &str| bvh.closest_points(walk.parse().unwrap(), &queries, COUNTED).unwrap().counters.unwrap();
    for counters in count("brute-force") {
        let (leaves, triangles) = (counters.leaf_visits as usize, counters.primitive_tests as usize);
        assert_eq!((leaves, triangles), (report.leaves, report.triangles));
        assert_eq!((counters.inner_visits, counters.restarts, counters.stack_depth), (0, 0, 0));
    }
    let sizes = [0, 1, 2, 3, 4, 8, 16];
    let by_size = sizes.map(|size| count(&format!("restart-trail:short-stack={size}")));
    for (index, full) in count("stack").iter().enumerate() {
        assert!(full.inner_visits > 0 && full.leaf_visits > 0 && full.restarts == 0);
        assert!((full.primitive_tests as usize) < report.triangles / 2, "the boxes cull nothing: {full:?}");
        let mut before = u32::MAX;
        for (size, counters) in sizes.iter().zip(&by_size) {
            let given = counters[index];
            assert!((full.inner_visits..=before).contains(&given.inner_visits), "{size}: {given:?}");
            before = given.inner_visits;
            assert_eq!(given.leaf_visits, full.leaf_visits);
            assert_eq!(given.primitive_tests, full.primitive_tests);
            assert_eq!(given.stack_depth, full.stack_depth.min(*size));
            assert_eq!(given.restarts > 0, given.inner_visits > full.inner_visits);
        }
    }
}
