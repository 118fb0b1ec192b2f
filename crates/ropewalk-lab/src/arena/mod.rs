//! The arena: ours and foreign engines side by side, on the same triangles, the same rays and as many threads.
//!
//! | file | concept |
//! |---|---|
//! | `engine` | what is asked of an engine |
//! | `shape`, `mixed` | the triangles: one mesh, turned off its axes, or with scans standing in it |
//! | `rays`, `viewpoint` | the rays: five classes, and from where they start |
//! | `judge` | who is right where answers differ |
//! | `tracing` | rays a second, each class in turn |
//! | `building`, `moving` | builds and bytes; refits, top levels, rays among copies |
//! | `clocks` | what is measured with |
//! | `record`, `tables`, `summary` | rows, ratios, and how they are printed, at length and for a README |
//! | `ours`, `packed` | our own engines |
//!
//! **Fairness.** Everybody gets the triangles of one indexed mesh and the same rays of unit length, and writes whole hits. All
//! answers are compared with a reference before anything is timed, and differences settled in f64. Then the rounds: each times
//! every engine once, one after the other, so that a machine that slows down slows all alike; what counts is the median of
//! the rounds' ratios, and how they spread is told. Foreign code is not in this crate: whoever has some brings an [`Engine`].

mod building;
mod clocks;
mod engine;
mod judge;
mod mixed;
mod moving;
pub mod ours;
mod packed;
mod rays;
mod record;
mod shape;
mod summary;
mod tables;
mod tracing;
mod viewpoint;

pub use clocks::{Counted, Instruments, Kind, WallClock};
pub use engine::{Engine, EngineError, Mode, Refitter, TopLevel, Tracer};
pub use judge::{Judge, Verdict};
pub use mixed::{MixError, mixed};
pub use rays::{Answers, ArenaClass, Packet, RaySet};
pub use record::{Grade, Row, RowKind, StageRecord};
pub use shape::{Shape, Turn};
pub use summary::summary;
pub use tables::markdown;
pub use viewpoint::Viewpoint;

use rayon::{ThreadPool, ThreadPoolBuilder};
use ropewalk::{BuildError, BuildOptions, Hit, Ray, SceneError};
use std::ops::ControlFlow;
use thiserror::Error;
use tracing::{Contender, Course, Task};

/// What is measured.
#[derive(Clone, Debug)]
pub struct ArenaSettings {
    /// The kinds of rows.
    pub kinds: Vec<RowKind>,
    /// The rays.
    pub classes: Vec<ArenaClass>,
    /// Numbers of threads, each measured by itself; in rising order.
    pub threads: Vec<usize>,
    /// How often every class of rays is timed.
    pub rounds: usize,
    /// How often builds, refits and top levels are timed.
    pub build_rounds: usize,
    /// Rays a class.
    pub rays: usize,
    /// What the rays are made from.
    pub seed: u64,
}

/// A scene that is measured.
#[derive(Clone, Debug)]
pub struct Stage {
    /// Its name.
    pub name: String,
    /// Its triangles as they stand.
    pub shape: Shape,
    /// How they are turned; so are the rays.
    pub turn: Option<Turn>,
    /// From where it is looked at; otherwise the scene itself tells.
    pub viewpoint: Option<Viewpoint>,
}

/// Why nothing was measured.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ArenaError {
    /// The scene is not to be measured.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The reference could not be built.
    #[error("the reference cannot be built: {0}")]
    Reference(#[from] BuildError),
    /// The scene has nothing to hit.
    #[error("the scene has no triangle that a ray could hit: there is nothing to measure")]
    Empty,
    /// A pool of threads could not be made.
    #[error("{threads} threads cannot be started: {reason}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}

/// Is told what is being done, and may stop it.
pub type Watch<'a> = dyn Fn(&str) -> ControlFlow<()> + Sync + 'a;

/// Measures all engines over a scene. What was measured before the caller stopped it is kept.
///
/// # Errors
/// When the scene is empty, the reference cannot be built, or threads cannot be started. That an engine fails is told in the
/// record.
pub fn run(
    stage: &Stage,
    engines: &[Box<dyn Engine>],
    settings: &ArenaSettings,
    instruments: &dyn Instruments,
    watch: &Watch<'_>,
) -> Result<StageRecord, ArenaError> {
    if stage.shape.triangles().is_empty() {
        return Err(ArenaError::Empty);
    }
    let shape = match &stage.turn {
        Some(turn) => stage.shape.turned(turn)?,
        None => stage.shape.clone(),
    };
    let mut record = StageRecord {
        scene: stage.name.clone(),
        triangles: shape.triangles().len(),
        rounds: settings.rounds,
        rows: Vec::new(),
        failures: Vec::new(),
    };
    let arena = Arena { stage, shape: &shape, engines, settings, instruments, watch };
    // A stopped run keeps the rows that are whole.
    let _ = arena.measure(&mut record)?;
    Ok(record)
}

struct Arena<'a> {
    stage: &'a Stage,
    shape: &'a Shape,
    engines: &'a [Box<dyn Engine>],
    settings: &'a ArenaSettings,
    instruments: &'a dyn Instruments,
    watch: &'a Watch<'a>,
}

