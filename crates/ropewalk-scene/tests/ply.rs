//! PLY, feature by feature.

mod common;

use common::{check, load_text, objects, skipped, triangles};
use ropewalk::glam::{DVec3, Vec2, Vec3};
use ropewalk_scene::Model;
use ropewalk_scene::load::load_bytes;
use std::path::Path;

const VERTICES: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const CORNERS: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
const FACES: &str = "property list uchar int vertex_indices\n";

/// The body begins on line 10 where the elements take seven lines.
fn text(elements: &str, body: &str) -> String {
    format!("ply\nformat ascii 1.0\n{elements}end_header\n{body}")
}

fn ply(text: &str) -> Model {
    let model = load_text("scene.ply", text).unwrap_or_else(|error| panic!("{error}"));
    check(&model, text);
    model
}

fn refusal(bytes: impl Into<Vec<u8>>) -> String {
    load_bytes(Path::new("scene.ply"), bytes.into()).unwrap_err().to_string()
}

fn indices(model: &Model) -> &[[u32; 3]] {
    &model.scene.objects[0].geometries[0].triangles
}

#[test]
fn polygons_of_any_size_are_read() {
    let body = format!("{CORNERS}4 0 1 2 3\n3 2 1 0\n2 0 1\n0\n1 3\n");
    let model = ply(&text(&format!("{VERTICES}element face 5\n{FACES}"), &body));
    assert_eq!(indices(&model), [[0, 1, 2], [0, 2, 3], [2, 1, 0]]);
    assert_eq!((skipped(&model, "fewer than three"), model.report.format.as_str()), (3, "PLY ascii"));
    assert_eq!(model.report.skipped[0].first, "face 2, counted from 0");
}

#[test]
fn vertices_keep_their_numbers() {
    let model = ply(&text(&format!("{VERTICES}element face 1\n{FACES}"), &format!("{CORNERS}3 3 1 2\n")));
    assert_eq!(indices(&model), [[3, 1, 2]]);
    assert_eq!(model.scene.objects[0].geometries[0].positions.len(), 4);
}

#[test]
fn strips_turn_every_other_triangle_and_start_again() {
    let elements = format!("{VERTICES}element tristrips 2\nproperty list int int vertex_indices\n");
    let model = ply(&text(&elements, &format!("{CORNERS}10 0 1 3 2 -1 0 1 2 2 3\n4 1 2 3 9\n")));
    assert_eq!(indices(&model), [[0, 1, 3], [3, 1, 2], [0, 1, 2], [1, 2, 3]]);
    assert_eq!(skipped(&model, "vertex that is not there"), 1);
}

