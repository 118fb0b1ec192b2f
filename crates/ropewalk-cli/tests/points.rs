//! Points in, what is closest to them out.

mod support;

use ropewalk::point::catalogue;
use std::fmt::Write;
use support::{Folder, array, has_adapter, run, scenes};

const NONE: u32 = u32::MAX;

/// Below the floor of the tetrahedron, left of it where three faces meet, before its slope, and inside of it.
const POINTS: [f64; 12] = [0.25, 0.25, -2.0, -3.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.25, 0.125, 0.25];

/// Two thirds of the root of three.
const TO_SLOPE: f32 = 1.154_700_5;

/// The tetrahedron of the origin and the units of the axes, moved along x.
fn tetrahedron(folder: &Folder, x: f64, faces: usize) -> String {
    let mut text = format!("v {x} 0 0\nv {} 0 0\nv {x} 1 0\nv {x} 0 1\n", x + 1.0);
    for face in ["f 1 3 2\n", "f 1 2 4\n", "f 1 4 3\n", "f 2 3 4\n"].iter().take(faces) {
        text += face;
    }
    folder.write("tetrahedron.obj", text)
}

/// A ball of radius 1 around zero: rings of quadrilaterals between two poles.
fn ball(folder: &Folder) -> String {
    const RINGS: usize = 40;
    const SECTORS: usize = 80;
    let mut text = String::from("v 0 0 1\n");
    for ring in 1..RINGS {
        for sector in 0..SECTORS {
            let (down, round) = (ring as f64 / RINGS as f64, 2.0 * sector as f64 / SECTORS as f64);
            let (height, radius) = ((down * std::f64::consts::PI).cos(), (down * std::f64::consts::PI).sin());
            let (y, x) = (round * std::f64::consts::PI).sin_cos();
            let _ = writeln!(text, "v {} {} {height}", radius * x, radius * y);
        }
    }
    text += "v 0 0 -1\n";
    let at = |ring: usize, sector: usize| match ring {
        0 => 1,
        RINGS => 2 + (RINGS - 1) * SECTORS,
        _ => 2 + (ring - 1) * SECTORS + sector % SECTORS,
    };
    for ring in 0..RINGS {
        for sector in 0..SECTORS {
            let [a, b] = [at(ring, sector), at(ring, sector + 1)];
            let [c, d] = [at(ring + 1, sector), at(ring + 1, sector + 1)];
            if ring + 1 < RINGS {
                let _ = writeln!(text, "f {a} {c} {d}");
            }
            if ring > 0 {
                let _ = writeln!(text, "f {a} {d} {b}");
            }
        }
    }
    folder.write("ball.obj", text)
}

/// Points as float64, of so many columns.
fn points(folder: &Folder, columns: usize, numbers: &[f64]) -> String {
    let body: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    folder.npy("points.npy", "<f8", &[numbers.len() / columns, columns], &body)
}

fn ask(folder: &Folder, scene: &str, points: &str, options: &str) -> String {
    format!("points {scene} --points {points} -o {} {options}", folder.text("answers.npz"))
}

/// Points all around and within a scene of about the size of the built-in one of cubes.
fn spiral(count: usize) -> Vec<f64> {
    (0..count)
        .flat_map(|index| {
            let (part, angle) = (index as f64 / count as f64, index as f64 * 0.618_034);
            [3.0 * part * angle.cos(), 2.0 * part - 0.5, 3.0 * part * angle.sin()]
        })
        .collect()
}

#[test]
fn closest_points_are_written_as_documented() {
    let folder = Folder::new();
    let (scene, points) = (tetrahedron(&folder, 0.0, 4), points(&folder, 3, &POINTS));
    run(&ask(&folder, &scene, &points, "")).success();
    let file = folder.path("answers.npz");
    assert_eq!(array(&file, "distance"), (vec![4], vec![2.0_f32, 3.0, TO_SLOPE, 0.125]));
    // Where three faces are equally near the first one answers.
    assert_eq!(array(&file, "primitive"), (vec![4], vec![0_u32, 0, 3, 1]));
    assert_eq!(array(&file, "geometry"), (vec![4], vec![0_u32; 4]));
    assert_eq!(array(&file, "instance"), (vec![4], vec![0_u32; 4]));
    let (shape, point) = array::<f64>(&file, "point");
    assert_eq!(shape, [4, 3]);
    let third = 1.0 / 3.0;
    for (found, expected) in
        point.iter().zip([0.25, 0.25, 0.0, 0.0, 0.0, 0.0, third, third, third, 0.25, 0.0, 0.25])
    {
        assert!((found - expected).abs() < 1e-7, "{point:?}");
    }
    let (shape, uv) = array::<f32>(&file, "uv");
    assert_eq!((shape, &uv[..4]), (vec![4, 2], [0.25_f32, 0.25, 0.0, 0.0].as_slice()));
}

