//! What is checked of a case: see [`super`].

use super::counters;
use super::{Accuracy, Failure, Judged, Report};
use crate::cases::Case;
use crate::compare::{Mismatch, Summary, across_queries, against_oracle, nearly, same_bits};
use crate::rays::RayClass;
use ropewalk::catalogue::{Row, is_offered};
use ropewalk::{Answer, Counters, DeviceKind, Query, Structure, StructureSpec, TraceOptions, Traced, Walk};

/// A row's answers for one case and structure.
pub(super) struct Run {
    pub(super) row: usize,
    pub(super) plain: Traced,
    pub(super) counted: Traced,
}

/// One case on its way through all structures and rows.
pub(super) struct Bench<'a> {
    pub(super) judged: &'a Judged,
    pub(super) accuracy: Accuracy,
    pub(super) rows: &'a [Row],
    report: &'a mut Report,
    /// The first answer to each query: what all later rows are compared with.
    first: Vec<(Row, Traced)>,
    /// The counters of walks that do not cull, which the order of children must not change.
    unculled: Vec<(usize, StructureSpec, Vec<Counters>)>,
}

impl<'a> Bench<'a> {
    pub(super) fn new(
        judged: &'a Judged,
        accuracy: Accuracy,
        rows: &'a [Row],
        report: &'a mut Report,
    ) -> Self {
        Self { judged, accuracy, rows, report, first: Vec::new(), unculled: Vec::new() }
    }

    pub(super) fn fail(&mut self, row: usize, structure: StructureSpec, what: impl Into<String>) {
        let failure = Failure { case: self.judged.case.name, structure, what: what.into() };
        self.report.rows[row].failures.push(failure);
    }

    /// Demands agreement of two tracers, as closely as the device allows.
    fn agree(&self, reference: &Traced, given: &Traced, counters: bool) -> Result<Summary, Mismatch> {
        let rays = &self.judged.case.rays;
        match self.accuracy {
            Accuracy::Exact => same_bits(rays, reference, given, counters),
            Accuracy::Relaxed => nearly(&self.judged.oracle, rays, reference, given),
        }
    }

    pub(super) fn judge(&mut self, structure: &Structure, variant: StructureSpec, runs: Vec<Run>) {
        for run in &runs {
            self.judge_run(structure, variant, run);
        }
        if self.accuracy == Accuracy::Exact {
            // A real GPU may fuse other operations in the kernel of another query.
            self.judge_walks(variant, &runs);
            let counted: Vec<_> =
                runs.iter().map(|run| (run.row, self.rows[run.row], &run.counted)).collect();
            for (row, what) in counters::relations(&self.judged.case, &counted) {
                self.fail(row, variant, what);
            }
        }
        for run in runs {
            let row = self.rows[run.row];
            let unculled = Walk::Stack(ropewalk::bvh::StackOrder::Unordered);
            if let (true, Query::Closest, Some(counters)) =
                (row.walk == unculled, row.query, run.counted.counters)
            {
                self.unculled.push((run.row, variant, counters));
            }
        }
    }

    /// Demands that the answers of each walk to different queries agree.
    fn judge_walks(&mut self, variant: StructureSpec, runs: &[Run]) {
        for walk in Walk::EVERY {
            let same_walk = |run: &&Run| self.rows[run.row].walk == walk;
            let of_walk: Vec<&Traced> = runs.iter().filter(same_walk).map(|run| &run.counted).collect();
            if let Err(mismatch) = across_queries(&self.judged.case.rays, &of_walk) {
                let all: Vec<usize> = runs.iter().filter(same_walk).map(|run| run.row).collect();
                all.into_iter().for_each(|row| self.fail(row, variant, mismatch.to_string()));
            }
        }
    }

