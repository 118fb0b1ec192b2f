//! `ropewalk bench`: build times and rays a second, measured by `ropewalk-lab` and printed here.

mod peers;
mod report;

use crate::device_argument;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::scene_argument::{DEFAULT_SCENE, SceneArgument, scene_help};
use crate::threads::MOST_THREADS;
use crate::{interrupt, output};
use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};
use glam::Vec3;
use ropewalk::catalogue::{self, StackMemory, TrailOptions, TrailRegister};
use ropewalk::{Query, StructureSpec, Walk};
use ropewalk_gpu::{Device, DeviceChoice};
use ropewalk_lab::Machine;
use ropewalk_lab::bench::{BenchError, BenchSettings, SceneRecord, View, bench};
use ropewalk_render::{CameraChoice, RenderError};
use ropewalk_scene::Model;
use serde::Serialize;
use std::str::FromStr;

const EXAMPLES: &str = "\
Rates are millions of rays a second: medians of the rounds. Every answer is
compared with the reference's before anything is timed.

Rays: primary rays of a camera; from what it sees, shadow rays to a light,
ambient occlusion rays a tenth of the scene long, diffuse bounces in the
camera's order and shuffled; and random rays. Shadow and ambient occlusion ask
for any hit, the others for the closest.

Examples:
  ropewalk bench
  ropewalk bench bunny.ply sponza.obj --walk all --threads 1
  ropewalk bench room.obj --camera look:eye=0/2/5,target=0/1/0
  ropewalk bench scene.glb --device cpu --device gpu --json > record.json
  ropewalk bench --peers bunny.ply rotated:room.obj mixed:room.obj+dragon.ply";

/// The arguments of `ropewalk bench`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[arg(value_name = "SCENE", help = scene_help(), default_value = DEFAULT_SCENE)]
    #[arg(value_parser = OsStringValueParser::new().map(SceneArgument::from))]
    scenes: Vec<SceneArgument>,
    /// What is built; see `ropewalk list`
    #[arg(long, value_name = "NAME[:key=value,...]", default_value_t)]
    structure: StructureSpec,
    /// How rays go through it; all measures one walk of each kind; may be given several times; by default the best for
    /// the structure
    #[arg(long, value_name = "WALK|all")]
    walk: Vec<Walks>,
    /// Where to trace: cpu, gpu, gpu:NUMBER or gpu:PART-OF-A-NAME; may be given several times; by default
    /// the CPU, and the graphics card where there is one
    #[arg(long, value_name = "DEVICE")]
    device: Vec<DeviceChoice>,
    /// Threads of the CPU; may be given several times; by default 1, and all of them
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    threads: Vec<u16>,
    /// How often everything is measured
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u16).range(1..=1000))]
    rounds: u16,
    /// Rays a class; by default 262144, and with --peers 1048576
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    rays: Option<u32>,
    /// From where primary rays come: auto (the file's first camera, else from outside) or
    /// look:eye=X/Y/Z,target=X/Y/Z[,fov=DEG]
    #[arg(long, value_name = "CAMERA", default_value = "auto")]
    camera: Viewpoint,
    /// What the rays are made from: the same number, the same rays
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    peers: peers::Arguments,
}

/// Rays a class, where nobody says how many.
const DEFAULT_RAYS: u32 = 1 << 18;

/// From where primary rays come.
#[derive(Clone, Copy, Debug)]
enum Viewpoint {
    Automatic,
    Look(View),
}

impl FromStr for Viewpoint {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.parse().map_err(|error: RenderError| error.to_string())? {
            CameraChoice::Automatic => Ok(Self::Automatic),
            CameraChoice::Look { eye, target, vertical_fov, .. } => {
                Ok(Self::Look(view(eye, target, vertical_fov.unwrap_or(DEFAULT_FOV_DEGREES.to_radians()))))
            }
            _ => Err("here it can be auto or look:eye=X/Y/Z,target=X/Y/Z[,fov=DEG]".into()),
        }
    }
}

impl Viewpoint {
    fn view(self, model: &Model) -> Option<View> {
        match self {
            Self::Look(view) => Some(view),
            Self::Automatic => model
                .cameras
                .first()
                .map(|camera| view(camera.position, camera.position + camera.forward, camera.vertical_fov)),
        }
    }
}

/// Wide enough for rooms.
const DEFAULT_FOV_DEGREES: f32 = 60.0;

fn view(eye: Vec3, target: Vec3, vertical_fov: f32) -> View {
    View::look_at(eye, target, f64::from(vertical_fov / 2.0).tan())
}

/// One walk or all that use the hierarchy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Walks {
    One(Walk),
    All,
}

impl FromStr for Walks {
    type Err = ropewalk::CatalogueError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "all" { Ok(Self::All) } else { text.parse().map(Self::One) }
    }
}

impl std::fmt::Display for Walks {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::One(walk) => walk.fmt(formatter),
            Self::All => formatter.pad("all"),
        }
    }
}

impl Walks {
    fn each(self) -> Vec<Walk> {
        match self {
            Self::One(walk) => vec![walk],
            Self::All => Walk::EVERY.into_iter().filter(|&walk| is_worth_measuring(walk)).collect(),
        }
    }
}