#[test]
fn a_largest_distance_comes_from_the_row_or_from_the_command_line() {
    let folder = Folder::new();
    let scene = tetrahedron(&folder, 0.0, 4);
    let found = |columns: usize, numbers: &[f64], options: &str| {
        let points = points(&folder, columns, numbers);
        run(&ask(&folder, &scene, &points, options)).success();
        array::<u32>(&folder.path("answers.npz"), "primitive").1
    };
    assert_eq!(found(3, &POINTS, "--max-distance 2"), [0, NONE, 3, 1], "the distance itself is within reach");
    assert_eq!(found(3, &POINTS, "--max-distance 1.9"), [NONE, NONE, 3, 1]);
    assert_eq!(found(3, &POINTS, "--max-distance inf"), [0, 0, 3, 1]);
    assert_eq!(found(3, &POINTS, "--max-distance 0"), [NONE; 4]);
    let rows = [0.25, 0.25, -2.0, 2.5, -3.0, 0.0, 0.0, f64::INFINITY, 1.0, 1.0, 1.0, 1.0];
    assert_eq!(found(4, &rows, ""), [0, 0, NONE]);
    assert_eq!(found(4, &rows, "--max-distance 2.25"), [0, NONE, NONE], "the smaller one counts");
    let file = folder.path("answers.npz");
    assert_eq!(array(&file, "distance"), (vec![3], vec![2.0_f32, f32::INFINITY, f32::INFINITY]));
    let point = array::<f64>(&file, "point").1;
    assert!(point[..3].iter().all(|number| number.is_finite()), "{point:?}");
    assert!(point[3..].iter().all(|number| number.is_nan()), "{point:?}");
    assert_eq!(array::<f32>(&file, "uv").1[2..], [0.0; 4]);
    assert_eq!(found(4, &rows, "--query k-nearest --k 4 --max-distance 2.02"), [0, 1, 2]);
    assert_eq!(array(&file, "offsets"), (vec![4], vec![0_u64, 3, 3, 3]));
}

#[test]
fn the_nearest_are_written_as_lists() {
    let folder = Folder::new();
    let (scene, points) = (tetrahedron(&folder, 0.0, 4), points(&folder, 3, &POINTS));
    let file = folder.path("answers.npz");
    run(&ask(&folder, &scene, &points, "--query k-nearest --k 2")).success();
    assert_eq!(array(&file, "offsets"), (vec![5], vec![0_u64, 2, 4, 6, 8]));
    let (shape, distance) = array::<f32>(&file, "distance");
    assert_eq!((shape, &distance[..4]), (vec![8], [2.0_f32, 2.015_564_4, 3.0, 3.0].as_slice()));
    let primitive = array::<u32>(&file, "primitive").1;
    assert_eq!(primitive[..4], [0, 1, 0, 1]);
    assert_eq!(array::<f64>(&file, "point").0, [8, 3]);
    // Eight where nothing is said, of which there are four; and no list is longer than what there is.
    for options in ["", "--k 4294967295"] {
        run(&ask(&folder, &scene, &points, &format!("--query k-nearest {options}"))).success();
        assert_eq!(array(&file, "offsets"), (vec![5], vec![0_u64, 4, 8, 12, 16]));
        let distance = array::<f32>(&file, "distance").1;
        for list in distance.chunks(4) {
            assert!(list.is_sorted(), "{list:?}");
        }
    }
    // The first of a list is the closest.
    run(&ask(&folder, &scene, &points, "--query k-nearest --k 1")).success();
    let nearest = array::<f32>(&file, "distance").1;
    run(&ask(&folder, &scene, &points, "")).success();
    assert_eq!(array::<f32>(&file, "distance").1, nearest);
}

