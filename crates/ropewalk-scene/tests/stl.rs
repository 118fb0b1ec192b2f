//! STL, feature by feature.

mod common;

use common::{check, load_text, objects, scene, skipped, triangles};
use ropewalk::glam::{DVec3, Vec3};
use ropewalk_scene::Model;
use ropewalk_scene::load::{load, load_bytes};
use std::path::Path;

fn facet(corners: [&str; 3]) -> String {
    let vertices = corners.map(|corner| format!("vertex {corner}\n")).concat();
    format!("facet normal 0 0 1\nouter loop\n{vertices}endloop\nendfacet\n")
}

fn first() -> String {
    facet(["0 0 0", "1 0 0", "0 1 0"])
}

fn second() -> String {
    facet(["1 0 0", "1 1 0", "-0 1e0 0"])
}

fn stl(text: &str) -> Model {
    let model = load_text("part.stl", text).unwrap_or_else(|error| panic!("{error}"));
    check(&model, text);
    model
}

fn binary(header: &[u8], facets: &[[Vec3; 3]]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend((facets.len() as u32).to_le_bytes());
    for corners in facets {
        let numbers = std::iter::once(&Vec3::Z).chain(corners).flat_map(Vec3::to_array);
        bytes.extend(numbers.flat_map(f32::to_le_bytes));
        bytes.extend([0, 0]);
    }
    bytes
}

const SQUARE: [[Vec3; 3]; 2] = [[Vec3::ZERO, Vec3::X, Vec3::Y], [Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]];

