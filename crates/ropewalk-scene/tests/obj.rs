//! OBJ and MTL, feature by feature.

mod common;

use common::{check, load_text, objects, skipped, triangles};
use ropewalk::glam::{DVec3, Vec2, Vec3};
use ropewalk_scene::load::{load, load_bytes};
use ropewalk_scene::{CornerAttribute, MaterialAssignment, Model};
use std::fs;
use std::path::Path;

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn obj(text: &str) -> Model {
    let model = load_text("scene.obj", text).unwrap_or_else(|error| panic!("{error}"));
    check(&model, text);
    model
}

/// The corners of all triangles.
fn corners(model: &Model) -> Vec<[Vec3; 3]> {
    let meshes = model.scene.objects.iter().flat_map(|object| &object.geometries);
    meshes
        .flat_map(|mesh| (0..mesh.triangles.len()).map(|index| mesh.triangle(index).unwrap().vertices))
        .collect()
}

fn names(model: &Model) -> Vec<&str> {
    model.object_names.iter().map(String::as_str).collect()
}

#[test]
fn all_forms_of_a_corner_lead_to_the_same_triangle() {
    let head = format!("{CORNERS}vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n");
    let plain = obj(&format!("{head}f 1 2 3"));
    for form in
        ["1/1 2/2 3/3", "1//1 2//1 3//1", "1/1/1 2/2/1 3/3/1", "-4 -3 -2", "-4/-3/-1 2/-2/1 3", "1/ 2// 3"]
    {
        let model = obj(&format!("{head}f {form}\n"));
        assert_eq!(corners(&model), corners(&plain), "{form}");
        assert_eq!(model.report.skipped, [], "{form}");
    }
}

#[test]
fn attributes_belong_to_corners() {
    let model = obj(&format!(
        "{CORNERS}vt 0 0\nvt 1 0 7\nvt .5\nvn 0 0 1\nvn 1 0 0\nf 1/1/1 2/2/2 3/3/1\nf 1/1/2 3/2/2 4/3/2\n"
    ));
    let mesh = &model.scene.objects[0].geometries[0];
    let surface = &model.surfaces[0][0];
    let normals = surface.normals.as_ref().unwrap();
    assert_eq!(normals.corners(0, mesh.triangles[0]), Some([Vec3::Z, Vec3::X, Vec3::Z]));
    assert_eq!(normals.corners(1, mesh.triangles[1]), Some([Vec3::X; 3]));
    let coordinates = surface.texture_coordinates.as_ref().unwrap();
    let expected = [Vec2::ZERO, Vec2::X, Vec2::new(0.5, 0.0)];
    assert_eq!(coordinates.corners(1, mesh.triangles[1]), Some(expected));
}

#[test]
fn attributes_that_follow_the_vertices_need_no_indices() {
    let model = obj(&format!("{CORNERS}vn 0 0 1\nvn 0 1 0\nvn 1 0 0\nvn 0 0 -1\nf 2//2 3//3 4//4 1//1\n"));
    let normals = model.surfaces[0][0].normals.as_ref().unwrap();
    assert_eq!(
        *normals,
        CornerAttribute { values: vec![Vec3::Y, Vec3::X, Vec3::NEG_Z, Vec3::Z], indices: None }
    );
}

#[test]
fn corners_without_an_attribute_get_a_stand_in() {
    let model = obj(&format!("{CORNERS}vn 1 0 0\nvt 3 4\nf 1//1 2 3\nf 1/1 3/9 4/1\n"));
    let mesh = &model.scene.objects[0].geometries[0];
    let normals = model.surfaces[0][0].normals.as_ref().unwrap();
    assert_eq!(normals.corners(0, mesh.triangles[0]), Some([Vec3::X, Vec3::Z, Vec3::Z]), "the face's own");
    let coordinates = model.surfaces[0][0].texture_coordinates.as_ref().unwrap();
    let there = Vec2::new(3.0, 4.0);
    assert_eq!(coordinates.corners(1, mesh.triangles[1]), Some([there, Vec2::ZERO, there]));
    assert_eq!(skipped(&model, "texture coordinate is not there"), 1);
}

