//! glTF and GLB: every file of the scene collection, odd files, documents made here, and broken ones.

#[path = "../common/mod.rs"]
mod common;

mod broken;
mod documents;
mod make;
mod motion;
mod odd;
mod pictures;
mod scenes;

use ropewalk_scene::Model;

/// Checks what every model keeps. A primitive without triangles stays as an empty geometry, so that a hit's
/// geometry index is the primitive's in the file; the rules are for the others.
fn check(model: &Model, name: &str) {
    let mut model = model.clone();
    for (object, surfaces) in model.scene.objects.iter_mut().zip(&mut model.surfaces) {
        assert_eq!(object.geometries.len(), surfaces.len(), "{name}");
        let is_full: Vec<bool> = object.geometries.iter().map(|mesh| !mesh.triangles.is_empty()).collect();
        let mut keep = is_full.iter();
        object.geometries.retain(|_| *keep.next().unwrap());
        let mut keep = is_full.iter();
        surfaces.retain(|_| *keep.next().unwrap());
    }
    common::check(&model, name);
}

#[test]
#[should_panic(expected = "material that is not there")]
fn the_check_objects() {
    let mut model = common::load_text("x.gltf", &make::triangle(r#"{"mesh":0}"#)).unwrap();
    check(&model, "whole");
    model.materials.clear();
    check(&model, "broken");
}
