//! Wavefront OBJ with its MTL: polygons between shared vertices, as text.
//!
//! The parser is our own. The crate tobj cuts every polygon into a fan, makes a new model at every `usemtl`, and its
//! errors carry no line; here concave polygons stay right, objects stay whole, and whatever is left out is counted
//! with the line of the first.
//!
//! * **Objects.** The lines `o` and `g` name the object of the faces after them: faces under the same pair of names
//!   belong to one object, also when other names came between, as the format has it. `o` leaves the group. Objects
//!   come in the order of their first faces; those without faces are dropped. `usemtl` starts no object.
//! * **Vertices** of each object are its own, in the order in which its faces use them.
//! * **Indices** count from 1, or backwards from the last. A face may name vertices that come later in the file.
//! * **Numbers** that cannot be read void their vertex, and the faces that use it; both are counted.
//! * **Normals and texture coordinates** that single corners lack are the face's own normal and zero. Where a whole
//!   object lacks them it has none.
//! * **Materials** with their pictures ([`maps`]). Those that no face uses are left out. One that no library has gets its name and the default looks.
//! * Weights and colours of vertices are passed over. Points, lines and free-form surfaces are counted.
//!
//! The cost is one pass over the bytes and one over the faces.

mod assemble;
mod document;
mod maps;
mod mtl;
mod parse;

use super::source::Source;
use crate::{LoadError, Model};

/// Reads an OBJ file, and the MTL files that it names.
pub(crate) fn load(source: &Source) -> Result<Model, LoadError> {
    let mut document = parse::parse(source)?;
    let materials = mtl::read_libraries(source, &mut document);
    Ok(assemble::assemble(document, materials))
}
