//! A scanned model: the Stanford bunny, where its file is at hand.

use ropewalk::glam::Vec3;
use ropewalk::{BuildOptions, Builder, Bvh, CounterTotals, Mesh, Scene, SignedDistance, TraceOptions};
use ropewalk_testkit::points::{
    PointOracle, around, closest_against_oracle, nearest_against_oracle, same_closest_points,
    same_nearest_points,
};
use std::path::PathBuf;

const COUNTED: TraceOptions = TraceOptions { counters: true };

/// Just enough of PLY for this file.
fn bunny() -> Option<Mesh> {
    use std::io::Read;
    let scenes = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes"));
    let path = scenes.join("stanford_bunny/bun_zipper.ply.gz");
    let Ok(packed) = std::fs::read(&path) else {
        println!("skipped: {} is not there", path.display());
        return None;
    };
    let mut text = String::new();
    flate2::read::GzDecoder::new(&packed[..]).read_to_string(&mut text).unwrap();
    let (header, body) = text.split_once("end_header").unwrap();
    let count = |element: &str| -> usize {
        let line = header.lines().find_map(|line| line.strip_prefix(element)).unwrap();
        line.trim().parse().unwrap()
    };
    let (vertices, faces) = (count("element vertex"), count("element face"));
    let mut lines = body.trim_start().lines();
    let mut mesh = Mesh::default();
    for line in lines.by_ref().take(vertices) {
        let numbers: Vec<f32> = line.split_whitespace().take(3).map(|word| word.parse().unwrap()).collect();
        mesh.positions.push(Vec3::from_slice(&numbers));
    }
    for line in lines.take(faces) {
        let corners: Vec<u32> = line.split_whitespace().skip(1).map(|word| word.parse().unwrap()).collect();
        mesh.triangles.push([corners[0], corners[1], corners[2]]);
    }
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (35_947, 69_451));
    Some(mesh)
}

fn totals(bvh: &Bvh, walk: &str, queries: &[ropewalk::PointQuery]) -> CounterTotals {
    let answers = bvh.closest_points(walk.parse().unwrap(), queries, COUNTED).unwrap();
    answers.counters.unwrap().iter().collect()
}

#[test]
fn the_bunny_is_as_far_as_brute_force_says() {
    let Some(mesh) = bunny() else { return };
    let scene = Scene::from_mesh(mesh);
    let oracle = PointOracle::of_scene(&scene).unwrap();
    let plain = BuildOptions::default();
    let queries = around(&scene.bounds(), 2000, 1);
    let first = scene.build(&plain).unwrap();
    let closest = first.closest_points("brute-force".parse().unwrap(), &queries, COUNTED).unwrap();
    let nearest = first.nearest_points("brute-force".parse().unwrap(), 8, &queries[..300], COUNTED).unwrap();
    closest_against_oracle(&oracle, &queries, &closest).unwrap();
    nearest_against_oracle(&oracle, 8, &queries[..300], &nearest).unwrap();
    for build in [plain, BuildOptions { builder: Builder::Sbvh, max_leaf: 1, ..plain }] {
        let bvh = scene.build(&build).unwrap();
        let walks = ["stack", "restart-trail:short-stack=0", "restart-trail:short-stack=1", "restart-trail"];
        for walk in walks.map(|walk| walk.parse().unwrap()) {
            let given = bvh.closest_points(walk, &queries, COUNTED).unwrap();
            same_closest_points(&queries, &closest, &given, false)
                .unwrap_or_else(|wrong| panic!("{walk}: {wrong}"));
            let given = bvh.nearest_points(walk, 8, &queries[..300], COUNTED).unwrap();
            same_nearest_points(&queries[..300], &nearest, &given, false)
                .unwrap_or_else(|wrong| panic!("{walk}: {wrong}"));
        }
    }
}

/// What the trail costs: more inner visits with fewer entries, and the same leaves.
#[test]
fn the_trail_costs_visits_only() {
    let Some(mesh) = bunny() else { return };
    let scene = Scene::from_mesh(mesh);
    let queries = around(&scene.bounds(), 2000, 2);
    for max_leaf in [1, 4, 8] {
        let bvh = scene.build(&BuildOptions { max_leaf, ..BuildOptions::default() }).unwrap();
        let full = totals(&bvh, "stack", &queries);
        let per_query = |count: u64| count as f64 / queries.len() as f64;
        println!(
            "leaves of {max_leaf}: {:.2} inner visits, {:.2} leaves, {:.2} triangles, depth {}",
            per_query(full.inner_visits),
            per_query(full.leaf_visits),
            per_query(full.primitive_tests),
            full.stack_depth
        );
        let mut before = f64::INFINITY;
        for entries in [0, 1, 2, 3, 4, 5, 8] {
            let trail = totals(&bvh, &format!("restart-trail:short-stack={entries}"), &queries);
            let ratio = trail.inner_visits as f64 / full.inner_visits as f64;
            println!("  {entries} entries: {ratio:.3} times, {:.2} restarts", per_query(trail.restarts));
            assert!((1.0..=before).contains(&ratio));
            before = ratio;
            assert_eq!((trail.leaf_visits, trail.primitive_tests), (full.leaf_visits, full.primitive_tests));
        }
        assert!(before < 1.1, "eight entries are nearly a full stack: {before}");
    }
}

/// The scan has holes, so it has no inside, and it is said how many edges are open.
#[test]
fn the_bunny_has_no_inside() {
    let Some(mesh) = bunny() else { return };
    let bvh = Scene::from_mesh(mesh).build(&BuildOptions::default()).unwrap();
    let error = SignedDistance::new(&bvh).unwrap_err();
    println!("{error}");
    assert!(error.open > 100 && error.crowded == 0 && error.flipped == 0);
}
