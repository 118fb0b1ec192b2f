//! The shaders of this crate, and the constants that they take from Rust.

use crate::light::{ENVIRONMENT_WORDS, SOURCE_WORDS};
use crate::looks::{MOST_PANES, layout};
use ropewalk_gpu::shader::{Definitions, ProgramSource, ShaderLibrary};

/// The one list of files. A test compares it with the folder.
macro_rules! files {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../shaders/", $name, ".wgsl")))),*]
    };
}

pub(super) const FILES: &[(&str, &str)] = files![
    "looks_words",
    "looks_texture",
    "looks_shaded",
    "looks_place",
    "looks_panes",
    "bsdf_arithmetic",
    "bsdf_fresnel",
    "bsdf",
    "bsdf_shading",
    "sampling",
    "light_source",
    "light_environment",
    "ray_tree_request",
    "ray_tree_ray",
    "ray_tree_node",
    "ray_tree",
];

/// The shipped shaders and those of this crate.
pub(super) fn library() -> ShaderLibrary {
    FILES.iter().fold(ShaderLibrary::shipped(), |library, &(name, text)| library.with(name, text))
}

/// What the shaders take from Rust.
pub(super) fn definitions() -> Definitions {
    let words = [
        ("LOOKS_INSTANCES", layout::INSTANCES),
        ("LOOKS_GEOMETRIES", layout::GEOMETRIES),
        ("LOOKS_TRIANGLES", layout::TRIANGLES),
        ("LOOKS_VERTICES", layout::VERTICES),
        ("LOOKS_NORMALS", layout::NORMALS),
        ("LOOKS_COORDINATES", layout::COORDINATES),
        ("LOOKS_MATERIALS", layout::MATERIALS),
        ("LOOKS_TEXTURES", layout::TEXTURES),
        ("LOOKS_BYTES", layout::BYTES),
        ("LOOKS_LIGHT", layout::LIGHT),
        ("LOOKS_REQUEST", layout::REQUEST),
        ("LOOKS_ATLAS", layout::ATLAS),
        ("LOOKS_FLAGS", layout::FLAGS),
        ("LOOKS_CATCHER", layout::CATCHER),
        ("LOOKS_ZERO", layout::HEADER - 1),
        ("LOOKS_INSTANCE_WORDS", layout::INSTANCE),
        ("LOOKS_GEOMETRY_WORDS", layout::GEOMETRY),
        ("LOOKS_TRIANGLE_WORDS", layout::TRIANGLE),
        ("LOOKS_MATERIAL_WORDS", layout::MATERIAL),
        ("LOOKS_TEXTURE_WORDS", layout::TEXTURE),
        ("LOOKS_HAS_CUT_OUTS", layout::HAS_CUT_OUTS as usize),
        ("LOOKS_HAS_PANES", layout::HAS_PANES as usize),
        ("MOST_PANES", MOST_PANES as usize),
        ("MATERIAL_GIVES_AMBIENT", layout::GIVES_AMBIENT as usize),
        ("MATERIAL_GIVES_SPECULAR", layout::GIVES_SPECULAR as usize),
        ("MATERIAL_MIRRORS_SHARPLY", layout::MIRRORS_SHARPLY as usize),
        ("WRAP_REPEAT", layout::REPEAT as usize),
        ("WRAP_MIRROR", layout::MIRROR as usize),
        ("TEXTURE_IS_LINEAR", layout::IS_LINEAR as usize),
        ("TEXTURE_IS_SRGB", layout::IS_SRGB as usize),
        ("LIGHT_ENVIRONMENT_WORDS", ENVIRONMENT_WORDS),
        ("LIGHT_SOURCE_WORDS", SOURCE_WORDS),
    ];
    let nothing = format!("{:#x}u", layout::NOTHING);
    words
        .iter()
        .fold(Definitions::new(), |these, (name, value)| these.text(name, value))
        .text("LOOKS_NOTHING", nothing)
        .text("COLLECT", "shared/collect_filtered")
}

/// A program of a library that has the files of this crate, but for its words.
pub(super) fn of(library: ShaderLibrary, root: &str) -> ProgramSource {
    ProgramSource::new(library, root).define(&definitions())
}

#[cfg(test)]
mod tests {
    use super::*;
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    use ropewalk::Query;
    use ropewalk_gpu::shader::Kernel;
    use std::collections::{BTreeSet, HashSet};
    use std::path::Path;

    #[test]
    fn the_list_holds_every_file_of_the_folder() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
        let name = |file: std::fs::DirEntry| {
            let name = file.file_name().into_string().unwrap();
            name.strip_suffix(".wgsl").expect("only WGSL lies here").to_string()
        };
        let found: BTreeSet<String> =
            std::fs::read_dir(folder).unwrap().map(|file| name(file.unwrap())).collect();
        assert_eq!(found, FILES.iter().map(|(name, _)| (*name).to_string()).collect());
        for (name, text) in FILES {
            for word in ["Source:", "Invariants:"] {
                let has =
                    text.lines().take_while(|line| line.starts_with("//")).any(|line| line.contains(word));
                assert!(has, "{name} does not say its {word}");
            }
        }
    }

    /// As a device without any optional feature would have it, over every tree.
    #[test]
    fn the_kernel_is_portable() {
        let source = of(library(), "ray_tree").with_words(1, 1, 100);
        let mut seen = HashSet::new();
        for kernel in Kernel::every() {
            if kernel.query != Query::Closest || !seen.insert(kernel.tree) {
                continue;
            }
            let text = source.source(kernel).unwrap();
            let module = naga::front::wgsl::parse_str(&text).unwrap_or_else(|error| {
                panic!("{}: {}", kernel.label(), error.emit_to_string(&text));
            });
            let checked = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
            assert!(checked.is_ok(), "{}: {checked:?}", kernel.label());
        }
        assert!(seen.len() > 10);
    }
}
