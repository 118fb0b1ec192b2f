//! What is checked of a case: see [`super`].

use super::work::is_same_work;
use super::{Accuracy, Failure, Judged, Report, counters, relations};
use crate::cases::{Case, Tree};
use crate::compare::{Mismatch, Summary, across_queries, against_oracle, fronts, nearly, same_bits};
use crate::oracle::{Expectation, Oracle};
use crate::rays::RayClass;
use glam::DMat3;
use ropewalk::catalogue::{Row, StackMemory, TrailOptions, is_offered};
use ropewalk::{
    Answer, BuildOptions, BuildReport, Builder, Counters, DeviceKind, Instance, Query, Ray, Scene, Structure,
    StructureSpec, TraceOptions, Traced, Transform, Walk,
};
use std::cell::OnceCell;

/// A row's answers for one case and structure.
pub(super) struct Run {
    pub(super) row: usize,
    pub(super) plain: Traced,
    pub(super) counted: Traced,
}

/// Structures whose answers are the same to the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Kin {
    /// Whether triangles have one side.
    one_sided: bool,
    /// Of two levels, whether objects are in frames of their own. A ray that is taken to an object's space is rounded, and so is
    /// a triangle that is turned: hits are the same only among those who do the same.
    two_level: Option<bool>,
}

impl Kin {
    fn of(structure: StructureSpec, case: &Case) -> Self {
        let two_level = match structure {
            // Where nothing is moved and nothing turned, nothing is rounded.
            StructureSpec::TwoLevel(options) if options.oriented || !is_unmoved(case) => {
                Some(options.oriented)
            }
            StructureSpec::Instanced(_) if !is_unmoved(case) => Some(false),
            _ => None,
        };
        Self { one_sided: structure.is_one_sided(), two_level }
    }
}

/// How many times longer the scene's transforms make some vectors than others, at most.
fn stretch(scene: &Scene) -> f64 {
    let of_instance = |instance: &Instance| {
        let matrix = instance.transform.to_world().matrix3.as_dmat3();
        let norm = |matrix: DMat3| matrix.to_cols_array().map(|it| it * it).iter().sum::<f64>().sqrt();
        norm(matrix) * norm(matrix.inverse())
    };
    scene.instances.iter().map(of_instance).fold(1.0, f64::max)
}

/// Whether all instances are where their objects are.
fn is_unmoved(case: &Case) -> bool {
    case.scene.instances.iter().all(|instance| instance.transform == Transform::IDENTITY)
}

/// The first answer to a query, of one kin: what all later rows of its kin are compared with.
struct First {
    row: Row,
    kin: Kin,
    traced: Traced,
    /// What the oracle saw, where it had nothing to object.
    truth: Option<Summary>,
}

/// One case on its way through all structures and rows.
pub(super) struct Bench<'a> {
    pub(super) judged: &'a Judged,
    pub(super) accuracy: Accuracy,
    pub(super) rows: &'a [Row],
    pub(super) report: Report,
    /// The oracles of those whose triangles have one side, of those who take rays to objects, and of those who do both; made
    /// where a row asks for them.
    truths: [OnceCell<(Oracle, Expectation)>; 3],
    first: Vec<First>,
    /// The counters of walks that do not cull, which the order of children must not change.
    unculled: Vec<(usize, Tree, Vec<Counters>)>,
}

impl<'a> Bench<'a> {
    pub(super) fn new(judged: &'a Judged, accuracy: Accuracy, rows: &'a [Row]) -> Self {
        let report = Report::new(rows);
        let truths = Default::default();
        Self { judged, accuracy, rows, report, truths, first: Vec::new(), unculled: Vec::new() }
    }

    pub(super) fn fail(&mut self, row: usize, structure: Tree, what: impl Into<String>) {
        let failure = Failure { case: self.judged.case.name, structure, what: what.into() };
        self.report.rows[row].failures.push(failure);
    }

