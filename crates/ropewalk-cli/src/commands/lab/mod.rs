//! `ropewalk lab EXPERIMENT`: the experiments of the papers, on any scene.

mod closest_point;
mod common;
mod reichl_table2;
mod restart_trail;
mod traversal_lists;
mod two_level;

use crate::failure::Failure;
use clap::{Args, Subcommand};

const EXAMPLES: &str = "\
Examples:
  ropewalk lab restart-trail bunny.ply -o bunny
  ropewalk lab restart-trail room.obj --views within --rounds 0
  ropewalk lab closest-point bunny.ply -o bunny
  ropewalk lab traversal-lists bunny.ply dragon.ply -o lists
  ropewalk lab two-level engine.glb car.glb -o levels
  ropewalk lab reichl-table2 Robot.aff kitchen.aff -o table2
  ropewalk lab restart-trail --help
  ropewalk lab closest-point --help
  ropewalk lab traversal-lists --help
  ropewalk lab two-level --help
  ropewalk lab reichl-table2 --help";

/// The arguments of `ropewalk lab`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    experiment: Experiment,
}

/// What can be tried.
#[derive(Debug, Subcommand)]
enum Experiment {
    /// What it costs to do without a stack: the restart trail against the full stack (Laine 2010)
    RestartTrail(restart_trail::Arguments),
    /// Whether closest points are right, and what it costs to find them without a stack
    ClosestPoint(closest_point::Arguments),
    /// What traversal lists cost with each of their options (Toczek et al. 2010)
    TraversalLists(traversal_lists::Arguments),
    /// What two levels cost beside one, and how fast the top level is rebuilt (Reichl et al. 2010)
    TwoLevel(two_level::Arguments),
    /// Frames a second of two levels beside one, by how much light is followed (Reichl et al. 2010, Table 2)
    ReichlTable2(reichl_table2::Arguments),
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.experiment {
        Experiment::RestartTrail(arguments) => restart_trail::run(arguments),
        Experiment::ClosestPoint(arguments) => closest_point::run(arguments),
        Experiment::TraversalLists(arguments) => traversal_lists::run(arguments),
        Experiment::TwoLevel(arguments) => two_level::run(arguments),
        Experiment::ReichlTable2(arguments) => reichl_table2::run(arguments),
    }
}
