//! Documents that break the format: an error that names the place, or a report; never a panic, never much memory.

use crate::check;
use crate::common::{load_text, scene, skipped, triangles};
use crate::make::{document, floats, glb, positions, split_glb, triangle};
use rand::{RngExt, SeedableRng};
use ropewalk_scene::load::load_bytes;
use std::path::{Path, PathBuf};

fn refused(text: &str) -> String {
    match load_text("x.gltf", text) {
        Ok(model) => panic!("loaded {} triangles of {text}", triangles(&model)),
        Err(error) => error.to_string(),
    }
}

/// One triangle, with the accessor of its positions replaced.
fn with_accessor(accessor: &str) -> String {
    document(&floats(&[0.5; 9]), "", accessor, r#""attributes":{"POSITION":0}"#, r#"{"mesh":0}"#)
}

#[test]
fn counts_are_checked_against_the_bytes() {
    for count in ["4", "1000000000", "4294967296", "18446744073709551615"] {
        let accessor = format!(r#"{{"bufferView":0,"componentType":5126,"type":"VEC3","count":{count}}}"#);
        let error = refused(&with_accessor(&accessor));
        assert!(error.contains("x.gltf: accessors[0]") && error.contains(count), "{error}");
        // Without bytes the elements would be zeros.
        let zeros = format!(r#"{{"componentType":5126,"type":"VEC3","count":{count}}}"#);
        if count != "4" {
            let error = refused(&with_accessor(&zeros));
            assert!(error.contains("limit") || error.contains("at most"), "{error}");
        }
    }
    for offset in ["4", "36", "37", "18446744073709551615"] {
        let accessor = format!(
            r#"{{"bufferView":0,"byteOffset":{offset},"componentType":5126,"type":"VEC3","count":3}}"#
        );
        assert!(refused(&with_accessor(&accessor)).contains("x.gltf"), "{offset}");
    }
}

#[test]
fn zeros_cost_nothing_until_they_are_used() {
    let accessors = r#"{"componentType":5126,"type":"VEC3","count":4000000000},
        {"bufferView":0,"componentType":5125,"type":"SCALAR","count":9}"#;
    let indices: Vec<u8> = (0..9_u32).flat_map(|corner| (corner * 400_000_000).to_le_bytes()).collect();
    let text =
        document(&indices, "", accessors, r#""attributes":{"POSITION":0},"indices":1"#, r#"{"mesh":0}"#);
    let model = load_text("x.gltf", &text).unwrap();
    check(&model, "zeros");
    assert_eq!((triangles(&model), model.scene.objects[0].geometries[0].positions.len()), (3, 9));
    assert_eq!(model.report.vertices, 4_000_000_000);
}

#[test]
fn wrong_types_and_strides() {
    for (accessor, text) in [
        (r#"{"bufferView":0,"componentType":5126,"type":"VEC2","count":3}"#, "must be VEC3"),
        (r#"{"bufferView":0,"componentType":5124,"type":"VEC3","count":3}"#, "componentType 5124"),
        (
            r#"{"bufferView":0,"componentType":4294972422,"type":"VEC3","count":3}"#,
            "componentType 4294972422",
        ),
        (
            r#"{"bufferView":4294967296,"componentType":5126,"type":"VEC3","count":3}"#,
            "bufferView 4294967296",
        ),
        (r#"{"bufferView":0,"componentType":5126,"type":"VEC3","count":-3}"#, "JSON line"),
        (r#"{"bufferView":0,"componentType":5126,"type":"VEC3"}"#, "missing field `count`"),
    ] {
        let error = refused(&with_accessor(accessor));
        assert!(error.contains(text), "{error}");
    }
    let stride = |stride: &str| {
        let view = format!(r#""byteStride":{stride}"#);
        document(&floats(&[0.5; 9]), &view, &positions(3), r#""attributes":{"POSITION":0}"#, r#"{"mesh":0}"#)
    };
    assert!(load_text("x.gltf", &stride("12")).is_ok());
    for wrong in ["4", "16", "18446744073709551615"] {
        assert!(refused(&stride(wrong)).contains("accessors[0]"), "{wrong}");
    }
    let float_indices = document(
        &floats(&[0.0; 9]),
        "",
        &format!(r#"{},{{"bufferView":0,"componentType":5126,"type":"SCALAR","count":3}}"#, positions(3)),
        r#""attributes":{"POSITION":0},"indices":1"#,
        r#"{"mesh":0}"#,
    );
    assert!(refused(&float_indices).contains("unsigned"));
}

#[test]
fn sparse_exceptions_are_checked() {
    let sparse = |count: u64, kind: u32, offset: u64| {
        let accessor = format!(
            r#"{{"componentType":5126,"type":"VEC3","count":3,"sparse":{{"count":{count},
            "indices":{{"bufferView":0,"componentType":{kind}}},"values":{{"bufferView":0,"byteOffset":{offset}}}}}}}"#
        );
        let bytes = [vec![0, 2, 9, 0], floats(&[1.0; 9])].concat();
        load_text(
            "x.gltf",
            &document(&bytes, "", &accessor, r#""attributes":{"POSITION":0}"#, r#"{"mesh":0}"#),
        )
        .map_err(|error| error.to_string())
    };
    assert!(sparse(2, 5121, 4).is_ok() && sparse(0, 5121, 4).is_ok());
    for (count, kind, offset, text) in [
        (3, 5121, 4, "element 9 of 3"),
        (4, 5121, 4, "more sparse values than elements"),
        (u64::MAX, 5121, 4, "more sparse values than elements"),
        (2, 5126, 4, "componentType 5126"),
        (2, 5121, 30, "sparse values: 2 elements"),
        (2, 5121, 41, "begins at byte 41 of 40"),
    ] {
        let error = sparse(count, kind, offset).unwrap_err();
        assert!(error.contains(text), "{error}");
    }
}

#[test]
fn buffers_that_are_short_missing_or_garbled() {
    let good = triangle(r#"{"mesh":0}"#);
    let (start, end) = (good.find("data:,").unwrap(), good.find("\",\"byteLength").unwrap());
    for (uri, text) in [
        ("data:,abc", "bufferViews[0]: it spans 36 bytes from byte 0 of buffer 0, which holds 3"),
        ("data:;base64,AAA!", "character 3"),
        ("data:;base64,AAAAA", "cut off"),
        ("data:;base64", "comma"),
        ("missing%20file.bin", "missing file.bin"),
        ("https://example.org/x.bin", "https://example.org/x.bin"),
        ("%ff%fe", "UTF-8"),
        ("", "buffers[0]"),
        ("a\\u0000b", "buffers[0]"),
    ] {
        let error = refused(&[&good[..start], uri, &good[end..]].concat());
        assert!(error.contains("x.gltf: ") && error.contains(text), "{error}");
    }
    let none = good.replace("\"uri\":", "\"name\":");
    assert!(refused(&none).contains("buffers[0]: it has no uri"));
    let unused = none.replace(r#""mesh":0"#, "");
    assert!(load_text("x.gltf", &unused).is_ok(), "a buffer that nothing uses is not missed");
}

#[test]
fn references_lead_somewhere() {
    for (nodes, place) in [
        (r#"{"mesh":1}"#, "nodes[0]: this names mesh 1, but the file has 1"),
        (r#"{"mesh":4294967296}"#, "mesh 4294967296"),
        (r#"{"children":[1]}"#, "nodes[0]: this names node 1"),
        (r#"{"camera":0}"#, "camera 0"),
        (r#"{"extensions":{"KHR_lights_punctual":{"light":0}}}"#, "light 0"),
    ] {
        let error = refused(&triangle(nodes));
        assert!(error.contains(place), "{error}");
    }
    let material = triangle(r#"{"mesh":0}"#).replace(r#""attributes":"#, r#""material":0,"attributes":"#);
    assert!(
        refused(&material).contains("meshes[0].primitives[0]: this names material 0, but the file has 0")
    );
    let root = triangle(r#"{"mesh":0}"#).replacen('{', r#"{"scenes":[{"nodes":[7]}],"#, 1);
    assert!(refused(&root).contains("scenes[0]: this names node 7"));
}

#[test]
fn attributes_that_a_mesh_can_do_without_are_left_out() {
    for (attribute, reason) in [
        ("\"NORMAL\":9", "normals that cannot be read"),
        ("\"TEXCOORD_0\":0", "texture coordinates that cannot be read"),
    ] {
        let text =
            triangle(r#"{"mesh":0}"#).replace(r#""POSITION":0"#, &format!(r#""POSITION":0,{attribute}"#));
        let model = load_text("x.gltf", &text).unwrap();
        check(&model, &text);
        assert_eq!((triangles(&model), skipped(&model, reason)), (1, 1), "{:?}", model.report);
    }
    let accessors = format!("{},{}", positions(3), positions(2));
    let corners = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, f32::NAN, 0.0, 1.0, 0.0]);
    let with = |normals: u32| {
        let primitive = format!(r#""attributes":{{"POSITION":0,"NORMAL":{normals}}}"#);
        load_text("x.gltf", &document(&corners, "", &accessors, &primitive, r#"{"mesh":0}"#)).unwrap()
    };
    assert_eq!(skipped(&with(1), "normals that are not one a vertex"), 1);
    assert_eq!(skipped(&with(0), "normals that are not finite"), 1);
    assert_eq!(with(0).scene.flatten().unwrap().report.not_finite, 1);
}

#[test]
fn restart_values_and_wrong_indices_are_counted() {
    let accessors = r#"{"componentType":5126,"type":"VEC3","count":300},
        {"bufferView":0,"componentType":5121,"type":"SCALAR","count":9}"#;
    let primitive = r#""attributes":{"POSITION":0},"indices":1"#;
    let text = document(&[0, 1, 2, 3, 255, 4, 5, 6, 7], "", accessors, primitive, r#"{"mesh":0}"#);
    let model = load_text("x.gltf", &text).unwrap();
    assert_eq!((triangles(&model), skipped(&model, "restart")), (2, 1));
    assert_eq!(model.report.skipped[0].first, "meshes[0].primitives[0] triangle 1");
    let model = load_text("x.gltf", &text.replace("300", "6")).unwrap();
    assert_eq!((triangles(&model), skipped(&model, "restart"), skipped(&model, "out of range")), (1, 1, 1));
}

#[test]
fn extensions_that_change_the_geometry_are_refused_by_name() {
    for name in ["EXT_meshopt_compression", "KHR_draco_mesh_compression", "VENDOR_anything"] {
        let text = triangle(r#"{"mesh":0}"#);
        let required = text.replacen('{', &format!(r#"{{"extensionsRequired":["{name}"],"#), 1);
        assert!(refused(&required).contains(name));
        let used = text.replacen('{', &format!(r#"{{"extensionsUsed":["{name}"],"#), 1);
        let notes = load_text("x.gltf", &used).unwrap().report.notes;
        assert!(notes.contains(&format!("extensions that are not read: {name}")), "{notes:?}");
    }
    let looks =
        triangle(r#"{"mesh":0}"#).replacen('{', r#"{"extensionsRequired":["KHR_texture_transform"],"#, 1);
    assert!(load_text("x.gltf", &looks).is_ok());
    let draco = with_accessor(r#"{"componentType":5126,"type":"VEC3","count":3}"#)
        .replace(r#""attributes":"#, r#""extensions":{"KHR_draco_mesh_compression":{}},"attributes":"#);
    assert!(refused(&draco).contains("KHR_draco_mesh_compression alone"));
}

#[test]
fn other_versions_and_other_json() {
    let one = r#"{"asset":{"version":"1.0"},"meshes":{"a":{}}}"#;
    assert!(refused(one).contains("asset.version: this is glTF 1.0; version 2 is read"));
    for (text, place) in
        [("{", "line 1 column 1"), ("{\n\"nodes\":3}", "line 2 column 9"), ("{\"nodes\":[3]}", "JSON line 1")]
    {
        let error = refused(text);
        assert!(error.contains("x.gltf") && error.contains(place) && !error.contains(" at line "), "{error}");
    }
    let deep = format!("{{\"extras\":{}", "[".repeat(1_000_000));
    assert!(refused(&deep).contains("JSON line 1 column 1000010"));
}

/// A hundred bytes that ask for the same triangles again must not multiply them without end.
#[test]
fn geometry_has_a_budget() {
    let accessors = r#"{"componentType":5126,"type":"VEC3","count":3000000}"#;
    let one = r#"{"attributes":{"POSITION":0}}"#;
    let mesh = format!(r#""meshes":[{{"primitives":[{}]"#, vec![one; 1000].join(","));
    let text =
        document(&[0], "", accessors, "", r#"{"mesh":0}"#).replace(r#""meshes":[{"primitives":[{}]"#, &mesh);
    let error = refused(&text);
    assert!(error.contains("meshes[0].primitives[") && error.contains("limit"), "{error}");
}

fn small_glb() -> Vec<u8> {
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"camera":0}],
        "cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}],"buffers":[{"byteLength":44}],
        "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],"accessors":[
        {"bufferView":0,"componentType":5126,"type":"VEC3","count":3},
        {"bufferView":1,"componentType":5123,"type":"SCALAR","count":3}],
        "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0},"indices":1,"material":0}]}]}"#;
    let corners = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    glb(json, &[corners, vec![0, 0, 1, 0, 2, 0, 0, 0]].concat())
}

#[test]
fn a_glb_cut_off_anywhere_is_refused() {
    let bytes = small_glb();
    assert_eq!(triangles(&load_bytes(Path::new("x.glb"), bytes.clone()).unwrap()), 1);
    for length in 0..bytes.len() {
        let error = load_bytes(Path::new("x.glb"), bytes[..length].to_vec()).expect_err("it is not whole");
        assert!(error.to_string().contains("x.glb"), "{error}");
    }
    // With a header that agrees with the cut, the parts behind it are missed instead.
    for length in 12..bytes.len() {
        let mut cut = bytes[..length].to_vec();
        cut[8..12].copy_from_slice(&(length as u32).to_le_bytes());
        assert!(load_bytes(Path::new("x.glb"), cut).is_err(), "{length}");
    }
}

fn survives(name: &str, path: &Path, bytes: Vec<u8>) {
    if let Ok(model) = load_bytes(path, bytes) {
        check(&model, name);
    }
}

#[test]
fn every_flipped_byte_of_a_small_glb_is_survived() {
    let bytes = small_glb();
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(1);
    for at in 0..bytes.len() {
        for value in [bytes[at] ^ 1, bytes[at] ^ 0x80, b'9', b'-', random.random()] {
            let mut flipped = bytes.clone();
            flipped[at] = value;
            survives("flipped", Path::new("x.glb"), flipped);
        }
    }
}

/// The odd files of the collection; none where it is not there.
fn odd_files() -> Vec<PathBuf> {
    let Some(folder) = scene("odd/gltf") else {
        return Vec::new();
    };
    let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
    let is_scene =
        |path: &PathBuf| path.extension().is_some_and(|ending| ending == "gltf" || ending == "glb");
    let mut files: Vec<_> = files.filter(is_scene).collect();
    files.sort();
    files
}

#[test]
fn flipped_bytes_of_the_odd_files_are_survived() {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(2);
    for path in odd_files() {
        let bytes = std::fs::read(&path).unwrap();
        // Every other flip is in the document, where it matters most.
        let document = bytes.len().min(3000);
        for round in 0..300 {
            let mut flipped = bytes.clone();
            let at = random.random_range(0..if round % 2 == 0 { document } else { bytes.len() });
            flipped[at] = random.random();
            survives(&path.display().to_string(), &path, flipped);
        }
    }
}

/// A flipped byte seldom makes another document; another value in the place of a number does.
#[test]
fn other_values_in_the_odd_files_are_survived() {
    const VALUES: [&str; 12] = [
        "0",
        "1",
        "7",
        "-1",
        "255",
        "5125",
        "1e9",
        "1e39",
        "4294967296",
        "18446744073709551615",
        "null",
        "[0,0]",
    ];
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(3);
    for path in odd_files() {
        let bytes = std::fs::read(&path).unwrap();
        let parts = split_glb(&bytes);
        let Some(json) = parts.map(|(json, _)| json).or_else(|| std::str::from_utf8(&bytes).ok()) else {
            continue;
        };
        let is_number = |letter: char| letter.is_ascii_digit() || matches!(letter, '-' | '.' | 'e' | 'E');
        let starts: Vec<usize> = json
            .match_indices(is_number)
            .map(|(at, _)| at)
            .filter(|&at| json[..at].ends_with([':', ',', '[', ' ', '\t', '\n']))
            .collect();
        for _ in 0..300 {
            let at = starts[random.random_range(0..starts.len())];
            let end = json[at..].find(|letter| !is_number(letter)).map_or(json.len(), |length| at + length);
            let changed = [&json[..at], VALUES[random.random_range(0..VALUES.len())], &json[end..]].concat();
            let changed =
                parts.map_or_else(|| changed.clone().into_bytes(), |(_, binary)| glb(&changed, binary));
            survives(&path.display().to_string(), &path, changed);
        }
    }
}
