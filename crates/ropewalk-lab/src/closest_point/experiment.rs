//! The runs: trees, points, answers, counts, times.

use super::judge::Judge;
use super::record::{PointComparison, PointRow, PointScene};
use super::reference::Reference;
use crate::bench::{Progress, Watch};
use crate::comparison::{ComparisonError, Means, Rates, TreeSettings, builder_name, time, walks};
use ropewalk::{
    BuildError, BuildOptions, CounterTotals, Scene, Structure, StructureSpec, TraceOptions, Walk,
};
use ropewalk_gpu::{Device, Traceable};
use ropewalk_testkit::points::{PointOracle, around};
use std::sync::Arc;

/// What is compared.
#[derive(Clone, Debug)]
pub struct PointSettings {
    /// Which trees are walked.
    pub trees: TreeSettings,
    /// Sizes of the short stack.
    pub short_stacks: Vec<u32>,
    /// How many points are asked.
    pub points: usize,
    /// What they are made from.
    pub seed: u64,
    /// How many of them brute force answers too; all where nothing is said.
    pub brute_force: Option<usize>,
    /// Where they are answered.
    pub devices: Vec<Device>,
    /// How often each walk is timed; 0 counts only.
    pub rounds: usize,
}

impl PointSettings {
    /// The CPU, without times.
    #[must_use]
    pub fn new() -> Self {
        Self {
            trees: TreeSettings::default(),
            short_stacks: vec![0, 4],
            points: 100_000,
            seed: 1,
            brute_force: None,
            devices: vec![Device::Cpu],
            rounds: 0,
        }
    }
}

impl Default for PointSettings {
    fn default() -> Self {
        Self::new()
    }
}

/// Compares the walks to closest points of a scene with each other, with the oracle and with brute force.
///
/// # Errors
/// When a tree cannot be built, a device fails, an answer is wrong, or the caller stops it.
pub fn run(
    name: &str,
    scene: &Scene,
    settings: &PointSettings,
    watch: &Watch<'_>,
) -> Result<PointComparison, ComparisonError> {
    let flat = scene.flatten().map_err(BuildError::from)?;
    if flat.triangles.is_empty() {
        return Err(ComparisonError::Empty);
    }
    let judge = Judge::new(&flat, &settings.devices);
    let oracle = PointOracle::new(&flat);
    drop(flat);
    let bvh = scene.build(&BuildOptions::default())?;
    let reference = Reference::new(&bvh, around(&scene.bounds(), settings.points, settings.seed))?;
    let oracle_points = reference.confirm_by_oracle(&oracle, watch)?;
    drop(oracle);
    let total = settings.trees.count() * settings.devices.len();
    let mut rows = Vec::new();
    for options in settings.trees.each() {
        let structure = Arc::new(Structure::Bvh(scene.build(&options)?));
        for device in &settings.devices {
            let what = format!("points, {}", StructureSpec::Bvh(options));
            let done = rows.len() / (1 + settings.short_stacks.len());
            if watch(Progress { what: &what, done, total }).is_break() {
                return Err(ComparisonError::Stopped);
            }
            let tree = Tree { name, options, traceable: &device.prepare(Arc::clone(&structure))? };
            rows.extend(tree.compare(&reference, settings, &judge, watch)?);
        }
    }
    let count = settings.brute_force.unwrap_or(usize::MAX);
    let brute_force_points = reference.confirm_by_brute_force(&bvh, count, watch)?;
    let scene = PointScene {
        scene: name.into(),
        triangles: bvh.report().triangles,
        points: reference.queries.len(),
        seed: settings.seed,
        brute_force_points,
        oracle_points,
        differences: rows.iter().map(|row| row.differing).sum(),
    };
    Ok(PointComparison { scenes: vec![scene], rows })
}

/// A tree on a device.
struct Tree<'a> {
    name: &'a str,
    options: BuildOptions,
    traceable: &'a Traceable,
}

/// What a walk did, once its answers were compared.
struct Counted {
    walk: Walk,
    totals: CounterTotals,
    differing: usize,
}

