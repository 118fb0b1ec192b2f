//! `ropewalk bench --peers`: ours beside foreign engines, in the arena of `ropewalk-lab`.
//!
//! The foreign engines are a crate of their own, outside of the plain build. A program without them says so, and how to
//! build one with them.

#[cfg(feature = "peers")]
mod arena;
#[cfg(feature = "peers")]
mod readme;
#[cfg(feature = "peers")]
mod stages;

use crate::failure::Failure;
use clap::Args;
use ropewalk_lab::arena::ArenaClass;
use std::path::PathBuf;

/// How to get a program with the peers in it.
#[cfg(not(feature = "peers"))]
const HOW_TO_BUILD: &str = "this program was built without the peers; in the folder of its source, build and run it with them: \
     RUSTFLAGS=\"-C target-cpu=native\" cargo run --release --features peers -- bench --peers SCENE";

/// The arguments of `ropewalk bench --peers`.
#[derive(Args, Debug)]
#[group(id = "peers-arguments")]
pub(super) struct Arguments {
    /// Compare with foreign engines: Embree, tinybvh, obvhs, parry3d, bvh. SCENE may also be rotated:FILE, turned off
    /// its axes, or mixed:ROOM+FILE+..., with the other files standing in a room
    #[arg(long, conflicts_with_all = ["structure", "walk", "device"])]
    pub(super) peers: bool,
    /// Only engines whose name and preset contain all these words, say "embree high"; may be given several times
    #[arg(long, value_name = "WORDS", requires = "peers")]
    pub(super) engine: Vec<String>,
    /// Only these rays: primary, diffuse, diffuse-shuffled, shadow, ambient-occlusion; may be given several times
    #[arg(long, value_name = "CLASS", requires = "peers")]
    pub(super) class: Vec<ArenaClass>,
    /// Only this: trace, build, refit, top-level; may be given several times
    #[arg(long, value_name = "KIND", requires = "peers", value_parser = ["trace", "build", "refit", "top-level"])]
    pub(super) kind: Vec<String>,
    /// Write the tables to a Markdown file, too
    #[arg(long, value_name = "FILE", requires = "peers")]
    pub(super) markdown: Option<PathBuf>,
    /// Put a short table of `bvh8:preset=high`, and of all builds, between the lines <!-- peers --> and <!-- /peers --> of this
    /// file
    #[arg(long, value_name = "FILE", requires = "peers")]
    pub(super) readme: Option<PathBuf>,
    /// Embree 4's library; by default where it is usually installed, or what ROPEWALK_EMBREE4 names
    #[arg(long, value_name = "FILE", requires = "peers")]
    pub(super) embree4: Option<PathBuf>,
    /// Embree 3's library; by default where it is usually installed, or what ROPEWALK_EMBREE3 names
    #[arg(long, value_name = "FILE", requires = "peers")]
    pub(super) embree3: Option<PathBuf>,
}

/// Runs the command.
#[cfg(feature = "peers")]
pub(super) fn run(arguments: &super::Arguments) -> Result<(), Failure> {
    arena::run(arguments)
}

/// Says how to run it.
#[cfg(not(feature = "peers"))]
pub(super) fn run(_: &super::Arguments) -> Result<(), Failure> {
    Err(Failure::failed(HOW_TO_BUILD))
}
