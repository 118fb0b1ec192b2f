//! `bench` and `verify`: what they say, not how fast it is.

mod support;

use support::{has_adapter, run};

#[test]
fn a_bench_record_says_where_it_was_made_and_what_was_measured() {
    let mut line =
        "bench builtin:cubes --rays 200 --rounds 2 --walk all --threads 1 --threads 2 --json --device cpu"
            .to_owned();
    let adapter = has_adapter();
    if adapter {
        line.push_str(" --device gpu");
    }
    let document = run(&line).success().json();
    let machine = &document["machine"];
    assert!(!machine["cpu"].as_str().unwrap().is_empty() && machine["threads"].as_u64().unwrap() > 0);
    assert_eq!(machine["date"].as_str().unwrap().len(), 10);
    let scene = &document["scenes"][0];
    assert_eq!((&scene["triangles"], &scene["rounds"]), (&222.into(), &2.into()));
    assert_eq!(scene["builds"].as_array().unwrap().len(), 2);
    let classes: Vec<&str> =
        scene["classes"].as_array().unwrap().iter().map(|class| class["class"].as_str().unwrap()).collect();
    assert_eq!(classes, ["primary", "shadow", "ambient-occlusion", "diffuse", "diffuse-shuffled", "random"]);
    let lanes = scene["lanes"].as_array().unwrap();
    // Recursion, four stacks, three short stacks and skip pointers; on a GPU the first and the last are not there, and one
    // short stack is in the memory of workgroups.
    assert_eq!(lanes.len(), 9 * 2 + if adapter { 8 } else { 0 });
    for lane in lanes {
        assert_eq!(lane["agreement"]["failed"].as_array().unwrap().len(), 0, "{lane}");
        assert_eq!(lane["agreement"]["rays"], 6 * 200);
        for rate in lane["rates"].as_array().unwrap() {
            let spread = &rate["mrays_per_second"];
            let [min, median, max] = ["min", "median", "max"].map(|key| spread[key].as_f64().unwrap());
            assert!(0.0 < min && min <= median && median <= max, "{rate}");
            assert!(rate["work"]["inner_visits"].as_f64().unwrap() > 0.0, "{rate}");
        }
    }
    let text = run("bench builtin:cubes --rays 100 --rounds 1 --device cpu").success().out;
    assert!(text.contains("222 triangles") && text.contains("diffuse-shuffled"), "{text}");
}

/// The peers are no part of a plain build, and a program without them says how to get one with them.
#[cfg(not(feature = "peers"))]
#[test]
fn a_plain_program_says_how_to_measure_peers() {
    let outcome = run("bench --peers builtin:cubes").failure(1);
    assert!(outcome.err.contains("cargo run --release --features peers"), "{outcome:?}");
    run("bench --engine embree").failure(2);
    run("bench --peers --class sideways").failure(2).mentions("ambient-occlusion");
}

/// Whatever peers this machine has: the program's own engines are there, and right.
#[cfg(feature = "peers")]
#[test]
fn the_arena_has_a_row_for_every_way_to_hand_over_rays() {
    let document = run(
        "bench --peers builtin:cubes rotated:builtin:cubes --rays 500 --rounds 1 --threads 1 --engine ropewalk --json",
    )
    .success()
    .json();
    let rows = document["rows"].as_array().unwrap();
    for row in rows {
        assert!(row["ms"].as_f64().unwrap() > 0.0, "{row}");
        assert!(row["ratio_to_best_peer"].is_null() && row["peer"] == false, "{row}");
    }
    let kinds = |kind: &str| rows.iter().filter(|row| row["kind"] == kind).count();
    assert!(["trace", "build", "refit", "top_level"].iter().all(|kind| kinds(kind) > 0), "{rows:?}");
    let folder = support::Folder::new();
    let table = folder.path("table.md");
    run(&format!(
        "bench --peers builtin:cubes --rays 100 --rounds 1 --threads 1 --kind trace --class primary --markdown {}",
        table.display()
    ))
    .success();
    assert!(folder.text("table.md").contains("| ropewalk bvh | binned | batch |"));
}

#[test]
fn a_bench_of_what_cannot_be_traced_is_an_error() {
    run("bench builtin:cubes --walk recursive --device gpu:0 --rays 10")
        .code
        .filter(|&code| code != 0)
        .unwrap();
    let folder = support::Folder::new();
    let scene = folder.write("empty.obj", "v 0 0 0\n");
    let outcome = run(&format!("bench {scene} --rays 10 --rounds 1 --json"));
    assert_eq!((outcome.code, outcome.out.as_str()), (Some(1), ""), "{outcome:?}");
    assert!(outcome.err.contains("empty.obj") && outcome.err.contains("nothing to measure"), "{outcome:?}");
}

/// Every row of the catalogue is the business of the conformance tests; here some are enough.
#[test]
fn what_is_asked_for_is_verified() {
    let document = run("verify --json --device cpu --structure wide-bvh --structure list").success().json();
    assert_eq!(document["passed"], true);
    let devices = document["devices"].as_array().unwrap();
    assert_eq!(devices.len(), 1);
    let rows = ropewalk::catalogue::rows();
    let is_meant = |row: &&ropewalk::catalogue::Row| {
        row.device == ropewalk::DeviceKind::Cpu && ["wide-bvh", "list"].contains(&row.structure.kind().name())
    };
    let meant = rows.iter().filter(is_meant).count();
    assert!(meant > 20);
    assert_eq!(devices[0]["rows"].as_array().unwrap().len(), meant);
    run("verify --structure octree").failure(2).mentions("kd-tree");
}
