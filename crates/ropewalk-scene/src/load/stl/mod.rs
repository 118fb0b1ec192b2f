//! STL: facets without connection, as text or binary.
//!
//! Every solid with facets is an object. Corners at the same place become one vertex, so that it shows where the
//! surface is closed; the report counts them as stored, three a facet. The normals of the file are not used: many
//! programs write zeros, and the corners say it better.
//!
//! Text begins with the word `solid`, but so do some binary files: binary it is when the size is just what the count
//! of facets asks for, or a zero byte is near the beginning.

mod binary;
mod text;
mod weld;

use super::format::has_the_size_of_binary_stl;
use super::placement::Placement;
use super::source::Source;
use crate::{LoadError, LoadReport, Material, Model, Surface};
use glam::DVec3;
use ropewalk::Transform;

/// Facets that belong together.
#[derive(Debug, Default)]
struct Solid {
    name: String,
    facets: Vec<[DVec3; 3]>,
}

/// Reads an STL file.
pub(crate) fn load(source: &Source) -> Result<Model, LoadError> {
    let mut report = LoadReport::default();
    let solids = if is_text(&source.bytes) {
        text::read(source, &mut report)
    } else {
        binary::read(source, &mut report).map(|solid| vec![solid])
    }?;
    let corners = solids.iter().flat_map(|solid| &solid.facets).flatten();
    let placement = Placement::of(corners.copied());
    let mut model = Model { report, ..Model::default() };
    model.scene.origin = placement.origin;
    for solid in solids.into_iter().filter(|solid| !solid.facets.is_empty()) {
        let object = model.scene.add_object(weld::weld(&solid.facets, placement));
        model.scene.add_instance(object, Transform::IDENTITY);
        model.object_names.push(solid.name);
        model.surfaces.push(vec![Surface::default()]);
    }
    if !model.surfaces.is_empty() {
        model.materials.push(Material::default());
    }
    Ok(model)
}

/// Where a binary file would have its header and its first facet.
const BEGINNING: usize = 84 + 50;

fn is_text(bytes: &[u8]) -> bool {
    let begins_with_solid = bytes
        .trim_ascii_start()
        .split_at_checked(5)
        .is_some_and(|(word, _)| word.eq_ignore_ascii_case(b"solid"));
    let beginning = bytes.get(..BEGINNING).unwrap_or(bytes);
    begins_with_solid && !has_the_size_of_binary_stl(bytes) && !beginning.contains(&0)
}
