//! Rays in, hits out.

mod support;

use support::{Folder, array, has_adapter, run};

const MISS: u32 = u32::MAX;

/// One ray through both triangles, one from behind through both, one past them.
const RAYS: [f32; 18] = [
    0.0, 0.0, 1.0, 0.0, 0.0, -1.0, //
    0.0, 0.0, -3.0, 0.0, 0.0, 2.0, //
    5.0, 0.0, 1.0, 0.0, 0.0, -1.0,
];

fn trace(folder: &Folder, rays: &str, options: &str) -> String {
    let scene = folder.two_triangles();
    format!("trace {scene} --rays {rays} -o {} {options}", folder.text("hits.npz"))
}

#[test]
fn closest_hits_are_written_as_documented() {
    let folder = Folder::new();
    let rays = folder.rays("rays.npy", 6, &RAYS);
    let mut devices = vec!["cpu"];
    if has_adapter() {
        devices.push("gpu");
    }
    for device in devices {
        run(&trace(&folder, &rays, &format!("--device {device}"))).success();
        let file = folder.path("hits.npz");
        assert_eq!(array(&file, "t"), (vec![3], vec![1.0_f32, 1.0, f32::INFINITY]));
        assert_eq!(array(&file, "primitive"), (vec![3], vec![0, 1, MISS]));
        assert_eq!(array(&file, "geometry"), (vec![3], vec![0, 0, MISS]));
        assert_eq!(array(&file, "instance"), (vec![3], vec![0, 0, MISS]));
        assert_eq!(array(&file, "front_face"), (vec![3], vec![true, false, false]));
        assert_eq!(array(&file, "uv"), (vec![3, 2], vec![0.25_f32, 0.5, 0.25, 0.5, 0.0, 0.0]));
    }
}

#[test]
fn the_other_queries_are_written_as_documented() {
    let folder = Folder::new();
    let rays = folder.rays("rays.npy", 6, &RAYS);
    let file = folder.path("hits.npz");
    run(&trace(&folder, &rays, "--query any")).success();
    assert_eq!(array(&file, "hit"), (vec![3], vec![true, true, false]));
    run(&trace(&folder, &rays, "--query count")).success();
    assert_eq!(array(&file, "count"), (vec![3], vec![2_u32, 2, 0]));
    run(&trace(&folder, &rays, "--query all")).success();
    assert_eq!(array(&file, "offsets"), (vec![4], vec![0_u64, 2, 4, 4]));
    assert_eq!(array(&file, "t"), (vec![4], vec![1.0_f32, 2.0, 1.0, 1.5]));
    assert_eq!(array(&file, "primitive"), (vec![4], vec![0_u32, 1, 1, 0]));
}

/// Each structure has a walk of its own when none is named, and refuses those of others with the right ones.
#[test]
fn a_structure_is_walked_by_its_best_walk() {
    let folder = Folder::new();
    let rays = folder.rays("rays.npy", 6, &RAYS);
    for structure in ["bvh", "wide-bvh", "list", "list:source=sbvh,bounds=aabb,directions=1"] {
        run(&trace(&folder, &rays, &format!("--structure {structure} --device cpu"))).success();
        let file = folder.path("hits.npz");
        assert_eq!(array(&file, "t"), (vec![3], vec![1.0_f32, 1.0, f32::INFINITY]), "{structure}");
    }
    run(&trace(&folder, &rays, "--structure list --walk stack --device cpu"))
        .failure(2)
        .mentions("brute-force, list");
    run(&trace(&folder, &rays, "--structure wide-bvh --walk list --device cpu"))
        .failure(2)
        .mentions("stack:order=ordered");
    run(&trace(&folder, &rays, "--structure list:directions=3")).failure(2).mentions("1, 2, 6, 8");
}

#[test]
fn windows_and_doubles_are_read() {
    let folder = Folder::new();
    let windows =
        [0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 1.5, f32::INFINITY, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.5];
    let rays = folder.rays("rays.npy", 8, &windows);
    run(&trace(&folder, &rays, "")).success();
    assert_eq!(array(&folder.path("hits.npz"), "primitive"), (vec![2], vec![1, MISS]));
    let body: Vec<u8> = RAYS.iter().flat_map(|&number| f64::from(number).to_be_bytes()).collect();
    let rays = folder.npy("double.npy", ">f8", &[3, 6], &body);
    run(&trace(&folder, &rays, "")).success();
    assert_eq!(array(&folder.path("hits.npz"), "primitive"), (vec![3], vec![0, 1, MISS]));
}

