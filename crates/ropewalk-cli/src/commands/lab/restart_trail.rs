//! `ropewalk lab restart-trail`: visits and rates of short stacks, measured by `ropewalk-lab` and written here.

use super::common::{CommonArguments, Findings, Plot, TreeArguments, unique_or};
use crate::failure::Failure;
use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use ropewalk::catalogue::TrailOptions;
use ropewalk_lab::restart_trail::{
    Seen, TrailRow, TrailSettings, markdown, plot, run as compare, with_ground, write_csv,
};
use ropewalk_testkit::rays::RayClass;
use serde::Serialize;
use std::io::{self, Write};

const EXAMPLES: &str = "\
Counts are means a ray and the same on every machine; ratios are to the full
stack on the same tree and rays. Every answer is compared with the full stack's
before it counts. Rates are medians of the rounds; --rounds 0 leaves them out.

Examples:
  ropewalk lab restart-trail bunny.ply -o bunny
  ropewalk lab restart-trail room.obj hall.obj --views within --rounds 0
  ropewalk lab restart-trail builtin:forest --device cpu --device gpu --json
  ropewalk lab restart-trail bunny.ply --ground --builder sweep --leaf-cap 8
  ropewalk lab restart-trail room.obj --views within --no-culling-at-pop

With -o the folder gets restart-trail.json, .csv, .md and .svg.";

/// The arguments of `ropewalk lab restart-trail`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    #[command(flatten)]
    common: CommonArguments,
    #[command(flatten)]
    trees: TreeArguments,
    /// Entries of the short stack; may be given several times; by default 0, 1, 2, 3, 4, 5 and 8
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=i64::from(TrailOptions::MAX_SHORT_STACK)))]
    short_stack: Vec<u32>,
    /// The class of the rays; may be given several times; by default primary, ambient-occlusion, diffuse and shadow
    #[arg(long = "class", value_name = "CLASS")]
    #[arg(value_parser = PossibleValuesParser::new(RayClass::MEASURED.map(RayClass::name)))]
    classes: Vec<String>,
    /// Rays a class, over all views
    #[arg(long, value_name = "N", default_value_t = 6 * 144 * 144, value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    rays: u32,
    /// From where the scene is seen
    #[arg(long, value_name = "VIEWS", default_value = "around")]
    views: Views,
    /// Put a ground of two triangles under the scene
    #[arg(long)]
    ground: bool,
    /// Do not cull entries again when they are popped, as the paper has it: counts only, on the CPU
    #[arg(long, conflicts_with = "device")]
    no_culling_at_pop: bool,
}

/// From where the scene is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Views {
    /// From six places around, each with all of it in sight
    Around,
    /// From the middle of its box in six directions: for rooms
    Within,
}

#[derive(Debug, Default, Serialize)]
struct Rows {
    rows: Vec<TrailRow>,
}

impl Findings for Rows {
    const NAME: &'static str = "restart-trail";
    const TITLE: &'static str = "The restart trail against the full stack";
    const PLOT: Option<Plot<Self>> = Some(|found| plot(&found.rows).map_err(Failure::failed));

    fn add(&mut self, more: Self) {
        self.rows.extend(more.rows);
    }

    fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    fn markdown(&self) -> String {
        markdown(&self.rows)
    }

    fn write_csv(&self, writer: &mut dyn Write) -> io::Result<()> {
        write_csv(&self.rows, writer)
    }
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.common.check()?;
    let settings = arguments.settings()?;
    arguments.common.run(|name, scene, watch| {
        let scene = if arguments.ground { with_ground(scene) } else { scene };
        compare(name, &scene, &settings, watch).map(|rows| Rows { rows })
    })
}

impl Arguments {
    fn settings(&self) -> Result<TrailSettings, Failure> {
        let plain = TrailSettings::new();
        let classes: Vec<RayClass> = RayClass::MEASURED
            .into_iter()
            .filter(|class| self.classes.iter().any(|name| name == class.name()))
            .collect();
        Ok(TrailSettings {
            trees: self.trees.settings(),
            short_stacks: unique_or(&self.short_stack, plain.short_stacks),
            classes: if classes.is_empty() { plain.classes } else { classes },
            rays: self.rays as usize,
            seen: match self.views {
                Views::Around => Seen::Around,
                Views::Within => Seen::Within,
            },
            devices: self.common.devices()?,
            rounds: self.common.rounds(),
            culls_at_pop: !self.no_culling_at_pop,
        })
    }
}