    fn judge_run(&mut self, structure: &Structure, variant: StructureSpec, run: &Run) {
        let row = self.rows[run.row];
        let mut wrong = Vec::new();
        let mut note = |what: &str, result: Result<Summary, Mismatch>| match result {
            Ok(summary) => Some(summary),
            Err(mismatch) => {
                wrong.push(format!("{what}: {mismatch}"));
                None
            }
        };
        let truth = note("against the oracle", against_oracle(&self.judged.expectation, &run.counted));
        note("without counters", self.agree(&run.counted, &run.plain, false));
        let first = self.first.iter().find(|(first, _)| first.query == row.query);
        let agreed = first.and_then(|(first, traced)| {
            let what = format!("against {} on {} ({})", first.walk, first.structure, first.device);
            note(&what, self.agree(traced, &run.counted, false))
        });
        if row.device == DeviceKind::Gpu && is_offered(row.walk, row.query, DeviceKind::Cpu) {
            let options = TraceOptions { counters: true };
            match structure.trace(row.walk, row.query, &self.judged.case.rays, options) {
                Ok(twin) => drop(note("against its twin on the cpu", self.agree(&twin, &run.counted, true))),
                Err(error) => wrong.push(error.to_string()),
            }
        }
        wrong.extend(escaped(&self.judged.case, &run.counted));
        if run.plain.counters.is_some() {
            wrong.push("there are counters that nobody asked for".into());
        }
        wrong.extend(counters::check(structure, row, &self.judged.case.rays, &run.counted).err());

        let result = &mut self.report.rows[run.row];
        result.cases += 1;
        result.rays += self.judged.case.rays.len();
        result.clear += truth.map_or(0, |summary| summary.clear);
        result.differing += agreed.map_or(0, |summary| summary.differing);
        if first.is_none() {
            self.first.push((row, run.counted.clone()));
        }
        wrong.into_iter().for_each(|what| self.fail(run.row, variant, what));
    }

    /// What can be said only when all structures are through.
    pub(super) fn finish(mut self) {
        if self.accuracy == Accuracy::Relaxed {
            return;
        }
        let mut wrong = Vec::new();
        for (index, (_, a, reference)) in self.unculled.iter().enumerate() {
            for (row, b, given) in &self.unculled[index + 1..] {
                if is_same_but_for_order(*a, *b) && !counters::is_same_work(reference, given) {
                    let what = "putting leaves first changed how much a walk without culling does";
                    wrong.push((*row, *b, what));
                }
            }
        }
        wrong.into_iter().for_each(|(row, structure, what)| self.fail(row, structure, what));
    }
}

fn is_same_but_for_order(a: StructureSpec, b: StructureSpec) -> bool {
    match (a, b) {
        (StructureSpec::Bvh(a), StructureSpec::Bvh(b)) => {
            ropewalk::BuildOptions { leaf_order: b.leaf_order, ..a } == b
        }
        _ => false,
    }
}

/// Checks a structure by itself.
pub(super) fn structure(structure: &Structure, spec: StructureSpec, case: &Case) -> Result<(), String> {
    let report = structure.report();
    if report.input.skipped() != case.skipped {
        return Err(format!(
            "{} triangles were left out instead of {}",
            report.input.skipped(),
            case.skipped
        ));
    }
    if report.triangles != structure.triangles().len() {
        return Err("the report counts triangles that are not there".into());
    }
    match (structure, spec) {
        (Structure::Bvh(bvh), StructureSpec::Bvh(options)) => {
            bvh.validate().map_err(|error| error.to_string())?;
            if report.depth > options.max_depth {
                return Err(format!("a leaf lies at depth {}, below {}", report.depth, options.max_depth));
            }
        }
        _ => return Err("another kind of structure was built than was asked for".into()),
    }
    Ok(())
}

/// The first ray that left a closed mesh.
fn escaped(case: &Case, traced: &Traced) -> Option<String> {
    let inside = case.classes.iter().filter(|(class, _)| *class == RayClass::Inside);
    let escaped = |index: &usize| match &traced.answer {
        Answer::Closest(hits) => hits.get(*index).is_some_and(|hit| !hit.is_hit()),
        Answer::Any(hits) => hits.get(*index) == Some(&false),
        Answer::Count(counts) => counts.get(*index) == Some(&0),
        Answer::All(lists) => lists.of(*index).is_empty(),
    };
    let index = inside.flat_map(|(_, range)| range.clone()).find(escaped)?;
    let ray = case.rays.get(index)?;
    Some(format!("ray {index} from inside a closed mesh escapes: {ray:?}"))
}
