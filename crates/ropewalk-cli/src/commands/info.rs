//! `ropewalk info`: what a scene holds, what is wrong with it, what its structure costs, and which GPU holds it.

mod document;
mod text;

use crate::failure::Failure;
use crate::scene_argument::{DEFAULT_SCENE, SceneArgument, scene_help};
use crate::{output, structure};
use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};
use document::Document;
use ropewalk::StructureSpec;

const EXAMPLES: &str = "\
Triangles count every instance; unique triangles count each object once.
Vertices are those of the file. Defects are left out of the structure and
counted here: nothing is dropped silently.

Examples:
  ropewalk info part.stl
  ropewalk info scene.glb --json
  ropewalk info scene.glb --structure bvh:max-leaf=1
  ropewalk info scene.glb --structure list:preset=best";

/// The arguments of `ropewalk info`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[arg(value_name = "SCENE", help = scene_help(), default_value = DEFAULT_SCENE)]
    #[arg(value_parser = OsStringValueParser::new().map(SceneArgument::from))]
    scene: SceneArgument,
    /// The structure whose cost is shown; see `ropewalk list`
    #[arg(long, value_name = "NAME[:key=value,...]", default_value_t)]
    structure: StructureSpec,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let scene = arguments.scene.load()?;
    let built = structure::build(&arguments.structure, &scene.model.scene)?;
    let document = Document::new(arguments, &scene, &built);
    if arguments.json { output::print_json(&document) } else { output::print(&document.to_text()) }
}
