//! Pictures of materials: where they come from, how they are looked up, and what a mistake in them costs.

use crate::check;
use crate::common::{load_text, scene};
use crate::make::{data, glb, triangle};
use image::{DynamicImage, ImageFormat, Rgba, RgbaImage};
use ropewalk::glam::{Vec2, Vec3};
use ropewalk_scene::load::{load, load_bytes};
use ropewalk_scene::{Filter, Material, Model, TextureUse, Wrap};
use std::fs;
use std::io::Cursor;
use std::path::Path;

/// Two texels: one opaque, one see-through.
fn png() -> Vec<u8> {
    let picture = RgbaImage::from_fn(2, 1, |x, _| Rgba([10 * x as u8, 20, 30, 255 - 255 * x as u8]));
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::ImageRgba8(picture).write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A document with these fields before the rest.
fn with(fields: &str) -> String {
    triangle(r#"{"mesh":0}"#).replacen('{', &format!("{{{fields},"), 1)
}

fn load_with(fields: &str) -> Model {
    let model = load_text("x.gltf", &with(fields)).unwrap_or_else(|error| panic!("{error}"));
    check(&model, fields);
    model
}

/// A document with one picture as the base colour of a material, to which something is added.
fn material(image: &str, sampler: &str, more: &str) -> (Material, Model) {
    let model = load_with(&format!(
        r#""images":[{image}],"samplers":[{sampler}],"textures":[{{"source":0,"sampler":0}}],
           "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}{more}}}]"#
    ));
    (model.materials[0].clone(), model)
}

fn uri(bytes: &[u8]) -> String {
    format!(r#"{{"name":"leaf","uri":"{}"}}"#, data(bytes))
}

#[test]
fn pictures_are_read_for_what_they_are_used_as() {
    let image = uri(&png());
    let info = r#"{"index":0}"#;
    let model = load_with(&format!(
        r#""images":[{image}],"textures":[{{"source":0}}],"materials":[
           {{"emissiveTexture":{info},"pbrMetallicRoughness":{{"baseColorTexture":{info},"metallicRoughnessTexture":{info}}}}},
           {{"pbrMetallicRoughness":{{"baseColorTexture":{info}}}}},{{}}]"#
    ));
    let [colors, data] = model.textures.as_slice() else { panic!("{}", model.textures.len()) };
    assert_eq!((colors.name.as_str(), colors.width, colors.height, colors.is_srgb), ("leaf", 2, 1, true));
    assert_eq!(colors.texels, [[0, 20, 30, 255], [10, 20, 30, 0]]);
    assert_eq!((&data.texels, data.is_srgb), (&colors.texels, false));
    let [all, one, none, ..] = model.materials.as_slice() else { panic!() };
    assert_eq!(all.base_color_texture, Some(TextureUse::plain(0)));
    assert_eq!(
        (all.emissive_texture, all.metallic_roughness_texture),
        (all.base_color_texture, Some(TextureUse::plain(1)))
    );
    assert_eq!(one.base_color_texture, all.base_color_texture);
    assert_eq!((none.base_color_texture, none.emissive_texture), (None, None));
    assert_eq!((all.opacity, all.alpha_cutoff), (1.0, 0.0), "OPAQUE");
}

#[test]
fn pictures_come_from_views_and_files() {
    let png = png();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{0}}}],
           "bufferViews":[{{"buffer":0,"byteOffset":4,"byteLength":{1}}}],
           "images":[{{"bufferView":0,"mimeType":"image/png"}},{{"uri":"a%20b.png"}},{{"uri":"no.png"}}],
           "textures":[{{"source":0}},{{"source":1}},{{"source":2}}],
           "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}},
           {{"emissiveTexture":{{"index":1}}}},{{"emissiveTexture":{{"index":2}}}}]}}"#,
        png.len() + 4,
        png.len()
    );
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a b.png"), &png).unwrap();
    let bytes = glb(&json, &[&[0; 4], png.as_slice()].concat());
    let model = load_bytes(&folder.path().join("x.glb"), bytes).unwrap();
    let names: Vec<_> = model.textures.iter().map(|texture| (texture.name.as_str(), texture.width)).collect();
    assert_eq!(names, [("images[0]", 2), ("a%20b.png", 2)]);
    assert_eq!(model.materials[2].emissive_texture, None);
    let notes = model.report.notes.join("\n");
    assert!(notes.contains("1 textures: not read") && notes.contains("no.png"), "{notes}");
}