#[test]
fn the_summary_is_one_document() {
    let folder = Folder::new();
    let rays = folder.rays("rays.npy", 6, &RAYS);
    let document = run(&trace(&folder, &rays, "--stats --json")).success().json();
    assert_eq!((&document["rays"], &document["rays_that_hit"]), (&3.into(), &2.into()));
    assert_eq!((&document["query"], &document["walk"]), (&"closest".into(), &"stack:order=ordered".into()));
    assert!(document["stats"]["primitive_tests_per_ray"].as_f64().unwrap() > 0.0);
    assert!(document["trace_seconds"].as_f64().unwrap() >= 0.0);
    let text = run(&trace(&folder, &rays, "--stats")).success().out;
    assert!(text.contains("2 of 3 rays") && text.contains("inner visits"), "{text}");
}

#[test]
fn no_rays_are_no_error() {
    let folder = Folder::new();
    let rays = folder.npy("rays.npy", "<f4", &[0, 6], &[]);
    run(&trace(&folder, &rays, "")).success();
    assert_eq!(array::<f32>(&folder.path("hits.npz"), "t"), (vec![0], vec![]));
}

#[test]
fn files_that_are_no_rays_are_refused_and_nothing_is_left() {
    let folder = Folder::new();
    let body: Vec<u8> = RAYS.iter().flat_map(|number| number.to_le_bytes()).collect();
    let refused = [
        (folder.npy("flat.npy", "<f4", &[18], &body), "(N, 6)"),
        (folder.npy("seven.npy", "<f4", &[2, 7], &body), "(2, 7)"),
        (folder.npy("cube.npy", "<f4", &[1, 3, 6], &body), "(N, 6)"),
        (folder.npy("whole.npy", "<i4", &[3, 6], &body), "<i4"),
        (folder.npy("half.npy", "<f2", &[3, 6], &body), "<f2"),
        (folder.npy("short.npy", "<f4", &[4, 6], &body), "cut off"),
        (folder.npy("huge.npy", "<f4", &[usize::MAX / 2, 6], &body), "cut off"),
        (folder.write("text.npy", "0 0 1 0 0 -1\n"), ".npy"),
        (folder.write("empty.npy", ""), "shorter"),
        (folder.write("header.npy", b"\x93NUMPY\x01\x00\xff\xff{'descr'"), "header"),
        (folder.text("missing.npy"), "no such file"),
        (folder.text(""), "file"),
    ];
    let before = {
        folder.two_triangles();
        folder.names()
    };
    for (rays, reason) in &refused {
        run(&trace(&folder, rays, "")).failure(1).mentions(reason);
    }
    assert_eq!(folder.names(), before);
}

#[test]
fn rays_that_cannot_be_traced_are_refused_unless_allowed() {
    let folder = Folder::new();
    let nan = f32::NAN;
    for (name, bad, reason) in [
        ("zero", [0.0, 0.0, 1.0, 0.0, 0.0, 0.0], "direction is zero"),
        ("nan", [nan, 0.0, 1.0, 0.0, 0.0, -1.0], "origin is NaN"),
        ("infinite", [0.0, 0.0, 1.0, 0.0, f32::INFINITY, 0.0], "direction is NaN or infinite"),
    ] {
        let rays = folder.rays("rays.npy", 6, &[&RAYS[..], &bad, &bad].concat());
        let outcome = run(&trace(&folder, &rays, "")).failure(1).mentions(reason);
        assert!(outcome.err.contains("2 of 5") && outcome.err.contains("row 3"), "{name}: {outcome:?}");
        assert!(!folder.names().contains(&"hits.npz".into()));
        let document = run(&trace(&folder, &rays, "--allow-invalid-rays --json")).success().json();
        assert_eq!(document["invalid_rays"], 2);
        assert_eq!(array(&folder.path("hits.npz"), "primitive"), (vec![5], vec![0, 1, MISS, MISS, MISS]));
        std::fs::remove_file(folder.path("hits.npz")).unwrap();
    }
}

