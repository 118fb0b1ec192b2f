//! `ropewalk lab restart-trail`: visits and rates of short stacks, measured by `ropewalk-lab` and written here.

use crate::device_argument;
use crate::failure::Failure;
use crate::interrupt;
use crate::output::{self, OutputFile};
use crate::progress::Progress;
use crate::scene_argument::{DEFAULT_SCENE, SceneArgument, scene_help};
use crate::threads::{self, MOST_THREADS};
use clap::builder::{OsStringValueParser, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use ropewalk::catalogue::TrailOptions;
use ropewalk::{BuildOptions, Builder, CatalogueError};
use ropewalk_gpu::{Device, DeviceChoice};
use ropewalk_lab::Machine;
use ropewalk_lab::restart_trail::{
    Seen, TrailError, TrailRow, TrailSettings, markdown, plot, run as compare, with_ground, write_csv,
};
use ropewalk_testkit::rays::RayClass;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Counts are means a ray and the same on every machine; ratios are to the full
stack on the same tree and rays. Every answer is compared with the full stack's
before it counts. Rates are medians of the rounds; --rounds 0 leaves them out.

Examples:
  ropewalk lab restart-trail bunny.ply -o bunny
  ropewalk lab restart-trail room.obj hall.obj --views within --rounds 0
  ropewalk lab restart-trail builtin:forest --device cpu --device gpu --json
  ropewalk lab restart-trail bunny.ply --ground --builder sweep --leaf-cap 8

With -o the folder gets restart-trail.json, .csv, .md and .svg.";

/// The arguments of `ropewalk lab restart-trail`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    #[arg(value_name = "SCENE", help = scene_help(), default_value = DEFAULT_SCENE)]
    #[arg(value_parser = OsStringValueParser::new().map(SceneArgument::from))]
    scenes: Vec<SceneArgument>,
    /// The folder for the tables and the plot; it is made if it is not there
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// What makes the trees: binned, sweep or sbvh; may be given several times; by default sweep and sbvh
    #[arg(long, value_name = "BUILDER", value_parser = builder)]
    builder: Vec<Builder>,
    /// Percent of references that sbvh may add
    #[arg(long, value_name = "PERCENT", default_value_t = BuildOptions::default().duplication)]
    duplication: u32,
    /// Triangles a leaf may have; may be given several times; by default 1, 4 and 8
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=255))]
    leaf_cap: Vec<u32>,
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
    /// Where to trace: cpu, gpu, gpu:NUMBER or gpu:PART-OF-A-NAME; may be given several times; by default the CPU
    #[arg(long, value_name = "DEVICE")]
    device: Vec<DeviceChoice>,
    /// Threads of the CPU; all of them by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    threads: Option<u16>,
    /// How often each walk is timed; 0 only counts
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(0..=1000))]
    rounds: u16,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

/// From where the scene is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Views {
    /// From six places around, each with all of it in sight
    Around,
    /// From the middle of its box in six directions: for rooms
    Within,
}

fn builder(text: &str) -> Result<Builder, CatalogueError> {
    Builder::NAMES.iter().find(|(name, _)| *name == text).map(|(_, builder)| *builder).ok_or_else(|| {
        let names: Vec<&str> = Builder::NAMES.iter().map(|(name, _)| *name).collect();
        CatalogueError(format!("there is no builder '{text}'; there is {}", names.join(", ")))
    })
}

#[derive(Debug, Serialize)]
struct Document {
    machine: Machine,
    command: String,
    rows: Vec<TrailRow>,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.scenes.iter().try_for_each(SceneArgument::check)?;
    let machine = Machine::here();
    let settings = arguments.settings()?;
    let files = arguments.output.as_deref().map(Files::new).transpose()?;
    if !machine.optimized && settings.rounds > 0 {
        output::note(
            "this is a debug build: its times mean little; build with --release, or count with --rounds 0",
        );
    }
    interrupt::listen()?;
    let mut rows = Vec::new();
    let mut failure = None;
    for argument in &arguments.scenes {
        match threads::run(arguments.threads, || compare_scene(argument, arguments, &settings)) {
            Ok(more) => rows.extend(more),
            // What is finished is kept.
            Err(error) => {
                failure = Some(error);
                break;
            }
        }
    }
    let document = Document { machine, command: command_line(), rows };
    if let Some(files) = files.filter(|_| !document.rows.is_empty()) {
        files.write(&document)?;
    }
    // A run that failed before anything was finished has nothing to print.
    if failure.is_none() || !document.rows.is_empty() {
        if arguments.json {
            output::print_json(&document)?;
        } else {
            output::print(&text(&document))?;
        }
    }
    failure.map_or(Ok(()), Err)
}

