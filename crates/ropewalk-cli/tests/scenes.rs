//! Scenes of every kind through `ropewalk info`: exact counts of good ones, an answer for every odd one.

mod support;

use serde_json::Value;
use std::path::Path;
use support::{Folder, ropewalk, run, scenes};

/// File, triangles with instances counted, unique triangles, objects, instances, vertices; from the list that comes
/// with the scenes. 0 where the list does not say.
const COUNTS: &[(&str, u64, u64, u64, u64, u64)] = &[
    ("toczek2010_cubes/cubes.obj", 222, 222, 6, 6, 124),
    ("suzanne/suzanne.obj", 968, 968, 1, 1, 507),
    ("suzanne/suzanne_ground_970.obj", 970, 970, 0, 0, 511),
    ("suzanne/cornellbox_suzanne.obj", 980, 980, 7, 7, 531),
    ("suzanne/monkey.glb", 968, 968, 1, 1, 0),
    ("stanford_bunny/bun_zipper.ply.gz", 69_451, 69_451, 1, 1, 35_947),
    ("stanford_bunny/bunny_ground_69453_be.ply", 69_453, 69_453, 1, 1, 35_951),
    ("stanford_dragon/dragon_vrip_871414_le.ply.gz", 871_414, 871_414, 1, 1, 437_645),
    ("stanford_dragon/dragon_vrip_res3.ply.gz", 47_794, 47_794, 1, 1, 22_998),
    ("stanford_dragon/dragon_vrip_res4.ply.gz", 11_102, 11_102, 1, 1, 5_205),
    ("stanford_dragon/ground.obj", 2, 2, 1, 1, 0),
    ("happy_buddha/buddha_standin_293232_le.ply.gz", 293_232, 293_232, 1, 1, 146_606),
    ("happy_buddha/buddha_100k.obj.gz", 100_000, 100_000, 1, 1, 49_990),
    ("chess34_cc0/chess34.obj", 20_648, 20_648, 34, 34, 10_470),
    ("chess34_ccby/chess34_fantasy.glb", 45_992, 0, 14, 34, 0),
    ("car_ldraw/car_ldraw.obj", 25_767, 25_767, 61, 61, 16_909),
    ("car_ldraw/car_ldraw_instanced.glb", 25_767, 0, 32, 61, 0),
    ("car_ldraw/vintage_car_40448_instanced.glb", 105_806, 50_192, 86, 200, 0),
    ("car_lamborghini/lamborghini.glb", 145_917, 145_917, 46, 46, 79_406),
    ("engine_2cylinder/2CylinderEngine.glb", 121_496, 75_730, 29, 67, 55_843),
    ("sponza_dabrovic/sponza_66447.obj.gz", 66_447, 66_447, 33, 33, 60_848),
    ("crytek_sponza/crytek_sponza.obj.gz", 262_205, 262_205, 381, 381, 165_046),
    ("sibenik/sibenik_73564.obj.gz", 73_564, 73_564, 0, 0, 40_259),
    ("kitchen_obvhs/kitchen_56939.obj.gz", 56_939, 56_939, 278, 278, 74_303),
    ("cornell_box/cornell_box_embree.obj", 34, 34, 0, 0, 76),
    ("cornell_box/tinyobj/cornell_box.obj", 36, 36, 0, 0, 76),
    ("cornell_box/hiprt/cornellBox.obj", 32, 32, 0, 0, 64),
    ("teapot/teapot_6320.obj", 6_320, 6_320, 1, 1, 3_644),
    ("teapot/Utah_teapot_solid_bin.stl", 9_438, 9_438, 1, 1, 0),
    ("teapot/teapot_mitsuba.ply", 2_256, 2_256, 1, 1, 1_177),
    ("utah_hand/hand_00.obj.gz", 15_855, 15_855, 0, 0, 9_284),
    ("unc_cloth_ball/cloth_ball92.ply.gz", 92_230, 92_230, 1, 1, 46_598),
    ("unc_cloth_ball/cloth_ball93.ply.gz", 92_230, 92_230, 1, 1, 46_598),
    ("armadillo/armadillo.obj.gz", 86_482, 86_482, 1, 1, 43_243),
    ("legocar_tinybvh/legocar.obj", 10_992, 10_992, 26, 26, 5_968),
    ("milktruck/CesiumMilkTruck.glb", 3_624, 0, 2, 3, 0),
    ("fox/Fox.glb", 576, 576, 1, 1, 0),
    ("duck/Duck.glb", 4_212, 4_212, 1, 1, 2_399),
    ("stl_parts/featuretype.STL", 3_476, 3_476, 1, 1, 0),
    ("stl_parts/ADIS16480.stl.gz", 7_436, 7_436, 1, 1, 0),
    ("stl_parts/pr2_head_pan_ascii.stl", 1_000, 1_000, 1, 1, 0),
    ("stl_parts/pr2_head_pan_bin.stl", 1_000, 1_000, 1, 1, 0),
];

