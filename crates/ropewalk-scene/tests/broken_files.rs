//! Files that are cut off or damaged anywhere: a model that keeps its rules, or an error in one line. Never a panic.

mod common;

use common::{broken_rule, scene};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ropewalk::glam::Vec3;
use ropewalk::{Instance, Transform};
use ropewalk_scene::load::load_bytes;
use ropewalk_scene::{CornerAttribute, LoadError, MaterialAssignment, Model};
use std::io::Write;
use std::path::Path;

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0 1\nv 1 1e0 0 .1 .2 .3\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\no a\ng b c\nusemtl m\n\
                   f 1/1/1 2/2/1 3//1 4\nf -1 -2 -3\nl 1 2\np 1\nf 1 2 \\\n3\ns off\nf 1 3 2 4\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                   property float s\nproperty float t\nelement face 2\nproperty list uchar int vertex_indices\nelement tristrips 1\n\
                   property list int int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n3 2 1 0\n6 0 1 2 -1 3 2\n";
const STL: &str = "solid a b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a b\n\
                   solid c\nfacet normal 0 0 1\nouter loop\nvertex 0 0 5\nvertex 1 0 5\nvertex 1 1 5\nvertex 0 1 5\nendloop\nendfacet\nendsolid\n";

const AFF: &str = "# c\nv from 0 1 8 at 0 1 0 up 0 1 0 angle 40 hither .1 resolution 4 3\nb 0 0 1 am 1 1 1 l 5 5 5 1 1 1 la n 0 3 0\n\
                   fm .1 .1 .1 .8 .2 .2 0 0 0 10 0 0\nxs 2 2 2 0 1 0 90 1 0 0 {\nx n { m vertices 3 0 0 0 1 0 0 0 1 0 normals 1 0 0 1\n\
                   texturecoords 1 t.ppm 0 1 triangles 1 0 1 2 0 0 0 0 0 0 }\n}\nk n { transl 4 0 0 0 0 0 0 0 1 0 0 0 0 0 0 2 0 0 4 0 0 0\n\
                   3 0 0 4 0 0 0 rot 4 0 0 0 1 0 0 0 0 1 0 0 1 0 0 0 0 2 0 0 1 90 0 0 0 3 0 0 1 90 0 0 0 visibility 1 0 1 }\n\
                   a 1 2 5 d 1 i 2 t.aff\nf 1 0 0 1 0 9 s 0 0 0 1\nc 0 0 0 .4 0 2 0 .1 p 4 0 0 0 2 0 0 .5 .5 0 0 2 0\n\
                   tpa 2 0 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1 1 0 0 2 0 0 1 1 0 2 0 0 1 0 1 2 0 0 1\ntt t.ppm 0 0 0 0 1 1 0 0 1 1 0 1 0 0 0\n";

fn binary_ply(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let header = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uchar ushort vertex_index\nend_header\n"
    );
    let numbers = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut bytes = header.into_bytes();
    bytes.extend(
        numbers.iter().flat_map(|number| if big { number.to_be_bytes() } else { number.to_le_bytes() }),
    );
    bytes.push(3);
    bytes.extend(
        [0u16, 1, 2].iter().flat_map(|index| if big { index.to_be_bytes() } else { index.to_le_bytes() }),
    );
    bytes
}

fn binary_stl() -> Vec<u8> {
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, 0);
    bytes.extend(2u32.to_le_bytes());
    for facet in 0..2 {
        let corners = [0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, facet as f32];
        bytes.extend(corners.iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn utf16(text: &str) -> Vec<u8> {
    std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_be_bytes).collect()
}

fn samples() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("a.obj", OBJ.into()),
        ("a.obj", utf16(OBJ)),
        ("a.obj.gz", packed(OBJ.as_bytes())),
        ("a.ply", PLY.into()),
        ("a.ply", binary_ply(false)),
        ("a.ply", binary_ply(true)),
        ("a.ply.gz", packed(PLY.as_bytes())),
        ("a.stl", STL.into()),
        ("a.stl", binary_stl()),
        ("a.stl.gz", packed(&binary_stl())),
        ("a.aff", AFF.into()),
        ("a.nff", utf16(AFF)),
        ("a.aff.gz", packed(AFF.as_bytes())),
    ]
}

/// What is wrong with an outcome.
fn fault(outcome: &Result<Model, LoadError>) -> Option<String> {
    match outcome {
        Ok(model) => broken_rule(model),
        Err(error) => {
            let text = error.to_string();
            (text.contains('\n') || text.len() > 500).then_some(text)
        }
    }
}

fn assert_sound(name: &Path, bytes: Vec<u8>, what: impl Fn() -> String) {
    if let Some(fault) = fault(&load_bytes(name, bytes)) {
        panic!("{}, {}: {fault}", name.display(), what());
    }
}

