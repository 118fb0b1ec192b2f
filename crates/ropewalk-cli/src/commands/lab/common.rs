//! What the experiments have in common: scenes, trees, devices and rounds on the command line; scene after scene; and
//! the files and texts of the result.

use crate::device_argument;
use crate::failure::Failure;
use crate::interrupt;
use crate::output::{self, OutputFile};
use crate::progress::Progress;
use crate::scene_argument::{DEFAULT_SCENE, SceneArgument, scene_help};
use crate::threads::{self, MOST_THREADS};
use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};
use ropewalk::{BuildError, BuildOptions, Builder, CatalogueError, Scene};
use ropewalk_gpu::{Device, DeviceChoice};
use ropewalk_lab::Machine;
use ropewalk_lab::bench::Watch;
use ropewalk_lab::comparison::{ComparisonError, TreeSettings};
use ropewalk_scene::Model;
use serde::Serialize;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The arguments that every experiment has.
#[derive(Args, Debug)]
pub(super) struct CommonArguments {
    #[arg(value_name = "SCENE", help = scene_help(), default_value = DEFAULT_SCENE)]
    #[arg(value_parser = OsStringValueParser::new().map(SceneArgument::from))]
    scenes: Vec<SceneArgument>,
    /// The folder for the tables and plots; it is made if it is not there
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Where to walk: cpu, gpu, gpu:NUMBER or gpu:PART-OF-A-NAME; may be given several times; by default the CPU
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

/// Which trees are walked, for experiments on trees.
#[derive(Args, Debug)]
pub(super) struct TreeArguments {
    /// What makes the trees: binned, sweep or sbvh; may be given several times; by default sweep and sbvh
    #[arg(long, value_name = "BUILDER", value_parser = builder)]
    builder: Vec<Builder>,
    /// Percent of references that sbvh may add
    #[arg(long, value_name = "PERCENT", default_value_t = BuildOptions::default().duplication)]
    duplication: u32,
    /// Triangles a leaf may have; may be given several times; by default 1, 4 and 8
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=255))]
    leaf_cap: Vec<u32>,
}

impl TreeArguments {
    /// Which trees are meant.
    pub(super) fn settings(&self) -> TreeSettings {
        let plain = TreeSettings::default();
        TreeSettings {
            builders: unique_or(&self.builder, plain.builders),
            leaf_caps: unique_or(&self.leaf_cap, plain.leaf_caps),
            duplication: self.duplication,
        }
    }
}

fn builder(text: &str) -> Result<Builder, CatalogueError> {
    Builder::NAMES.iter().find(|(name, _)| *name == text).map(|(_, builder)| *builder).ok_or_else(|| {
        let names: Vec<&str> = Builder::NAMES.iter().map(|(name, _)| *name).collect();
        CatalogueError(format!("there is no builder '{text}'; there is {}", names.join(", ")))
    })
}

/// Draws what was found out, as SVG.
pub(super) type Plot<F> = fn(&F) -> Result<String, Failure>;

/// What an experiment finds out of one scene, or of several.
pub(super) trait Findings: Default + Serialize + Send {
    /// The name of its files, without their endings.
    const NAME: &'static str;
    /// What stands above its tables.
    const TITLE: &'static str;
    /// What draws it, if anything does.
    const PLOT: Option<Plot<Self>>;

    /// Takes those of the next scene.
    fn add(&mut self, more: Self);
    /// Whether nothing was found out.
    fn is_empty(&self) -> bool;
    /// Its tables.
    fn markdown(&self) -> String;
    /// Its rows.
    fn write_csv(&self, writer: &mut dyn Write) -> io::Result<()>;
    /// Writes what else there is into the folder, such as pictures.
    fn write_more(&self, _folder: &Path) -> Result<(), Failure> {
        Ok(())
    }
}

#[derive(Debug, Serialize)]
struct Document<F> {
    machine: Machine,
    command: String,
    #[serde(flatten)]
    findings: F,
}

impl CommonArguments {
    /// Finds out what can be found out before any device is opened: whether the scenes are there.
    pub(super) fn check(&self) -> Result<(), Failure> {
        self.scenes.iter().try_for_each(SceneArgument::check)
    }

    /// Opens the devices.
    pub(super) fn devices(&self) -> Result<Vec<Device>, Failure> {
        if self.device.is_empty() {
            return Ok(vec![Device::Cpu]);
        }
        device_argument::open_each(&self.device)
    }

    /// How often each walk is timed.
    pub(super) fn rounds(&self) -> usize {
        self.rounds.into()
    }