#[test]
fn samplers_and_transforms() {
    for (sampler, wrap, filter) in [
        ("{}", [Wrap::Repeat; 2], Filter::Linear),
        (r#"{"magFilter":9728,"wrapS":33071,"wrapT":33648}"#, [Wrap::Clamp, Wrap::Mirror], Filter::Nearest),
        (r#"{"magFilter":9729,"minFilter":9728,"wrapS":10497,"wrapT":7}"#, [Wrap::Repeat; 2], Filter::Linear),
        (r#"{"magFilter":"x"}"#, [Wrap::Repeat; 2], Filter::Linear),
    ] {
        let texture = material(&uri(&png()), sampler, "").0.base_color_texture.unwrap();
        assert_eq!((texture.wrap, texture.filter), (wrap, filter), "{sampler}");
    }
    let transformed = |transform: &str| {
        let model = load_with(&format!(
            r#""images":[{}],"textures":[{{"source":0}}],"materials":[{{"emissiveTexture":{{"index":0,
               "extensions":{{"KHR_texture_transform":{transform}}}}}}}]"#,
            uri(&png())
        ));
        (model.materials[0].emissive_texture, model.report.notes.join("; "))
    };
    let (texture, notes) = transformed(r#"{"offset":[0.25,0.5],"scale":[2,-3]}"#);
    let texture = texture.unwrap();
    assert_eq!((texture.scale, texture.offset), (Vec2::new(2.0, -3.0), Vec2::new(0.25, 0.5)));
    assert!(!notes.contains("textures"), "{notes}");
    let (texture, notes) = transformed(r#"{"rotation":1}"#);
    assert!(texture.is_some() && notes.contains("without the rotation"), "{notes}");
    let (texture, notes) = transformed(r#"{"texCoord":1}"#);
    assert!(texture.is_none() && notes.contains("other texture coordinates"), "{notes}");
}

#[test]
fn alpha_makes_holes_or_lets_light_through() {
    let factor = r#","alphaMode":"MASK","alphaCutoff":0.25"#;
    let (mask, _) = material(&uri(&png()), "{}", factor);
    assert_eq!((mask.opacity, mask.alpha_cutoff, mask.transmission), (1.0, 0.25, 0.0));
    let (mask, _) = material(&uri(&png()), "{}", r#","alphaMode":"MASK""#);
    assert_eq!(mask.alpha_cutoff, 0.5);
    let (blend, model) = material(&uri(&png()), "{}", r#","alphaMode":"BLEND""#);
    assert_eq!((blend.alpha_cutoff, blend.transmission, blend.ior), (0.5, 0.0, 1.5));
    assert!(model.report.notes.iter().any(|note| note.starts_with("1 materials: blended")));
    let plain = |mode: &str| {
        let factor = r#""pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25]}"#;
        load_with(&format!(r#""materials":[{{"alphaMode":"{mode}",{factor}}}]"#)).materials[0].clone()
    };
    let (blend, mask, opaque) = (plain("BLEND"), plain("MASK"), plain("OPAQUE"));
    assert_eq!((blend.transmission, blend.ior, blend.alpha_cutoff, blend.opacity), (0.75, 1.0, 0.0, 1.0));
    assert_eq!((mask.opacity, mask.alpha_cutoff, mask.transmission), (0.25, 0.5, 0.0));
    assert_eq!((opaque.opacity, opaque.alpha_cutoff, opaque.transmission), (1.0, 0.0, 0.0));
}

#[test]
fn specular_colours() {
    let specular = |fields: &str| {
        let model = load_with(&format!(
            r#""materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0}},"extensions":{{{fields}}}}}]"#
        ));
        model.materials[0].specular
    };
    assert_eq!(specular(r#""KHR_materials_ior":{"ior":3}"#), None);
    let found = specular(
        r#""KHR_materials_ior":{"ior":3},"KHR_materials_specular":{"specularFactor":0.5,"specularColorFactor":[1,2,8]}"#,
    );
    assert_eq!(found, Some(Vec3::new(0.125, 0.25, 0.5)));
    assert_eq!(specular(r#""KHR_materials_specular":7"#), None, "a mistake costs the extension alone");
}

#[test]
fn a_mistake_in_a_picture_costs_the_picture() {
    let png = png();
    let cut = uri(&png[..png.len() / 2]);
    for (image, words) in [
        (cut.as_str(), "leaf: "),
        (r#"{"uri":"data:;base64,???"}"#, "base64"),
        (r#"{"uri":"data:,GIF89a"}"#, "neither PNG"),
        (r#"{"uri":"https://x/y.png"}"#, "https"),
        (r#"{"bufferView":9}"#, "9"),
        (r#"{"bufferView":0}"#, "neither PNG"),
        (r#"{"uri":7}"#, "neither uri nor bufferView"),
        ("{}", "neither uri nor bufferView"),
        ("", "no such image"),
    ] {
        let (material, model) = material(image, "", "");
        assert_eq!(material.base_color_texture, None, "{image}");
        let notes = model.report.notes.join("\n");
        assert!(notes.contains("1 textures: not read") && notes.contains(words), "{image}: {notes}");
    }
    for fields in [
        r#""textures":[{"source":-1}],"materials":[{"emissiveTexture":{"index":0}}]"#,
        r#""textures":7,"images":"x","samplers":{},"materials":[{"emissiveTexture":{"index":0}}]"#,
        r#""textures":[{"extensions":{"KHR_texture_basisu":{"source":0}}}],"materials":[{"emissiveTexture":{"index":0}}]"#,
    ] {
        let model = load_with(fields);
        assert!(model.report.notes.iter().any(|note| note.starts_with("1 textures: not read")), "{fields}");
    }
    for fields in [
        r#""materials":[{"emissiveTexture":{"index":"x"}}]"#,
        r#""materials":[{"emissiveTexture":[]}]"#,
        r#""materials":[{"alphaMode":"MASK","alphaCutoff":"x"}]"#,
    ] {
        assert_eq!(load_with(fields).materials[0].emissive_texture, None);
    }
}

#[test]
fn the_collection_has_its_pictures() {
    for (file, sizes) in [
        ("duck/Duck.glb", &[(512, 512)][..]),
        ("milktruck/CesiumMilkTruck.glb", &[(2048, 2048)]),
        ("fox/Fox.glb", &[(1024, 1024)]),
    ] {
        let Some(path) = scene(file) else { return };
        let model = load(Path::new(&path)).unwrap();
        let found: Vec<_> = model.textures.iter().map(|texture| (texture.width, texture.height)).collect();
        assert_eq!(found, sizes, "{file}");
        assert!(model.materials.iter().any(|material| material.base_color_texture.is_some()), "{file}");
        assert!(!model.report.notes.join(";").contains("textures"), "{:?}", model.report.notes);
        // A picture of one colour would be a picture that was not decoded.
        assert!(
            model
                .textures
                .iter()
                .all(|texture| texture.texels.iter().any(|&texel| texel != texture.texels[0]))
        );
    }
}