/// Changes a few bytes: flips, insertions, removals, and numbers put where they hurt.
fn damage(bytes: &mut Vec<u8>, random: &mut Pcg64Mcg) {
    for _ in 0..random.random_range(1..4) {
        if bytes.is_empty() {
            return;
        }
        let at = random.random_range(0..bytes.len());
        match random.random_range(0..6) {
            0 => bytes[at] ^= 1 << random.random_range(0..8),
            1 => bytes[at] = random.random(),
            2 => drop(bytes.remove(at)),
            3 => bytes.insert(at, random.random()),
            4 => {
                let words: [&[u8]; 6] = [b" -1 ", b" 4294967296 ", b" nan ", b" 1e309 ", b"\n", b" 0 "];
                let word = words[random.random_range(0..words.len())];
                bytes.splice(at..at, word.iter().copied());
            }
            _ => {
                let end = bytes.len().min(at + 4);
                bytes[at..end].fill(0xff);
            }
        }
    }
}

#[test]
fn small_files_are_cut_at_every_length() {
    for (name, bytes) in samples() {
        assert_eq!(fault(&load_bytes(Path::new(name), bytes.clone())), None);
        for length in 0..bytes.len() {
            assert_sound(Path::new(name), bytes[..length].to_vec(), || format!("cut at {length}"));
        }
    }
}

#[test]
fn small_files_are_damaged_at_every_byte() {
    for (name, bytes) in samples() {
        for at in 0..bytes.len() {
            for value in [0, b' ', b'9', b'-', b'\n', 0x80, 0xff, bytes[at] ^ 1, bytes[at] ^ 0x20] {
                let mut damaged = bytes.clone();
                damaged[at] = value;
                assert_sound(Path::new(name), damaged, || format!("{value} at {at}"));
            }
        }
    }
}

#[test]
fn small_files_are_damaged_at_random() {
    let mut random = Pcg64Mcg::seed_from_u64(20);
    for (name, bytes) in samples() {
        for round in 0..3000 {
            let mut damaged = bytes.clone();
            damage(&mut damaged, &mut random);
            assert_sound(Path::new(name), damaged, || format!("round {round}"));
        }
    }
}

#[test]
fn odd_files_are_cut_and_damaged() {
    let mut random = Pcg64Mcg::seed_from_u64(21);
    for folder in ["obj", "ply", "stl", "nff"] {
        let Some(folder) = scene(&format!("odd/{folder}")) else { return };
        let mut paths: Vec<_> =
            std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        for path in paths {
            let bytes = std::fs::read(&path).unwrap();
            // Every length of small files; of large ones the beginning, where the headers are, and some more.
            let mut lengths: Vec<usize> = (0..bytes.len().min(4000)).collect();
            lengths.extend((0..40).map(|_| random.random_range(0..=bytes.len())));
            for length in lengths {
                assert_sound(&path, bytes[..length].to_vec(), || format!("cut at {length}"));
            }
            for round in 0..(4_000_000 / (bytes.len() + 1)).min(300) {
                let mut damaged = bytes.clone();
                damage(&mut damaged, &mut random);
                assert_sound(&path, damaged, || format!("round {round}"));
            }
        }
    }
}

#[test]
fn scenes_with_includes_are_cut_and_damaged() {
    let mut random = Pcg64Mcg::seed_from_u64(22);
    for file in ["bart_museum/museum5.aff", "bart_kitchen/car.aff", "bart_robot/Robot1.aff"] {
        let Some(path) = scene(file) else { return };
        let bytes = std::fs::read(&path).unwrap();
        for _ in 0..20 {
            let length = random.random_range(0..=bytes.len());
            assert_sound(&path, bytes[..length].to_vec(), || format!("cut at {length}"));
        }
        for round in 0..60 {
            let mut damaged = bytes.clone();
            damage(&mut damaged, &mut random);
            assert_sound(&path, damaged, || format!("round {round}"));
        }
    }
}

#[test]
fn the_rules_object() {
    let sound = || load_bytes(Path::new("a.obj"), OBJ.into()).unwrap();
    assert_eq!(broken_rule(&sound()), None);
    let breakers: [fn(&mut Model); 10] = [
        |model| model.surfaces.clear(),
        |model| model.surfaces[0].clear(),
        |model| drop(model.object_names.pop()),
        |model| model.materials.clear(),
        |model| model.scene.objects[0].geometries[0].triangles.clear(),
        |model| model.scene.objects[0].geometries[0].triangles[0][1] = 99,
        |model| model.scene.instances.push(Instance::new(7, Transform::IDENTITY)),
        |model| model.surfaces[0][0].materials = MaterialAssignment::PerTriangle(vec![0]),
        |model| model.surfaces[0][0].materials = MaterialAssignment::One(9),
        |model| {
            model.surfaces[0][0].normals =
                Some(CornerAttribute { values: vec![Vec3::X], indices: Some(vec![[0; 3]]) });
        },
    ];
    for (index, breaker) in breakers.iter().enumerate() {
        let mut model = sound();
        breaker(&mut model);
        assert!(broken_rule(&model).is_some(), "rule {index}");
    }
    let two_lines = LoadError::UnknownFormat { path: "a".into(), what: "b\nc".into() };
    assert!(fault(&Err(two_lines)).is_some());
}