impl Tree<'_> {
    fn compare(
        &self,
        reference: &Reference,
        settings: &PointSettings,
        judge: &Judge,
        watch: &Watch<'_>,
    ) -> Result<Vec<PointRow>, ComparisonError> {
        let (traceable, queries) = (self.traceable, reference.queries.as_slice());
        let walks = walks(&settings.short_stacks);
        let mut counted = Vec::new();
        for &walk in &walks {
            let given = traceable.closest_points(walk, queries, TraceOptions { counters: true })?;
            let compared = judge.compare(traceable.device(), queries, &reference.answers, &given);
            let differing = compared.map_err(|what| ComparisonError::Disagrees {
                walk: walk.to_string(),
                device: traceable.device().to_string(),
                structure: StructureSpec::Bvh(self.options).to_string(),
                asked: "closest points against the full stack".into(),
                what,
            })?;
            counted.push(Counted { walk, totals: given.counters.iter().flatten().collect(), differing });
        }
        let what = format!("timing points, {}", StructureSpec::Bvh(self.options));
        let times = time(&walks, settings.rounds, &what, watch, |walk| {
            traceable.closest_points(walk, queries, TraceOptions::default()).map(drop)
        })?;
        let (full, full_times) = (counted[0].totals, times[0].as_slice());
        let rows = counted.iter().zip(&times).map(|(counted, times)| {
            let means = Means::new(queries.len(), &counted.totals, &full);
            self.row(queries.len(), counted, means, Rates::new(queries.len(), times, full_times))
        });
        Ok(rows.collect())
    }

    fn row(&self, points: usize, counted: &Counted, means: Means, rates: Rates) -> PointRow {
        let report = self.traceable.structure().report();
        PointRow {
            scene: self.name.into(),
            triangles: report.triangles,
            builder: builder_name(self.options.builder),
            max_leaf: self.options.max_leaf,
            walk: counted.walk.to_string(),
            device: self.traceable.device().to_string(),
            points,
            inner_visits: means.inner_visits,
            leaf_visits: means.leaf_visits,
            primitive_tests: means.primitive_tests,
            restarts: means.restarts,
            ratio_inner: means.ratio_inner,
            points_per_s: rates.per_second,
            ratio_time: rates.ratio_time,
            threads: matches!(self.traceable.device(), Device::Cpu).then(rayon::current_num_threads),
            references: report.references,
            depth: report.depth,
            deepest_stack: counted.totals.stack_depth,
            differing: counted.differing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::ClosestPoint;
    use ropewalk_testkit::meshes;
    use std::ops::ControlFlow;

    fn settings() -> PointSettings {
        let trees = TreeSettings { leaf_caps: vec![1, 4], ..TreeSettings::default() };
        PointSettings { trees, points: 700, ..PointSettings::new() }
    }

    fn on(_: Progress<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    #[test]
    fn each_row_is_there_and_everybody_confirms_it() {
        let scene = Scene::from_mesh(meshes::soup(2000, 0.2, 5));
        let settings = PointSettings { rounds: 1, brute_force: Some(300), ..settings() };
        let PointComparison { scenes, rows } = run("soup", &scene, &settings, &on).unwrap();
        let [record] = scenes.as_slice() else { panic!("{scenes:?}") };
        assert_eq!((record.triangles, record.points, record.seed), (2000, 700, 1));
        assert_eq!((record.oracle_points, record.brute_force_points, record.differences), (700, 300, 0));
        assert_eq!(rows.len(), 2 * 2 * 3);
        for tree in rows.chunks(3) {
            let [full, none, four] = tree else { panic!("{tree:?}") };
            assert_eq!((full.ratio_inner, full.restarts), (1.0, 0.0));
            assert!(none.ratio_inner > four.ratio_inner && four.ratio_inner >= 1.0, "{tree:?}");
            assert!(none.restarts > four.restarts);
            assert!(tree.iter().all(|row| row.leaf_visits == full.leaf_visits));
            assert!(tree.iter().all(|row| row.points_per_s.is_some_and(|rate| rate > 0.0)));
        }
        assert!(rows.iter().any(|row| row.references > row.triangles), "spatial splits add some");
    }

    #[test]
    fn a_walk_that_answers_otherwise_is_an_error_that_names_it() {
        let scene = Scene::from_mesh(meshes::soup(300, 0.3, 8));
        let options = BuildOptions::default();
        let bvh = scene.build(&options).unwrap();
        let mut reference = Reference::new(&bvh, around(&scene.bounds(), 100, 1)).unwrap();
        let judge = Judge::new(&scene.flatten().unwrap(), &[Device::Cpu]);
        let traceable = Device::Cpu.prepare(Arc::new(Structure::Bvh(bvh))).unwrap();
        let tree = Tree { name: "soup", options, traceable: &traceable };
        assert_eq!(tree.compare(&reference, &settings(), &judge, &on).unwrap().len(), 3);
        reference.answers.points[42] = ClosestPoint::NONE;
        let text = tree.compare(&reference, &settings(), &judge, &on).unwrap_err().to_string();
        assert!(text.starts_with("stack") && text.contains("query 42 (point ["), "{text}");
    }

    #[test]
    fn an_empty_scene_and_a_stop_are_errors() {
        let empty = run("nothing", &Scene::default(), &settings(), &on);
        assert!(matches!(empty, Err(ComparisonError::Empty)));
        let scene = Scene::from_mesh(meshes::icosphere(1));
        let stopped = run("sphere", &scene, &settings(), &|_| ControlFlow::Break(()));
        assert!(matches!(stopped, Err(ComparisonError::Stopped)));
    }
}
