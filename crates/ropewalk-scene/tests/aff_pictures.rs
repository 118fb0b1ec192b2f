//! Pictures, backgrounds and ambient light of AFF: from a folder, from an archive, missing, broken, and those of the
//! benchmark.

mod common;

use common::{check, load_text, scene};
use ropewalk::glam::{Vec2, Vec3};
use ropewalk_scene::load::load;
use ropewalk_scene::{Filter, Model, Wrap};
use std::fs;
use std::io::Write;
use std::path::Path;

/// Triangles with two pictures, one of them under two materials, and one without a picture.
const SCENE: &str = "fm .1 .2 .3  .5 .5 .5  .25 2 0  30 0 0\n\
    tt a.ppm 0 0 0 0 1   1 0 0 1 1   0 1 0 0 0\n\
    p 3 0 0 0 1 0 0 0 1 0\n\
    tt b.ppm 0 0 0 0 1   1 0 0 1 1   0 1 0 0 0\n\
    fm 0 0 0  1 1 1  0 0 0  30 .5 1.5\n\
    tt a.ppm 0 0 0 0 1   1 0 0 1 1   0 1 0 0 0\n";

const A: &[u8] = b"P6 # caf\xe9\n2 1 255\nabcdefX";
const B: &[u8] = b"P6\n1 1\n255\nxyz";

fn archive(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = tar::Builder::new(Vec::new());
    for (name, bytes) in files {
        let mut header = tar::Header::new_gnu();
        header.set_size(bytes.len() as u64);
        header.set_mode(0o644);
        archive.append_data(&mut header, name, *bytes).unwrap();
    }
    archive.into_inner().unwrap()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// Writes files into a folder and loads the scene from it.
fn load_with(files: &[(&str, &[u8])]) -> Model {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.aff");
    fs::write(&scene, SCENE).unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap_or(Path::new(""))).unwrap();
        fs::write(path, bytes).unwrap();
    }
    let model = load(&scene).unwrap();
    check(&model, SCENE);
    model
}

/// Which picture each of the four materials has, by name.
fn pictures(model: &Model) -> Vec<Option<&str>> {
    let name = |texture: u32| model.textures[texture as usize].name.as_str();
    let materials = model.materials.iter();
    materials.map(|material| material.base_color_texture.map(|texture| name(texture.texture))).collect()
}

const ALL: [Option<&str>; 4] = [Some("a.ppm"), None, Some("b.ppm"), Some("a.ppm")];

#[test]
fn pictures_come_from_a_folder_or_an_archive() {
    let whole = archive(&[("TextureFiles/a.ppm", A), ("TextureFiles/b.ppm", B), ("c.ppm", B)]);
    let packed = gzip(&whole);
    for files in [
        &[("TextureFiles/a.ppm", A), ("TextureFiles/b.ppm", B)][..],
        &[("TextureFiles.tar.gz", &packed)],
        &[("TextureFiles.tar", &whole)],
        // The folder goes first.
        &[("TextureFiles.tar.gz", &packed), ("TextureFiles/b.ppm", B)],
        &[("TextureFiles.tar", &archive(&[("./TextureFiles/a.ppm", A), ("b.ppm", B)]))],
    ] {
        let model = load_with(files);
        assert_eq!(pictures(&model), ALL);
        assert_eq!(model.report.notes, Vec::<String>::new());
        let [a, b] = model.textures.as_slice() else { panic!("{}", model.textures.len()) };
        assert_eq!((a.width, a.height, a.is_srgb), (2, 1, true));
        assert_eq!(a.texels, [*b"abc\xff", *b"def\xff"]);
        assert_eq!((b.width, b.height), (1, 1));
        let texture = model.materials[0].base_color_texture.unwrap();
        assert_eq!((texture.wrap, texture.filter), ([Wrap::Repeat; 2], Filter::Linear));
        assert_eq!((texture.scale, texture.offset), (Vec2::ONE, Vec2::ZERO), "rows begin at v = 0");
    }
}

