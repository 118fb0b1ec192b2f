//! `ropewalk lab traversal-lists`: elements a ray and frames a second of traversal lists, found out by `ropewalk-lab` and
//! written here.

use super::common::{CommonArguments, Findings, Plot};
use crate::failure::Failure;
use clap::Args;
use clap::builder::PossibleValuesParser;
use ropewalk::ListOptions;
use ropewalk_lab::traversal_lists::{
    ListComparison, ListSettings, Table, markdown, plot, run as compare, write_csv,
};
use std::io::{self, Write};

const EXAMPLES: &str = "\
Each scene stands on a ground of two triangles, which takes the place of one that
it has, and is seen from six places around it. Counts are means a ray and the same
on every machine. Every answer is compared with the ordered stack's, of triangles
with two sides or with one, before it counts. Frames are timed in rounds;
--rounds 0 leaves them out.

Tables:
  columns     1, 2, 6 and 8 lists, without options and with all, of spheres that
              hold boxes and of spheres that hold vertices alone
  table-1     the paper's Table 1: order, culling, heads and frustum culling
  as-printed  the paper's rule of culling, with the hits that it loses
  best        the best lists, and the same tree walked in other ways

Examples:
  ropewalk lab traversal-lists bunny.ply -o bunny
  ropewalk lab traversal-lists bunny.ply dragon.ply --table columns --rounds 0
  ropewalk lab traversal-lists builtin:cubes --frame 512 --json

With -o the folder gets traversal-lists.json, .csv, .md and .svg.";

/// The arguments of `ropewalk lab traversal-lists`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    #[command(flatten)]
    common: CommonArguments,
    /// The table to make; may be given several times; by default all
    #[arg(long = "table", value_name = "TABLE")]
    #[arg(value_parser = PossibleValuesParser::new(Table::EVERY.map(Table::name)))]
    tables: Vec<String>,
    /// Pixels a side of the six views in which elements are counted
    #[arg(long, value_name = "PIXELS", default_value_t = 144, value_parser = clap::value_parser!(u16).range(1..=512))]
    view: u16,
    /// Pixels a side of the frame that is timed
    #[arg(long, value_name = "PIXELS", default_value_t = 1024, value_parser = clap::value_parser!(u16).range(1..=2048))]
    frame: u16,
    /// Cells a side of the screen where frustums are culled
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=i64::from(ListOptions::MOST_FRUSTUM_GRID)))]
    frustum_grid: u32,
    /// Millions of tests of triangles by which brute force confirms the answers of each part of the rays
    #[arg(long, value_name = "MILLIONS", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    brute_force: u32,
}

impl Findings for ListComparison {
    const NAME: &'static str = "traversal-lists";
    const TITLE: &'static str = "Traversal lists, option by option";
    const PLOT: Option<Plot<Self>> = Some(|found| plot(&found.rows).map_err(Failure::failed));

    fn add(&mut self, more: Self) {
        self.scenes.extend(more.scenes);
        self.rows.extend(more.rows);
        self.copies.extend(more.copies);
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
    arguments.common.run(|name, scene, watch| compare(name, scene, &settings, watch))
}

impl Arguments {
    fn settings(&self) -> Result<ListSettings, Failure> {
        let is_asked =
            |table: &Table| self.tables.is_empty() || self.tables.iter().any(|name| name == table.name());
        Ok(ListSettings {
            tables: Table::EVERY.into_iter().filter(is_asked).collect(),
            side: self.view.into(),
            grid: self.frustum_grid,
            frame: self.frame.into(),
            brute_force: (self.brute_force as usize).saturating_mul(1_000_000),
            devices: self.common.devices()?,
            rounds: self.common.rounds(),
        })
    }
}
