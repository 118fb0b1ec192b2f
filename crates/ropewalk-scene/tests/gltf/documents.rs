//! Documents made here: what a correct file means.

use crate::check;
use crate::common::{load_text, skipped, triangles};
use crate::make::{document, floats, glb, positions, shorts, triangle};
use ropewalk::glam::{DVec3, Vec2, Vec3};
use ropewalk_scene::{Light, MaterialAssignment, Model};
use std::path::Path;

fn load(text: &str) -> Model {
    let model = load_text("x.gltf", text).unwrap_or_else(|error| panic!("{error}"));
    check(&model, text);
    model
}

/// Five vertices in a zigzag.
const ZIGZAG: [f32; 15] = [0., 0., 0., 0., 1., 0., 1., 0., 0., 1., 1., 0., 2., 0., 0.];

fn with_mode(mode: u32) -> Model {
    let primitive = format!(r#""attributes":{{"POSITION":0}},"mode":{mode}"#);
    load(&document(&floats(&ZIGZAG), "", &positions(5), &primitive, r#"{"mesh":0}"#))
}

#[test]
fn modes() {
    let triangles_of = |mode| with_mode(mode).scene.objects[0].geometries[0].triangles.clone();
    assert_eq!(triangles_of(4), [[0, 1, 2]]);
    assert_eq!(triangles_of(5), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
    assert_eq!(triangles_of(6), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
    assert_eq!(skipped(&with_mode(4), "fewer than three corners"), 1);
    for (mode, what) in [(0, "points"), (1, "lines"), (2, "lines"), (3, "lines"), (7, "unknown mode")] {
        let model = with_mode(mode);
        assert_eq!((triangles(&model), skipped(&model, what)), (0, 1), "{mode}");
    }
    // All triangles of a strip face the same way.
    let strip = with_mode(5);
    let mesh = &strip.scene.objects[0].geometries[0];
    assert!((0..3).all(|triangle| mesh.triangle(triangle).unwrap().normal().z < 0.0));
}

#[test]
fn indices_of_every_width() {
    let bytes =
        [shorts(&[3, 2, 1]), 4_u32.to_le_bytes().repeat(3), vec![1, 2, 4, 0], floats(&ZIGZAG)].concat();
    for (kind, offset, expected) in [(5123, 0, [3, 2, 1]), (5121, 18, [1, 2, 4]), (5125, 6, [4, 4, 4])] {
        let accessors = format!(
            r#"{{"bufferView":0,"byteOffset":22,"componentType":5126,"type":"VEC3","count":5}},
               {{"bufferView":0,"byteOffset":{offset},"componentType":{kind},"type":"SCALAR","count":3}}"#
        );
        let model = load(&document(
            &bytes,
            "",
            &accessors,
            r#""attributes":{"POSITION":0},"indices":1"#,
            r#"{"mesh":0}"#,
        ));
        let mesh = &model.scene.objects[0].geometries[0];
        let corner = |index: usize| Vec3::from_slice(&ZIGZAG[3 * index..]);
        assert_eq!(mesh.triangle(0).unwrap().vertices, expected.map(corner), "{kind}");
    }
}

#[test]
fn strides_leave_out_what_lies_between() {
    let vertex = |x: f32, y: f32| [vec![0xff; 4], floats(&[x, y, 0.0]), floats(&[x / 2.0, y / 4.0])].concat();
    let bytes = [vertex(0.0, 0.0), vertex(1.0, 0.0), vertex(0.0, 2.0)].concat();
    let accessors = r#"{"bufferView":0,"byteOffset":4,"componentType":5126,"type":"VEC3","count":3},
        {"bufferView":0,"byteOffset":16,"componentType":5126,"type":"VEC2","count":3}"#;
    let primitive = r#""attributes":{"POSITION":0,"TEXCOORD_0":1}"#;
    let model = load(&document(&bytes, r#""byteStride":24"#, accessors, primitive, r#"{"mesh":0}"#));
    assert_eq!(model.scene.objects[0].geometries[0].positions, [Vec3::ZERO, Vec3::X, Vec3::Y * 2.0]);
    let coordinates = model.surfaces[0][0].texture_coordinates.as_ref().unwrap();
    assert_eq!(coordinates.values, [Vec2::ZERO, Vec2::new(0.5, 0.0), Vec2::new(0.0, 0.5)]);
}

#[test]
fn sparse_values_replace_zeros_or_what_is_there() {
    let bytes = [vec![2, 0], floats(&[0.0, 7.0, 0.0, 5.0, 0.0, 0.0])].concat();
    let sparse = r#""sparse":{"count":2,"indices":{"bufferView":0,"componentType":5121},
        "values":{"bufferView":0,"byteOffset":2}}"#;
    let primitive = r#""attributes":{"POSITION":0}"#;
    let zeros = format!(r#"{{"componentType":5126,"type":"VEC3","count":3,{sparse}}}"#);
    let model = load(&document(&bytes, "", &zeros, primitive, r#"{"mesh":0}"#));
    let expected = [Vec3::X * 5.0, Vec3::ZERO, Vec3::Y * 7.0];
    assert_eq!(model.scene.objects[0].geometries[0].positions, expected);

    let bytes = [bytes, floats(&[1.0; 9])].concat();
    let filled = format!(
        r#"{{"bufferView":0,"byteOffset":26,"componentType":5126,"type":"VEC3","count":3,{sparse}}}"#
    );
    let model = load(&document(&bytes, "", &filled, primitive, r#"{"mesh":0}"#));
    let expected = [Vec3::X * 5.0, Vec3::ONE, Vec3::Y * 7.0];
    assert_eq!(model.scene.objects[0].geometries[0].positions, expected);
}

#[test]
fn quantized_positions_and_normals() {
    let bytes: Vec<u8> = [0, 0, 0, 0, 127, 0, 0, 0, 0, 129, 0, 0].to_vec();
    let accessors = r#"{"bufferView":0,"componentType":5120,"type":"VEC3","count":3,"normalized":true},
        {"bufferView":0,"componentType":5121,"type":"VEC3","count":3}"#;
    let primitive = r#""attributes":{"POSITION":0,"NORMAL":1}"#;
    let text = document(&bytes, r#""byteStride":4"#, accessors, primitive, r#"{"mesh":0}"#);
    let text = text.replacen('{', r#"{"extensionsRequired":["KHR_mesh_quantization"],"#, 1);
    let model = load(&text);
    assert_eq!(model.scene.objects[0].geometries[0].positions, [Vec3::ZERO, Vec3::X, Vec3::NEG_Y]);
    let normals = &model.surfaces[0][0].normals.as_ref().unwrap().values;
    assert_eq!(*normals, [Vec3::ZERO, Vec3::X * 127.0, Vec3::Y * 129.0]);
}

#[test]
fn nodes_compose_and_mirror() {
    let nodes = r#"{"children":[1],"translation":[10,0,0],"rotation":[0,0,0.70710678118654752,0.70710678118654752],
        "scale":[2,2,2]}, {"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,3,1]}, {"mesh":0,"name":"plain"}"#;
    let model = load(&triangle(nodes));
    assert_eq!((model.scene.objects.len(), model.scene.instances.len()), (1, 2));
    let transform = model.scene.instances[0].transform;
    assert!(transform.mirrors() && !model.scene.instances[1].transform.mirrors());
    // x is mirrored, then turned to -y, scaled and moved; z is moved within the parent's scale.
    assert!((transform.point(Vec3::X) - Vec3::new(10.0, -2.0, 6.0)).length() < 1e-5);
    assert!((transform.point(Vec3::Y) - Vec3::new(8.0, 0.0, 6.0)).length() < 1e-5);
}

#[test]
fn a_rotation_need_not_be_of_unit_length() {
    let model = load(&triangle(r#"{"mesh":0,"rotation":[0,0,3,3]}"#));
    assert!((model.scene.instances[0].transform.point(Vec3::X) - Vec3::Y).length() < 1e-6);
}

#[test]
fn instances_that_cannot_be_placed_are_counted_by_name() {
    let model = load(&triangle(
        r#"{"mesh":0}, {"mesh":0,"name":"flat","scale":[1,0,1]}, {"mesh":0,"name":"turned","rotation":[0,0,0,0]},
           {"mesh":0,"translation":[1e300,0,0]}"#,
    ));
    assert_eq!((triangles(&model), skipped(&model, "singular"), skipped(&model, "not finite")), (1, 1, 2));
    let places: Vec<&str> = model.report.skipped.iter().map(|row| row.first.as_str()).collect();
    assert_eq!(places, ["nodes[1] 'flat'", "nodes[2] 'turned'"]);
    assert_eq!(model.scene.origin, DVec3::ZERO);
}

#[test]
fn cycles_and_second_parents_end() {
    let model = load(&triangle(r#"{"mesh":0,"children":[1]}, {"children":[2]}, {"children":[1]}"#));
    assert_eq!((triangles(&model), skipped(&model, "met again")), (1, 1));
    let model = load(&triangle(r#"{"children":[2,2]}, {"children":[2]}, {"mesh":0}"#));
    assert_eq!((triangles(&model), skipped(&model, "met again")), (1, 2));
    let model = load(&triangle(r#"{"mesh":0,"children":[0]}"#));
    assert_eq!(triangles(&model), 0, "no node is a root");
}

#[test]
fn a_chain_of_ten_thousand_nodes_is_walked() {
    let chain: Vec<String> =
        (1..10_000).map(|child| format!(r#"{{"translation":[1,0,0],"children":[{child}]}}"#)).collect();
    let model = load(&triangle(&format!(r#"{},{{"mesh":0}}"#, chain.join(","))));
    let place = model.scene.origin + model.scene.instances[0].transform.point(Vec3::ZERO).as_dvec3();
    assert_eq!(place, DVec3::X * 9_999.0);
}

#[test]
fn the_default_scene_is_shown() {
    let nodes = r#"{"mesh":0}, {"mesh":0,"translation":[5,0,0]}, {"translation":[0,0,1],"mesh":0}"#;
    for (scenes, expected, note) in [
        (
            r#""scene":1,"scenes":[{"nodes":[0]},{"nodes":[2,1]}],"#,
            &[Vec3::Z, Vec3::X * 5.0][..],
            "scene 1 is shown",
        ),
        (r#""scenes":[{"nodes":[1]},{"nodes":[2,0]}],"#, &[Vec3::X * 5.0], "scene 0 is shown"),
        (r#""scene":9,"scenes":[{"nodes":[1]}],"#, &[Vec3::X * 5.0], "names scene 9"),
        ("", &[Vec3::ZERO, Vec3::X * 5.0, Vec3::Z], "no scene"),
    ] {
        let model = load(&triangle(nodes).replacen('{', &format!("{{{scenes}"), 1));
        let places: Vec<Vec3> =
            model.scene.instances.iter().map(|instance| instance.transform.point(Vec3::ZERO)).collect();
        assert_eq!(places, expected, "{scenes}");
        assert!(model.report.notes.iter().any(|found| found.contains(note)), "{:?}", model.report.notes);
    }
}

#[test]
fn far_scenes_keep_their_accuracy() {
    let model = load(&triangle(
        r#"{"mesh":0,"translation":[1e7,0,0.25]}, {"mesh":0,"translation":[10000002.125,0,0]}"#,
    ));
    assert_eq!(model.scene.origin.z, 0.0);
    let place = |index: usize| {
        model.scene.origin + model.scene.instances[index].transform.point(Vec3::ZERO).as_dvec3()
    };
    // In f32 there is no number between 10,000,002 and 10,000,003.
    assert_eq!((place(0), place(1)), (DVec3::new(1e7, 0.0, 0.25), DVec3::new(10_000_002.125, 0.0, 0.0)));
}

#[test]
fn materials_and_their_default() {
    let text = triangle(r#"{"mesh":0}"#).replacen(
        '{',
        r#"{"materials":[{"name":"glow","emissiveFactor":[0.5,0,1],"alphaMode":"BLEND","pbrMetallicRoughness":
            {"baseColorFactor":[0.25,0.5,2,1],"metallicFactor":0.125,"roughnessFactor":-3,"baseColorTexture":{"index":-1}},
            "extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":4},"KHR_materials_ior":{"ior":1.25},
            "KHR_materials_transmission":{"transmissionFactor":0.75},"KHR_materials_sheen":{}}},
            {}],"extensionsUsed":["KHR_materials_sheen","KHR_materials_ior"],"#,
        1,
    );
    let model = load(&text);
    let glow = &model.materials[0];
    assert_eq!((glow.name.as_str(), glow.base_color), ("glow", Vec3::new(0.25, 0.5, 1.0)));
    assert_eq!(glow.emissive, Vec3::new(2.0, 0.0, 4.0));
    assert_eq!((glow.metallic, glow.roughness, glow.transmission, glow.ior), (0.125, 0.0, 0.75, 1.25));
    let plain = &model.materials[1];
    assert_eq!((plain.base_color, plain.metallic, plain.roughness, plain.ior), (Vec3::ONE, 1.0, 1.0, 1.5));
    assert_eq!(model.materials[2].name, "default");
    assert_eq!(model.surfaces[0][0].materials, MaterialAssignment::One(2));
    let notes = model.report.notes.join("\n");
    assert!(
        notes.contains("not read: KHR_materials_sheen\n") && notes.contains("blended by alpha"),
        "{notes}"
    );
}

#[test]
fn cameras_and_lights_stand_in_the_scene() {
    let turned = r#""rotation":[0,0.70710678118654752,0,0.70710678118654752]"#;
    let nodes = format!(
        r#"{{"mesh":0}}, {{"name":"eye","camera":0,"translation":[1,2,3],{turned}}}, {{"camera":1}}, {{"camera":2}},
        {{"translation":[0,5,0],"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}},
        {{{turned},"extensions":{{"KHR_lights_punctual":{{"light":1}}}}}},
        {{"scale":[0,0,0],"extensions":{{"KHR_lights_punctual":{{"light":1}}}}}},
        {{"extensions":{{"KHR_lights_punctual":{{"light":2}}}}}}"#
    );
    let text = triangle(&nodes).replacen(
        '{',
        r#"{"cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}},
            {"type":"orthographic","orthographic":{}},{"type":"perspective","perspective":{"yfov":4}}],
            "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":8,"color":[1,0.5,0]},
            {"type":"directional"},{"type":"spot","spot":{}}]}},"#,
        1,
    );
    let model = load(&text);
    let [camera] = &model.cameras[..] else { panic!("{:?}", model.cameras) };
    assert_eq!((camera.name.as_str(), camera.position), ("eye", Vec3::new(1.0, 2.0, 3.0)));
    assert!(
        (camera.forward - Vec3::NEG_X).length() < 1e-6 && camera.up == Vec3::Y && camera.vertical_fov == 0.5
    );
    assert_eq!((skipped(&model, "without perspective"), skipped(&model, "field of view")), (1, 1));
    assert_eq!(skipped(&model, "lights"), 1, "a light without direction");
    let [point, sun, spot] = &model.lights[..] else { panic!("{:?}", model.lights) };
    assert_eq!(*point, Light::Point { position: Vec3::Y * 5.0, color: Vec3::new(8.0, 4.0, 0.0) });
    assert!(
        matches!(sun, Light::Sun { direction, color: Vec3::ONE } if (direction - Vec3::NEG_X).length() < 1e-6)
    );
    assert!(matches!(spot, Light::Point { .. }));
}

#[test]
fn meshes_without_nodes_are_shown_once() {
    let model = load(&triangle(""));
    assert_eq!((triangles(&model), model.scene.instances.len()), (1, 1));
    assert!(model.report.notes.iter().any(|note| note.contains("no nodes")));
}

#[test]
fn unused_meshes_are_left_out() {
    let text = triangle(r#"{"mesh":1,"name":"node"}"#).replacen(
        r#""meshes":["#,
        r#""meshes":[{"primitives":[{"attributes":{"POSITION":0}}]},"#,
        1,
    );
    let model = load(&text);
    assert_eq!((model.scene.objects.len(), model.report.vertices), (1, 3));
    assert_eq!(model.object_names, ["node"]);
    assert!(model.report.notes.contains(&"1 meshes: not part of the scene, left out".to_owned()));
}

#[test]
fn a_glb_a_byte_order_mark_and_a_packed_sibling() {
    let corners = floats(&ZIGZAG[..9]);
    let text = document(&[], "", &positions(3), r#""attributes":{"POSITION":0}"#, r#"{"mesh":0}"#);
    let text = text.replace(r#""byteLength":0"#, r#""byteLength":36"#);
    let bytes = glb(&text.replace(r#""uri":"data:,","#, ""), &corners);
    let model = ropewalk_scene::load::load_bytes(Path::new("x"), bytes).unwrap();
    assert_eq!((triangles(&model), model.report.format.as_str()), (1, "GLB"));
    assert_eq!(triangles(&load(&format!("\u{feff}{}", triangle(r#"{"mesh":0}"#)))), 1);

    let folder = tempfile::tempdir().unwrap();
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut encoder, &corners).unwrap();
    std::fs::write(folder.path().join("ä b.bin.gz"), encoder.finish().unwrap()).unwrap();
    std::fs::write(folder.path().join("a%20b.bin"), &corners).unwrap();
    for name in ["%C3%A4%20b.bin", "ä b.bin", "a%20b.bin"] {
        let path = folder.path().join("x.gltf");
        std::fs::write(&path, text.replace("data:,", name)).unwrap();
        assert_eq!(triangles(&ropewalk_scene::load::load(&path).unwrap()), 1, "{name}");
    }
}

#[test]
fn a_geometry_keeps_the_vertices_that_it_uses() {
    let mut corners = vec![9.0; 3 * 1000];
    corners[3 * 500..3 * 500 + 9].copy_from_slice(&ZIGZAG[..9]);
    let bytes = [shorts(&[502, 500, 501, 0]), floats(&corners)].concat();
    let accessors = r#"{"bufferView":0,"componentType":5123,"type":"SCALAR","count":3},
        {"bufferView":0,"byteOffset":8,"componentType":5126,"type":"VEC3","count":1000}"#;
    let primitive = r#""indices":0,"attributes":{"POSITION":1,"NORMAL":1}"#;
    let model = load(&document(&bytes, "", accessors, primitive, r#"{"mesh":0}"#));
    let mesh = &model.scene.objects[0].geometries[0];
    assert_eq!(
        (mesh.positions.as_slice(), mesh.triangles.as_slice()),
        (&[Vec3::ZERO, Vec3::Y, Vec3::X][..], &[[2, 0, 1]][..])
    );
    assert_eq!(model.surfaces[0][0].normals.as_ref().unwrap().values, mesh.positions);
    assert_eq!(model.report.vertices, 1000);
}
