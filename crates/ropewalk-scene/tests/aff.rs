//! AFF and NFF: small documents with everything that the format has, and the scenes of the benchmark as they start.

mod common;

use common::{check, load_text, objects, scene, skipped, triangles};
use ropewalk::Ray;
use ropewalk::glam::{DVec3, Vec3};
use ropewalk_scene::load::load;
use ropewalk_scene::{Light, LoadError, Material, MaterialAssignment, Model};
use std::f64::consts::SQRT_2;
use std::fs;

fn aff(text: &str) -> Model {
    let model = load_text("x.aff", text).unwrap_or_else(|error| panic!("{error}"));
    check(&model, text);
    model
}

fn refused(text: &str) -> String {
    load_text("x.aff", text).unwrap_err().to_string()
}

/// The vertices of an object in the world.
fn world(model: &Model, object: usize) -> Vec<DVec3> {
    let instance = model.scene.instances.iter().find(|instance| instance.object as usize == object).unwrap();
    let mesh = &model.scene.objects[object].geometries[0];
    let placed =
        mesh.positions.iter().map(|&at| instance.transform.point(at).as_dvec3() + model.scene.origin);
    placed.collect()
}

fn near(found: &[DVec3], expected: &[[f64; 3]]) -> bool {
    found.len() == expected.len()
        && found.iter().zip(expected).all(|(one, other)| one.distance(DVec3::from(*other)) < 1e-5)
}

/// A triangle that turns and flies in a block that is turned itself, seen by a camera, and started at some time.
fn spinner(start: f64) -> String {
    format!(
        "# a comment\nb 0.1 0.1 0.2\nv\nfrom 0 1 8  at 0 1 0  up 0 1 0\nangle 40 hither 0.1 resolution 320 240\n\
         am 0.5 0.5 0.5\nl 5 5 5  1 1 1\nfm 0.1 0.1 0.1  0.8 0.2 0.1  0 0 0  10 0 0\n\
         xs 2 2 2   0 1 0 90   1 0 0\n{{\n  x spinner\n  {{\n    m\n    vertices 3\n 0 0 0   1 0 0   0 1 0\n\
         normals 1\n 0 0 1\n triangles 1\n 0 1 2  0 0 0\n  }}\n}}\n\
         k spinner\n{{\n transl 4\n 0 0 0 0  0 0 0\n 1 0 0 0  0 0 0\n 2 0 0 4  0 0 0\n 3 0 0 4  0 0 0\n\
         rot 4\n 0 0 0 1   0  0 0 0\n 1 0 0 1   0  0 0 0\n 2 0 0 1  90  0 0 0\n 3 0 0 1  90  0 0 0\n}}\n\
         a {start} 2 5  % five frames"
    )
}

#[test]
fn a_triangle_that_turns_and_flies() {
    for (start, vertices) in [
        (1.0, [[1.0, 0.0, 0.0], [1.0, 0.0, -2.0], [1.0, 2.0, 0.0]]),
        (1.25, [[2.625, 0.0, 0.0], [2.625, 0.62736, -1.89906], [2.625, 1.89906, 0.62736]]),
        (1.5, [[5.0, 0.0, 0.0], [5.0, SQRT_2, -SQRT_2], [5.0, SQRT_2, SQRT_2]]),
        (2.0, [[9.0, 0.0, 0.0], [9.0, 2.0, 0.0], [9.0, 0.0, 2.0]]),
    ] {
        let model = aff(&spinner(start));
        assert_eq!((objects(&model), triangles(&model)), (1, 1));
        let found = world(&model, 0);
        assert!(near(&found, &vertices), "{start}: {found:?}");
        assert!(!near(&found[1..], &vertices[..2]), "the comparison objects");
    }
    let model = aff(&spinner(1.0));
    assert_eq!((model.report.format.as_str(), model.report.vertices), ("AFF", 3));
    assert_eq!(model.object_names, ["spinner"]);
    assert_eq!(model.up, Some(Vec3::Y));
    let [material] = model.materials.as_slice() else { panic!("one material") };
    assert_eq!((material.base_color, material.roughness), (Vec3::new(0.8, 0.2, 0.1), 1.0));
    assert_eq!(material.name, "x.aff, line 8");
    let [camera] = model.cameras.as_slice() else { panic!("one camera") };
    assert_eq!(
        (camera.position, camera.forward, camera.up),
        (Vec3::new(0.0, 1.0, 8.0), Vec3::NEG_Z, Vec3::Y)
    );
    assert_eq!(camera.vertical_fov, 40f32.to_radians());
    assert!(model.report.notes.iter().any(|note| note.starts_with("2 keyframe tracks: shown as at time 1")));
    let surface = &model.surfaces[0][0];
    assert_eq!(surface.normals.as_ref().unwrap().values, [Vec3::Z]);
}