#[test]
fn sides_of_a_closed_surface_are_told() {
    let folder = Folder::new();
    let (scene, points) = (tetrahedron(&folder, 0.0, 4), points(&folder, 3, &POINTS));
    let file = folder.path("answers.npz");
    run(&ask(&folder, &scene, &points, "--query signed-distance")).success();
    assert_eq!(array(&file, "distance"), (vec![4], vec![2.0_f32, 3.0, TO_SLOPE, -0.125]));
    let (shape, normal) = array::<f32>(&file, "normal");
    assert_eq!(shape, [4, 3]);
    assert_eq!(
        (&normal[..3], &normal[9..]),
        ([0.0_f32, 0.0, -1.0].as_slice(), [0.0_f32, -1.0, 0.0].as_slice())
    );
    assert_eq!(array(&file, "primitive"), (vec![4], vec![0_u32, 0, 3, 1]));
    assert_eq!(array::<f64>(&file, "point").1[..3], [0.25, 0.25, 0.0]);
    assert_eq!(array::<u32>(&file, "instance").1, [0; 4]);
    let text = run(&ask(&folder, &scene, &points, "--query inside")).success().out;
    assert_eq!(array(&file, "inside"), (vec![4], vec![false, false, false, true]));
    assert!(text.contains("1 of 4 points are inside of"), "{text}");
}

#[test]
fn a_ball_has_its_distances() {
    let folder = Folder::new();
    let (scene, numbers) = (ball(&folder), spiral(400));
    let points = points(&folder, 3, &numbers);
    let file = folder.path("answers.npz");
    let document = run(&ask(&folder, &scene, &points, "--query signed-distance --json")).success().json();
    let distance = array::<f32>(&file, "distance").1;
    let mut inside = Vec::new();
    for (point, &distance) in numbers.chunks(3).zip(&distance) {
        let radius = point.iter().map(|number| number * number).sum::<f64>().sqrt();
        // The flat faces lie up to 1 - cos(pi / 40) within the ball.
        assert!((f64::from(distance) - (radius - 1.0)).abs() < 0.004, "{point:?}: {distance}");
        inside.push(distance <= 0.0);
    }
    let volume = document["volume"].as_f64().unwrap();
    assert!((volume - 4.188).abs() < 0.03, "{volume}");
    assert_eq!(document["points_found"], 400);
    assert_eq!(document["points_inside"], inside.iter().filter(|&&inside| inside).count());
    assert!(inside.contains(&true) && inside.contains(&false));
    run(&ask(&folder, &scene, &points, "--query inside --structure bvh:builder=sbvh")).success();
    assert_eq!(array(&file, "inside"), (vec![400], inside));
    run(&ask(&folder, &scene, &points, "")).success();
    let absolute: Vec<f32> = distance.iter().map(|distance| distance.abs()).collect();
    for (signed, plain) in absolute.iter().zip(array::<f32>(&file, "distance").1) {
        assert!((signed - plain).abs() < 1e-5);
    }
}

#[test]
fn a_surface_that_is_inside_out_is_noted() {
    let folder = Folder::new();
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
    let (scene, points) = (folder.write("turned.obj", text), points(&folder, 3, &POINTS));
    for query in ["inside", "signed-distance"] {
        let outcome = run(&ask(&folder, &scene, &points, &format!("--query {query} --json"))).success();
        assert!(outcome.err.contains("face inwards"), "{outcome:?}");
        assert!(outcome.json()["volume"].as_f64().unwrap() < 0.0);
    }
    let distance = array(&folder.path("answers.npz"), "distance");
    assert_eq!(distance, (vec![4], vec![-2.0_f32, -3.0, -TO_SLOPE, 0.125]));
}

#[test]
fn what_has_no_inside_is_an_error_that_says_what_to_do() {
    let folder = Folder::new();
    let (scene, points) = (tetrahedron(&folder, 0.0, 3), points(&folder, 3, &POINTS));
    for query in ["signed-distance", "inside"] {
        run(&ask(&folder, &scene, &points, &format!("--query {query}")))
            .failure(1)
            .mentions("tetrahedron.obj")
            .mentions("of its 6 edges 3 have a triangle on one side only")
            .mentions("Close the holes")
            .mentions("--query closest-point");
    }
    assert!(!folder.names().contains(&"answers.npz".into()));
    run(&ask(&folder, &scene, &points, "")).success();
}