fn info(path: &Path) -> Value {
    ropewalk(["info".as_ref(), "--json".as_ref(), path.as_os_str()]).success().json()
}

#[test]
fn counts_are_exact() {
    let Some(scenes) = scenes() else { return };
    for &(file, triangles, unique, objects, instances, vertices) in COUNTS {
        let document = info(&scenes.join(file));
        let counts = [
            ("triangles", triangles),
            ("unique_triangles", unique),
            ("objects", objects),
            ("instances", instances),
            ("vertices", vertices),
        ];
        for (key, expected) in counts {
            assert!(expected == 0 || document[key] == expected, "{file}: {key} is {}", document[key]);
        }
        assert_eq!(document["defects"]["not_finite"], 0, "{file}");
        assert_eq!(document["defects"]["out_of_range"], 0, "{file}");
        assert_eq!(document["structure"]["triangles"].as_u64().unwrap(), {
            triangles - document["defects"]["degenerate"].as_u64().unwrap()
        });
    }
}

#[test]
fn every_odd_file_is_answered() {
    let Some(scenes) = scenes() else { return };
    let mut folders = vec![scenes.join("odd")];
    let mut files = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            files += 1;
            let outcome = ropewalk(["info".as_ref(), "--json".as_ref(), path.as_os_str()]);
            if outcome.code == Some(0) {
                assert!(outcome.json()["triangles"].is_u64(), "{outcome:?}");
            } else {
                outcome.failure(1).mentions(path.file_name().unwrap().to_str().unwrap());
            }
        }
    }
    assert!(files > 100, "{files}");
}

#[test]
fn the_document_has_every_key() {
    let document = run("info builtin:cubes --json").success().json();
    assert_eq!((&document["triangles"], &document["scene"]), (&222.into(), &"builtin:cubes".into()));
    assert_eq!((&document["vertices"], &document["objects"]), (&124.into(), &6.into()));
    for key in ["format", "unique_triangles", "instances", "materials", "cameras", "lights", "origin", "gpu"]
    {
        assert!(!document[key].is_null(), "{key}");
    }
    for key in ["min", "max"] {
        assert_eq!(document["bounds"][key].as_array().unwrap().len(), 3);
    }
    for key in ["not_finite", "out_of_range", "degenerate", "collinear", "skipped", "notes"] {
        assert!(!document["defects"][key].is_null(), "{key}");
    }
    let structure = &document["structure"];
    for key in ["nodes", "leaves", "depth", "sah_cost", "bytes", "bytes_per_triangle", "build_seconds"] {
        assert!(structure[key].as_f64().unwrap() > 0.0, "{key}");
    }
    assert_eq!((&structure["references"], &structure["triangles"]), (&222.into(), &222.into()));
    assert_eq!((&structure["reference_growth"], &structure["width"]), (&0.0.into(), &2.into()));
    for fit in document["gpu"].as_array().unwrap() {
        assert_eq!(fit["fits"], true);
        assert!(fit["limit_bytes"].as_u64().unwrap() > 0 && !fit["name"].as_str().unwrap().is_empty());
    }
}