fn compare_scene(
    argument: &SceneArgument,
    arguments: &Arguments,
    settings: &TrailSettings,
) -> Result<Vec<TrailRow>, Failure> {
    let loaded = argument.load()?;
    loaded.note_defects();
    let scene = if arguments.ground { with_ground(loaded.model.scene) } else { loaded.model.scene };
    let progress = Progress::bar(argument.to_string());
    let watch = |step: ropewalk_lab::bench::Progress<'_>| {
        progress.label(format!("{argument}: {}", step.what));
        progress.step(step.done, step.total)
    };
    compare(&argument.to_string(), &scene, settings, &watch).map_err(|error| match error {
        TrailError::Build(error @ ropewalk::BuildError::Option { .. }) => error.into(),
        TrailError::Gpu(error) => error.into(),
        TrailError::Stopped => {
            Failure::failed(format!("{argument}: stopped by ctrl-C: the scenes before are kept"))
        }
        other => Failure::failed(format!("{argument}: {other}")),
    })
}

impl Arguments {
    fn settings(&self) -> Result<TrailSettings, Failure> {
        let plain = TrailSettings::new();
        let or = |given: &[u32], plain: Vec<u32>| if given.is_empty() { plain } else { unique(given) };
        let classes: Vec<RayClass> = RayClass::MEASURED
            .into_iter()
            .filter(|class| self.classes.iter().any(|name| name == class.name()))
            .collect();
        Ok(TrailSettings {
            builders: if self.builder.is_empty() { plain.builders } else { unique(&self.builder) },
            leaf_caps: or(&self.leaf_cap, plain.leaf_caps),
            duplication: self.duplication,
            short_stacks: or(&self.short_stack, plain.short_stacks),
            classes: if classes.is_empty() { plain.classes } else { classes },
            rays: self.rays as usize,
            seen: match self.views {
                Views::Around => Seen::Around,
                Views::Within => Seen::Within,
            },
            devices: self.devices()?,
            rounds: self.rounds.into(),
        })
    }

    fn devices(&self) -> Result<Vec<Device>, Failure> {
        if self.device.is_empty() {
            return Ok(vec![Device::Cpu]);
        }
        device_argument::open_each(&self.device)
    }
}

/// Each once, in the order of the first mention.
fn unique<T: Copy + PartialEq>(given: &[T]) -> Vec<T> {
    let mut each: Vec<T> = Vec::new();
    for &one in given {
        if !each.contains(&one) {
            each.push(one);
        }
    }
    each
}

/// The command as it was given, the program's folder left out.
fn command_line() -> String {
    let words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    std::iter::once("ropewalk".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

fn text(document: &Document) -> String {
    let Machine { cpu, threads, system, ropewalk, commit, date, .. } = &document.machine;
    let command = &document.command;
    format!(
        "# The restart trail against the full stack\n\n`{command}`\n\n{cpu}, {threads} threads, {system}; ropewalk {ropewalk} ({commit}), {date}\n\n{}",
        markdown(&document.rows)
    )
}

/// What goes into the folder.
struct Files {
    json: OutputFile,
    csv: OutputFile,
    markdown: OutputFile,
    plot: OutputFile,
}

impl Files {
    /// Makes the folder and checks that the files can be written, before any work is done for them.
    fn new(folder: &Path) -> Result<Self, Failure> {
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::failed(format!("{}: cannot be made: {error}", folder.display())))?;
        let file = |ending: &str| OutputFile::new(&folder.join(format!("restart-trail.{ending}")));
        Ok(Self { json: file("json")?, csv: file("csv")?, markdown: file("md")?, plot: file("svg")? })
    }

    fn write(&self, document: &Document) -> Result<(), Failure> {
        let json = serde_json::to_string_pretty(document)
            .map_err(|error| Failure::failed(format!("the result has no JSON form: {error}")))?;
        let plot = plot(&document.rows).map_err(Failure::failed)?;
        self.json.write(|writer| writeln!(writer, "{json}"))?;
        self.csv.write(|writer| write_csv(&document.rows, writer))?;
        self.markdown.write(|writer| writer.write_all(text(document).as_bytes()))?;
        self.plot.write(|writer| writer.write_all(plot.as_bytes()))
    }
}
