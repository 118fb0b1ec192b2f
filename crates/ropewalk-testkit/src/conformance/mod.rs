//! The conformance suite: every row of the catalogue over every case, on any device.
//!
//! For each case and structure, each row is traced with and without counters, and must
//! * give answers that the f64 oracle accepts, of one side or of two as the structure has it, and status words that fit,
//! * let no ray escape from a closed mesh, nor into one,
//! * give the same answers with counters as without,
//! * agree with all other rows of its query and as many sides, whatever their structure and walk: to the bit on exact
//!   devices; and of one side, have no other hits than those of two sides, and lack none of a front,
//! * agree with its own answers to the other queries,
//! * count what its walk may count: see [`counters`] and [`relations`],
//! * refuse a tree that is deeper than its register, and no other: see [`refusal`],
//! * of traversal lists: answer rays that begin at a head as those that begin with the first element (see `heads`), and go
//!   through the second layer with what they have of the first (see `layers`),
//! * on a GPU: agree with its twin on the CPU, counters included on exact devices.
//!
//! No walk is the reference: brute force, too, is a row like any other, and is judged by the oracle.
//!
//! ```
//! use ropewalk::{DeviceKind, catalogue};
//! use ropewalk_testkit::conformance::{Accuracy, Cpu, Suite};
//! use ropewalk_testkit::cases::Case;
//! let cases = Case::named("one-triangle").into_iter().collect();
//! let rows: Vec<_> = catalogue::rows().into_iter().filter(|row| row.device == DeviceKind::Cpu).collect();
//! let report = Suite::of(cases, Accuracy::Exact).run(&rows, &mut Cpu::default(), &mut |_, _| {});
//! assert!(report.is_passed(), "{report}");
//! ```

mod checks;
pub mod counters;
mod heads;
mod layers;
mod registers;
pub mod relations;
mod report;
mod short_stacks;
mod turns;
mod work;

pub use registers::refusal;
pub use report::{Failure, Report, RowResult};
pub use short_stacks::{Compared, ShortStacks, every_short_stack, every_short_stack_on_cpu};

use crate::cases::{Case, Tree};
use crate::oracle::{Expectation, Oracle};
use checks::{Bench, Run};
use rayon::prelude::*;
use ropewalk::catalogue::Row;
use ropewalk::traversal_list::Starts;
use ropewalk::{Query, Ray, Structure, TraceOptions, Traced, Walk};
use std::sync::atomic::{AtomicUsize, Ordering};
use turns::Turns;

/// What is judged: something that traces batches through a structure.
pub trait Device {
    /// Makes ready to trace through a structure, until the next one.
    ///
    /// # Errors
    /// When the device cannot; the suite reports the text.
    fn prepare(&mut self, structure: &Structure) -> Result<(), String>;

    /// Traces through the structure that was prepared last.
    ///
    /// # Errors
    /// When the device cannot; the suite reports the text.
    fn trace(
        &mut self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, String>;

    /// Traces through the traversal lists that were prepared last, each ray from where `starts` says. `None` where the
    /// device does not offer that, which the suite then does not ask.
    ///
    /// # Errors
    /// When the device cannot; the suite reports the text.
    fn trace_from(
        &mut self,
        query: Query,
        rays: &[Ray],
        starts: Starts<'_>,
        options: TraceOptions,
    ) -> Result<Option<Traced>, String> {
        let _ = (query, rays, starts, options);
        Ok(None)
    }
}

/// The CPU.
#[derive(Clone, Debug, Default)]
pub struct Cpu {
    structure: Option<Structure>,
}

impl Device for Cpu {
    fn prepare(&mut self, structure: &Structure) -> Result<(), String> {
        self.structure = Some(structure.clone());
        Ok(())
    }

    fn trace(
        &mut self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, String> {
        let structure = self.structure.as_ref().ok_or("no structure is prepared")?;
        structure.trace(walk, query, rays, options).map_err(|error| error.to_string())
    }

    fn trace_from(
        &mut self,
        query: Query,
        rays: &[Ray],
        starts: Starts<'_>,
        options: TraceOptions,
    ) -> Result<Option<Traced>, String> {
        let structure = self.structure.as_ref().ok_or("no structure is prepared")?;
        structure.trace_from(query, rays, starts, options).map(Some).map_err(|error| error.to_string())
    }
}

/// How well a device computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accuracy {
    /// Every operation is rounded correctly and none is fused: the CPU, lavapipe, `SwiftShader`. Answers are the
    /// same to the bit.
    Exact,
    /// A real GPU: ids are the same and `t` within 1e-5, ties and edges aside.
    Relaxed,
}

/// The cases with what the oracle says of them. Made once, it judges any number of devices.
#[derive(Clone, Debug)]
pub struct Suite {
    cases: Vec<Judged>,
    accuracy: Accuracy,
    turns: usize,
}

/// A case with its oracle.
#[derive(Clone, Debug)]
struct Judged {
    case: Case,
    oracle: Oracle,
    expectation: Expectation,
}

impl Suite {
    /// All cases.
    #[must_use]
    pub fn new(accuracy: Accuracy) -> Self {
        Self::of(Case::every(), accuracy)
    }

