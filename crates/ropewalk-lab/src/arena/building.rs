//! How long builds take, and how many bytes: in turn, round after round, with each number of threads.
//!
//! One thread is timed by the processor time of the whole process, so that an engine that uses more threads than it was told
//! gains nothing. Freeing what was built is not part of it.

use super::clocks::{Counted, Instruments, Kind, seconds};
use super::record::{Peers, Sample, row};
use super::tracing::Course;
use super::{Engine, EngineError, Row, RowKind, Shape, Tracer};
use std::ops::ControlFlow;

/// The bytes of an engine's structure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Bytes {
    kept: Option<usize>,
    peak: Option<usize>,
}

/// Builds once, and counts: this structure is kept.
pub(super) fn first(
    engine: &dyn Engine,
    shape: &Shape,
    course: &Course<'_>,
) -> Result<(Box<dyn Tracer>, Bytes), EngineError> {
    // What engines share of a shape is made now, and is no part of a build.
    let _ = (shape.aligned_positions(), shape.aligned_corners());
    course.pool.install(|| {
        course.instruments.start_counting();
        let built = engine.build(shape, course.threads);
        let counted = course.instruments.stop_counting();
        let tracer = built?;
        let bytes = Bytes {
            kept: tracer.bytes().or(counted.map(|counted: Counted| counted.kept)),
            peak: tracer.peak_bytes().or(counted.map(|counted| counted.peak)),
        };
        Ok((tracer, bytes))
    })
}

/// Times the builds of all engines; `bytes` belong to the engines one by one.
pub(super) fn measure(
    course: &Course<'_>,
    engines: &[(&dyn Engine, Bytes)],
    shape: &Shape,
    failures: &mut Vec<String>,
    go_on: &dyn Fn() -> ControlFlow<()>,
) -> Option<Vec<Row>> {
    let engines: Vec<_> = engines.iter().filter(|(engine, _)| engine.has_own_build()).collect();
    let sample = |(engine, _): &&(&dyn Engine, Bytes)| Sample {
        peers: Peers::Builds(engine.grade()),
        label: format!("{} {}", engine.name(), engine.preset()),
        is_standard: engine.is_peer(),
        seconds: Vec::new(),
    };
    let mut samples: Vec<Sample> = engines.iter().map(sample).collect();
    for round in 0..course.rounds {
        for index in 0..engines.len() {
            go_on().is_continue().then_some(())?;
            let index = (index + round * 7) % engines.len();
            match once(engines[index].0, shape, course) {
                Ok(seconds) => samples[index].seconds.push(seconds),
                Err(error) => failures.push(error.to_string()),
            }
        }
    }
    let a_triangle =
        |bytes: Option<usize>| bytes.map(|bytes| bytes as f64 / shape.triangles().len().max(1) as f64);
    let row = |index: usize| {
        let (engine, bytes) = engines[index];
        let row = row(RowKind::Build, course.scene, course.threads, *engine, &samples, index)?;
        let (bytes_per_triangle, peak_bytes_per_triangle) = (a_triangle(bytes.kept), a_triangle(bytes.peak));
        Some(Row { bytes_per_triangle, peak_bytes_per_triangle, ..row })
    };
    Some((0..engines.len()).filter_map(row).collect())
}

fn once(engine: &dyn Engine, shape: &Shape, course: &Course<'_>) -> Result<f64, EngineError> {
    let (seconds, built) = course.pool.install(|| {
        let mut built = None;
        let time = seconds(course.instruments, course.kind(), || {
            built = Some(engine.build(shape, course.threads));
        });
        (time, built)
    });
    built.transpose().map(|_| seconds)
}

impl Course<'_> {
    /// The clock for work that may use threads of its own.
    pub(super) fn kind(&self) -> Kind {
        if self.threads == 1 { Kind::Process } else { Kind::Wall }
    }
}

/// The instruments of a course, by the best clock for work with threads of its own.
pub(super) fn time(course: &Course<'_>, work: impl FnOnce()) -> f64 {
    let instruments: &dyn Instruments = course.instruments;
    seconds(instruments, course.kind(), work)
}
