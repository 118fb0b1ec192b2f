//! The runs: trees, rays, answers, counts, times.

use super::as_printed;
use super::bands::{PUBLISHED, REFERENCE, WANTED, is_within};
use super::rays::Seen;
use super::record::TrailRow;
use crate::bench::{Judge, Progress, Watch};
use crate::comparison::{ComparisonError, Means, Rates, ShortStack, TreeSettings, builder_name, time, walks};
use ropewalk::{
    Answer, BuildError, BuildOptions, CounterTotals, FlatScene, Hit, Query, Ray, Scene, Structure,
    StructureSpec, TraceOptions, Traced, Walk,
};
use ropewalk_gpu::{Device, GpuError, Traceable};
use ropewalk_testkit::rays::RayClass;
use std::sync::Arc;

/// What is compared.
#[derive(Clone, Debug)]
pub struct TrailSettings {
    /// Which trees are walked.
    pub trees: TreeSettings,
    /// Sizes of the short stack.
    pub short_stacks: Vec<u32>,
    /// The classes of rays.
    pub classes: Vec<RayClass>,
    /// Rays a class, over all views.
    pub rays: usize,
    /// From where they are seen.
    pub seen: Seen,
    /// Where they are traced. Counts are the same everywhere; the CPU's come first.
    pub devices: Vec<Device>,
    /// How often each walk is timed; 0 counts only.
    pub rounds: usize,
    /// Whether entries are culled again when they are popped, as the catalogue's walks do. The paper does not; without
    /// it counts alone are taken, on the CPU.
    pub culls_at_pop: bool,
}

impl TrailSettings {
    /// The paper's comparison, without times.
    #[must_use]
    pub fn new() -> Self {
        Self {
            trees: TreeSettings::default(),
            short_stacks: vec![0, 1, 2, 3, 4, 5, 8],
            classes: vec![
                RayClass::Primary,
                RayClass::AmbientOcclusion,
                RayClass::DiffuseBounce,
                RayClass::Shadow,
            ],
            rays: 1 << 16,
            seen: Seen::Around,
            devices: vec![Device::Cpu],
            rounds: 0,
            culls_at_pop: true,
        }
    }
}

impl Default for TrailSettings {
    fn default() -> Self {
        Self::new()
    }
}

/// Compares short stacks with the full stack on a scene.
///
/// # Errors
/// When a tree cannot be built, a device fails, a walk's answers are wrong, or the caller stops it.
pub fn run(
    name: &str,
    scene: &Scene,
    settings: &TrailSettings,
    watch: &Watch<'_>,
) -> Result<Vec<TrailRow>, ComparisonError> {
    let flat = scene.flatten().map_err(BuildError::from)?;
    if flat.triangles.is_empty() {
        return Err(ComparisonError::Empty);
    }
    let judge = Judge::new(&flat, &settings.devices);
    // All trees are asked with the same rays: those that one tree's hits give, which are every tree's.
    let maker = scene.build(&BuildOptions::default())?;
    let batches = make_rays(&flat, &Structure::Bvh(maker), settings)?;
    drop(flat);
    let total = settings.trees.count() * batches.len() * settings.devices.len();
    let mut done = 0;
    let mut rows = Vec::new();
    for options in settings.trees.each() {
        let structure = Arc::new(Structure::Bvh(scene.build(&options)?));
        for device in &settings.devices {
            let traceable = device.prepare(Arc::clone(&structure))?;
            for batch in &batches {
                let what = format!("{} rays, {}", batch.class, StructureSpec::Bvh(options));
                if watch(Progress { what: &what, done, total }).is_break() {
                    return Err(ComparisonError::Stopped);
                }
                let tree = Tree { name, triangles: scene.triangle_count(), options, traceable: &traceable };
                rows.extend(tree.compare(batch, settings, &judge, watch)?);
                done += 1;
            }
        }
    }
    Ok(rows)
}