impl<'a> Arena<'a> {
    /// All kinds of rows; `None` when the caller stopped it.
    fn measure(&self, record: &mut StageRecord) -> Result<Option<()>, ArenaError> {
        let mut pools = Vec::new();
        for &threads in &self.settings.threads {
            pools.push((threads, pool(threads)?));
        }
        let Some((first, pool)) = pools.first() else { return Ok(Some(())) };
        let course = self.course(*first, pool, 1);
        let mut contenders = Vec::new();
        let mut built = Vec::new();
        for engine in self.engines {
            if self.say(&format!("building {} {}", engine.name(), engine.preset())).is_break() {
                return Ok(None);
            }
            match building::first(&**engine, self.shape, &course) {
                Ok((tracer, bytes)) => {
                    contenders.push(Contender { engine: &**engine, tracer });
                    built.push((&**engine, bytes));
                }
                Err(error) => record.failures.push(error.to_string()),
            }
        }
        if self.wants(RowKind::Trace) && self.trace(&pools, &contenders, record)?.is_none() {
            return Ok(None);
        }
        // Not beside the builds: an engine may own threads as long as it has structures.
        drop(contenders);
        for (threads, pool) in &pools {
            let course = self.course(*threads, pool, self.settings.build_rounds);
            if self.build_and_move(&course, &built, record).is_none() {
                return Ok(None);
            }
        }
        Ok(Some(()))
    }

    fn trace(
        &self,
        pools: &[(usize, ThreadPool)],
        contenders: &[Contender<'_>],
        record: &mut StageRecord,
    ) -> Result<Option<()>, ArenaError> {
        let Arena { stage, settings, .. } = *self;
        let upright = stage.shape.scene().build(&BuildOptions::default())?;
        let closest_of = |bvh: &ropewalk::Bvh, rays: &[Ray]| {
            let mut hits = vec![Hit::MISS; rays.len()];
            bvh.closest_batch(rays, &mut hits);
            hits
        };
        let on_upright = |rays: &[Ray]| closest_of(&upright, rays);
        let viewpoint =
            stage.viewpoint.unwrap_or_else(|| Viewpoint::of_scene(&stage.shape.bounds(), &on_upright));
        let reference = match stage.turn {
            Some(_) => self.shape.scene().build(&BuildOptions::default())?,
            None => upright.clone(),
        };
        let judge = Judge::new(self.shape.flat());
        for &class in &settings.classes {
            let (flat, turn) = (stage.shape.flat(), stage.turn.as_ref());
            let (count, seed) = (settings.rays, settings.seed);
            let set = RaySet::make(class, flat, &viewpoint, turn, count, seed, &on_upright);
            if set.rays.is_empty() {
                record.failures.push(format!("{class}: the camera sees nothing to start from"));
                continue;
            }
            let reference = closest_of(&reference, &set.rays);
            let task = Task { set: &set, reference: &reference };
            for (threads, pool) in pools {
                let course = self.course(*threads, pool, settings.rounds);
                let go_on = || self.say(&format!("{class}, {threads} threads"));
                match tracing::measure(&course, contenders, &task, &judge, &go_on) {
                    Some(rows) => record.rows.extend(rows),
                    None => return Ok(None),
                }
            }
        }
        Ok(Some(()))
    }

    fn build_and_move(
        &self,
        course: &Course<'_>,
        built: &[(&dyn Engine, building::Bytes)],
        record: &mut StageRecord,
    ) -> Option<()> {
        let engines: Vec<&dyn Engine> = built.iter().map(|(engine, _)| *engine).collect();
        let failures = &mut record.failures;
        if self.wants(RowKind::Build) {
            let go_on = || self.say(&format!("builds, {} threads", course.threads));
            record.rows.extend(building::measure(course, built, self.shape, failures, &go_on)?);
        }
        if self.wants(RowKind::Refit) {
            let go_on = || self.say(&format!("refits, {} threads", course.threads));
            record.rows.extend(moving::refits(course, &engines, self.shape, failures, &go_on)?);
        }
        if self.wants(RowKind::TopLevel) {
            let go_on = || self.say(&format!("copies, {} threads", course.threads));
            let rays = self.settings.rays;
            record.rows.extend(moving::top_levels(course, &engines, self.shape, rays, failures, &go_on)?);
        }
        Some(())
    }

    fn wants(&self, kind: RowKind) -> bool {
        self.settings.kinds.contains(&kind)
    }

    fn say(&self, what: &str) -> ControlFlow<()> {
        (self.watch)(what)
    }

    fn course(&self, threads: usize, pool: &'a ThreadPool, rounds: usize) -> Course<'a> {
        let (scene, instruments) = (self.stage.name.as_str(), self.instruments);
        Course { scene, threads, pool, rounds: rounds.max(1), instruments }
    }
}

fn pool(threads: usize) -> Result<ThreadPool, ArenaError> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| ArenaError::Threads { threads, reason: error.to_string() })
}
