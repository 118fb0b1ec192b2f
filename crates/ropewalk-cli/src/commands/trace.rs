//! `ropewalk trace`: rays as data in, hits as data out.

use crate::arrays::hits_file;
use crate::arrays::rays_file::RaysFile;
use crate::arrays::rows::InvalidRows;
use crate::commands::complete;
use crate::device_argument::{self, DEVICE_HELP, DEVICE_LONG_HELP};
use crate::failure::Failure;
use crate::output::{self, OutputFile, note};
use crate::progress::Progress;
use crate::scene_argument::{DEFAULT_SCENE, SceneArgument, scene_help};
use crate::table::{seconds, thousands};
use crate::threads::MOST_THREADS;
use crate::{structure, threads};
use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};
use ropewalk::{CounterTotals, Query, StructureSpec, TraceOptions, Traced, Walk};
use ropewalk_gpu::DeviceChoice;
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

const EXAMPLES: &str = "\
Rays: an .npy file of float32 or float64, shape (N, 6) = origin x y z,
direction x y z, or (N, 8) with t_min and t_max. t counts in units of the
direction, which may have any length but zero.

Hits: an .npz file.
  closest  t float32 (inf on a miss), primitive, geometry, instance uint32
           (4294967295 on a miss), uv float32 (N, 2), front_face bool
  any      hit bool
  count    count uint32
  all      offsets uint64 (N + 1), and the arrays of closest: the hits of ray i
           are those from offsets[i] to offsets[i + 1], sorted by t

Examples:
  ropewalk trace bunny.ply --rays rays.npy -o hits.npz
  ropewalk trace room.glb --rays lidar.npy -o seen.npz --query any --device gpu
  ropewalk trace part.stl --rays rays.npy -o all.npz --query all --stats --json

In Python:
  numpy.save('rays.npy', numpy.hstack([origins, directions]))
  hits = numpy.load('hits.npz')
  points = origins + hits['t'][:, None] * directions";

/// The arguments of `ropewalk trace`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[arg(value_name = "SCENE", help = scene_help(), default_value = DEFAULT_SCENE)]
    #[arg(value_parser = OsStringValueParser::new().map(SceneArgument::from))]
    scene: SceneArgument,
    /// The rays: an .npy file, shape (N, 6) or (N, 8)
    #[arg(long, value_name = "FILE")]
    rays: PathBuf,
    /// Where the hits go: an .npz file
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// What is asked of each ray: closest, any, count or all
    #[arg(long, value_name = "QUERY", default_value_t = Query::Closest)]
    query: Query,
    /// What is built, such as bvh:max-leaf=8; see `ropewalk list`
    #[arg(long, value_name = "NAME[:key=value,...]", default_value_t)]
    structure: StructureSpec,
    /// How rays go through it, such as stack:order=culled; see `ropewalk list`; by default the best for the structure
    #[arg(long, value_name = "NAME[:key=value,...]")]
    walk: Option<Walk>,
    #[arg(long, value_name = "DEVICE", default_value_t, help = DEVICE_HELP, long_help = DEVICE_LONG_HELP)]
    device: DeviceChoice,
    /// Threads of the CPU; all of them by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    threads: Option<u16>,
    /// Answer rays that cannot be traced (NaN, zero direction) with misses instead of refusing the file
    #[arg(long)]
    allow_invalid_rays: bool,
    /// Count what the walk does: nodes, leaves and triangles a ray
    #[arg(long)]
    stats: bool,
    /// Print the summary as one JSON document
    #[arg(long)]
    json: bool,
}

/// What was done, for people and for scripts.
#[derive(Debug, Serialize)]
struct Summary {
    scene: String,
    rays: usize,
    invalid_rays: usize,
    query: String,
    structure: String,
    walk: String,
    device: String,
    rays_that_hit: usize,
    /// Of all rays; differs from `rays_that_hit` for the queries count and all.
    hits: Option<u64>,
    load_seconds: f64,
    build_seconds: f64,
    trace_seconds: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    device_seconds: Option<f64>,
    rays_per_second: f64,
    output: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    stats: Option<Stats>,
}

/// What the walk did: means over all rays.
#[derive(Debug, Serialize)]
struct Stats {
    inner_visits_per_ray: f64,
    leaf_visits_per_ray: f64,
    primitive_tests_per_ray: f64,
    restarts_per_ray: f64,
    objects_entered_per_ray: f64,
    deepest_stack: u32,
}

