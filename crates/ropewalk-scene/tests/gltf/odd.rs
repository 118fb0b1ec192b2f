//! Odd and malformed files of the collection: loaded with a report, or refused with the file and the place.

use crate::check;
use crate::common::{scene, skipped, triangles};
use ropewalk_scene::load::load;

/// What a file is to become.
enum Expected {
    /// So many triangles, instances counted, and so many things left out for a reason with this text.
    Loaded(usize, usize, &'static str),
    /// An error with this text.
    Refused(&'static str),
}

use Expected::{Loaded, Refused};

const FILES: [(&str, Expected); 24] = [
    ("AllIndicesOutOfRange.gltf", Loaded(0, 12, "restart")),
    ("BoxBadNormals.glb", Loaded(12, 0, "")),
    ("BoxInterleaved.glb", Loaded(12, 0, "")),
    ("Horse_utf8_mangled.glb", Refused("byte 8: the GLB header says")),
    ("Mesh_PrimitiveMode_04.gltf", Loaded(2, 0, "")),
    ("MissingBin_BoxTextured.gltf", Refused("buffers[0]")),
    ("NoScene.gltf", Loaded(0, 0, "")),
    ("SceneWithoutNodes.gltf", Loaded(0, 0, "")),
    ("empty_nodes.glb", Loaded(0, 0, "")),
    ("invalid-buffer-index.gltf", Refused("bufferViews[1]: this names buffer 1, but the file has 1")),
    ("invalid-buffer-view-index.gltf", Refused("bufferViews[0]: this names buffer 0, but the file has 0")),
    ("invalid-primitive-indices.gltf", Refused("bufferViews[0]: this names buffer 0, but the file has 0")),
    ("issue-492.glb", Loaded(0, 0, "")),
    ("nested.glb", Loaded(36, 0, "")),
    ("no_indices_3storybuilding.glb", Loaded(72, 0, "")),
    ("pins.glb", Loaded(3_408, 0, "")),
    ("singleBlendshapeCube_sparse.glb", Loaded(12, 0, "")),
    ("texcoord_crash.gltf", Loaded(10, 0, "")),
    ("validator_accessor_unaligned.gltf", Loaded(1, 0, "")),
    ("validator_index_buffer_degenerate_triangle.gltf", Loaded(3, 0, "")),
    ("validator_index_buffer_oob.gltf", Loaded(1, 1, "out of range")),
    ("validator_index_buffer_primitive_restart.gltf", Loaded(0, 1, "restart")),
    ("wrongTypes/badArray.gltf", Refused("JSON line 44 column 26: invalid type: map")),
    ("wrongTypes/badUint.gltf", Loaded(12, 0, "")),
];

#[test]
fn every_odd_file_does_what_its_table_says() {
    for (file, expected) in &FILES {
        let Some(path) = scene(&format!("odd/gltf/{file}")) else {
            return;
        };
        match (load(&path), expected) {
            (Ok(model), Loaded(count, left_out, reason)) => {
                assert_eq!(triangles(&model), *count, "{file}");
                assert_eq!(skipped(&model, reason), *left_out, "{file}: {:?}", model.report);
                assert_eq!(model.report.skipped_count(), *left_out, "{file}: {:?}", model.report);
                check(&model, file);
            }
            (Err(error), Refused(text)) => {
                let error = error.to_string();
                assert!(error.contains(file) && error.contains(text), "{error}");
            }
            (Ok(_), Refused(text)) => panic!("{file} is loaded, but should be refused for {text}"),
            (Err(error), Loaded(..)) => panic!("{file} is refused: {error}"),
        }
    }
}

#[test]
fn no_odd_file_is_forgotten() {
    let Some(folder) = scene("odd/gltf") else { return };
    let mut found = 0;
    for folder in [folder.clone(), folder.join("wrongTypes")] {
        for file in std::fs::read_dir(folder).unwrap() {
            let ending = file.unwrap().path().extension().map(|ending| ending.to_string_lossy().into_owned());
            found += usize::from(matches!(ending.as_deref(), Some("gltf" | "glb")));
        }
    }
    assert_eq!(found, FILES.len());
}

#[test]
fn the_missing_buffer_is_named() {
    let Some(path) = scene("odd/gltf/MissingBin_BoxTextured.gltf") else {
        return;
    };
    let error = load(&path).unwrap_err().to_string();
    assert!(error.contains("BoxTextured0.bin"), "{error}");
}

#[test]
fn degenerate_triangles_are_counted_when_a_scene_is_flattened() {
    let Some(path) = scene("odd/gltf/validator_index_buffer_degenerate_triangle.gltf") else {
        return;
    };
    // Its positions are zeros: no triangle has an area.
    assert_eq!(load(&path).unwrap().scene.flatten().unwrap().report.degenerate, 3);
}
