//! The command line, as clap reads it. The arguments of a command stand with the command.

use crate::commands::{bench, info, lab, list, points, render, trace, verify};
use clap::{Parser, Subcommand};

/// Ray queries and rendering on the CPU and on any GPU, without ray tracing hardware.
#[derive(Debug, Parser)]
#[command(name = "ropewalk", version, max_term_width = 110, after_help = EXAMPLES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

/// What the program can do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to a PNG or EXR file
    Render(render::Arguments),
    /// Trace rays from an .npy file and write the hits to an .npz file
    Trace(trace::Arguments),
    /// Find what is closest to the points of an .npy file, or on which side of a surface they lie
    Points(points::Arguments),
    /// Show what a scene holds, what is wrong with it, and what its structure costs
    Info(info::Arguments),
    /// List every structure, walk, query and device that exists, and this machine's adapters
    List(list::Arguments),
    /// Check every walk on every device of this machine against brute force
    Verify(verify::Arguments),
    /// Measure build times and rays per second
    Bench(bench::Arguments),
    /// Repeat an experiment of the papers on any scene
    Lab(lab::Arguments),
}

const EXAMPLES: &str = "\
Examples:
  ropewalk render -o demo.png                       the built-in demo scene
  ropewalk info part.stl                            what is in a file
  ropewalk trace part.stl --rays rays.npy -o hits.npz
  ropewalk COMMAND --help                           more, and what every word means

Results go to standard output or to the named file, notes to standard error.
Exit codes: 0 done, 1 failed, 2 wrong usage.";