#[test]
fn objects_are_pairs_of_names_in_the_order_of_their_faces() {
    let face = "f 1 2 3\n";
    let model = obj(&format!(
        "{CORNERS}{face}o\ng one\n{face}g two three\n{face}g one\n{face}o b\ng empty\no b\n{face}g one\n{face}g b\n{face}o c d\n{face}"
    ));
    assert_eq!(names(&model), ["", "one", "two three", "b", "b/one", "b", "c d"]);
    let counts: Vec<usize> = model.scene.objects.iter().map(ropewalk::Object::triangle_count).collect();
    assert_eq!(counts, [1, 2, 1, 1, 1, 1, 1]);
    assert_eq!(model.scene.instances.len(), objects(&model));
}

#[test]
fn each_object_has_its_own_vertices() {
    let model = obj(&format!("v 9 9 9\n{CORNERS}o a\nf 2 3 4\no b\nf 5 3 4\n"));
    let [a, b] = [0, 1].map(|object: usize| &model.scene.objects[object].geometries[0]);
    assert_eq!((a.positions.len(), b.positions.len(), model.report.vertices), (3, 3, 5));
    assert_eq!((b.positions[0], b.triangles[0]), (Vec3::Y, [0, 1, 2]));
}

#[test]
fn materials_change_within_an_object() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("two words.mtl"), "newmtl unused\nnewmtl red\nKd 1 0 0\nmap_Kd a.png\n")
        .unwrap();
    fs::write(folder.path().join("b.mtl"), "newmtl blue\nKd 0 0 1\nnewmtl red\nKd 9 9 9\n").unwrap();
    fs::write(folder.path().join("c.mtl"), "newmtl green\nKd 0 1 0\n").unwrap();
    let path = folder.path().join("scene.obj");
    let faces = "f 1 2 3\nusemtl blue\nf 1 2 3 4\nusemtl lost\nf 1 2 3\nusemtl red\nf 1 2 3\nusemtl green\n";
    let text = format!("mtllib two words.mtl\nmtllib b.mtl c.mtl\nmtllib no.mtl\n{CORNERS}{faces}");
    fs::write(&path, text).unwrap();
    let model = load(&path).unwrap();
    check(&model, "materials");
    let named: Vec<_> =
        model.materials.iter().map(|material| (material.name.as_str(), material.base_color)).collect();
    let grey = Vec3::splat(0.6);
    assert_eq!(named, [("red", Vec3::X), ("blue", Vec3::Z), ("lost", grey), ("", grey)]);
    assert_eq!(model.surfaces[0][0].materials, MaterialAssignment::PerTriangle(vec![3, 1, 1, 2, 0]));
    let notes = model.report.notes.join("\n");
    for words in ["no.mtl", "1 textures", "the first is 'lost'"] {
        assert!(notes.contains(words), "{notes}");
    }
}

#[test]
fn lines_go_on_and_end_in_any_way() {
    let plain = obj(&format!("{CORNERS}f 1 2 3 4\n"));
    let crlf = format!("{CORNERS}f 1 2 3 4").replace('\n', "\r\n");
    let old = format!("{CORNERS}f 1 2 3 4").replace('\n', "\r");
    let marked = format!("\u{feff}{CORNERS}f 1 2 3 4");
    let continued = "v 0 0 \\\n0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n  f 1 \\\r\n 2 3\\\n 4 # end\n".to_owned();
    for text in [crlf, old, marked, continued] {
        assert_eq!(corners(&obj(&text)), corners(&plain), "{text:?}");
    }
    for (mark, bytes_of) in [(0xfeffu16, u16::to_le_bytes as fn(u16) -> [u8; 2]), (0xfeff, u16::to_be_bytes)]
    {
        let units =
            std::iter::once(mark).chain("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4".encode_utf16());
        let model = load_bytes(Path::new("x.obj"), units.flat_map(bytes_of).collect()).unwrap();
        assert_eq!(corners(&model), corners(&plain));
    }
}

#[test]
fn numbers_that_cannot_be_read_void_only_what_uses_them() {
    let model = obj(&format!(
        "{CORNERS}v 1 x 2\nv 1 2\nf 1 2 3\nf 1 2 5\nf 6 2 3\nf 1 2.5 3\nf 1 2 3/a\nvt q\nvn 1 2\n"
    ));
    assert_eq!((triangles(&model), model.report.vertices), (1, 6));
    let rows: Vec<_> = model.report.skipped.iter().map(|row| (row.count, row.first.as_str())).collect();
    assert_eq!(rows, [(2, "line 5"), (2, "line 10"), (1, "line 12"), (1, "line 13"), (2, "line 8")]);
}

