//! Rays a second: every engine answers every class, is compared, and then all are timed in turn, round after round.
//!
//! A single call or a packet works through the rays in chunks, which threads share; a batch gets all rays at once and shares
//! them itself. What a chunk costs beyond its rays is nothing that one could measure.

use super::clocks::{Instruments, Kind, seconds};
use super::judge::{Judge, Verdict};
use super::record::{Peers, Sample, row};
use super::{Answers, Engine, Mode, RaySet, Row, RowKind, Tracer};
use rayon::ThreadPool;
use rayon::prelude::*;
use ropewalk::{Hit, Query};
use std::ops::{ControlFlow, Range};

/// Rays of one chunk: a multiple of every packet, and some microseconds' work at least.
pub(super) const CHUNK: usize = 2048;
/// A peer with a larger share of wrong answers is timed, but nobody is compared with it: who loses triangles is fast.
const STANDARD: f64 = 0.005;

/// An engine's structure, and whose it is.
pub(super) struct Contender<'a> {
    pub(super) engine: &'a dyn Engine,
    pub(super) tracer: Box<dyn Tracer>,
}

/// A contender with a way to hand over rays.
struct Lane<'a> {
    contender: &'a Contender<'a>,
    mode: Mode,
}

/// The answers that are right, where the oracle says nothing else.
pub(super) struct Task<'a> {
    pub(super) set: &'a RaySet,
    /// The closest hit of every ray, whatever is asked.
    pub(super) reference: &'a [Hit],
}

/// How it is measured.
pub(super) struct Course<'a> {
    pub(super) scene: &'a str,
    pub(super) threads: usize,
    pub(super) pool: &'a ThreadPool,
    pub(super) rounds: usize,
    pub(super) instruments: &'a dyn Instruments,
}

/// Compares and times all contenders at one class of rays.
pub(super) fn measure(
    course: &Course<'_>,
    contenders: &[Contender<'_>],
    task: &Task<'_>,
    judge: &Judge<'_>,
    go_on: &dyn Fn() -> ControlFlow<()>,
) -> Option<Vec<Row>> {
    let lanes: Vec<Lane<'_>> = contenders
        .iter()
        .flat_map(|contender| {
            let modes = contender.tracer.modes().iter();
            modes.map(move |&mode| Lane { contender, mode })
        })
        .filter(|lane| task.set.class.is_coherent() || !lane.mode.is_packet())
        .collect();
    let mut answers = Answers::poisoned(task.set);
    let mut verdicts = Vec::new();
    for lane in &lanes {
        go_on().is_continue().then_some(())?;
        answers.invert();
        lane.answer(course, task.set, &mut answers);
        verdicts.push(match task.set.query() {
            Query::Any => judge.any(&task.set.rays, task.reference, &answers.any),
            _ => judge.closest(&task.set.rays, task.reference, &answers.hits),
        });
    }
    let mut samples: Vec<Sample> =
        lanes.iter().zip(&verdicts).map(|(lane, verdict)| lane.sample(verdict)).collect();
    for round in 0..course.rounds {
        for index in 0..lanes.len() {
            go_on().is_continue().then_some(())?;
            // Each round begins with another one, so that nobody always runs behind the same neighbour.
            let index = (index + round * 7) % lanes.len();
            let seconds = lanes[index].answer(course, task.set, &mut answers);
            samples[index].seconds.push(seconds);
        }
    }
    let row = |index: usize| lanes[index].row(course, task.set, &samples, index, verdicts[index]);
    Some((0..lanes.len()).filter_map(row).collect())
}

impl Lane<'_> {
    /// Answers all rays and says how many seconds it took.
    fn answer(&self, course: &Course<'_>, set: &RaySet, answers: &mut Answers) -> f64 {
        let tracer = &*self.contender.tracer;
        match set.query() {
            Query::Any => {
                let any = |range: Range<usize>, out: &mut [bool]| tracer.any(self.mode, set, range, out);
                timed(course, self.mode, &mut answers.any, &any)
            }
            _ => {
                let closest =
                    |range: Range<usize>, out: &mut [Hit]| tracer.closest(self.mode, set, range, out);
                timed(course, self.mode, &mut answers.hits, &closest)
            }
        }
    }

    fn sample(&self, verdict: &Verdict) -> Sample {
        let engine = self.contender.engine;
        let is_right = verdict.suspect() as f64 <= STANDARD * verdict.rays as f64;
        Sample {
            peers: Peers::Rays(self.mode),
            label: format!("{} {}, {}", engine.name(), engine.preset(), self.mode),
            is_standard: engine.is_peer() && is_right,
            seconds: Vec::new(),
        }
    }

    fn row(
        &self,
        course: &Course<'_>,
        set: &RaySet,
        samples: &[Sample],
        index: usize,
        verdict: Verdict,
    ) -> Option<Row> {
        let row = row(RowKind::Trace, course.scene, course.threads, self.contender.engine, samples, index)?;
        Some(Row {
            rays: set.class.name().into(),
            api: self.mode.api(),
            mode: self.mode.name(),
            mrays_per_s: Some(set.rays.len() as f64 / row.ms / 1e3),
            agreement: Some(verdict),
            ..row
        })
    }
}

/// The seconds that all chunks of the answers take.
pub(super) fn timed<T: Send>(
    course: &Course<'_>,
    mode: Mode,
    answers: &mut [T],
    answer: &(dyn Fn(Range<usize>, &mut [T]) + Sync),
) -> f64 {
    let chunk = |(index, part): (usize, &mut [T])| {
        let first = index * CHUNK;
        answer(first..first + part.len(), part);
    };
    let work = || match (mode, course.threads) {
        (Mode::Batch, _) => answer(0..answers.len(), answers),
        (_, 1) => answers.chunks_mut(CHUNK).enumerate().for_each(chunk),
        _ => answers.par_chunks_mut(CHUNK).enumerate().for_each(chunk),
    };
    // Inside the pool: a thread's own time is that of the thread that does the work.
    course.pool.install(|| {
        let kind = if course.threads == 1 { Kind::Thread } else { Kind::Wall };
        seconds(course.instruments, kind, work)
    })
}