#[test]
fn lights_are_as_bright_as_the_file_says_at_any_distance() {
    let model =
        aff("l 4 4 0  1 .5 0\nxs 1 1 1 0 1 0 0 0 0 2 { la lamp 9 9 9 }\nl 1 0 1\np 3 0 0 0 3 0 0 0 0 0\n\
                     k lamp { transl 4 0 1 0 0 0 0 0 1 1 0 0 0 0 0 2 1 0 0 0 0 0 3 1 0 0 0 0 0 }");
    let expected = [
        Light::Lamp { position: Vec3::new(4.0, 4.0, 0.0), color: Vec3::new(1.0, 0.5, 0.0) },
        Light::Lamp { position: Vec3::new(1.0, 0.0, 2.0), color: Vec3::ONE },
        Light::Lamp { position: Vec3::new(1.0, 0.0, 1.0), color: Vec3::ONE },
    ];
    assert_eq!(model.lights, expected);
}

#[test]
fn every_shape_is_read() {
    let model = aff("f 0.9 0.2 0.1 0.5 0.3 20 0 1\n\
                     p 4   0 0 0   1 0 0   1 1 0   0 1 0\n\
                     p 4   0 0 0   2 0 0   0.5 0.5 0   0 2 0\n\
                     pp 3  0 0 0 0 0 1   1 0 0 0 0 1   0 1 0 0 0 1\n\
                     tt brick.ppm   0 0 0 0 1   1 0 0 1 1   0 1 0 0 0\n\
                     ttp brick.ppm  0 0 0 0 0 1 0 1   1 0 0 0 0 1 1 1   0 1 0 0 0 1 0 0\n\
                     s 0 1 0 0.5\ns 0 0 0 0\nc 0 0 0 0.4 0 2 0 0.1\nc 1 1 1 1 1 1 1 1\n\
                     fm 0 0 0 .1 .2 .3 .4 .4 .4 5 0.75 1.4\n\
                     tpa 2 0   0 0 0 0 0 1   1 0 0 0 0 1   0 1 0 0 0 1\n\
                           1   0 0 2 0 0 1   1 0 2 0 0 1   0 1 2 0 0 1\n\
                     m vertices 4 0 0 0 1 0 0 1 1 0 0 1 0 texturecoords 1 a.ppm .5 .5\n\
                     triangles 2 0 1 2 0 0 0 0 2 3 0 0 0\n\
                     m vertices 0 triangles 0\n\
                     a 0.25 1 4\n");
    // Two objects: what keeps its shape, and what does not.
    let counts: Vec<_> = model.scene.objects.iter().map(ropewalk::Object::triangle_count).collect();
    assert_eq!(counts, [2 + 2 + 1 + 1 + 1 + 960 + 64 + 2, 1]);
    assert_eq!(model.object_names, ["", ""]);
    assert!(near(&world(&model, 1), &[[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [0.0, 1.0, 0.5]]));
    assert_eq!((skipped(&model, "spheres"), skipped(&model, "cones")), (1, 1));
    assert_eq!(model.report.skipped[0].first, "x.aff, line 8");
    assert_eq!(model.report.vertices, 4 + 4 + 3 + 3 + 3 + 3 + 4);
    let notes = model.report.notes.join("; ");
    for words in ["1 animated triangles: shown as at time 0.25", "2 textures", "1 spheres", "1 cones"] {
        assert!(notes.contains(words), "{notes}");
    }
    // Each of the two, with a picture and without.
    let [first, _, second, _] = model.materials.as_slice() else { panic!("{}", model.materials.len()) };
    assert_eq!((first.base_color, first.ior), (Vec3::new(0.45, 0.1, 0.05), 1.0));
    assert!(first.roughness > 0.0 && first.roughness < 1.0);
    assert_eq!((second.transmission, second.ior), (0.75, 1.4));
    let MaterialAssignment::PerTriangle(materials) = &model.surfaces[0][0].materials else { panic!() };
    assert_eq!((materials[0], materials[materials.len() - 1]), (0, 3));
    assert_eq!(model.surfaces[1][0].materials, MaterialAssignment::One(2));
}

#[test]
fn polygons_and_triangles_keep_their_sides() {
    let model = aff("xs -1 1 1 0 1 0 0 0 0 0 { p 3 0 0 0 1 0 0 0 1 0 }\n\
                     x mirrored { p 3 0 0 0 1 0 0 0 1 0 }\n\
                     k mirrored { scale 4 0 -1 1 1 0 0 0 1 -1 1 1 0 0 0 2 -1 1 1 0 0 0 3 -1 1 1 0 0 0 }");
    let flat = model.scene.flatten().unwrap();
    assert_eq!(flat.triangles.len(), 2);
    // Both are seen from the front at z = 1.
    let [a, b, c] = model.scene.objects[0].geometries[0].triangle(0).unwrap().vertices;
    assert!((b - a).cross(c - a).z > 0.0);
    assert!(model.scene.instances[1].transform.mirrors());
}

#[test]
fn blocks_nest_and_share_their_motion() {
    let model = aff("x a { p 3 0 0 0 1 0 0 0 1 0  x b { p 3 0 0 0 1 0 0 0 1 0 } }\n\
                     x a { xs 1 1 1 0 0 1 0 0 0 5 { p 3 0 0 0 1 0 0 0 1 0 } }\n\
                     xs 1 1 1 0 0 1 0 9 0 0 { x a { p 3 0 0 0 1 0 0 0 1 0 } }\n\
                     x empty { }\n\
                     p 3 0 0 0 1 0 0 0 1 0\n\
                     k a { transl 4 0 0 1 0 0 0 0 1 0 1 0 0 0 0 2 0 1 0 0 0 0 3 0 1 0 0 0 0 }");
    assert_eq!(model.object_names, ["a", "a/b", "a", ""]);
    let counts: Vec<_> = model.scene.objects.iter().map(ropewalk::Object::triangle_count).collect();
    assert_eq!(counts, [2, 1, 1, 1], "the first two blocks move together, the one beside them does not");
    let first = |object| world(&model, object)[0].to_array();
    assert_eq!([0, 1, 2, 3].map(first), [[0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [9.0, 1.0, 0.0], [0.0; 3]]);
}

#[test]
fn hidden_blocks_are_there_and_not_seen() {
    let model = aff("a 1 2 2 x a { x b { p 3 0 0 0 1 0 0 0 1 0 } } x c { p 3 0 0 0 1 0 0 0 1 0 }\n\
                     k a { visibility 2 0.5 0 2 1 } k c { visibility 1 2 0 }");
    let masks: Vec<_> = model.scene.instances.iter().map(|instance| instance.mask).collect();
    assert_eq!(masks, [0, Ray::ALL]);
}

#[test]
fn parts_that_cannot_be_placed_are_counted() {
    let model = aff("x flat { p 3 0 0 0 1 0 0 0 1 0 } x far { p 3 0 0 0 1 0 0 0 1 0 }\n\
                     k flat { scale 4 0 0 1 1 0 0 0 1 0 1 1 0 0 0 2 0 1 1 0 0 0 3 0 1 1 0 0 0 }\n\
                     k far { transl 4 0 1e300 1 1 0 0 0 1 1e300 1 1 0 0 0 2 1 1 1 0 0 0 3 1 1 1 0 0 0 }\n\
                     v from 0 0 0 at 0 1 0 up 0 1 0 angle 40 hither 0 resolution 1 1\nl 1e308 0 0\n");
    assert_eq!((objects(&model), model.scene.instances.len()), (2, 0));
    assert_eq!((skipped(&model, "singular"), skipped(&model, "not finite")), (1, 1));
    assert_eq!((skipped(&model, "views"), skipped(&model, "lights")), (1, 1));
    assert!(model.cameras.is_empty() && model.lights.is_empty());
}

#[test]
fn scenes_far_away_get_an_origin() {
    let model = aff("x a { p 3 0 0 0 1 0 0 0 1 0 } p 3 1e7 0 0 10000001 0 0 1e7 1 0\n\
                     k a { transl 4 0 1e7 0 2 0 0 0 1 1e7 0 2 0 0 0 2 0 0 0 0 0 0 3 0 0 0 0 0 0 }\n\
                     v from 1e7 0 4 at 1e7 0 0 up 0 1 0 angle 40 hither 0 resolution 1 1\n");
    assert!(model.scene.origin.x > 9e6);
    assert!(near(&world(&model, 0)[..1], &[[1e7, 0.0, 2.0]]));
    assert!(near(&world(&model, 1)[..2], &[[1e7, 0.0, 0.0], [1e7 + 1.0, 0.0, 0.0]]));
    let eye = model.cameras[0].position.as_dvec3() + model.scene.origin;
    assert_eq!(eye, DVec3::new(1e7, 0.0, 4.0));
}

/// Writes files into a folder and loads the first.
fn folder(files: &[(&str, &str)]) -> Result<Model, LoadError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    load(&folder.path().join(files[0].0))
}

const TRIANGLE: &str = "p 3 0 0 0 1 0 0 0 1 0\n";

#[test]
fn includes_are_read_where_they_stand() {
    let model = folder(&[
        ("main.aff", "i 0 red.aff i 0 parts/part.aff i 1 not_there.aff d 1 i 1 detail.aff"),
        ("red.aff", "fm 0 0 0 1 0 0 0 0 0 1 0 0"),
        (
            "parts/part.aff",
            "xs 1 1 1 0 0 1 0 2 0 0 { i 0 wheel.aff\r\ni 0 wheel.aff } fm 0 0 0 0 1 0 0 0 0 1 0 0",
        ),
        ("parts/wheel.aff", TRIANGLE),
        ("detail.aff", TRIANGLE),
    ])
    .unwrap();
    check(&model, "includes");
    assert_eq!((objects(&model), triangles(&model)), (1, 3));
    // Materials live on beyond the file that sets them, transforms end with their block.
    let colors: Vec<_> = model.materials.iter().map(|material| material.base_color).collect();
    assert_eq!(colors, [Vec3::X, Vec3::Y]);
    let names: Vec<_> = model.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["red.aff, line 1", "part.aff, line 2"]);
    assert_eq!(model.surfaces[0][0].materials, MaterialAssignment::PerTriangle(vec![0, 0, 1]));
    let found = world(&model, 0);
    assert_eq!((found[0], found[6]), (DVec3::X * 2.0, DVec3::ZERO));
}