#[test]
fn missing_and_broken_pictures_leave_plain_surfaces() {
    let whole = archive(&[("TextureFiles/a.ppm", A), ("TextureFiles/b.ppm", B)]);
    let packed = gzip(&whole);
    type Files<'a> = &'a [(&'a str, &'a [u8])];
    let cases: [(Files<'_>, &str); 6] = [
        (&[], "2 textures: not read, surfaces keep their plain colours; a.ppm: "),
        (&[("TextureFiles/a.ppm", A)], "1 textures: not read, surfaces keep their plain colours; b.ppm: "),
        (&[("TextureFiles/a.ppm", A), ("TextureFiles/b.ppm", b"P6 9 9 255 x")], "1 are there"),
        (
            &[("TextureFiles.tar", &archive(&[("TextureFiles/A.ppm", A)]))],
            "a.ppm: TextureFiles.tar does not hold",
        ),
        (&[("TextureFiles.tar.gz", &packed[..packed.len() / 2])], "2 textures"),
        // The archive ends in the header of its second file.
        (&[("TextureFiles.tar", &whole[..1100])], "b.ppm: TextureFiles.tar does not hold it"),
    ];
    for (files, words) in cases {
        let model = load_with(files);
        let [note] = model.report.notes.as_slice() else { panic!("{:?}", model.report.notes) };
        assert!(note.contains(words), "{note}");
        assert_eq!(model.materials.len(), 4);
        assert!(pictures(&model).iter().flatten().count() == 2 * model.textures.len());
    }
    // Cut off anywhere, an archive costs pictures but never the scene.
    for length in (0..whole.len()).step_by(97) {
        load_with(&[("TextureFiles.tar", &whole[..length])]);
    }
}

#[test]
fn mirrors_ambient_light_and_backgrounds() {
    let model = load_with(&[]);
    let shiny = &model.materials[0];
    assert_eq!(shiny.ambient, Some(Vec3::new(0.1, 0.2, 0.3)));
    assert_eq!((shiny.specular, shiny.mirrors_sharply), (Some(Vec3::new(0.25, 1.0, 0.0)), true));
    let glass = &model.materials[3];
    assert_eq!((glass.specular, glass.mirrors_sharply), (None, false));
    assert_eq!((glass.transmission, glass.ior, glass.roughness), (0.5, 1.5, 1.0));
    assert_eq!((model.background, model.ambient), (Some(Vec3::ZERO), Some(Vec3::ONE)));
    let model = load_text("x.aff", "b .1 .2 .3 am 2.5 2.5 2 p 3 0 0 0 1 0 0 0 1 0").unwrap();
    assert_eq!(model.background, Some(Vec3::new(0.1, 0.2, 0.3)));
    assert_eq!(model.ambient, Some(Vec3::new(2.5, 2.5, 2.0)));
    let model = load_text("x.nff", "p 3 0 0 0 1 0 0 0 1 0").unwrap();
    assert_eq!(model.ambient, Some(Vec3::splat(0.1)));
}

/// The pictures that a scene names, and that all of them are found.
fn benchmark(file: &str) -> Option<Model> {
    let model = load(&scene(file)?).unwrap_or_else(|error| panic!("{error}"));
    assert!(model.report.notes.iter().all(|note| !note.contains("textures")), "{:?}", model.report.notes);
    let used = pictures(&model);
    for texture in &model.textures {
        assert!(used.contains(&Some(texture.name.as_str())), "{}", texture.name);
        assert_eq!(texture.texels.len() as u32, texture.width * texture.height, "{}", texture.name);
    }
    // A material with a picture is on surfaces with coordinates.
    for surface in model.surfaces.iter().flatten().filter(|surface| surface.texture_coordinates.is_none()) {
        let count = model.materials.len();
        let materials = (0..count).filter(|&material| match &surface.materials {
            ropewalk_scene::MaterialAssignment::One(one) => *one as usize == material,
            ropewalk_scene::MaterialAssignment::PerTriangle(all) => all.contains(&(material as u32)),
        });
        assert!(materials.into_iter().all(|material| used[material].is_none()));
    }
    Some(model)
}

#[test]
fn the_robot_has_44_pictures() {
    let Some(model) = benchmark("bart_robot/Robot.aff") else { return };
    assert_eq!(model.textures.len(), 44);
    assert_eq!((model.background, model.ambient.is_some()), (Some(Vec3::ZERO), true));
}

#[test]
fn the_kitchen_has_8_pictures() {
    let Some(model) = benchmark("bart_kitchen/kitchen.aff") else { return };
    assert_eq!(model.textures.len(), 8);
    let floor = model.textures.iter().find(|texture| texture.name == "floor.ppm").unwrap();
    assert_eq!((floor.width, floor.height), (1044, 1044));
    assert_eq!(model.ambient, Some(Vec3::splat(2.5)));
    assert!(model.materials.iter().any(|material| material.transmission > 0.0 && material.mirrors_sharply));
}

#[test]
fn the_museum_has_5_pictures() {
    let Some(model) = benchmark("bart_museum/museum5.aff") else { return };
    assert_eq!(model.textures.len(), 5);
    assert_eq!(model.ambient, Some(Vec3::ONE));
}
