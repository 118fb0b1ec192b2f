//! The program `ropewalk`: render a scene, trace rays and find points as data, look into files, verify and measure.
//!
//! Results go to standard output or to the file that is named, notes and progress to standard error. The exit
//! code is 0 when done, 1 when something failed, 2 when the question was wrong. What went wrong is one line on
//! standard error.
//!
//! | module | concept |
//! |---|---|
//! | [`cli`] | the command line, as clap reads it |
//! | [`commands`] | a file a command |
//! | [`arrays`] | rays, points and answers in numpy's file formats |
//! | `*_argument` | what a word on the command line means |
//! | [`families`] | the catalogue in short |
//! | [`output`], [`progress`], [`table`] | what people and scripts get to see |
//! | [`failure`], [`mod@panic`], [`interrupt`] | how it ends when it ends early |

#![forbid(unsafe_code)]

mod arrays;
mod cli;
mod commands;
mod device_argument;
mod failure;
mod families;
mod interrupt;
mod light_argument;
mod output;
mod panic;
mod progress;
mod scene_argument;
mod structure;
mod table;
mod threads;

use clap::Parser;
use clap::error::ErrorKind;
use cli::{Cli, Command};
use failure::Failure;
use std::io::Write;
use std::process::ExitCode;

/// Counts what builds allocate, while it is told to: `bench --peers` shows the most that each takes.
#[cfg(feature = "peers")]
#[global_allocator]
static ALLOCATOR: ropewalk_peers::CountingAllocator = ropewalk_peers::CountingAllocator;

fn main() -> ExitCode {
    panic::silence();
    match panic::catch(run) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            // Nobody may be listening; there is nothing else to tell it to.
            let _ = writeln!(std::io::stderr(), "ropewalk: {}", failure.message());
            failure.exit_code()
        }
    }
}

fn run() -> Result<(), Failure> {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) => {
            // With colours where standard output takes them. Of a closed pipe nothing needs to be said.
            let _ = error.print();
            return Ok(());
        }
        Err(error) => return Err(error.into()),
    };
    match cli.command {
        None => commands::welcome::run(),
        Some(Command::Render(arguments)) => commands::render::run(&arguments),
        Some(Command::Trace(arguments)) => commands::trace::run(&arguments),
        Some(Command::Points(arguments)) => commands::points::run(&arguments),
        Some(Command::Info(arguments)) => commands::info::run(&arguments),
        Some(Command::List(arguments)) => commands::list::run(&arguments),
        Some(Command::Verify(arguments)) => commands::verify::run(&arguments),
        Some(Command::Bench(arguments)) => commands::bench::run(&arguments),
        Some(Command::Lab(arguments)) => commands::lab::run(&arguments),
    }
}