    /// Some cases.
    #[must_use]
    pub fn of(cases: Vec<Case>, accuracy: Accuracy) -> Self {
        let rounding = if accuracy == Accuracy::Exact { 1.0 } else { Oracle::RELAXED };
        let judge = |case: Case| {
            // A scene that cannot be flattened cannot be built either, which its rows then report.
            let oracle = Oracle::new(&case.scene.flatten().unwrap_or_default()).with_rounding(rounding);
            Judged { expectation: oracle.expect(case.rays.clone()), oracle, case }
        };
        Self { cases: cases.into_iter().map(judge).collect(), accuracy, turns: 1 }
    }

    /// The same with fewer pairs of walks and structures, for devices on which a pass is dear: of each kind of structure, walks other
    /// than the default one are judged on one of `turns` structures only, in each case on others. Each is still judged in every case
    /// and on every structure.
    #[must_use]
    pub fn in_turns(self, turns: usize) -> Self {
        Self { turns, ..self }
    }

    /// The number of cases.
    #[must_use]
    pub fn case_count(&self) -> usize {
        self.cases.len()
    }

    /// Judges rows on a device. `progress` hears after each case how many of how many are done.
    pub fn run(
        &self,
        rows: &[Row],
        device: &mut dyn Device,
        progress: &mut dyn FnMut(usize, usize),
    ) -> Report {
        let mut report = Report::new(rows);
        for (done, judged) in self.cases.iter().enumerate() {
            report.add(self.run_case(done, judged, rows, device));
            progress(done + 1, self.cases.len());
        }
        report
    }

    /// The same on the CPU, with the cases spread over the threads of the caller's pool. `progress` hears from any of
    /// them.
    pub fn run_on_cpu(&self, rows: &[Row], progress: &(dyn Fn(usize, usize) + Sync)) -> Report {
        let done = AtomicUsize::new(0);
        let reports: Vec<Report> = self
            .cases
            .par_iter()
            .with_max_len(1)
            .enumerate()
            .map(|(index, judged)| {
                let report = self.run_case(index, judged, rows, &mut Cpu::default());
                progress(done.fetch_add(1, Ordering::Relaxed) + 1, self.cases.len());
                report
            })
            .collect();
        reports.into_iter().fold(Report::new(rows), |mut sum, report| {
            sum.add(report);
            sum
        })
    }

    fn run_case(&self, index: usize, judged: &Judged, rows: &[Row], device: &mut dyn Device) -> Report {
        let mut bench = Bench::new(judged, self.accuracy, rows);
        let turns = Turns::new(rows, self.turns);
        for structure in turns.structures() {
            let mut asked =
                (0..rows.len()).filter(|&row| rows[row].structure == structure).collect::<Vec<_>>();
            asked.retain(|&row| turns.is_due(&rows[row], index));
            for tree in judged.case.trees(structure) {
                judge(&mut bench, &asked, tree, device);
            }
        }
        bench.finish()
    }
}

/// Judges rows of one structure, over one tree.
fn judge(bench: &mut Bench<'_>, rows: &[usize], tree: Tree, device: &mut dyn Device) {
    let prepared = tree.build(&bench.judged.case).and_then(|structure| {
        checks::structure(&structure, tree.spec, &bench.judged.case)?;
        device.prepare(&structure)?;
        Ok(structure)
    });
    let structure = match prepared {
        Ok(structure) => structure,
        Err(why) => {
            rows.iter().for_each(|&row| bench.fail(row, tree, why.clone()));
            return;
        }
    };
    let mut runs = Vec::new();
    for &row in rows {
        let Row { walk, query, .. } = bench.rows[row];
        let mut trace =
            |counters| device.trace(walk, query, &bench.judged.case.rays, TraceOptions { counters });
        let traced = trace(false).and_then(|plain| Ok((plain, trace(true)?)));
        match (traced, refusal(&structure, walk)) {
            (Ok((plain, counted)), None) => runs.push(Run { row, plain, counted }),
            (Err(why), Some(due)) if why == due => {}
            (Ok(_), Some(due)) => bench.fail(row, tree, format!("it answers where it must refuse: {due}")),
            (Err(why), _) => bench.fail(row, tree, why),
        }
    }
    let listed: Vec<usize> =
        runs.iter().map(|run| run.row).filter(|&row| bench.rows[row].walk == Walk::List).collect();
    if let (Structure::List(list), Accuracy::Exact) = (&structure, bench.accuracy) {
        for (row, what) in layers::check(list, &bench.judged.case.rays, bench.rows, &runs) {
            bench.fail(row, tree, what);
        }
    }
    bench.judge(&structure, tree, runs);
    if let Structure::List(list) = &structure {
        heads::judge(bench, list, (tree, &listed), device);
    }
}