#[test]
fn normals_and_texture_coordinates_are_read_by_any_name() {
    for (u, v) in [("s", "t"), ("u", "v"), ("texture_u", "texture_v")] {
        let elements = format!(
            "element vertex 3\nproperty double {u}\nproperty double x\nproperty float ny\nproperty char y\nproperty float nx\n\
             property short z\nproperty float nz\nproperty float {v}\nelement face 1\n{FACES}"
        );
        let model = ply(&text(&elements, ".5 0 1 0 0 0 0 .25\n0 1 1 0 0 0 0 0\n0 0 1 1 0 0 0 0\n3 0 1 2\n"));
        let surface = &model.surfaces[0][0];
        assert_eq!(surface.normals.as_ref().unwrap().values, [Vec3::Y; 3]);
        assert_eq!(surface.texture_coordinates.as_ref().unwrap().values[0], Vec2::new(0.5, 0.25));
        assert_eq!(model.scene.objects[0].geometries[0].positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    }
}

#[test]
fn what_else_is_there_is_passed_over_and_named() {
    let elements = format!(
        "comment made by hand\nobj_info 1\nelement camera 1\nproperty list uchar float view\nproperty int id\n{VERTICES}\
         property uchar red\nelement face 1\nproperty float quality\n{FACES}property list uchar float texcoord\n\
         element nothing 99999999999\n"
    );
    let body = "3 1 nan(ind) 3 7\n0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n0.5 3 0 1 2 2 0 0\n";
    let model = ply(&text(&elements, body));
    assert_eq!(indices(&model), [[0, 1, 2]]);
    assert_eq!(model.report.notes, ["not read: camera, vertex.red, face.quality, face.texcoord, nothing"]);
}

/// Every scalar type, a polygon and a strip, with a list before the vertices.
fn binary(big: bool) -> Vec<u8> {
    fn put<const N: usize>(bytes: &mut Vec<u8>, big: bool, mut value: [u8; N]) {
        if big {
            value.reverse();
        }
        bytes.extend(value);
    }
    let format = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = format!(
        "ply\nformat {format} 1.0\nelement face 2\nproperty list ushort uint vertex_index\nproperty list char double extra\n\
         element vertex 4\nproperty double x\nproperty short y\nproperty int8 z\nproperty float32 w\nend_header\n"
    )
    .into_bytes();
    for face in [&[0u32, 1, 2, 3][..], &[3, 2, 1]] {
        put(&mut bytes, big, (face.len() as u16).to_le_bytes());
        for index in face {
            put(&mut bytes, big, index.to_le_bytes());
        }
        put(&mut bytes, big, [1]);
        put(&mut bytes, big, 0.1f64.to_le_bytes());
    }
    for (x, y) in [(0.5f64, -2i16), (1.5, -2), (1.5, 300), (0.5, 300)] {
        put(&mut bytes, big, x.to_le_bytes());
        put(&mut bytes, big, y.to_le_bytes());
        put(&mut bytes, big, (-1i8).to_le_bytes());
        put(&mut bytes, big, f32::NAN.to_le_bytes());
    }
    bytes
}

#[test]
fn both_byte_orders_are_read() {
    for big in [false, true] {
        let model = load_bytes(Path::new("x"), binary(big)).unwrap();
        check(&model, "binary");
        assert_eq!(indices(&model), [[0, 1, 2], [0, 2, 3], [3, 2, 1]]);
        let corners =
            [(0.5, -2.0), (1.5, -2.0), (1.5, 300.0), (0.5, 300.0)].map(|(x, y)| Vec3::new(x, y, -1.0));
        assert_eq!(model.scene.objects[0].geometries[0].positions, corners);
        let order = if big { "PLY binary big endian" } else { "PLY binary little endian" };
        assert_eq!(model.report.format, order);
    }
}

#[test]
fn a_body_that_ends_early_is_an_error_with_its_place() {
    let whole = binary(false);
    let body = whole.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
    for length in body..whole.len() {
        let error = refusal(&whole[..length]);
        let at: usize = error
            .strip_prefix("scene.ply: byte ")
            .and_then(|rest| rest.split(':').next()?.parse().ok())
            .unwrap();
        assert!((body..=length).contains(&at), "{error}");
    }
    let mut longer = whole;
    longer.extend([1, 2, 3]);
    let model = load_bytes(Path::new("x"), longer).unwrap();
    assert_eq!(model.report.notes.last().unwrap(), "3 bytes after the last element are not read");
}

#[test]
fn promises_are_not_believed() {
    let vertices = VERTICES.replace('4', "4000000000000000000");
    let error = refusal(text(&vertices, CORNERS));
    assert!(
        error.contains("4000000000000000000 elements 'vertex' are promised, but only 23 bytes"),
        "{error}"
    );
    let error =
        refusal(text(&format!("{VERTICES}element face 1\n{FACES}"), &format!("{CORNERS}4000000000 0 1 2\n")));
    assert!(error.contains("line 14: a list of 4000000000 is promised"), "{error}");
    let mut binary =
        text(&format!("{VERTICES}element face 1\nproperty list int int vertex_index\n"), "").into_bytes();
    let name = binary.windows(5).position(|window| window == b"ascii").unwrap();
    binary.splice(name..name + 5, *b"binary_little_endian");
    binary.extend([0; 48]);
    binary.extend((-1i32).to_le_bytes());
    assert!(refusal(binary.clone()).contains("the length of a list is negative"));
    let end = binary.len();
    binary[end - 4..].copy_from_slice(&i32::MAX.to_le_bytes());
    assert!(refusal(binary).contains("a list of 2147483647 is promised, but only 0 bytes are left"));
}

#[test]
fn errors_in_a_text_name_the_line() {
    let elements = format!("{VERTICES}element face 1\n{FACES}");
    for (body, words) in [
        ("0 0 0\n1 zero 0\n1 1 0\n0 1 0\n3 0 1 2\n", "line 11: 'zero' is no number"),
        ("0 0 0 9\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n", "line 10: the line holds more numbers"),
        ("0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 3\n", "line 14: the line holds more numbers"),
        ("0 0 0\n1 0 0\n1 1 0\n0 1 0\n5 0 1 2 3\n", "line 14: a list of 5 is promised"),
        ("0 0 0\n1 0 0\n1 1 0\n0 1 0\n", "line 13: 1 elements 'face' are promised, but only 0 bytes"),
    ] {
        let error = refusal(text(&elements, body));
        assert!(error.contains(words), "{error}");
    }
    let error = refusal(text("element vertex 1\nproperty float x\nproperty float y\n", "0 0\n"));
    assert!(error.contains("no property 'z'"), "{error}");
}

#[test]
fn an_element_may_span_lines() {
    let body = "0 0\n0 1 0 0\n1 1 0 0 1 0\n3 0\n1\n2";
    let elements = format!("{VERTICES}element face 1\n{FACES}");
    let error = refusal(text(&elements, body));
    assert!(error.contains("line 11"), "but a line ends after an element: {error}");
    let model = ply(&text(&elements, "0 0\n0\n1 0 0\n1 1\n\n0\n0 1 0\n3 0\n1\n2"));
    assert_eq!(indices(&model), [[0, 1, 2]]);
}

#[test]
fn indices_that_lead_nowhere_skip_their_face() {
    let elements = format!("{VERTICES}element face 4\n{FACES}");
    let model =
        ply(&text(&elements, &format!("{CORNERS}3 0 1 4\n3 0 1 -1\n4 0 1 2 99999999999\n3 0 1 2.0\n")));
    assert_eq!((triangles(&model), skipped(&model, "vertex that is not there")), (1, 3));
}

#[test]
fn far_meshes_get_an_origin_and_empty_ones_no_object() {
    let elements = format!("{VERTICES}element face 1\n{FACES}");
    let model = ply(&text(&elements, "9000.5 0 0\n9001.5 0 0\n9000.5 1 0\n0 0 0\n3 0 1 2\n"));
    assert_eq!(model.scene.origin, DVec3::new(9001.0, 1.0, 0.0));
    let empty = ply(&text(VERTICES, CORNERS));
    assert_eq!((objects(&empty), empty.report.vertices), (0, 4));
}