#[test]
fn corners_at_one_place_become_one_vertex() {
    let model = stl(&format!("solid a\n{}{}endsolid a\n", first(), second()));
    let mesh = &model.scene.objects[0].geometries[0];
    assert_eq!((mesh.positions.len(), model.report.vertices), (4, 6));
    assert_eq!(mesh.triangles, [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(model.report.format, "STL ascii");
}

#[test]
fn solids_are_objects() {
    let (a, b) = (first(), second());
    let model =
        stl(&format!("SOLID a b \n{a}EndSolid a b\nsolid nothing\nendsolid\nsolid\n{b}{b}endsolid\n"));
    assert_eq!(model.object_names, ["a b", ""]);
    let counts: Vec<usize> = model.scene.objects.iter().map(ropewalk::Object::triangle_count).collect();
    assert_eq!((counts, model.report.skipped_count()), (vec![1, 2], 0));
}

#[test]
fn keywords_have_any_case_and_lines_any_shape() {
    let plain = stl(&format!("solid a\n{}endsolid a\n", first()));
    let upper = stl(&format!("solid a\n{}endsolid a\n", first().to_uppercase()));
    let one_line = stl(&format!("solid a\n{} endsolid a", first().replace('\n', " ")));
    let crlf = stl(&format!("solid a\n{}endsolid a\n", first()).replace('\n', "\r\n"));
    let old = stl(&format!("solid a\n{}endsolid a\n", first()).replace('\n', "\r"));
    for other in [upper, one_line, crlf, old] {
        assert_eq!(other.scene, plain.scene);
    }
}

#[test]
fn odd_facets_are_cut_or_counted() {
    let quad = facet(["0 0 0", "1 0 0", "1 1 0\nvertex 0 1 0"]);
    let short = facet(["0 0 0", "1 0 0", "0 1 0"]).replace("vertex 0 1 0\n", "");
    let model = stl(&format!("solid a\n{quad}{short}facet normal -nan(ind) x y\nendfacet\nendsolid\n"));
    assert_eq!((triangles(&model), skipped(&model, "fewer than three")), (2, 2));
    assert_eq!(model.report.vertices, 6);
}

#[test]
fn errors_name_the_line() {
    for (text, words) in [
        ("solid a\nfacet normal 0 0 1\nvertex 1 2\n", "line 3: a vertex needs three numbers"),
        ("solid a\nfacet normal 0 0 1\nvertex 1 2 z\n", "line 3: 'z' is no number"),
        ("solid a\nfacets\n", "line 2: 'facets' is no word of STL"),
        ("solid a\nfacet normal 0 0 1\nouter loop\nvertex 1 2 3\n", "line 4: the file ends within a facet"),
    ] {
        let error = load_text("part.stl", text).unwrap_err().to_string();
        assert_eq!(error, format!("part.stl: {words}"));
    }
    let open = stl(&format!("solid a\n{}", first()));
    assert_eq!(open.report.notes, ["the last solid has no 'endsolid'"]);
}

#[test]
fn binary_files_may_begin_with_any_word() {
    let text = stl(&format!("solid a\n{}{}endsolid a\n", first(), second().replace("-0 1e0", "0 1")));
    for header in [&b"solid part"[..], b"COLOR=", b"\xef\xbb\xbf", b"\xff\xfe", b"v 1 2 3\n"] {
        for name in ["part.stl", "part", "part.obj"] {
            let model = load_bytes(Path::new(name), binary(header, &SQUARE)).unwrap();
            check(&model, "binary");
            assert_eq!(model.scene, text.scene, "{header:?}");
            assert_eq!(model.report.format, "STL binary");
        }
    }
}

#[test]
fn binary_sizes_are_checked() {
    let whole = binary(b"part", &SQUARE);
    for length in 1..whole.len() {
        let error = load_bytes(Path::new("part.stl"), whole[..length].to_vec()).unwrap_err().to_string();
        let words = if length < 84 {
            "ends before its count"
        } else {
            "byte 80: 2 facets are promised, but the file ends after"
        };
        assert!(error.contains(words), "{length}: {error}");
    }
    let mut longer = binary(b"solid\0", &SQUARE);
    longer.extend([7; 13]);
    let model = load_bytes(Path::new("part.stl"), longer).unwrap();
    assert_eq!((triangles(&model), model.report.notes.len()), (2, 1));
    let mut promises = whole;
    promises[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let error = load_bytes(Path::new("part.stl"), promises).unwrap_err().to_string();
    assert!(error.contains("4294967295 facets are promised, but the file ends after 2"), "{error}");
}

#[test]
fn far_parts_get_an_origin() {
    let far = SQUARE.map(|corners| corners.map(|corner| corner + Vec3::splat(1000.0)));
    let model = load_bytes(Path::new("part.stl"), binary(b"", &far)).unwrap();
    assert_eq!(model.scene.origin, DVec3::new(1001.0, 1001.0, 1000.0));
    assert_eq!(model.scene.objects[0].geometries[0].positions[0], Vec3::new(-1.0, -1.0, 0.0));
}

#[test]
fn corners_that_are_not_numbers_are_left_to_the_builder() {
    let model = stl(&format!("solid a\n{}{}endsolid\n", first(), facet(["0 0 0", "nan 0 0", "0 1 0"])));
    assert_eq!(model.scene.flatten().unwrap().report.not_finite, 1);
}

#[test]
fn text_and_binary_of_one_part_agree() {
    let (Some(text), Some(binary)) =
        (scene("stl_parts/pr2_head_pan_ascii.stl"), scene("stl_parts/pr2_head_pan_bin.stl"))
    else {
        return;
    };
    let [text, binary] = [text, binary].map(|path| load(&path).unwrap());
    assert_eq!((objects(&text), objects(&binary)), (1, 1));
    // The text has six digits: 1e-6 of half a metre.
    let (a, b) = (&text.scene.objects[0].geometries[0], &binary.scene.objects[0].geometries[0]);
    assert_eq!(a.triangles.len(), b.triangles.len());
    for index in 0..a.triangles.len() {
        let (a, b) = (a.triangle(index).unwrap().vertices, b.triangle(index).unwrap().vertices);
        assert!(a.iter().zip(&b).all(|(a, b)| a.distance(*b) < 1e-6), "{index}: {a:?} {b:?}");
    }
}