#[test]
fn a_scene_far_from_zero_keeps_its_digits() {
    let folder = Folder::new();
    let far = 1e8;
    let moved: Vec<f64> = POINTS.chunks(3).flat_map(|point| [point[0] + far, point[1], point[2]]).collect();
    let (scene, points) = (tetrahedron(&folder, far, 4), points(&folder, 3, &moved));
    let file = folder.path("answers.npz");
    for query in ["closest-point", "signed-distance"] {
        run(&ask(&folder, &scene, &points, &format!("--query {query}"))).success();
        let distance = array::<f32>(&file, "distance").1;
        assert_eq!(
            distance.iter().map(|distance| distance.abs()).collect::<Vec<_>>(),
            [2.0, 3.0, TO_SLOPE, 0.125]
        );
        let point = array::<f64>(&file, "point").1;
        assert_eq!(point[..6], [far + 0.25, 0.25, 0.0, far, 0.0, 0.0]);
    }
    let scene = tetrahedron(&folder, far, 3);
    run(&ask(&folder, &scene, &points, "--query inside")).failure(1).mentions("1000000");
}

#[test]
fn every_walk_and_builder_writes_the_same_bytes() {
    let folder = Folder::new();
    let points = points(&folder, 3, &spiral(600));
    let has_adapter = has_adapter();
    for query in ["closest-point", "k-nearest --k 5", "k-nearest --max-distance 0.25"] {
        let bytes = |options: &str| {
            run(&ask(&folder, "builtin:cubes", &points, &format!("--query {query} {options}"))).success();
            std::fs::read(folder.path("answers.npz")).unwrap()
        };
        let expected = bytes("--walk brute-force --device cpu");
        for options in [
            "--device cpu",
            "--device cpu --threads 1 --stats",
            "--walk restart-trail:short-stack=0 --device cpu",
            "--walk restart-trail:short-stack=3,register=u64 --device cpu --threads 3",
            "--structure bvh:builder=sweep,max-leaf=1 --walk restart-trail:register=array --device cpu",
            "--structure bvh:builder=sbvh --device cpu",
        ] {
            assert!(bytes(options) == expected, "{query} {options}");
        }
        if has_adapter {
            assert!(bytes("--device gpu") == expected, "{query} gpu");
            assert!(bytes("--device gpu --walk restart-trail") == expected, "{query} gpu");
        }
    }
}

#[test]
fn points_without_an_answer_are_refused_unless_allowed() {
    let folder = Folder::new();
    let (scene, nan) = (tetrahedron(&folder, 0.0, 4), f64::NAN);
    for (bad, reason) in [
        ([nan, 0.0, 0.0], "a coordinate is NaN or infinite"),
        ([0.0, f64::NEG_INFINITY, 0.0], "a coordinate is NaN or infinite"),
        ([0.0, 0.0, 1e300], "a coordinate is NaN or infinite"),
        ([0.0, 0.0, 1e30], "a coordinate is beyond 2^60"),
    ] {
        let points = points(&folder, 3, &[&POINTS[..], &bad, &bad].concat());
        run(&ask(&folder, &scene, &points, ""))
            .failure(1)
            .mentions(reason)
            .mentions("2 of 6 points have no answer; the first is row 4")
            .mentions("--allow-invalid-points");
        assert!(!folder.names().contains(&"answers.npz".into()));
        let file = folder.path("answers.npz");
        let allowed = |query: &str| {
            let options = format!("--query {query} --allow-invalid-points --json");
            let document = run(&ask(&folder, &scene, &points, &options)).success().json();
            assert_eq!(document["invalid_points"], 2);
            document
        };
        assert_eq!(allowed("closest-point")["points_found"], 4);
        assert_eq!(array::<f32>(&file, "distance").1[4..], [f32::INFINITY; 2]);
        assert_eq!(array::<u32>(&file, "primitive").1, [0, 0, 3, 1, NONE, NONE]);
        allowed("k-nearest");
        assert_eq!(array::<u64>(&file, "offsets").1, [0, 4, 8, 12, 16, 16, 16]);
        assert_eq!(allowed("signed-distance")["points_found"], 4);
        assert_eq!(array::<f32>(&file, "distance").1[3..], [-0.125, f32::INFINITY, f32::INFINITY]);
        assert!(array::<f32>(&file, "normal").1[12..].iter().all(|number| number.is_nan()));
        assert_eq!(allowed("inside")["points_inside"], 1);
        assert_eq!(array::<bool>(&file, "inside").1, [false, false, false, true, false, false]);
        std::fs::remove_file(file).unwrap();
    }
    let points = points(&folder, 4, &[0.0, 0.0, 0.0, -1.0]);
    run(&ask(&folder, &scene, &points, "--max-distance 3")).failure(1).mentions("negative or NaN");
}

