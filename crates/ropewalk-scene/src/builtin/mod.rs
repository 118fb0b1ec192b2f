//! Procedural scenes: made by code, from no file, the same bits on every run.
//!
//! [`builtin`] makes one by its name. [`NAMES`] lists what there is.

mod assembly;
mod cornell;
mod cubes;
mod forest;
mod shape;
mod stage;

use crate::{Animated, LoadError, Model};

/// The names of the built-in scenes, each with a line that says what it is.
pub const NAMES: [(&str, &str); 4] = [
    ("assembly", "a gearbox of more than 100 parts, cut open: the demo"),
    ("cornell", "a box with a red and a green wall, a lamp, a sphere of mirror and one of glass"),
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
        "cornell" => Ok(cornell::cornell()),
        "cubes" => Ok(cubes::cubes()),
        "forest" => Ok(forest::forest()),
        _ => {
            Err(LoadError::NoSuchBuiltin { name: name.into(), known: NAMES.map(|(name, _)| name).join(", ") })
        }
    }
}

/// Makes a built-in scene with its motion: `assembly` runs and comes apart, the others stand still.
///
/// # Errors
/// When there is no scene of that name; the error lists those that there are.
///
/// ```
/// let assembly = ropewalk_scene::builtin::builtin_animated("assembly")?;
/// let span = assembly.span().expect("it moves");
/// let pose = assembly.pose(span.start + 1.0).expect("it moves");
/// assert_eq!(pose.transforms.len(), assembly.model().scene.instances.len());
/// # Ok::<(), ropewalk_scene::LoadError>(())
/// ```
pub fn builtin_animated(name: &str) -> Result<Animated, LoadError> {
    match name {
        "assembly" => Ok(assembly::animated()),
        _ => builtin(name).map(Animated::still),
    }
}