    /// The oracle of a structure, and what it says of the case's rays.
    pub(super) fn truth(&self, structure: StructureSpec) -> (&Oracle, &Expectation) {
        let kin = Kin::of(structure, &self.judged.case);
        let place = match (kin.one_sided, kin.two_level.is_some()) {
            (false, false) => return (&self.judged.oracle, &self.judged.expectation),
            (true, false) => 0,
            (false, true) => 1,
            (true, true) => 2,
        };
        let made = || {
            let Judged { oracle, expectation, case } = self.judged;
            let (mut oracle, mut expectation) = (oracle.clone(), expectation.clone());
            if kin.two_level.is_some() {
                oracle = oracle.taking_rays(stretch(&case.scene));
                expectation = oracle.expect(case.rays.clone());
            }
            if kin.one_sided {
                (oracle, expectation) = (oracle.one_sided(), expectation.one_sided());
            }
            (oracle, expectation)
        };
        let (oracle, expectation) = self.truths[place].get_or_init(made);
        (oracle, expectation)
    }

    /// Demands agreement of two tracers of some rays, as closely as the device allows.
    pub(super) fn agree(
        &self,
        structure: StructureSpec,
        rays: &[Ray],
        (reference, given): (&Traced, &Traced),
        counters: bool,
    ) -> Result<Summary, Mismatch> {
        match self.accuracy {
            Accuracy::Exact => same_bits(rays, reference, given, counters),
            Accuracy::Relaxed => nearly(self.truth(structure).0, rays, reference, given),
        }
    }

    pub(super) fn judge(&mut self, structure: &Structure, tree: Tree, runs: Vec<Run>) {
        for run in &runs {
            self.judge_run(structure, tree, run);
        }
        if self.accuracy == Accuracy::Exact {
            // A real GPU may fuse other operations in the kernel of another query.
            self.judge_walks(tree, &runs);
            let counted: Vec<_> =
                runs.iter().map(|run| (run.row, self.rows[run.row], &run.counted)).collect();
            for (row, what) in relations::relations(structure.kind(), &self.judged.case, &counted) {
                self.fail(row, tree, what);
            }
        }
        for run in runs {
            let row = self.rows[run.row];
            let unculled = Walk::Stack(ropewalk::bvh::StackOrder::Unordered);
            if let (true, Query::Closest, Some(counters)) =
                (row.walk == unculled, row.query, run.counted.counters)
            {
                self.unculled.push((run.row, tree, counters));
            }
        }
    }

    /// Demands that the answers of each walk to different queries agree.
    fn judge_walks(&mut self, tree: Tree, runs: &[Run]) {
        let mut judged: Vec<Walk> = Vec::new();
        for run in runs {
            let walk = self.rows[run.row].walk;
            if judged.contains(&walk) {
                continue;
            }
            judged.push(walk);
            let same_walk = |run: &&Run| self.rows[run.row].walk == walk;
            let of_walk: Vec<&Traced> = runs.iter().filter(same_walk).map(|run| &run.counted).collect();
            if let Err(mismatch) = across_queries(&self.judged.case.rays, &of_walk) {
                let all: Vec<usize> = runs.iter().filter(same_walk).map(|run| run.row).collect();
                all.into_iter().for_each(|row| self.fail(row, tree, mismatch.to_string()));
            }
        }
    }