/// Rays of a class.
struct Batch {
    class: RayClass,
    rays: Vec<Ray>,
}

fn make_rays(
    flat: &FlatScene,
    structure: &Structure,
    settings: &TrailSettings,
) -> Result<Vec<Batch>, ComparisonError> {
    let failure = std::cell::RefCell::default();
    let closest = |rays: &[Ray]| match structure.trace(
        Walk::default(),
        Query::Closest,
        rays,
        TraceOptions::default(),
    ) {
        Ok(Traced { answer: Answer::Closest(hits), .. }) => hits,
        Ok(_) => vec![Hit::MISS; rays.len()],
        Err(error) => {
            failure.replace(Some(error));
            vec![Hit::MISS; rays.len()]
        }
    };
    let batch = |&class: &RayClass| {
        let rays = settings.seen.rays(flat, class, settings.rays, &closest);
        (!rays.is_empty()).then_some(Batch { class, rays })
    };
    let batches = settings.classes.iter().filter_map(batch).collect();
    match failure.into_inner() {
        Some(error) => Err(GpuError::from(error).into()),
        None => Ok(batches),
    }
}

/// A tree on a device.
struct Tree<'a> {
    name: &'a str,
    /// As the scene has them: what the reference is looked up by.
    triangles: usize,
    options: BuildOptions,
    traceable: &'a Traceable,
}