#[test]
fn an_output_that_cannot_be_written_is_known_at_once() {
    let folder = Folder::new();
    let (scene, rays) = (folder.two_triangles(), folder.rays("rays.npy", 6, &RAYS));
    let to = |output: String| run(&format!("trace {scene} --rays {rays} -o {output}"));
    to(folder.text("no/such/hits.npz")).failure(1).mentions("no/such/hits.npz");
    to(folder.text("")).failure(1).mentions("folder");
    // A file that is there is replaced, and only by a whole one.
    let old = folder.write("old.npz", "old");
    run(&format!("trace {scene} --rays {} -o {old}", folder.text("missing.npy"))).failure(1);
    assert_eq!(std::fs::read(&old).unwrap(), b"old");
    to(old.clone()).success();
    assert_eq!(array(old.as_ref(), "primitive"), (vec![3], vec![0, 1, MISS]));
    assert_eq!(folder.names(), ["old.npz", "rays.npy", "two.obj"]);
}

#[test]
fn every_walk_writes_the_same_bytes() {
    let folder = Folder::new();
    let numbers: Vec<f32> = (0..600)
        .flat_map(|ray| {
            let angle = ray as f32 * 0.618;
            [
                3.0 * angle.cos(),
                0.02 * ray as f32,
                3.0 * angle.sin(),
                -angle.cos(),
                -0.004 * ray as f32,
                -angle.sin(),
            ]
        })
        .collect();
    let rays = folder.rays("rays.npy", 6, &numbers);
    let bytes = |options: &str| {
        run(&format!("trace builtin:cubes --rays {rays} -o {} {options}", folder.text("h.npz"))).success();
        std::fs::read(folder.path("h.npz")).unwrap()
    };
    let expected = bytes("--walk brute-force");
    for options in [
        "",
        "--walk recursive",
        "--walk stack:order=unordered",
        "--walk stack:order=sorted --threads 1",
        "--structure bvh:leaf-order=left,max-leaf=1 --walk stack:order=culled --threads 3",
        "--walk restart-trail",
        "--walk restart-trail:short-stack=0,register=u64",
        "--structure bvh:builder=sbvh,max-leaf=1 --walk restart-trail:short-stack=1,register=array",
        "--structure bvh:builder=sweep,reinsertion=2",
        "--structure wide-bvh",
        "--structure wide-bvh:width=4,collapse=sah,builder=sbvh --walk restart-trail:short-stack=3",
    ] {
        assert!(bytes(options) == expected, "{options}");
    }
    if has_adapter() {
        for options in [
            "",
            "--walk restart-trail:short-stack=2",
            "--walk restart-trail:short-stack=3,memory=workgroup",
            "--structure wide-bvh:builder=sbvh --walk restart-trail:short-stack=0",
        ] {
            assert!(bytes(&format!("{options} --device gpu")) == expected, "{options} on the gpu");
        }
    }
}

/// A chain of triangles that makes a tree deeper than 31.
#[test]
fn a_tree_that_is_too_deep_for_a_register_is_an_error_with_a_way_out() {
    let folder = Folder::new();
    let mut text = String::new();
    for k in 0..100 {
        let size = 0.5f64.powi(k);
        text += &format!("v {size:e} 0 0\nv {size:e} {size:e} 0\nv {size:e} 0 {size:e}\nf -3 -2 -1\n");
    }
    let scene = folder.write("chain.obj", &text);
    let rays = folder.rays("rays.npy", 6, &[2.0, 0.01, 0.01, -1.0, -0.001, -0.001]);
    let trace = |structure: &str, walk: &str| {
        let output = folder.text("h.npz");
        run(&format!(
            "trace {scene} --rays {rays} -o {output} --device cpu --structure {structure} --walk {walk}"
        ))
    };
    let (deep, short) = ("bvh:max-leaf=1,max-depth=64", "restart-trail:short-stack=2,register=u32");
    trace(deep, short).failure(1).mentions("max-depth=31");
    assert_eq!(folder.names(), ["chain.obj", "rays.npy"], "nothing is left behind");
    trace(deep, "restart-trail:short-stack=2").success();
    trace(deep, "restart-trail:short-stack=2,register=u64").success();
    trace("bvh:max-leaf=1,max-depth=31", short).success();
}