#[test]
fn packed_files_are_read() {
    use std::io::Write;
    let pack = |text: &str| {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(text.as_bytes()).unwrap();
        encoder.finish().unwrap()
    };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("main.aff.gz"), pack("i 0 part.aff")).unwrap();
    fs::write(folder.path().join("part.aff.gz"), pack(TRIANGLE)).unwrap();
    assert_eq!(triangles(&load(&folder.path().join("main.aff.gz")).unwrap()), 1);
}

#[test]
fn includes_that_cannot_be_are_errors() {
    let error = |files: &[(&str, &str)]| folder(files).unwrap_err().to_string();
    for (files, words) in [
        (&[("a.aff", "\n i 0 b.aff")] as &[_], &["a.aff: line 2", "b.aff", "no such file"] as &[_]),
        (&[("a.aff", "i 0 a.aff")], &["a.aff: line 1", "included in itself"]),
        (&[("a.aff", "i 0 b.aff"), ("b.aff", "\ni 0 a.aff")], &["b.aff: line 2", "included in itself"]),
        (&[("a.aff", "x a {\ni 0 b.aff }"), ("b.aff", "}")], &["b.aff: line 1", "no block of this file"]),
        (&[("a.aff", "i 0 b.aff }"), ("b.aff", "\nx a {\n")], &["b.aff", "block of line 2"]),
    ] {
        let error = error(files);
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
}

#[test]
fn includes_have_a_depth_and_an_amount() {
    let mut files: Vec<(String, String)> =
        (0..40).map(|file| (format!("{file}.aff"), format!("i 0 {}.aff", file + 1))).collect();
    let run = |files: &[(String, String)]| {
        let files: Vec<_> = files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
        folder(&files).map_err(|error| error.to_string())
    };
    let error = run(&files).unwrap_err();
    assert!(error.contains("more than 32 deep, the limit"), "{error}");
    // Each includes the next eight times: 8 to the 20th in all.
    files =
        (0..20).map(|file| (format!("{file}.aff"), format!("i 0 {}.aff\n", file + 1).repeat(8))).collect();
    files.push(("20.aff".into(), String::new()));
    let error = run(&files).unwrap_err();
    assert!(error.contains("bytes of text, the limit"), "{error}");
}

#[test]
fn blocks_have_a_depth() {
    let nested = |depth: usize| format!("{}{TRIANGLE}{}", "x a {".repeat(depth), "}".repeat(depth));
    assert_eq!(triangles(&aff(&nested(256))), 1);
    let error = refused(&nested(257));
    assert!(error.contains("x.aff: line 1") && error.contains("more than 256 deep, the limit"), "{error}");
}

#[test]
fn what_breaks_the_format_is_named_with_its_line() {
    for (text, words) in [
        ("\nq 1", "line 2: 'q' begins no statement"),
        ("v from 0 0 x", "line 1: 'x' stands where a number"),
        ("v at", "'at' stands where 'from' must stand"),
        ("fm 1 1\n1 1", "line 2: the file ends where a number must stand"),
        ("p 2 0 0 0 1 1 1", "polygon of 2 corners"),
        ("p 4000000000 0 0 0", "4000000000 corners are promised, but only 6 bytes are left"),
        ("p -3", "'-3' stands where a whole number"),
        ("p 3.0 0 0 0", "'3.0' stands where a whole number"),
        ("m vertices 1 0 0 0 triangles 1 0 0 1", "no vertex 1: the mesh has 1"),
        ("m vertices 1 0 0 0 normals 0 triangles 1 0 0 0 0 0 0", "no normal 0: the mesh has 0"),
        ("m vertices 1 0 0 0 texturecoords 0 t triangles 1 0 0 0 5 0 0", "no texture coordinate 5"),
        ("m vertices 1 0 0 0 texturecoords 0 t normals 0", "'normals' stands where 'triangles'"),
        ("m normals", "'normals' stands where 'vertices' must stand"),
        ("tpa 0", "at least one"),
        ("tpa 1 0 0 0 0 0 0 1", "keys are promised"),
        ("}", "no block"),
        ("x a {\n", "block of line 1; '}' is missing"),
        ("b 0 0 0 {", "'{' stands where no"),
        ("x { }", "'{' stands where the name of what moves"),
        ("x a p", "'p' stands where '{' must stand"),
        ("k a { transl 3 }", "3 keys are promised"),
        ("a 0 1 x", "'x' stands where a whole number"),
        ("s 0 0 0 inf", "'inf' stands where a number"),
        ("s 0 0 0 1e999", "'1e999' stands where a number"),
        ("NFF\nversion 2", "WorldToolKit"),
    ] {
        let error = refused(text);
        assert!(error.contains(words) && error.starts_with("x.aff"), "{text}: {error}");
    }
}

#[test]
fn nff_is_loose_at_the_ends_of_lines() {
    let text = "\nf 1 .5 .25 .5 wood.png\ntess 4 s\ns 0 0 0 1 2 2\nf 0 1 0 1 0 1 0 1 a.jpg # b\n s 3 0 0 1 s 6 0 0 1";
    let model = load_text("x.nff", text).unwrap();
    check(&model, text);
    assert_eq!((model.report.format.as_str(), triangles(&model), objects(&model)), ("NFF", 3 * 960, 1));
    let colors: Vec<_> = model.materials.iter().map(|material| material.base_color).collect();
    assert_eq!(colors, [Vec3::new(0.5, 0.25, 0.125), Vec3::Y]);
    let white = load_text("x.nff", "s 0 0 0 1").unwrap();
    assert_eq!(white.materials[0].base_color, Vec3::ONE);
}

/// The triangles of each object of a scene of the benchmark, the background last.
fn benchmark(file: &str) -> Option<(Model, Vec<usize>)> {
    let model = load(&scene(file)?).unwrap_or_else(|error| panic!("{error}"));
    check(&model, file);
    assert_eq!(model.report.skipped, [], "{file}");
    let counts = model.scene.objects.iter().map(ropewalk::Object::triangle_count).collect();
    Some((model, counts))
}

/// How many triangles have none; nothing else is wrong with any.
fn without_area(model: &Model) -> usize {
    let report = model.scene.flatten().unwrap().report;
    assert_eq!((report.not_finite, report.out_of_range), (0, 0));
    report.degenerate + report.collinear
}

/// How many materials there are when pictures are not told apart. Two statements may say what is one material in f32.
fn without_pictures(model: &Model) -> usize {
    let mut distinct: Vec<Material> = Vec::new();
    for material in &model.materials {
        let plain = Material { name: String::new(), base_color_texture: None, ..material.clone() };
        if !distinct.contains(&plain) {
            distinct.push(plain);
        }
    }
    distinct.len()
}

#[test]
fn the_robots() {
    let Some((model, counts)) = benchmark("bart_robot/Robot.aff") else { return };
    assert_eq!((counts.len(), model.scene.instances.len()), (161, 161));
    assert_eq!((triangles(&model), model.report.vertices), (71_708, 134_127));
    let background = model.object_names.iter().position(String::is_empty).unwrap();
    assert_eq!(counts[background], 9_218);
    assert_eq!((model.materials.len(), model.lights.len(), model.cameras.len()), (141, 1, 1));
    assert_eq!(without_pictures(&model), 62);
    assert_eq!(model.cameras[0].position, Vec3::new(-3.5, 2.0, -203.0));
    // Ten robots of sixteen parts each.
    let parts = |robot: usize| {
        let head = format!("robot_transl{robot}/");
        model.object_names.iter().filter(|name| name.starts_with(&head)).count()
    };
    assert_eq!((1..=10).map(parts).collect::<Vec<_>>(), [16; 10]);
    assert_eq!(without_area(&model), 128);
}

#[test]
fn the_kitchen() {
    let Some((model, counts)) = benchmark("bart_kitchen/kitchen.aff") else { return };
    assert_eq!((triangles(&model), model.report.vertices), (110_561, 63_706));
    assert_eq!(
        model.object_names,
        [
            "",
            "toycar",
            "toycar/front_wheel_left/rotating_wheel_left",
            "toycar/front_wheel_right/rotating_wheel_right",
            "toycar/rotating_wheel_left",
            "toycar/rotating_wheel_right",
        ]
    );
    assert_eq!((counts[0], counts[1..].iter().sum()), (103_343, 7_218));
    assert_eq!((model.materials.len(), model.lights.len(), model.cameras.len()), (28, 6, 1));
    assert_eq!(without_pictures(&model), 26);
    assert_eq!(without_area(&model), 41);
}

#[test]
fn the_museum() {
    let Some((model, counts)) = benchmark("bart_museum/museum5.aff") else { return };
    // 10,000 triangles of a mesh, 274 of polygons, 10 with textures, 8 cylinders; and those that change.
    assert_eq!(counts, [10_000 + 274 + 10 + 8 * 64, 1_024]);
    assert_eq!((model.materials.len(), model.lights.len(), model.cameras.len()), (14, 2, 1));
    assert_eq!(without_pictures(&model), 11);
    assert!(model.materials[0].name.contains(".aff, line "), "{}", model.materials[0].name);
    assert_eq!(without_area(&model), 0);
}
