//! `ropewalk lab closest-point`: closest points held against brute force and an oracle, and what the walks to them cost,
//! found out by `ropewalk-lab` and written here.

use super::common::{CommonArguments, Findings, Plot, TreeArguments, unique_or};
use crate::failure::Failure;
use clap::Args;
use ropewalk::catalogue::TrailOptions;
use ropewalk_lab::closest_point::{PointComparison, PointSettings, markdown, run as compare, write_csv};
use std::io::{self, Write};

const EXAMPLES: &str = "\
Random points around each scene are answered by the full stack and by restart
trails. Every answer is checked by an oracle in f64, and by brute force to the
bit; the first wrong one ends the run with exit code 1. Counts are means a
point and the same on every machine; ratios are to the full stack on the same
tree. Brute force asks every triangle for every point: of large scenes it takes
minutes, and --brute-force bounds it.

Examples:
  ropewalk lab closest-point bunny.ply -o bunny
  ropewalk lab closest-point dragon.ply --brute-force 5000 --rounds 0
  ropewalk lab closest-point builtin:forest --device cpu --device gpu --json
  ropewalk lab closest-point bunny.ply --builder sbvh --leaf-cap 4 --seed 7

With -o the folder gets closest-point.json, .csv and .md.";

/// The arguments of `ropewalk lab closest-point`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    #[command(flatten)]
    common: CommonArguments,
    #[command(flatten)]
    trees: TreeArguments,
    /// Entries of the short stack; may be given several times; by default 0 and 4
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=i64::from(TrailOptions::MAX_SHORT_STACK)))]
    short_stack: Vec<u32>,
    /// Points around each scene
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    points: u32,
    /// What the points are made from: another number, other points
    #[arg(long, value_name = "N", default_value_t = PointSettings::new().seed, allow_negative_numbers = true)]
    seed: u64,
    /// How many of the points brute force answers too; all by default
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    brute_force: Option<u32>,
}

impl Findings for PointComparison {
    const NAME: &'static str = "closest-point";
    const TITLE: &'static str = "Closest points, with a stack and without";
    const PLOT: Option<Plot<Self>> = None;

    fn add(&mut self, more: Self) {
        self.scenes.extend(more.scenes);
        self.rows.extend(more.rows);
    }

    fn is_empty(&self) -> bool {
        self.scenes.is_empty()
    }

    fn markdown(&self) -> String {
        markdown(self)
    }

    fn write_csv(&self, writer: &mut dyn Write) -> io::Result<()> {
        write_csv(&self.rows, writer)
    }
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.common.check()?;
    let settings = arguments.settings()?;
    arguments.common.run(|name, scene, watch| compare(name, &scene, &settings, watch))
}

impl Arguments {
    fn settings(&self) -> Result<PointSettings, Failure> {
        Ok(PointSettings {
            trees: self.trees.settings(),
            short_stacks: unique_or(&self.short_stack, PointSettings::new().short_stacks),
            points: self.points as usize,
            seed: self.seed,
            brute_force: self.brute_force.map(|count| count as usize),
            devices: self.common.devices()?,
            rounds: self.common.rounds(),
        })
    }
}