impl Tree<'_> {
    fn compare(
        &self,
        batch: &Batch,
        settings: &TrailSettings,
        judge: &Judge,
        watch: &Watch<'_>,
    ) -> Result<Vec<TrailRow>, ComparisonError> {
        let walks = walks(&settings.short_stacks);
        let options = TraceOptions { counters: true };
        let query = batch.class.query();
        // On the CPU: every device must agree with it.
        let expected = self
            .traceable
            .structure()
            .trace(Walk::default(), query, &batch.rays, options)
            .map_err(GpuError::from)?;
        let mut counted = Vec::new();
        for &walk in &walks {
            let as_printed =
                || as_printed::trace(self.traceable.structure(), ShortStack::of(walk), query, &batch.rays);
            let traced = match (!settings.culls_at_pop).then(as_printed).flatten() {
                Some(traced) => traced,
                None => self.traceable.trace(walk, query, &batch.rays, options)?,
            };
            judge.compare(self.traceable.device(), &batch.rays, &expected, &traced).map_err(|what| {
                ComparisonError::Disagrees {
                    walk: walk.to_string(),
                    device: self.traceable.device().to_string(),
                    structure: StructureSpec::Bvh(self.options).to_string(),
                    asked: format!("{} rays", batch.class),
                    what,
                }
            })?;
            counted.push(traced.totals().unwrap_or_default());
        }
        let what = format!("timing {} rays, {}", batch.class, StructureSpec::Bvh(self.options));
        let rounds = if settings.culls_at_pop { settings.rounds } else { 0 };
        let times = time(&walks, rounds, &what, watch, |walk| {
            self.traceable.trace(walk, query, &batch.rays, TraceOptions::default()).map(drop)
        })?;
        let (full, full_times) = (counted[0], times[0].as_slice());
        let rows = walks.iter().zip(&counted).zip(&times).map(|((&walk, totals), times)| {
            let means = Means::new(batch.rays.len(), totals, &full);
            let rates = Rates::new(batch.rays.len(), times, full_times);
            self.row(batch, ShortStack::of(walk), means, rates, totals, settings.culls_at_pop)
        });
        Ok(rows.collect())
    }

    fn row(
        &self,
        batch: &Batch,
        short_stack: ShortStack,
        means: Means,
        rates: Rates,
        totals: &CounterTotals,
        culls_at_pop: bool,
    ) -> TrailRow {
        let report = self.traceable.structure().report();
        let entries = short_stack.entries();
        let ratio_inner = means.ratio_inner;
        let reference = REFERENCE.iter().find(|reference| {
            reference.triangles == self.triangles
                && reference.builder == self.options.builder
                && reference.max_leaf == self.options.max_leaf
                && reference.class == batch.class
        });
        let reference_ratio = reference.and_then(|reference| {
            let of = |&&(size, _): &&(u32, f64)| Some(size) == entries;
            reference.ratios.iter().find(of).map(|&(_, ratio)| ratio)
        });
        TrailRow {
            scene: self.name.into(),
            builder: builder_name(self.options.builder),
            max_leaf: self.options.max_leaf,
            rays: batch.class.name(),
            short_stack,
            culls_at_pop,
            inner_visits: means.inner_visits,
            leaf_visits: means.leaf_visits,
            primitive_tests: means.primitive_tests,
            restarts: means.restarts,
            ratio_inner,
            rays_per_s: rates.per_second,
            device: self.traceable.device().to_string(),
            ratio_time: rates.ratio_time,
            threads: matches!(self.traceable.device(), Device::Cpu).then(rayon::current_num_threads),
            query: batch.class.query().name(),
            ray_count: batch.rays.len(),
            verified: batch.rays.len(),
            triangles: report.triangles,
            references: report.references,
            depth: report.depth,
            deepest_stack: totals.stack_depth,
            in_band: entries.and_then(|entries| is_within(&WANTED, entries, ratio_inner)),
            in_published_band: entries.and_then(|entries| is_within(&PUBLISHED, entries, ratio_inner)),
            reference_ratio,
            deviation_percent: reference_ratio.map(|reference| 100.0 * (ratio_inner / reference - 1.0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk_testkit::meshes;
    use std::ops::ControlFlow;

    fn settings() -> TrailSettings {
        let trees = TreeSettings { leaf_caps: vec![1, 4], ..TreeSettings::default() };
        TrailSettings { trees, rays: 600, ..TrailSettings::new() }
    }

    fn on(_: Progress<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    #[test]
    fn each_row_is_there_and_ratios_fall() {
        let scene = Scene::from_mesh(meshes::soup(2000, 0.2, 5));
        let rows = run("soup", &scene, &TrailSettings { rounds: 1, ..settings() }, &on).unwrap();
        assert_eq!(rows.len(), 2 * 2 * 4 * 8);
        for group in rows.chunks(8) {
            assert_eq!(group[0].short_stack, ShortStack::Full);
            assert_eq!((group[0].ratio_inner, group[0].restarts), (1.0, 0.0));
            let trail = &group[1..];
            assert!(trail[0].ratio_inner > 1.2, "{:?}", trail[0]);
            assert!(trail.windows(2).all(|pair| pair[0].ratio_inner >= pair[1].ratio_inner));
            assert!(trail.iter().all(|row| row.leaf_visits == group[0].leaf_visits));
            assert!(trail.iter().all(|row| row.verified == row.ray_count && row.rays_per_s.is_some()));
        }
        assert!(rows.iter().any(|row| row.references > row.triangles), "spatial splits add some");
    }

    /// The same answers, which [`run`] demands, and more visits where rays go on after a hit.
    #[test]
    fn without_culling_at_pop_there_are_more_visits() {
        let scene = Scene::from_mesh(meshes::soup(2000, 0.2, 5));
        let with = run("soup", &scene, &settings(), &on).unwrap();
        let without =
            run("soup", &scene, &TrailSettings { rounds: 1, culls_at_pop: false, ..settings() }, &on)
                .unwrap();
        for (with, without) in with.iter().zip(&without) {
            assert_eq!((with.rays, with.short_stack), (without.rays, without.short_stack));
            assert!(
                (with.culls_at_pop, without.culls_at_pop) == (true, false) && without.rays_per_s.is_none()
            );
            if with.query == "closest" && with.short_stack == ShortStack::Full {
                assert!(without.inner_visits > 1.005 * with.inner_visits, "{without:?}");
                assert_eq!(without.restarts, 0.0);
            }
        }
        assert_eq!(with.len(), without.len());
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