    fn judge_run(&mut self, structure: &Structure, tree: Tree, run: &Run) {
        let row = self.rows[run.row];
        let rays = &self.judged.case.rays;
        let one_sided = row.structure.is_one_sided();
        let agree =
            |reference, given, counters| self.agree(row.structure, rays, (reference, given), counters);
        let mut wrong = Vec::new();
        let mut note = |what: &str, result: Result<Summary, Mismatch>| match result {
            Ok(summary) => Some(summary),
            Err(mismatch) => {
                wrong.push(format!("{what}: {mismatch}"));
                None
            }
        };
        let kin = Kin::of(row.structure, &self.judged.case);
        let first_of =
            |kin: Kin| self.first.iter().find(|first| first.row.query == row.query && first.kin == kin);
        let first = first_of(kin);
        let agreed = first.map(|first| {
            let what =
                format!("against {} on {} ({})", first.row.walk, first.row.structure, first.row.device);
            note(&what, agree(&first.traced, &run.counted, false))
        });
        // What is the same to the bit as a true answer is true: the oracle need not say so again.
        let known = match (first, agreed, self.accuracy) {
            (Some(first), Some(Some(_)), Accuracy::Exact) => first.truth,
            _ => None,
        };
        let truth = known.or_else(|| {
            note("against the oracle", against_oracle(self.truth(row.structure).1, &run.counted))
        });
        // The others of one side have the words of the first.
        if let (true, Accuracy::Exact, None, Some(both)) =
            (one_sided, self.accuracy, first, first_of(Kin { one_sided: false, ..kin }))
        {
            let what = format!("against two sides of {}", both.row.structure);
            note(&what, fronts(&self.judged.expectation, &both.traced, &run.counted));
        }
        note("without counters", agree(&run.counted, &run.plain, false));
        let twin = twin(row.walk);
        if row.device == DeviceKind::Gpu && is_offered(structure.kind(), twin, row.query, DeviceKind::Cpu) {
            let options = TraceOptions { counters: true };
            match structure.trace(twin, row.query, rays, options) {
                Ok(twin) => drop(note("against its twin on the cpu", agree(&twin, &run.counted, true))),
                Err(error) => wrong.push(error.to_string()),
            }
        }
        wrong.extend(escaped(&self.judged.case, one_sided, &run.counted));
        if run.plain.counters.is_some() {
            wrong.push("there are counters that nobody asked for".into());
        }
        wrong.extend(counters::check(structure, row, rays, &run.counted).err());
        let is_first = first.is_none();

        let result = &mut self.report.rows[run.row];
        result.cases += 1;
        result.rays += rays.len();
        result.clear += truth.map_or(0, |summary| summary.clear);
        result.differing += agreed.flatten().map_or(0, |summary| summary.differing);
        if is_first {
            self.first.push(First { row, kin, traced: run.counted.clone(), truth });
        }
        wrong.into_iter().for_each(|what| self.fail(run.row, tree, what));
    }

    /// Gives back what came of the case, with what can be said only when all structures are through.
    pub(super) fn finish(mut self) -> Report {
        if self.accuracy == Accuracy::Relaxed {
            return self.report;
        }
        let mut wrong = Vec::new();
        for (index, (_, a, reference)) in self.unculled.iter().enumerate() {
            for (row, b, given) in &self.unculled[index + 1..] {
                if is_same_but_for_order(*a, *b) && !is_same_work(reference, given) {
                    let what = "putting leaves first changed how much a walk without culling does";
                    wrong.push((*row, *b, what));
                }
            }
        }
        wrong.into_iter().for_each(|(row, structure, what)| self.fail(row, structure, what));
        self.report
    }
}

/// The walk of the CPU that does what a walk of a GPU does: there is no memory of workgroups there.
fn twin(walk: Walk) -> Walk {
    match walk {
        Walk::RestartTrail(options) => {
            Walk::RestartTrail(TrailOptions { memory: StackMemory::Private, ..options })
        }
        other => other,
    }
}

