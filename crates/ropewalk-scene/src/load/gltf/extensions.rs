//! Which extensions are understood, and what becomes of a file that uses others.

use super::document::Document;
use crate::load::source::Source;
use crate::{LoadError, LoadReport};

/// Extensions that are read.
const READ: [&str; 7] = [
    "KHR_mesh_quantization",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_texture_transform",
];

/// Extensions that change looks or motion but neither shape nor place: a file that requires one can be loaded without.
const LOOKS_ONLY: [&str; 5] = [
    "KHR_animation_pointer",
    "KHR_texture_basisu",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "MSFT_texture_dds",
];

/// Refuses a file that requires what is not understood; notes what it uses that is not read.
pub(super) fn check(source: &Source, document: &Document, report: &mut LoadReport) -> Result<(), LoadError> {
    let is_read = |name: &str| READ.contains(&name);
    let is_dispensable = |name: &str| LOOKS_ONLY.contains(&name) || name.starts_with("KHR_materials_");
    for name in &document.extensions_required {
        if !is_read(name) && !is_dispensable(name) {
            let what =
                format!("the file requires the extension {name}, which is not read; export it without");
            return Err(source.malformed("extensionsRequired", what));
        }
    }
    let mut ignored: Vec<&str> = Vec::new();
    for name in document.extensions_used.iter().chain(&document.extensions_required) {
        if !is_read(name) && !ignored.contains(&name.as_str()) {
            ignored.push(name);
        }
    }
    if !ignored.is_empty() {
        report.notes.push(format!("extensions that are not read: {}", ignored.join(", ")));
    }
    Ok(())
}