    /// Runs the experiment on scene after scene, and prints and writes what it finds out.
    pub(super) fn run<F: Findings>(
        &self,
        experiment: impl Fn(&str, Scene, &Watch<'_>) -> Result<F, ComparisonError> + Sync,
    ) -> Result<(), Failure> {
        self.run_models(|name, model, watch| {
            experiment(name, model.scene, watch).map_err(|error| not_compared(name, error))
        })
    }

    /// The same for an experiment that needs to know more of the model than its triangles.
    pub(super) fn run_models<F: Findings>(
        &self,
        experiment: impl Fn(&str, Model, &Watch<'_>) -> Result<F, Failure> + Sync,
    ) -> Result<(), Failure> {
        let machine = Machine::here();
        let files = self.output.as_deref().map(Files::new::<F>).transpose()?;
        if !machine.optimized && self.rounds > 0 {
            output::note(
                "this is a debug build: its times mean little; build with --release, or count with --rounds 0",
            );
        }
        interrupt::listen()?;
        let mut findings = F::default();
        let mut failure = None;
        for scene in unique(&self.scenes) {
            match threads::run(self.threads, || try_scene(&scene, &experiment)) {
                Ok(more) => findings.add(more),
                // What is finished is kept.
                Err(error) => {
                    failure = Some(error);
                    break;
                }
            }
        }
        let document = Document { machine, command: command_line(), findings };
        let is_empty = document.findings.is_empty();
        if let Some(files) = files.filter(|_| !is_empty) {
            files.write(&document)?;
        }
        // A run that failed before anything was finished has nothing to print.
        if failure.is_none() || !is_empty {
            if self.json {
                output::print_json(&document)?;
            } else {
                output::print(&text(&document))?;
            }
        }
        failure.map_or(Ok(()), Err)
    }
}

fn try_scene<F: Findings>(
    argument: &SceneArgument,
    experiment: impl Fn(&str, Model, &Watch<'_>) -> Result<F, Failure>,
) -> Result<F, Failure> {
    let loaded = argument.load()?;
    loaded.note_defects();
    let name = argument.to_string();
    let progress = Progress::bar(name.as_str());
    let watch = |step: ropewalk_lab::bench::Progress<'_>| {
        progress.label(format!("{name}: {}", step.what));
        progress.step(step.done, step.total)
    };
    experiment(&name, loaded.model, &watch)
}

/// Why there is no comparison of a scene.
pub(super) fn not_compared(name: &str, error: ComparisonError) -> Failure {
    match error {
        ComparisonError::Build(error @ BuildError::Option { .. }) => error.into(),
        ComparisonError::Gpu(error) => error.into(),
        ComparisonError::Render(error) => error.into(),
        ComparisonError::Stopped => {
            Failure::failed(format!("{name}: stopped by ctrl-C: the scenes before are kept"))
        }
        other => Failure::failed(format!("{name}: {other}")),
    }
}

/// Each once, in the order of the first mention.
fn unique<T: Clone + PartialEq>(given: &[T]) -> Vec<T> {
    let mut each: Vec<T> = Vec::new();
    for one in given {
        if !each.contains(one) {
            each.push(one.clone());
        }
    }
    each
}

/// The same, or what is meant where none is given.
pub(super) fn unique_or<T: Clone + PartialEq>(given: &[T], plain: Vec<T>) -> Vec<T> {
    if given.is_empty() { plain } else { unique(given) }
}

/// The command as it was given, the program's folder left out.
fn command_line() -> String {
    let words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    std::iter::once("ropewalk".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

fn text<F: Findings>(document: &Document<F>) -> String {
    let Machine { cpu, threads, system, ropewalk, commit, date, .. } = &document.machine;
    let (title, command) = (F::TITLE, &document.command);
    format!(
        "# {title}\n\n`{command}`\n\n{cpu}, {threads} threads, {system}; ropewalk {ropewalk} ({commit}), {date}\n\n{}",
        document.findings.markdown()
    )
}

/// What goes into the folder.
struct Files {
    folder: PathBuf,
    json: OutputFile,
    csv: OutputFile,
    markdown: OutputFile,
    plot: Option<OutputFile>,
}

impl Files {
    /// Makes the folder and checks that the files can be written, before any work is done for them.
    fn new<F: Findings>(folder: &Path) -> Result<Self, Failure> {
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::failed(format!("{}: cannot be made: {error}", folder.display())))?;
        let file = |ending: &str| OutputFile::new(&folder.join(format!("{}.{ending}", F::NAME)));
        let plot = F::PLOT.map(|_| file("svg")).transpose()?;
        Ok(Self {
            folder: folder.into(),
            json: file("json")?,
            csv: file("csv")?,
            markdown: file("md")?,
            plot,
        })
    }

    fn write<F: Findings>(&self, document: &Document<F>) -> Result<(), Failure> {
        let json = serde_json::to_string_pretty(document)
            .map_err(|error| Failure::failed(format!("the result has no JSON form: {error}")))?;
        let plot = F::PLOT.map(|plot| plot(&document.findings)).transpose()?;
        self.json.write(|writer| writeln!(writer, "{json}"))?;
        self.csv.write(|writer| document.findings.write_csv(writer))?;
        self.markdown.write(|writer| writer.write_all(text(document).as_bytes()))?;
        if let (Some(file), Some(plot)) = (&self.plot, plot) {
            file.write(|writer| writer.write_all(plot.as_bytes()))?;
        }
        document.findings.write_more(&self.folder)
    }
}