impl Arguments {
    /// The walk that was asked for, or the best for the structure.
    fn walk(&self) -> Walk {
        self.walk.unwrap_or(self.structure.kind().default_walk())
    }
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.scene.check()?;
    let rays = RaysFile::open(&arguments.rays)?;
    let output = OutputFile::new(&arguments.output)?;
    let device = device_argument::open(
        &arguments.device,
        arguments.structure.kind(),
        arguments.walk(),
        &[arguments.query],
    )?;
    threads::run(arguments.threads, || {
        let scene = arguments.scene.load()?;
        let invalid = InvalidRows::allowed(arguments.allow_invalid_rays);
        // Before the structure is built: bad rays are known at once.
        let rays = rays.read(scene.model.scene.origin, invalid)?;
        scene.note_defects();
        if rays.unread > 0 {
            note(&format!(
                "{}: {} bytes after the last row were not read",
                arguments.rays.display(),
                rays.unread
            ));
        }
        let built = structure::build(&arguments.structure, &scene.model.scene)?;
        structure::note_defects(&built);
        let build_time = built.report().flatten_time + built.report().build_time;
        let traceable = device_argument::prepare(&arguments.device, &device, built)?;
        let progress = Progress::spinner(format!("tracing {} rays", thousands(rays.rows.len())));
        let options = TraceOptions { counters: arguments.stats };
        let start = Instant::now();
        let (traced, device_time) =
            traceable.trace_timed(arguments.walk(), arguments.query, &rays.rows, options)?;
        let trace_time = start.elapsed();
        drop(progress);
        complete::check(&traced.status, "rays")?;
        output.write(|writer| hits_file::write(writer, &traced.answer))?;
        let summary = Summary {
            scene: arguments.scene.to_string(),
            rays: rays.rows.len(),
            invalid_rays: rays.invalid,
            query: arguments.query.to_string(),
            structure: arguments.structure.to_string(),
            walk: arguments.walk().to_string(),
            device: traceable.device().to_string(),
            rays_that_hit: traced.answer.rays_that_hit(),
            hits: hit_count(&traced),
            load_seconds: scene.time.as_secs_f64(),
            build_seconds: build_time.as_secs_f64(),
            trace_seconds: trace_time.as_secs_f64(),
            device_seconds: device_time.map(|time| time.as_secs_f64()),
            rays_per_second: rate(rays.rows.len(), trace_time),
            output: output.name().display().to_string(),
            stats: traced.totals().map(|totals| Stats::new(&totals)),
        };
        if arguments.json { output::print_json(&summary) } else { output::print(&summary.to_text()) }
    })
}

fn hit_count(traced: &Traced) -> Option<u64> {
    match &traced.answer {
        ropewalk::Answer::All(lists) => Some(lists.hits.len() as u64),
        ropewalk::Answer::Count(counts) => Some(counts.iter().copied().map(u64::from).sum()),
        _ => None,
    }
}

fn rate(rays: usize, time: Duration) -> f64 {
    if time.is_zero() { 0.0 } else { rays as f64 / time.as_secs_f64() }
}

impl Stats {
    fn new(totals: &CounterTotals) -> Self {
        let mean = |sum: u64| if totals.rays == 0 { 0.0 } else { sum as f64 / totals.rays as f64 };
        Self {
            inner_visits_per_ray: mean(totals.inner_visits),
            leaf_visits_per_ray: mean(totals.leaf_visits),
            primitive_tests_per_ray: mean(totals.primitive_tests),
            restarts_per_ray: mean(totals.restarts),
            objects_entered_per_ray: mean(totals.objects_entered),
            deepest_stack: totals.stack_depth,
        }
    }
}

impl Summary {
    fn to_text(&self) -> String {
        let mut text = String::new();
        let share = 100.0 * self.rays_that_hit as f64 / self.rays.max(1) as f64;
        let _ = writeln!(
            text,
            "{}: {} of {} rays hit {} ({share:.1}%)",
            self.output,
            thousands(self.rays_that_hit),
            thousands(self.rays),
            self.scene
        );
        if let Some(hits) = self.hits {
            let _ = writeln!(text, "hits      {}", thousands(hits));
        }
        if self.invalid_rays > 0 {
            let _ = writeln!(text, "invalid   {} rays, answered with misses", thousands(self.invalid_rays));
        }
        let _ = writeln!(text, "asked     {} of {} with the walk {}", self.query, self.structure, self.walk);
        let _ = writeln!(text, "device    {}", self.device);
        let _ = writeln!(
            text,
            "time      load {}, build {}, trace {} ({:.2} Mrays/s)",
            seconds(self.load_seconds),
            seconds(self.build_seconds),
            seconds(self.trace_seconds),
            self.rays_per_second / 1e6
        );
        if let Some(stats) = &self.stats {
            let _ = writeln!(
                text,
                "a ray     {:.2} inner visits, {:.2} leaf visits, {:.2} primitive tests; deepest stack {}",
                stats.inner_visits_per_ray,
                stats.leaf_visits_per_ray,
                stats.primitive_tests_per_ray,
                stats.deepest_stack
            );
        }
        text
    }
}