#[test]
fn vertices_that_are_not_finite_are_left_to_the_builder() {
    let model = obj(&format!("{CORNERS}v nan 0 0\nv 1e39 0 0\nf 1 2 3\nf 1 2 5\nf 1 2 6\n"));
    assert_eq!((triangles(&model), model.report.skipped_count()), (3, 0));
    let report = model.scene.flatten().unwrap().report;
    assert_eq!((report.not_finite, report.skipped()), (2, 2));
}

#[test]
fn indices_that_lead_nowhere_skip_their_face() {
    for index in ["0", "5", "-5", "4294967296", "99999999999999999999999", "-99999999999999999999"] {
        let model = obj(&format!("{CORNERS}f 1 2 {index}\nf 1 2 3\n"));
        assert_eq!((triangles(&model), skipped(&model, "vertex that is not there")), (1, 1), "{index}");
        assert_eq!(model.report.skipped[0].first, "line 5");
    }
    let later = obj(&format!("f 1 2 3\n{CORNERS}"));
    assert_eq!(triangles(&later), 1, "a face may come before its vertices");
}

#[test]
fn polygons_are_cut() {
    let dart = obj("v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\nf 1 2 3 4\n");
    let fan_about_reflex = obj("v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\nf 4 1 2\nf 4 2 3\n");
    let area =
        |model: &Model| -> f32 { corners(model).iter().map(|[a, b, c]| (b - a).cross(c - a).length()).sum() };
    assert_eq!((triangles(&dart), area(&dart)), (2, area(&fan_about_reflex)));
    let bow_tie = obj("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n");
    assert_eq!(triangles(&bow_tie), 2);
    assert!(bow_tie.report.notes[0].contains("line 5"), "{:?}", bow_tie.report.notes);
}

#[test]
fn far_scenes_get_an_origin() {
    let far = "v 5000000.125 0 -7\nv 5000001.125 0 -7\nv 5000000.125 1.5 -7\nf 1 2 3\n";
    let model = obj(far);
    assert_eq!(model.scene.origin, DVec3::new(5_000_001.0, 1.0, -7.0));
    assert_eq!(corners(&model)[0][0], Vec3::new(-0.875, -1.0, 0.0));
    let unused = obj(&format!("v 0 0 0\n{}", far.replace("f 1 2 3", "f 2 3 4")));
    assert_eq!(unused.scene, model.scene, "what no face uses has no say");
}

#[test]
fn other_statements_do_no_harm() {
    let model = obj(&format!(
        "# comment \\\nmg 1 2\n{CORNERS}s off\nl 1 2\np 1\nt crease 1\nvp 1 2\ncstype bezier\ncurv 0 1 1 2\nend\nf 1 2 3\nbanana\n"
    ));
    assert_eq!(triangles(&model), 1);
    let counts =
        ["line elements", "point elements", "free-form", "unknown word"].map(|what| skipped(&model, what));
    assert_eq!((counts, model.report.skipped_count()), ([1, 1, 1, 1], 4));
}

#[test]
fn a_file_of_another_kind_is_refused() {
    let error = load_text("x.obj", "Dear reader,\nthis is a letter.\n").unwrap_err().to_string();
    assert_eq!(error, "x.obj: line 1: 'Dear' begins no statement of OBJ, and no other line does");
    assert_eq!(triangles(&load_text("x.obj", "# nothing\n").unwrap()), 0);
}

#[test]
fn the_format_is_told_by_the_content() {
    let text = format!("# made by hand\n{CORNERS}f 1 2 3\n");
    assert_eq!(triangles(&load_text("x", &text).unwrap()), 1);
    assert_eq!(triangles(&load_text("x.txt", &text).unwrap()), 1);
}

#[test]
fn what_is_no_file_is_an_error_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().join("missing.obj"), folder.path().to_owned(), "/dev/zero".into()] {
        let error = load(&path).unwrap_err().to_string();
        assert!(error.contains(&*path.to_string_lossy()) && !error.contains('\n'), "{error}");
    }
}
