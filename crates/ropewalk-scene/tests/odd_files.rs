//! Every odd file of the collection in the formats OBJ, PLY, STL and NFF: loaded with the right counts, or refused with
//! the right words.

mod common;

use common::{check, objects, scene, skipped, triangles};
use ropewalk::glam::DVec3;
use ropewalk_scene::load::load;
use ropewalk_scene::{LoadError, Model};
use std::collections::BTreeSet;

#[derive(Clone, Copy, Debug)]
enum Expected {
    /// So many triangles in so many objects; so many things are left out.
    Loaded(usize, usize, usize),
    /// An error with these words.
    Refused(&'static str),
}
use Expected::{Loaded, Refused};

const FILES: &[(&str, Expected)] = &[
    ("obj/box_UTF16BE.obj", Loaded(12, 1, 0)),
    ("obj/box_without_lineending.obj", Loaded(12, 1, 0)),
    // Its faces name normals, but it has none: 32 quads.
    ("obj/catmark_torus_creases0.obj", Loaded(64, 1, 128)),
    ("obj/concave_polygon.obj", Loaded(64, 1, 0)),
    ("obj/cornell_box.obj", Loaded(36, 8, 0)),
    ("obj/cube-vertex-w-component.obj", Loaded(12, 6, 0)),
    ("obj/cube-vertexcol.obj", Loaded(12, 6, 0)),
    ("obj/cube_compressed.obj", Loaded(12, 1, 0)),
    ("obj/empty.obj", Refused("the file is empty")),
    ("obj/invalid-face-definition.obj", Loaded(0, 0, 2)),
    ("obj/invalid-relative-texture-index.obj", Loaded(0, 0, 1)),
    ("obj/invalid-relative-vertex-index.obj", Loaded(0, 0, 1)),
    ("obj/issue-161-inconsistent-f.obj", Loaded(12, 1, 0)),
    ("obj/issue-295-trianguation-failure.obj", Loaded(28, 1, 0)),
    ("obj/issue-330.obj", Loaded(3, 1, 0)),
    ("obj/joined_tetrahedra.obj", Loaded(8, 2, 0)),
    ("obj/leading-decimal-dot-issue-201.obj", Loaded(1, 1, 0)),
    ("obj/leading-zero-in-exponent-notation-issue-210.obj", Loaded(1, 1, 0)),
    ("obj/line-prim.obj", Loaded(0, 0, 2)),
    ("obj/malformed2.obj", Loaded(10, 1, 1)),
    ("obj/missing_material_file.obj", Loaded(36, 8, 0)),
    ("obj/mtl filename with whitespace issue46.obj", Loaded(12, 6, 0)),
    ("obj/multiple_spaces.obj", Loaded(1, 1, 0)),
    ("obj/nancolor.obj", Loaded(12, 1, 0)),
    ("obj/negative_indices.obj", Loaded(12, 1, 0)),
    ("obj/no_material.obj", Loaded(36, 8, 0)),
    // Six of its vertices have numbers such as 3.1+e2.
    ("obj/number_formats.obj", Loaded(1, 1, 6)),
    ("obj/obj_points.obj", Loaded(0, 0, 0)),
    ("obj/obj_wireframe.obj", Loaded(0, 0, 12)),
    ("obj/only_a_part_of_vertexcolors.obj", Loaded(3, 1, 0)),
    ("obj/point_cloud.obj", Loaded(0, 0, 0)),
    ("obj/points-prim.obj", Loaded(0, 0, 1)),
    ("obj/regr01.obj", Loaded(2710, 55, 0)),
    ("obj/testmixed.obj", Loaded(12, 1, 12)),
    ("obj/two_objects.obj", Loaded(16, 2, 0)),
    ("ply/cube_binary_starts_with_nl.ply", Loaded(12, 1, 0)),
    ("ply/cube_blender_uv.ply", Loaded(12, 1, 0)),
    ("ply/dolphins_ascii.ply", Loaded(1689, 1, 0)),
    (
        "ply/dolphins_be_utf8_mangled.ply",
        Refused("byte 44409: a list of 191 is promised, but only 636 bytes are left"),
    ),
    ("ply/empty.ply", Loaded(0, 0, 0)),
    ("ply/empty_0bytes.ply", Refused("the file is empty")),
    ("ply/float-color.ply", Loaded(1, 1, 0)),
    ("ply/issue623.ply", Refused("line 15: the length of a list is negative or not whole")),
    ("ply/multi.ply", Loaded(2, 1, 0)),
    ("ply/platonic_shelf.ply", Loaded(80, 1, 0)),
    ("ply/platonic_shelf_ascii.ply", Loaded(80, 1, 0)),
    ("ply/platonic_shelf_big_endian.ply", Loaded(80, 1, 0)),
    ("ply/ply_empty_ascii.ply", Loaded(0, 0, 0)),
    ("ply/ply_empty_bin.ply", Loaded(0, 0, 0)),
    ("ply/points_emptyface.ply", Loaded(0, 0, 0)),
    ("ply/reference.ply", Loaded(1610, 1, 0)),
    ("ply/tet.ply", Loaded(4, 1, 0)),
    ("stl/20mm-xyz-cube.stl", Loaded(260, 1, 0)),
    ("stl/colored.stl", Loaded(2156, 1, 0)),
    ("stl/multibody.stl", Loaded(32, 2, 0)),
    ("stl/soup.stl", Loaded(100, 1, 0)),
    ("stl/triangle_with_empty_solid.stl", Loaded(1, 1, 0)),
    ("stl/two_objects_mixed_case_names.stl", Loaded(24, 2, 0)),
    // Three spheres and a quad.
    ("nff/WithCamera.nff", Loaded(3 * 960 + 2, 1, 0)),
    // Two spheres, a cone that is cut off and one with a point.
    ("nff/cone.nff", Loaded(2 * 960 + 64 + 32, 1, 0)),
    ("nff/cylinder.nff", Loaded(64, 1, 0)),
    ("nff/positionTest.nff", Loaded(14 * 960 + 64, 1, 0)),
    ("nff/spheres.nff", Loaded(4 * 960, 1, 0)),
    ("nff/teapot_sense8.nff", Refused("Sense8's WorldToolKit")),
];

/// What is not as expected.
fn difference(outcome: &Result<Model, LoadError>, expected: Expected) -> Option<String> {
    match (outcome, expected) {
        (Ok(model), Loaded(count, of_objects, left_out)) => {
            let found = (triangles(model), objects(model), model.report.skipped_count());
            let wanted = (count, of_objects, left_out);
            (found != wanted).then(|| format!("{found:?}, not {wanted:?}: {:?}", model.report))
        }
        (Err(error), Refused(words)) => {
            let text = error.to_string();
            let is_fine = text.contains(words) && !text.contains('\n');
            (!is_fine).then(|| format!("the error is: {text}"))
        }
        (Ok(model), Refused(_)) => Some(format!("loaded: {:?}", model.report)),
        (Err(error), Loaded(..)) => Some(format!("refused: {error}")),
    }
}

#[test]
fn every_odd_file_does_what_its_table_says() {
    for &(file, expected) in FILES {
        let Some(path) = scene(&format!("odd/{file}")) else { return };
        let outcome = load(&path);
        if let Some(difference) = difference(&outcome, expected) {
            panic!("{file}: {difference}");
        }
        match outcome {
            Ok(model) => check(&model, file),
            Err(error) => {
                let name = path.file_name().unwrap().to_string_lossy();
                assert!(error.to_string().contains(&*name), "{error} does not name the file");
            }
        }
    }
}

#[test]
fn no_odd_file_is_forgotten() {
    let known: BTreeSet<String> = FILES.iter().map(|(file, _)| (*file).to_owned()).collect();
    let mut found = BTreeSet::new();
    for folder in ["obj", "ply", "stl", "nff"] {
        let Some(path) = scene(&format!("odd/{folder}")) else { return };
        let names = std::fs::read_dir(path).unwrap().map(|entry| entry.unwrap().file_name());
        let scenes =
            names.map(|name| name.to_string_lossy().into_owned()).filter(|name| !name.ends_with(".mtl"));
        found.extend(scenes.map(|name| format!("{folder}/{name}")));
    }
    assert_eq!(found, known);
}

#[test]
fn the_comparison_objects() {
    let cube = || common::load_text("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert_eq!(difference(&cube(), Loaded(1, 1, 0)), None);
    for wrong in [Loaded(2, 1, 0), Loaded(1, 2, 0), Loaded(1, 1, 1), Refused("")] {
        assert!(difference(&cube(), wrong).is_some(), "{wrong:?}");
    }
    let refused = || common::load_text("x.obj", "");
    assert_eq!(difference(&refused(), Refused("empty")), None);
    for wrong in [Loaded(0, 0, 0), Refused("full")] {
        assert!(difference(&refused(), wrong).is_some(), "{wrong:?}");
    }
}

#[test]
fn three_encodings_hold_one_shelf() {
    let mut shelves = Vec::new();
    for name in ["platonic_shelf", "platonic_shelf_ascii", "platonic_shelf_big_endian"] {
        let Some(path) = scene(&format!("odd/ply/{name}.ply")) else { return };
        shelves.push(load(&path).unwrap().scene);
    }
    // The text has six digits only.
    let [binary, text, big] = shelves.as_slice() else { panic!() };
    assert_eq!(binary, big);
    let (binary, text) = (&binary.objects[0].geometries[0], &text.objects[0].geometries[0]);
    assert_eq!(binary.triangles, text.triangles);
    assert!(binary.positions.iter().zip(&text.positions).all(|(a, b)| a.distance(*b) < 1e-5));
}

#[test]
fn far_and_folded_quads_keep_their_area() {
    let Some(path) = scene("odd/obj/issue-295-trianguation-failure.obj") else { return };
    let model = load(&path).unwrap();
    assert_eq!(model.scene.origin, DVec3::new(14_678.0, 0.0, 9_606.0));
    let mesh = &model.scene.objects[0].geometries[0];
    let areas = (0..28).map(|index| {
        let [a, b, c] = mesh.triangle(index).unwrap().vertices;
        (b - a).cross(c - a).length() / 2.0
    });
    assert!(areas.into_iter().all(|area| area == 0.5));
}

#[test]
fn a_library_with_blanks_in_its_name_is_found() {
    let Some(path) = scene("odd/obj/mtl filename with whitespace issue46.obj") else { return };
    let model = load(&path).unwrap();
    assert_eq!(model.materials.len(), 1);
    assert_eq!(
        (model.materials[0].name.as_str(), model.materials[0].base_color.to_array()),
        ("green", [0.0, 1.0, 0.0])
    );
}

#[test]
fn what_is_left_out_is_named_with_its_line() {
    for (file, what, count, first) in [
        ("number_formats.obj", "readable numbers", 6, "line 11"),
        ("malformed2.obj", "fewer than three vertices", 1, "line 23"),
        ("testmixed.obj", "point elements", 6, "line 23"),
        ("invalid-relative-vertex-index.obj", "vertex that is not there", 1, "line 1"),
    ] {
        let Some(path) = scene(&format!("odd/obj/{file}")) else { return };
        let model = load(&path).unwrap();
        assert_eq!(skipped(&model, what), count, "{file}");
        let row = model.report.skipped.iter().find(|row| row.what.contains(what)).unwrap();
        assert_eq!(row.first, first, "{file}");
    }
}
