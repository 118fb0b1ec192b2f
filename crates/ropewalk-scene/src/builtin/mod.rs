//! Procedural scenes: made by code, from no file, the same bits on every run.
//!
//! [`builtin`] makes one by its name. [`NAMES`] lists what there is.

mod assembly;
mod cubes;
mod forest;
mod shape;
mod stage;

use crate::{LoadError, Model};

/// The names of the built-in scenes, each with a line that says what it is.
pub const NAMES: [(&str, &str); 3] = [
    ("assembly", "a gearbox of more than 100 parts, cut open: the demo"),
    ("cubes", "five bevelled cubes on a ground, 222 triangles, as in Toczek et al. 2010"),
    ("forest", "a clearing among leafy trees and grass: long paths through half-empty boxes"),
];

/// Makes a built-in scene.
///
/// # Errors
/// When there is no scene of that name; the error lists those that there are.
///
/// ```
/// let model = ropewalk_scene::builtin::builtin("cubes")?;
/// assert_eq!(model.scene.triangle_count(), 222);
/// assert!(ropewalk_scene::builtin::builtin("pyramids").is_err());
/// # Ok::<(), ropewalk_scene::LoadError>(())
/// ```
pub fn builtin(name: &str) -> Result<Model, LoadError> {
    match name {
        "assembly" => Ok(assembly::assembly()),
        "cubes" => Ok(cubes::cubes()),
        "forest" => Ok(forest::forest()),
        _ => {
            Err(LoadError::NoSuchBuiltin { name: name.into(), known: NAMES.map(|(name, _)| name).join(", ") })
        }
    }
}
