//! Files in. The format is told by the content, then by the name.
//!
//! Every loader keeps three rules. What a file declares is never believed before the bytes are there, so no file
//! makes the program allocate much more than it holds. What cannot be represented is skipped and counted in the
//! [`LoadReport`](crate::LoadReport) with the place of the first such thing; what is merely odd, such as triangles
//! with two equal vertices or vertices that are not numbers, is passed on, and counted when a structure is built. A file that
//! breaks its format is an error that names the place.

mod aff;
mod format;
mod gltf;
mod obj;
mod placement;
mod ply;
mod polygon;
mod source;
mod stl;
mod text;
mod textures;

use crate::{Animated, LoadError, Model};
use format::Format;
use source::Source;
use std::path::Path;

/// Loads a scene from a file of any known format, gzipped or not.
///
/// # Errors
/// When the file cannot be read, is of no known format, or is malformed.
pub fn load(path: &Path) -> Result<Model, LoadError> {
    load_source(&Source::open(path)?)
}

/// Loads a scene from the content of a file, gzipped or not. The path is the name in messages; its ending helps
/// where the content leaves the format open, and files that the scene names are looked for beside it.
///
/// # Errors
/// When the content is of no known format or malformed, or a file that the scene needs cannot be read.
pub fn load_bytes(path: &Path, bytes: Vec<u8>) -> Result<Model, LoadError> {
    load_source(&Source::from_bytes(path, bytes)?)
}

/// Loads a scene with its motion. Of formats that have none the scene stands still.
///
/// The model is as when its first clip begins. It may differ in this from that of [`load`], and in that what is flattened to
/// nothing at the time is hidden, not left out.
///
/// # Errors
/// When [`load`] would refuse the file.
pub fn load_animated(path: &Path) -> Result<Animated, LoadError> {
    animated_source(&Source::open(path)?)
}

/// The same from the content of a file, as [`load_bytes`].
///
/// # Errors
/// When [`load_bytes`] would refuse it.
pub fn load_animated_bytes(path: &Path, bytes: Vec<u8>) -> Result<Animated, LoadError> {
    animated_source(&Source::from_bytes(path, bytes)?)
}

fn animated_source(source: &Source) -> Result<Animated, LoadError> {
    match Format::of(source)? {
        Format::Aff => aff::load_animated(source),
        Format::Gltf => gltf::load_animated(source),
        Format::Obj | Format::Ply | Format::Stl => load_source(source).map(Animated::still),
    }
}

fn load_source(source: &Source) -> Result<Model, LoadError> {
    match Format::of(source)? {
        Format::Aff => aff::load(source),
        Format::Gltf => gltf::load(source),
        Format::Obj => obj::load(source),
        Format::Ply => ply::load(source),
        Format::Stl => stl::load(source),
    }
}