#[test]
fn the_summary_is_one_document() {
    let folder = Folder::new();
    let (scene, points) = (tetrahedron(&folder, 0.0, 4), points(&folder, 3, &POINTS));
    let options = "--query k-nearest --k 3 --max-distance 2 --walk restart-trail:short-stack=0 --stats";
    let document = run(&ask(&folder, &scene, &points, &format!("{options} --json"))).success().json();
    assert_eq!((&document["points"], &document["points_found"]), (&4.into(), &3.into()));
    assert_eq!((&document["k"], &document["max_distance"]), (&3.into(), &2.0.into()));
    assert_eq!(document["query"], "k-nearest");
    assert_eq!(document["walk"], "restart-trail:short-stack=0");
    assert_eq!(document["answers"], array::<u32>(&folder.path("answers.npz"), "primitive").0[0]);
    assert!(document["points_inside"].is_null() && document["volume"].is_null());
    assert!(document["stats"]["primitive_tests_per_point"].as_f64().unwrap() > 0.0);
    for key in ["load_seconds", "build_seconds", "search_seconds", "points_per_second"] {
        assert!(document[key].as_f64().unwrap() >= 0.0, "{key}");
    }
    let text = run(&ask(&folder, &scene, &points, options)).success().out;
    for words in ["3 of 4 points find ", "k = 3", "at most 2 away", "inner visits", "restarts"] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn no_points_are_no_error() {
    let folder = Folder::new();
    let (scene, points) = (tetrahedron(&folder, 0.0, 4), points(&folder, 3, &[]));
    let file = folder.path("answers.npz");
    for query in ["closest-point", "k-nearest", "signed-distance"] {
        run(&ask(&folder, &scene, &points, &format!("--query {query}"))).success();
        assert_eq!(array::<f32>(&file, "distance"), (vec![0], vec![]));
        assert_eq!(array::<f64>(&file, "point"), (vec![0, 3], vec![]));
    }
    run(&ask(&folder, &scene, &points, "--query k-nearest --stats")).success();
    assert_eq!(array::<u64>(&file, "offsets"), (vec![1], vec![0]));
    run(&ask(&folder, &scene, &points, "--query inside")).success();
    assert_eq!(array::<bool>(&file, "inside"), (vec![0], vec![]));
}

#[test]
fn files_that_are_no_points_are_refused_and_nothing_is_left() {
    let folder = Folder::new();
    let scene = tetrahedron(&folder, 0.0, 4);
    let body = [0; 96];
    let refused = [
        (folder.npy("flat.npy", "<f8", &[12], &body), "(N, 3) or (N, 4)"),
        (folder.npy("rays.npy", "<f8", &[2, 6], &body), "(2, 6)"),
        (folder.npy("whole.npy", "<i8", &[4, 3], &body), "<i8"),
        (folder.npy("short.npy", "<f8", &[5, 3], &body), "cut off"),
        (folder.npy("huge.npy", "<f8", &[usize::MAX / 2, 3], &body), "cut off"),
        (folder.text("missing.npy"), "no such file"),
        (folder.text(""), "points are read from"),
    ];
    let before = folder.names();
    for (points, reason) in &refused {
        run(&ask(&folder, &scene, points, "")).failure(1).mentions(reason);
    }
    let distances = folder.npy("distances.npy", "<f8", &[3, 4], &body);
    for query in ["signed-distance", "inside"] {
        run(&ask(&folder, &scene, &distances, &format!("--query {query}"))).failure(1).mentions("(N, 3)");
    }
    assert_eq!(folder.names().len(), before.len() + 1);
}

#[test]
fn wrong_usage_is_answered_with_the_right_one() {
    let folder = Folder::new();
    let (scene, points) = (tetrahedron(&folder, 0.0, 4), points(&folder, 3, &POINTS));
    for (options, right) in [
        ("--query closest", "closest-point, k-nearest, signed-distance, inside"),
        ("--k 3", "k-nearest"),
        ("--query inside --k 3", "k-nearest"),
        ("--query k-nearest --k 0", "1.."),
        ("--query k-nearest --k -1", "-1"),
        ("--max-distance -1", "not negative"),
        ("--max-distance nan", "not negative"),
        ("--query inside --max-distance 1", "closest-point and k-nearest"),
        ("--query signed-distance --stats", "closest-point and k-nearest"),
        ("--walk recursive", "stack:order=ordered, restart-trail:short-stack=0"),
        ("--walk restart-trail:memory=workgroup --device cpu", "short-stack=4"),
        ("--structure wide-bvh", "'bvh'"),
        ("--query inside --walk restart-trail", "the walk 'stack:order=ordered' of the structure 'bvh'"),
        ("--query signed-distance --structure wide-bvh", "the structure 'bvh' does on the cpu"),
        ("--query signed-distance --device gpu", "on the cpu"),
        ("--query k-nearest --k 33 --device gpu", "at most 32"),
        ("--device cuda", "auto, cpu, gpu"),
        ("--threads 0", "1..=1024"),
    ] {
        run(&ask(&folder, &scene, &points, options)).failure(2).mentions(right);
    }
    run(&format!("points {scene} --points {points}")).failure(2).mentions("--output");
    run(&format!("points {scene} -o {}", folder.text("a.npz"))).failure(2).mentions("--points");
    run(&format!("points {scene} --points {points} -o -")).failure(2).mentions("file");
    run(&format!("points builtin:pyramids --points {points} -o {}", folder.text("a.npz"))).failure(2);
    assert_eq!(folder.names(), ["points.npy", "tetrahedron.obj"]);
}

#[test]
fn the_list_has_every_row() {
    let listed = run("list --json").success().json();
    let listed = listed["point_rows"].as_array().unwrap();
    for row in catalogue::rows() {
        let texts = [row.structure.name(), &row.walk.to_string(), row.search.name(), &row.device.to_string()];
        let is_it = |listed: &&serde_json::Value| {
            ["structure", "walk", "query", "device"]
                .iter()
                .zip(&texts)
                .all(|(key, text)| listed[*key] == **text)
        };
        assert_eq!(listed.iter().filter(is_it).count(), 1, "{row:?}");
    }
    assert_eq!(listed.len(), catalogue::rows().len() + 2, "those, and the two about the side");
    let text = run("list").success().out;
    for query in ["closest-point", "k-nearest", "signed-distance", "inside"] {
        assert!(text.contains(query), "{text}");
    }
}

#[test]
fn help_has_examples_that_fit_a_terminal() {
    let outcome = run("points --help").success();
    assert!(outcome.out.matches("ropewalk points").count() >= 4, "{outcome:?}");
    assert!(outcome.out.contains("numpy.load"), "{outcome:?}");
    let (_, text) = outcome.out.split_once("Print help").unwrap();
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn a_scanned_model_is_answered_alike_by_every_query() {
    let Some(scenes) = scenes() else { return };
    let scene = scenes.join("stanford_bunny/bunny_ground_69453_be.ply");
    if !scene.is_file() {
        return println!("skipped: there is no {}", scene.display());
    }
    let folder = Folder::new();
    let numbers: Vec<f64> = spiral(2000).iter().map(|number| number * 0.1).collect();
    let points = points(&folder, 3, &numbers);
    let scene = scene.to_str().unwrap();
    run(&ask(&folder, scene, &points, "")).success();
    let file = folder.path("answers.npz");
    let (distance, point) = (array::<f32>(&file, "distance").1, array::<f64>(&file, "point").1);
    for ((asked, found), distance) in numbers.chunks(3).zip(point.chunks(3)).zip(&distance) {
        let square: f64 = asked.iter().zip(found).map(|(a, b)| (a - b) * (a - b)).sum();
        assert!((square.sqrt() - f64::from(*distance)).abs() < 1e-6, "{asked:?}");
    }
    run(&ask(&folder, scene, &points, "--query k-nearest --k 3")).success();
    let nearest = array::<f32>(&file, "distance").1;
    assert!(nearest.chunks(3).zip(&distance).all(|(list, closest)| list[0] == *closest));
}
