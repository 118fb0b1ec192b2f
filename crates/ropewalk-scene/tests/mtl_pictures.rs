//! Pictures of MTL files, and the colours that mirror.

mod common;

use common::check;
use ropewalk::glam::{Vec2, Vec3};
use ropewalk_scene::load::load;
use ropewalk_scene::{Model, TextureUse, Wrap};
use std::fs;

/// A triangle for each material of a library, beside these files.
fn load_with(library: &str, files: &[(&str, &[u8])]) -> Model {
    let folder = tempfile::tempdir().unwrap();
    let names = library.lines().filter_map(|line| line.strip_prefix("newmtl "));
    let faces: String = names.map(|name| format!("usemtl {name}\nf 1/1 2/2 3/3\n")).collect();
    let text = format!("mtllib sub/x.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n{faces}");
    fs::create_dir(folder.path().join("sub")).unwrap();
    fs::write(folder.path().join("x.obj"), text).unwrap();
    fs::write(folder.path().join("sub/x.mtl"), library).unwrap();
    for (name, bytes) in files {
        fs::write(folder.path().join("sub").join(name), bytes).unwrap();
    }
    let model = load(&folder.path().join("x.obj")).unwrap();
    check(&model, library);
    model
}

const RED: &[u8] = b"P6 2 1 255 \xff\0\0\xff\0\0";
const HALF: &[u8] = b"P6 2 1 255 \0\0\0\xff\xff\xff";
const SMALL: &[u8] = b"P6 1 1 255 \xff\xff\xff";

#[test]
fn pictures_lie_beside_the_library() {
    let model = load_with(
        "newmtl a\nKd .5 .5 .5\nmap_Kd red wall.ppm\nnewmtl b\nmap_Kd -s 2 2 -clamp on red wall.ppm\n\
         map_Ke half.ppm\nnewmtl c\nKd 0 0 0\nKe 2 2 2\nmap_Kd red wall.ppm\nmap_Ke half.ppm\nnewmtl d\n",
        &[("red wall.ppm", RED), ("half.ppm", HALF)],
    );
    let [red, half] = model.textures.as_slice() else { panic!("{}", model.textures.len()) };
    assert_eq!((red.name.as_str(), red.texels[0], red.is_srgb), ("red wall.ppm", [255, 0, 0, 255], true));
    assert_eq!(half.name, "half.ppm");
    let [a, b, c, d] = model.materials.as_slice() else { panic!() };
    // The first row of a picture is its upper edge, where v is 1.
    let plain =
        TextureUse { scale: Vec2::new(1.0, -1.0), offset: Vec2::new(0.0, 1.0), ..TextureUse::plain(0) };
    assert_eq!((a.base_color, a.base_color_texture), (Vec3::splat(0.5), Some(plain)));
    let doubled = TextureUse { scale: Vec2::new(2.0, -2.0), wrap: [Wrap::Clamp; 2], ..plain };
    assert_eq!((b.base_color, b.base_color_texture), (Vec3::ONE, Some(doubled)));
    assert_eq!((b.emissive, b.emissive_texture), (Vec3::ONE, Some(TextureUse { texture: 1, ..plain })));
    assert_eq!((c.base_color, c.emissive), (Vec3::ONE, Vec3::splat(2.0)));
    assert_eq!((d.base_color_texture, d.emissive_texture, d.emissive), (None, None, Vec3::ZERO));
    assert_eq!(model.report.notes, Vec::<String>::new());
}

#[test]
fn masks_make_holes() {
    let model = load_with(
        "newmtl a\nmap_Kd red.ppm\nmap_d half.ppm\nnewmtl b\nmap_d half.ppm\nnewmtl c\nmap_Kd red.ppm\nmap_d red.ppm\n\
         newmtl d\nmap_Kd red.ppm\nmap_d small.ppm\nnewmtl e\nmap_Kd red.ppm\nmap_d half.ppm\n",
        &[("red.ppm", RED), ("half.ppm", HALF), ("small.ppm", SMALL)],
    );
    let alphas = |material: usize| {
        let texture = model.materials[material].base_color_texture.unwrap().texture;
        model.textures[texture as usize].texels.clone()
    };
    assert_eq!(alphas(0), [[255, 0, 0, 0], [255, 0, 0, 255]]);
    assert_eq!(alphas(1), [[255, 255, 255, 0], [255; 4]]);
    assert_eq!((alphas(2), alphas(3)), (vec![[255, 0, 0, 255]; 2], vec![[255, 0, 0, 255]; 2]));
    assert_eq!(model.materials[0].base_color_texture, model.materials[4].base_color_texture, "joined once");
    let cutoffs: Vec<_> = model.materials.iter().map(|material| material.alpha_cutoff).collect();
    assert_eq!(cutoffs, [0.5, 0.5, 0.0, 0.0, 0.5]);
    let [note] = model.report.notes.as_slice() else { panic!("{:?}", model.report.notes) };
    assert!(note.contains("1 textures: not read") && note.contains("small.ppm: map_d"), "{note}");
}

#[test]
fn missing_pictures_and_other_maps_are_noted() {
    let model =
        load_with("newmtl a\nKd 0 0 0\nmap_Kd no.png\nmap_Ke x.tga\nmap_Bump b.png\n", &[("x.tga", b"TGA")]);
    let material = &model.materials[0];
    assert_eq!((material.base_color, material.emissive), (Vec3::ZERO, Vec3::ZERO));
    assert_eq!((material.base_color_texture, material.emissive_texture), (None, None));
    let notes = model.report.notes.join("\n");
    for words in ["2 textures: not read", "no.png", "1 maps of materials are not read"] {
        assert!(notes.contains(words), "{notes}");
    }
}

#[test]
fn highlights_mirror_where_the_model_says_so() {
    let model = load_with(
        "newmtl a\nKs .5 .25 2\nNs 30\nillum 3\nnewmtl b\nKs 1 1 1\nillum 2\nnewmtl c\nKs 0 0 0\nillum 7\nnewmtl d\nillum 3\n",
        &[],
    );
    let [a, b, c, d] = model.materials.as_slice() else { panic!() };
    assert_eq!((a.specular, a.mirrors_sharply, a.roughness), (Some(Vec3::new(0.5, 0.25, 1.0)), true, 0.5));
    for plain in [b, c, d] {
        assert_eq!((plain.specular, plain.mirrors_sharply), (None, false), "{}", plain.name);
    }
}
