//! `ropewalk lab EXPERIMENT`: the experiments of the papers, on any scene.

mod restart_trail;

use crate::failure::Failure;
use clap::{Args, Subcommand};

const EXAMPLES: &str = "\
Examples:
  ropewalk lab restart-trail bunny.ply -o bunny
  ropewalk lab restart-trail room.obj --views within --rounds 0
  ropewalk lab restart-trail --help";

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
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.experiment {
        Experiment::RestartTrail(arguments) => restart_trail::run(arguments),
    }
}