/// Triangles that straddle each other: spatial splits put some of them into several leaves.
#[test]
fn references_and_wide_nodes_are_told() {
    let folder = Folder::new();
    let mut text = String::new();
    for index in 0..30 {
        // A grating of bars along x and bars along z: whole bars overlap, their parts do not.
        let at = f64::from(index) * 0.5;
        text += &format!("v 0 0 {at}\nv 15 0 {at}\nv 15 0.1 {at}\nf -3 -2 -1\n");
        text += &format!("v {at} 0 0\nv {at} 0 15\nv {at} 0.1 15\nf -3 -2 -1\n");
    }
    let scene = folder.write("sticks.obj", &text);
    let info = |structure: &str| {
        let document = run(&format!("info {scene} --json --structure {structure}")).success().json();
        let numbers = ["triangles", "references", "width", "nodes", "leaves", "bytes"];
        let numbers = numbers.map(|key| document["structure"][key].as_u64().unwrap());
        let growth = document["structure"]["reference_growth"].as_f64().unwrap();
        assert!((growth - (numbers[1] as f64 / 60.0 - 1.0)).abs() < 1e-9, "{document}");
        assert!(document["gpu"].as_array().unwrap().iter().all(|fit| fit["node_bytes"].as_u64() > Some(0)));
        numbers
    };
    let [triangles, references, width, nodes, leaves, bytes] =
        info("bvh:builder=sbvh,max-leaf=1,duplication=400");
    assert!(references > triangles && triangles == 60 && width == 2, "{references}");
    assert_eq!((nodes, bytes), (2 * leaves - 1, 32 * nodes + 48 * references));
    let text =
        run(&format!("info {scene} --structure bvh:builder=sbvh,max-leaf=1,duplication=400")).success().out;
    assert!(text.contains(&format!("{references} to 60 triangles (+")), "{text}");
    for (spec, children) in [("wide-bvh:width=4", 4), ("wide-bvh:collapse=sah", 8)] {
        let [_, references, width, nodes, leaves, bytes] = info(spec);
        assert_eq!((references, width), (60, children));
        assert_eq!(bytes, 32 * children * (nodes - leaves) + 48 * 60, "{spec}");
        let text = run(&format!("info {scene} --structure {spec}")).success().out;
        let (nodes, text) = (format!("{} of {children} children", nodes - leaves), text);
        assert!(text.contains(&nodes) && !text.contains("references"), "{text}");
    }
}

#[test]
fn defects_are_counted_and_told() {
    let folder = Folder::new();
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 1 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2\n";
    let scene = folder.write("bad.obj", text);
    let document = run(&format!("info {scene} --json")).success().json();
    let defects = &document["defects"];
    assert_eq!(document["structure"]["triangles"], 1, "{document}");
    assert_eq!(defects["degenerate"], 1, "{document}");
    assert!(defects["skipped"].as_array().unwrap().iter().any(|row| row["first"] == "line 9"), "{document}");
    let text = run(&format!("info {scene}")).success().out;
    assert!(text.contains("1 triangles with two equal vertices") && text.contains("line 9"), "{text}");
}

#[test]
fn what_is_no_scene_is_an_error_that_names_it() {
    let folder = Folder::new();
    run(&format!("info {}", folder.text("missing.obj")))
        .failure(1)
        .mentions("missing.obj: there is no such file");
    run(&format!("info {}", folder.text("")[..].trim_end_matches('/'))).failure(1).mentions("folder");
    run(&format!("info {}", folder.write("empty.obj", ""))).failure(1).mentions("empty.obj");
    run(&format!("info {}", folder.write("noise.bin", [7; 999]))).failure(1).mentions("noise.bin");
    run(&format!("info {}", folder.write("half.ply.gz", b"\x1f\x8b\x08\x00abc")))
        .failure(1)
        .mentions("half.ply.gz");
    run("info cubes").failure(1).mentions("builtin:cubes");
    let lines = folder.path("two\nlines.obj");
    ropewalk(["info".as_ref(), lines.as_os_str()]).failure(1);
    if cfg!(unix) {
        run("info /dev/zero").failure(1).mentions("regular file");
    }
}