/// What `--walk all` measures: one walk for each thing that a choice is about.
fn is_worth_measuring(walk: Walk) -> bool {
    match walk {
        // Over a large scene it takes hours, and its rate is known beforehand.
        Walk::BruteForce => false,
        // Sizes that differ. The smallest register that serves a tree is the fastest; beyond 8 entries nothing is
        // dropped any more; of the memories of a GPU one size tells.
        Walk::RestartTrail(TrailOptions { short_stack, register, memory }) => {
            let sizes: &[u32] = match memory {
                StackMemory::Private => &[0, 1, 4, 8],
                StackMemory::Workgroup => &[4],
            };
            register == TrailRegister::Auto && sizes.contains(&short_stack)
        }
        Walk::Recursive
        | Walk::Stack(_)
        | Walk::List
        | Walk::KdRestart
        | Walk::KdBacktrack
        | Walk::ShortStack { .. }
        | Walk::Ropes
        | Walk::SmartStack { .. } => true,
    }
}

#[derive(Debug, Serialize)]
struct Document {
    machine: Machine,
    rays: u32,
    seed: u64,
    scenes: Vec<SceneRecord>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.peers.peers {
        return peers::run(arguments);
    }
    arguments.scenes.iter().try_for_each(SceneArgument::check)?;
    let machine = Machine::here();
    let settings = arguments.settings(machine.threads)?;
    check_walks(&settings)?;
    if !machine.optimized {
        output::note("this is a debug build: its times mean little; build with --release");
    }
    interrupt::listen()?;
    if !arguments.json {
        output::print(&report::heading(&machine, arguments, &settings.devices))?;
    }
    let mut scenes = Vec::new();
    for argument in &arguments.scenes {
        if interrupt::requested() {
            break;
        }
        let scene = argument.load()?;
        scene.note_defects();
        let progress = Progress::bar(argument.to_string());
        let watch = |step: ropewalk_lab::bench::Progress<'_>| {
            progress.label(format!("{argument}: {}", step.what));
            progress.step(step.done, step.total)
        };
        let settings = BenchSettings { view: arguments.camera.view(&scene.model), ..settings.clone() };
        let measured = bench(&argument.to_string(), &scene.model.scene, &settings, &watch);
        drop(progress);
        match measured {
            Ok(record) => {
                if !arguments.json {
                    output::print(&report::scene(&record))?;
                }
                scenes.push(record);
            }
            Err(BenchError::Stopped) => break,
            Err(error) => return Err(failure(argument, error)),
        }
    }
    let verdict = verdict(arguments, &scenes);
    if arguments.json {
        output::print_json(&Document { machine, rays: arguments.rays(), seed: arguments.seed, scenes })?;
    }
    verdict
}

impl Arguments {
    fn rays(&self) -> u32 {
        self.rays.unwrap_or(DEFAULT_RAYS)
    }

    fn settings(&self, all_threads: usize) -> Result<BenchSettings, Failure> {
        let mut walks: Vec<Walk> = Vec::new();
        let plain = [Walks::One(self.structure.kind().default_walk())];
        let asked = if self.walk.is_empty() { &plain[..] } else { &self.walk };
        for walk in asked.iter().flat_map(|walks| walks.each()) {
            if !walks.contains(&walk) {
                walks.push(walk);
            }
        }
        let threads = self.thread_counts(all_threads);
        Ok(BenchSettings {
            structure: self.structure,
            walks,
            devices: self.devices()?,
            threads,
            rounds: self.rounds.into(),
            rays: self.rays() as usize,
            seed: self.seed,
            view: None,
        })
    }

    /// In rising order, each once.
    fn thread_counts(&self, all: usize) -> Vec<usize> {
        let mut threads: Vec<usize> = match &self.threads[..] {
            [] => vec![1, all],
            given => given.iter().copied().map(usize::from).collect(),
        };
        threads.sort_unstable();
        threads.dedup();
        threads
    }

    fn devices(&self) -> Result<Vec<Device>, Failure> {
        let plain = [DeviceChoice::Cpu, DeviceChoice::Auto];
        let choices = if self.device.is_empty() { &plain[..] } else { &self.device };
        device_argument::open_each(choices)
    }
}

/// A device without any of the walks would be left out of the table without a word.
fn check_walks(settings: &BenchSettings) -> Result<(), Failure> {
    for device in &settings.devices {
        let checks = || {
            settings
                .walks
                .iter()
                .map(|&walk| catalogue::check(settings.structure.kind(), walk, Query::Closest, device.kind()))
        };
        if checks().all(|check| check.is_err()) {
            checks().try_for_each(|check| check)?;
        }
    }
    Ok(())
}

fn failure(scene: &SceneArgument, error: BenchError) -> Failure {
    match error {
        BenchError::Build(error @ ropewalk::BuildError::Option { .. }) => error.into(),
        BenchError::Gpu(error) => error.into(),
        other => Failure::failed(format!("{scene}: {other}")),
    }
}

fn verdict(arguments: &Arguments, scenes: &[SceneRecord]) -> Result<(), Failure> {
    let wrong: Vec<String> = scenes
        .iter()
        .flat_map(|scene| scene.lanes.iter().map(move |lane| (scene, lane)))
        .flat_map(|(scene, lane)| {
            lane.agreement.failed.iter().map(move |failed| {
                format!(
                    "{}: {} on {}: {} rays: {}",
                    scene.scene, lane.walk, lane.device, failed.class, failed.what
                )
            })
        })
        .collect();
    if let Some(first) = wrong.first() {
        return Err(Failure::failed(format!("{} batches have wrong answers: {first}", wrong.len())));
    }
    if interrupt::requested() {
        let rounds: usize = scenes.iter().map(|scene| scene.rounds).sum();
        let wanted = usize::from(arguments.rounds) * arguments.scenes.len();
        return Err(Failure::failed(format!(
            "stopped by ctrl-C after {rounds} of {wanted} rounds, which are kept"
        )));
    }
    Ok(())
}
