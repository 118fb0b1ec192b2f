//! The benchmark of one scene: how long its structure takes to build, and how many rays a second each walk
//! answers on each device, per ray class.
//!
//! **Order of work.** Rays are made and answered by a reference, the default walk on the CPU. Every lane (a walk
//! on a device with a number of threads) answers every batch once, which warms it up, and its answers are
//! compared; a lane that disagrees is not timed. Then the rounds: each measures every lane once, one after the
//! other, so that a machine that slows down slows all lanes alike. Kept are median, smallest and largest.
//!
//! **Stopping.** After each measurement the caller is asked whether to go on. Of a run that was stopped the whole
//! rounds are kept.

mod agreement;
mod batches;
mod builds;
mod lanes;
mod record;

pub use agreement::{Agreement, Disagreement};
pub use record::{BuildRecord, ClassRecord, LaneRecord, RateRecord, SceneRecord, Work};
pub use ropewalk_testkit::rays::View;

pub(crate) use agreement::{Judge, is_hardware};
use batches::Batch;
use lanes::Lane;
use ropewalk::{BuildError, Scene, Structure, StructureSpec, Walk};
use ropewalk_gpu::{Device, GpuError};
use std::ops::ControlFlow;
use std::sync::Arc;
use thiserror::Error;

/// What is measured.
#[derive(Clone, Debug)]
pub struct BenchSettings {
    /// What is built.
    pub structure: StructureSpec,
    /// The walks.
    pub walks: Vec<Walk>,
    /// Where they run.
    pub devices: Vec<Device>,
    /// How many threads the CPU has, each number measured by itself.
    pub threads: Vec<usize>,
    /// How often everything is measured.
    pub rounds: usize,
    /// Rays a batch.
    pub rays: usize,
    /// What the rays are made from.
    pub seed: u64,
    /// From where primary rays come; else from outside, with all of the scene in sight.
    pub view: Option<View>,
}

/// Why nothing was measured.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BenchError {
    /// The structure was not built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The pool of threads could not be made.
    #[error("{threads} threads cannot be started: {reason}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
    /// The scene has nothing to hit.
    #[error("the scene has no triangle that a ray could hit: there is nothing to measure")]
    Empty,
    /// The caller stopped it before the first round was whole.
    #[error("stopped before anything was measured")]
    Stopped,
}

/// Where a benchmark is.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// What is being done.
    pub what: &'a str,
    /// Steps behind us.
    pub done: usize,
    /// All steps.
    pub total: usize,
}

/// Is told where the benchmark is, and may stop it.
pub type Watch<'a> = dyn Fn(Progress<'_>) -> ControlFlow<()> + Sync + 'a;

/// Measures a scene.
///
/// # Errors
/// When it cannot be built, a device fails, or the caller stops it before the first round is whole.
pub fn bench(
    name: &str,
    scene: &Scene,
    settings: &BenchSettings,
    watch: &Watch<'_>,
) -> Result<SceneRecord, BenchError> {
    let pools = lanes::pools(&settings.threads)?;
    let rounds = settings.rounds.max(1);
    let step = |what: &str, done, total| match watch(Progress { what, done, total }) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(BenchError::Stopped),
    };
    let (structure, builds) = builds::measure(scene, &settings.structure, &pools, rounds, &step)?;
    let structure = Arc::new(structure);
    step("making rays", 0, 1)?;
    let flat = scene.flatten().map_err(BuildError::from)?;
    if flat.triangles.is_empty() {
        return Err(BenchError::Empty);
    }
    let batches = batches::make(&flat, &structure, settings)?;
    let judge = Judge::new(&flat, &settings.devices);
    drop(flat);
    let mut lanes = lanes::make(settings, &pools, &structure)?;
    verify(&mut lanes, &judge, &batches, &step)?;
    let whole_rounds = measure(&mut lanes, &batches, rounds, watch)?;
    if whole_rounds == 0 {
        return Err(BenchError::Stopped);
    }
    Ok(record(name, scene, &structure, settings, builds, &batches, &lanes, whole_rounds))
}

/// Lets every lane answer every batch and compares.
fn verify(
    lanes: &mut [Lane<'_>],
    judge: &Judge,
    batches: &[Batch],
    step: &dyn Fn(&str, usize, usize) -> Result<(), BenchError>,
) -> Result<(), BenchError> {
    let total = lanes.len() * batches.len();
    let mut done = 0;
    for lane in lanes {
        for batch in batches {
            step("verifying", done, total)?;
            lane.verify(judge, batch)?;
            done += 1;
        }
    }
    Ok(())
}

/// Measures the lanes that agree, round after round; says how many rounds are whole.
fn measure(
    lanes: &mut [Lane<'_>],
    batches: &[Batch],
    rounds: usize,
    watch: &Watch<'_>,
) -> Result<usize, BenchError> {
    let total = rounds * lanes.len() * batches.len();
    let mut done = 0;
    for round in 0..rounds {
        for lane in lanes.iter_mut() {
            for (index, batch) in batches.iter().enumerate() {
                if watch(Progress { what: "measuring", done, total }).is_break() {
                    return Ok(round);
                }
                lane.measure(index, batch)?;
                done += 1;
            }
        }
    }
    Ok(rounds)
}

#[expect(
    clippy::too_many_arguments,
    reason = "the parts of one record, gathered at the one place that has them"
)]
fn record(
    name: &str,
    scene: &Scene,
    structure: &Structure,
    settings: &BenchSettings,
    builds: Vec<BuildRecord>,
    batches: &[Batch],
    lanes: &[Lane<'_>],
    rounds: usize,
) -> SceneRecord {
    let report = structure.report();
    SceneRecord {
        scene: name.into(),
        triangles: scene.triangle_count(),
        references: report.references,
        structure: settings.structure.to_string(),
        nodes: report.nodes,
        leaves: report.leaves,
        depth: report.depth,
        sah_cost: report.sah_cost,
        bytes: report.bytes,
        bytes_per_triangle: report.bytes_per_triangle(),
        builds,
        rounds,
        stopped: rounds < settings.rounds.max(1),
        classes: batches.iter().map(Batch::record).collect(),
        lanes: lanes.iter().map(|lane| lane.record(batches, rounds)).collect(),
    }
}
