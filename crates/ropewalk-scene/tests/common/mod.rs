//! What the tests of the loaders share.

#![allow(dead_code, reason = "each test uses a part of it")]

use ropewalk_scene::{CornerAttribute, LoadError, MaterialAssignment, Model};
use std::path::{Path, PathBuf};

/// A file of the scene collection; `None`, with a message, where the collection is not there.
pub(crate) fn scene(name: &str) -> Option<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes"));
    if folder.is_dir() {
        return Some(folder.join(name));
    }
    println!("skipped: there is no scene collection at {}", folder.display());
    None
}

/// Loads a text under a name.
pub(crate) fn load_text(name: &str, text: &str) -> Result<Model, LoadError> {
    ropewalk_scene::load::load_bytes(Path::new(name), text.as_bytes().to_vec())
}

/// Triangles with instances counted.
pub(crate) fn triangles(model: &Model) -> usize {
    model.scene.triangle_count()
}

/// How many objects there are.
pub(crate) fn objects(model: &Model) -> usize {
    model.scene.objects.len()
}

/// How many things were left out for a reason that contains a text.
pub(crate) fn skipped(model: &Model, what: &str) -> usize {
    model.report.skipped.iter().filter(|row| row.what.contains(what)).map(|row| row.count).sum()
}

/// What every model keeps, whatever its file; the first rule that this one breaks.
pub(crate) fn broken_rule(model: &Model) -> Option<String> {
    let objects = &model.scene.objects;
    if model.surfaces.len() != objects.len() || model.object_names.len() != objects.len() {
        return Some("an object without surfaces or name".into());
    }
    for (index, (object, surfaces)) in objects.iter().zip(&model.surfaces).enumerate() {
        if surfaces.len() != object.geometries.len() {
            return Some(format!("object {index} has {} surfaces", surfaces.len()));
        }
        for (mesh, surface) in object.geometries.iter().zip(surfaces) {
            let count = mesh.triangles.len();
            if count == 0 {
                return Some(format!("object {index} is empty"));
            }
            if let Some(triangle) =
                mesh.triangles.iter().flatten().find(|&&v| v as usize >= mesh.positions.len())
            {
                return Some(format!("object {index} has no vertex {triangle}"));
            }
            let sound = leads_somewhere(surface.normals.as_ref(), mesh)
                && leads_somewhere(surface.texture_coordinates.as_ref(), mesh);
            if !sound {
                return Some(format!("object {index} has an attribute that leads nowhere"));
            }
            if let MaterialAssignment::PerTriangle(materials) = &surface.materials
                && materials.len() != count
            {
                return Some(format!("object {index} has {} materials of {count}", materials.len()));
            }
            let known = model.materials.len();
            if (0..count).any(|triangle| surface.materials.of(triangle) as usize >= known) {
                return Some(format!("object {index} has a material that is not there"));
            }
        }
    }
    model.scene.flatten().err().map(|error| error.to_string())
}

fn leads_somewhere<T: Copy>(attribute: Option<&CornerAttribute<T>>, mesh: &ropewalk::Mesh) -> bool {
    attribute.is_none_or(|attribute| {
        let length_fits =
            attribute.indices.as_ref().is_none_or(|indices| indices.len() == mesh.triangles.len());
        length_fits
            && (0..mesh.triangles.len())
                .all(|triangle| attribute.corners(triangle, mesh.triangles[triangle]).is_some())
    })
}

/// Fails when a model breaks a rule.
pub(crate) fn check(model: &Model, name: &str) {
    if let Some(rule) = broken_rule(model) {
        panic!("{name}: {rule}");
    }
}