fn is_same_but_for_order(a: Tree, b: Tree) -> bool {
    let (StructureSpec::Bvh(of_a), StructureSpec::Bvh(of_b)) = (a.spec, b.spec) else { return false };
    a.is_chain == b.is_chain && BuildOptions { leaf_order: of_b.leaf_order, ..of_a } == of_b
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
    // These have each triangle once, and references to it in their elements, leaves or objects.
    let is_once = matches!(
        structure,
        Structure::List(_) | Structure::KdTree(_) | Structure::TwoLevel(_) | Structure::Instanced(_)
    );
    let held = if is_once { report.triangles } else { report.references };
    if held != structure.triangles().len() {
        return Err("the report counts references that are not there".into());
    }
    let of_list = |spec: &StructureSpec| match spec {
        StructureSpec::List(options) => options.build_options(),
        _ => None,
    };
    // A list from no binary tree may be as deep as its hierarchy likes, and repeats nothing.
    let options = spec.build_options().copied().or_else(|| of_list(&spec));
    // Cells share triangles as their splits will have it.
    if !matches!(structure, Structure::KdTree(_) | Structure::TwoLevel(_)) {
        references(report, &options.unwrap_or_default())?;
    }
    // That a binary tree has the depth that was asked for; one made of it is no deeper.
    if let Some(options) = options.filter(|options| report.depth > options.max_depth) {
        return Err(format!("a leaf lies at depth {}, below {}", report.depth, options.max_depth));
    }
    match (structure, spec) {
        (Structure::Bvh(bvh), StructureSpec::Bvh(_)) => bvh.validate().map_err(|error| error.to_string()),
        (Structure::WideBvh(bvh), StructureSpec::WideBvh(options)) => {
            if bvh.width() != options.width {
                return Err(format!("the nodes have {} children", bvh.width().children()));
            }
            bvh.validate().map_err(|error| error.to_string())
        }
        (Structure::Bvh8(bvh), StructureSpec::Bvh8(options)) => {
            if options.level.is_some_and(|level| level.is_available() && level != bvh.level()) {
                return Err(format!("walks use the vectors of '{}'", bvh.level()));
            }
            bvh.validate().map_err(|error| error.to_string())
        }
        (Structure::Instanced(scene), StructureSpec::Instanced(options)) => {
            if options.level.is_some_and(|level| level.is_available() && level != scene.level()) {
                return Err(format!("walks use the vectors of '{}'", scene.level()));
            }
            scene.validate().map_err(|error| error.to_string())
        }
        (Structure::List(list), StructureSpec::List(options)) => {
            if *list.options() != options {
                return Err("the lists were made otherwise than was asked for".into());
            }
            list.validate().map_err(|error| error.to_string())
        }
        (Structure::KdTree(tree), StructureSpec::KdTree(_)) => {
            tree.validate().map_err(|error| error.to_string())
        }
        (Structure::TwoLevel(scene), StructureSpec::TwoLevel(options)) => {
            if *scene.options() != options {
                return Err("the levels were made otherwise than was asked for".into());
            }
            scene.validate().map_err(|error| error.to_string())
        }
        _ => Err("another kind of structure was built than was asked for".into()),
    }
}

/// Checks that triangles stand in several leaves only where the builder may put them there, and no more than allowed.
fn references(report: &BuildReport, options: &BuildOptions) -> Result<(), String> {
    let Some(repeats) = report.references.checked_sub(report.triangles) else {
        return Err(format!("{} references to {} triangles", report.references, report.triangles));
    };
    let allowed = match options.builder {
        Builder::Sbvh => report.triangles * options.duplication as usize / 100,
        Builder::BinnedSah | Builder::SweepSah => 0,
    };
    if repeats <= allowed { Ok(()) } else { Err(format!("{repeats} repeats, {allowed} may be")) }
}

/// The first ray that left a closed mesh, or came in, unseen. Where triangles have one side, their backs let rays out.
fn escaped(case: &Case, one_sided: bool, traced: &Traced) -> Option<String> {
    let escaped = |index: &usize| match &traced.answer {
        Answer::Closest(hits) => hits.get(*index).is_some_and(|hit| !hit.is_hit()),
        Answer::Any(hits) => hits.get(*index) == Some(&false),
        Answer::Count(counts) => counts.get(*index) == Some(&0),
        Answer::All(lists) => lists.of(*index).is_empty(),
    };
    let of_class = |wanted: RayClass| {
        let ranges = case.classes.iter().filter(move |(class, _)| *class == wanted);
        ranges.flat_map(|(_, range)| range.clone())
    };
    let from_inside = of_class(RayClass::Inside).filter(|_| !one_sided).find(escaped);
    let from_outside = || of_class(RayClass::Outside).find(escaped);
    let (index, way) = match from_inside {
        Some(index) => (index, "from inside a closed mesh escapes"),
        None => (from_outside()?, "from outside comes into a closed mesh unseen"),
    };
    Some(format!("ray {index} {way}: {:?}", case.rays.get(index)?))
}
