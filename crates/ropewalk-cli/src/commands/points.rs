//! `ropewalk points`: points as data in, what is closest to them out.

mod answer;
pub(crate) mod listing;
mod question;
mod summary;

use crate::arrays::answers_file;
use crate::arrays::points_file::PointsFile;
use crate::arrays::rows::{InvalidRows, Rows};
use crate::device_argument::{self, DEVICE_HELP, DEVICE_LONG_HELP};
use crate::failure::Failure;
use crate::output::{self, OutputFile, note};
use crate::progress::Progress;
use crate::scene_argument::{DEFAULT_SCENE, SceneArgument, scene_help};
use crate::table::thousands;
use crate::threads::MOST_THREADS;
use crate::{structure, threads};
use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};
use question::Question;
use ropewalk::{PointQuery, PointSearch, StructureSpec, Walk};
use ropewalk_gpu::DeviceChoice;
use std::path::PathBuf;
use summary::Summary;

const EXAMPLES: &str = "\
Points: an .npy file of float32 or float64, shape (N, 3) = x y z, or (N, 4)
with the largest distance that counts as found.

Answers: an .npz file.
  closest-point    distance float32 (inf where nothing is within reach),
                   point float64 (N, 3) (NaN there), primitive, geometry,
                   instance uint32 (4294967295 there), uv float32 (N, 2)
  k-nearest        offsets uint64 (N + 1), and the arrays of closest-point: the
                   answers to point i are those from offsets[i] to
                   offsets[i + 1], the nearest triangles sorted by distance
  signed-distance  the arrays of closest-point, with distance negative inside,
                   and normal float32 (N, 3), which points outwards
  inside           inside bool; the surface belongs to the inside

signed-distance and inside need closed surfaces whose triangles face outwards.

Examples:
  ropewalk points bunny.ply --points points.npy -o near.npz
  ropewalk points part.stl --points p.npy -o side.npz --query signed-distance
  ropewalk points room.glb --points p.npy -o all.npz --query k-nearest --k 4
  ropewalk points scan.ply --points p.npy -o n.npz --max-distance 0.5 --stats

In Python:
  numpy.save('points.npy', points)
  near = numpy.load('near.npz')
  found = numpy.isfinite(near['distance'])
  offsets = near['point'][found] - points[found]";

/// The arguments of `ropewalk points`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[arg(value_name = "SCENE", help = scene_help(), default_value = DEFAULT_SCENE)]
    #[arg(value_parser = OsStringValueParser::new().map(SceneArgument::from))]
    scene: SceneArgument,
    /// The points: an .npy file, shape (N, 3) or (N, 4)
    #[arg(long, value_name = "FILE")]
    points: PathBuf,
    /// Where the answers go: an .npz file
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// What is asked of each point: closest-point, k-nearest, signed-distance or inside
    #[arg(long, value_name = "QUERY", default_value_t)]
    query: Question,
    /// How many triangles k-nearest finds for each point; 8 by default
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..))]
    k: Option<u32>,
    /// The largest distance that counts as found; no limit by default
    #[arg(long, value_name = "R", value_parser = distance, allow_negative_numbers = true)]
    max_distance: Option<f32>,
    /// What is built, such as bvh:max-leaf=8; see `ropewalk list`
    #[arg(long, value_name = "NAME[:key=value,...]", default_value_t)]
    structure: StructureSpec,
    /// How points go through it, such as restart-trail; see `ropewalk list`; by default the best for the structure
    #[arg(long, value_name = "NAME[:key=value,...]")]
    walk: Option<Walk>,
    #[arg(long, value_name = "DEVICE", default_value_t, help = DEVICE_HELP, long_help = DEVICE_LONG_HELP)]
    device: DeviceChoice,
    /// Threads of the CPU; all of them by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    threads: Option<u16>,
    /// Answer points that are NaN, infinite or beyond 2^60 as if nothing was there instead of refusing the file
    #[arg(long)]
    allow_invalid_points: bool,
    /// Count what the walk does: nodes, leaves and triangles a point
    #[arg(long)]
    stats: bool,
    /// Print the summary as one JSON document
    #[arg(long)]
    json: bool,
}

fn distance(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(distance) if distance >= 0.0 => Ok(distance),
        _ => Err("a number that is not negative is wanted".into()),
    }
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.check()?;
    arguments.scene.check()?;
    let points = arguments.open_points()?;
    let output = OutputFile::new(&arguments.output)?;
    let device = device_argument::open_checked(&arguments.device, |kind| {
        arguments.query.check(arguments.structure.kind(), arguments.walk(), kind, arguments.k())
    })?;
    threads::run(arguments.threads, || {
        let scene = arguments.scene.load()?;
        let origin = scene.model.scene.origin;
        // Before the structure is built: bad points are known at once.
        let mut points = points.read(origin, InvalidRows::allowed(arguments.allow_invalid_points))?;
        arguments.limit_distances(&mut points);
        scene.note_defects();
        if points.unread > 0 {
            let file = arguments.points.display();
            note(&format!("{file}: {} bytes after the last row were not read", points.unread));
        }
        let built = structure::build(&arguments.structure, &scene.model.scene)?;
        structure::note_defects(&built);
        let build_time = built.report().flatten_time + built.report().build_time;
        let traceable = device_argument::prepare(&arguments.device, &device, built)?;
        let progress = Progress::spinner(format!("answering {} points", thousands(points.rows.len())));
        let answered = answer::answer(arguments, &traceable, origin, &points.rows)?;
        drop(progress);
        output.write(|writer| answers_file::write(writer, origin, &answered.answer))?;
        let summary = Summary::new(arguments, &points, &traceable, &answered, scene.time, build_time);
        if arguments.json { output::print_json(&summary) } else { output::print(&summary.to_text()) }
    })
}

impl Arguments {
    /// The walk that was asked for, or the best for the structure.
    fn walk(&self) -> Walk {
        self.walk.unwrap_or(self.structure.kind().default_walk())
    }

    /// Refuses options that the query has no use for: what they were meant to do would not happen.
    fn check(&self) -> Result<(), Failure> {
        let nearest = Question::Search(PointSearch::Nearest);
        let side = self.query.needs_inside();
        for (is_given, has_use, option, right) in [
            (self.k.is_some(), self.query == nearest, "--k", "k-nearest"),
            (self.max_distance.is_some(), !side, "--max-distance", "closest-point and k-nearest"),
            (self.stats, !side, "--stats", "closest-point and k-nearest"),
        ] {
            if is_given && !has_use {
                let query = self.query;
                return Err(Failure::usage(format!(
                    "{option} has no use with --query {query}; it belongs to {right}"
                )));
            }
        }
        Ok(())
    }

    fn open_points(&self) -> Result<PointsFile, Failure> {
        let file = PointsFile::open(&self.points)?;
        if self.query.needs_inside() && file.columns() > 3 {
            return Err(Failure::failed(format!(
                "{}: its rows end with a largest distance, which --query {} has no use for; the shape is (N, 3)",
                self.points.display(),
                self.query
            )));
        }
        Ok(file)
    }

    /// How many triangles are found for each point, at most.
    fn k(&self) -> usize {
        match self.query {
            Question::Search(PointSearch::Nearest) => self.k.unwrap_or(8) as usize,
            _ => 1,
        }
    }

    /// The smaller one counts, of the distance of the row and that of the command line.
    fn limit_distances(&self, points: &mut Rows<PointQuery>) {
        let Some(largest) = self.max_distance else { return };
        for point in &mut points.rows {
            // A distance that is NaN stays so: the point has no answer.
            if largest < point.radius {
                point.radius = largest;
            }
        }
    }
}
