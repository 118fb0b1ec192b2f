//! `ropewalk lab reichl-table2`: frames a second of two levels beside one, found out by `ropewalk-lab`; the camera and the files are
//! chosen here.

use super::common::{CommonArguments, Findings, Plot, not_compared};
use crate::failure::Failure;
use crate::output::OutputFile;
use clap::Args;
use ropewalk_lab::reichl_table2::{
    ReichlTable2Findings, ReichlTable2Settings, markdown, run as compare, write_csv, write_primary_csv,
};
use ropewalk_render::{CameraChoice, Ground, Stage, StageOptions};
use std::io::{self, Write};
use std::path::Path;

const EXAMPLES: &str = "\
A picture is rendered by a tree of rays in four configurations: primary hits shaded
alone, with shadows, with reflections, and with everything five bounces deep; with
one kd-tree over the scene and with two levels of kd-trees. Primary hits are drawn,
as in the paper; a table of its own has them beside traced ones. The pictures of
both structures are held against each other before any is timed. What their walks
do is counted, the same on every machine.

Robots, kitchens, chess sets and cars are put beside the paper's figures.

Examples:
  ropewalk lab reichl-table2 Robot.aff kitchen.aff chess34.glb car.glb -o table2
  ropewalk lab reichl-table2 Robot.aff --device cpu --device gpu --json
  ropewalk lab reichl-table2 engine.glb --size 128 --rounds 0

With -o the folder gets reichl-table2.json, .csv and .md, and
reichl-table2-primary.csv.";

/// The arguments of `ropewalk lab reichl-table2`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    #[command(flatten)]
    common: CommonArguments,
    /// Pixels a side of the picture
    #[arg(long, value_name = "PIXELS", default_value_t = 512, value_parser = clap::value_parser!(u16).range(1..=4096))]
    size: u16,
    /// From where: auto (the file's first camera, else from outside), frame:..., inside:..., look:..., or a camera of the
    /// file, as for render
    #[arg(long, value_name = "CAMERA", default_value = "auto")]
    camera: CameraChoice,
}

impl Findings for ReichlTable2Findings {
    const NAME: &'static str = "reichl-table2";
    const TITLE: &'static str = "Frames a second of two levels beside one";
    const PLOT: Option<Plot<Self>> = None;

    fn add(&mut self, more: Self) {
        self.scenes.extend(more.scenes);
        self.rows.extend(more.rows);
        self.primary.extend(more.primary);
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

    fn write_more(&self, folder: &Path) -> Result<(), Failure> {
        OutputFile::new(&folder.join("reichl-table2-primary.csv"))?
            .write(|writer| write_primary_csv(&self.primary, writer))
    }
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let common = &arguments.common;
    common.check()?;
    let settings = ReichlTable2Settings {
        size: arguments.size.into(),
        camera: arguments.camera.clone(),
        devices: common.devices()?,
        rounds: common.rounds(),
    };
    common.run_models(|name, model, watch| {
        // A ground of ours would be an object more than the paper's scenes have.
        let stage = Stage::new(model, &StageOptions { ground: Ground::Off, ..StageOptions::default() });
        compare(name, &stage, &settings, watch).map_err(|error| not_compared(name, error))
    })
}
