//! The runs: trees, rays, answers, counts, times.

use super::bands::{PUBLISHED, REFERENCE, WANTED, is_within};
use super::rays::Seen;
use super::record::{ShortStack, TrailRow};
use crate::Spread;
use crate::bench::{Judge, Progress, Watch};
use ropewalk::catalogue::TrailOptions;
use ropewalk::{
    Answer, BuildError, BuildOptions, Builder, CounterTotals, FlatScene, Hit, Query, Ray, Scene, Structure,
    StructureSpec, TraceOptions, Traced, Walk,
};
use ropewalk_gpu::{Device, GpuError, Traceable};
use ropewalk_testkit::rays::RayClass;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;
use thiserror::Error;

/// What is compared.
#[derive(Clone, Debug)]
pub struct TrailSettings {
    /// What makes the trees.
    pub builders: Vec<Builder>,
    /// Their leaf caps.
    pub leaf_caps: Vec<u32>,
    /// Percent of references that the SBVH builder may add.
    pub duplication: u32,
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
}

impl TrailSettings {
    /// The paper's comparison, without times.
    #[must_use]
    pub fn new() -> Self {
        Self {
            builders: vec![Builder::SweepSah, Builder::Sbvh],
            leaf_caps: vec![1, 4, 8],
            duplication: BuildOptions::default().duplication,
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
        }
    }
}

impl Default for TrailSettings {
    fn default() -> Self {
        Self::new()
    }
}

/// Why there is no comparison.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TrailError {
    /// A tree was not built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A walk gives other answers than the full stack.
    #[error("{walk} on {device}, {structure}, {class} rays: {what}")]
    Disagrees {
        /// The walk.
        walk: String,
        /// The device.
        device: String,
        /// The tree.
        structure: String,
        /// The rays.
        class: &'static str,
        /// The first difference.
        what: String,
    },
    /// The scene has nothing to hit.
    #[error("the scene has no triangle that a ray could hit: there is nothing to compare")]
    Empty,
    /// The caller stopped it.
    #[error("stopped before the scene was through")]
    Stopped,
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
) -> Result<Vec<TrailRow>, TrailError> {
    let flat = scene.flatten().map_err(BuildError::from)?;
    if flat.triangles.is_empty() {
        return Err(TrailError::Empty);
    }
    let judge = Judge::new(&flat, &settings.devices);
    // All trees are asked with the same rays: those that one tree's hits give, which are every tree's.
    let maker = scene.build(&BuildOptions::default())?;
    let batches = make_rays(&flat, &Structure::Bvh(maker), settings)?;
    drop(flat);
    let total = settings.builders.len() * settings.leaf_caps.len() * batches.len() * settings.devices.len();
    let mut done = 0;
    let mut rows = Vec::new();
    for &builder in &settings.builders {
        for &max_leaf in &settings.leaf_caps {
            let options = BuildOptions {
                builder,
                max_leaf,
                duplication: settings.duplication,
                ..BuildOptions::default()
            };
            let structure = Arc::new(Structure::Bvh(scene.build(&options)?));
            for device in &settings.devices {
                let traceable = device.prepare(Arc::clone(&structure))?;
                for batch in &batches {
                    let what = format!("{} rays, {}", batch.class, StructureSpec::Bvh(options));
                    if watch(Progress { what: &what, done, total }).is_break() {
                        return Err(TrailError::Stopped);
                    }
                    let tree =
                        Tree { name, triangles: scene.triangle_count(), options, traceable: &traceable };
                    rows.extend(tree.compare(batch, settings, &judge, watch)?);
                    done += 1;
                }
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
) -> Result<Vec<Batch>, TrailError> {
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
    ) -> Result<Vec<TrailRow>, TrailError> {
        let trail = |&short_stack: &u32| {
            let options = TrailOptions { short_stack, ..TrailOptions::default() };
            (ShortStack::Entries(short_stack), Walk::RestartTrail(options))
        };
        let full = (ShortStack::Full, Walk::default());
        let walks: Vec<_> = std::iter::once(full).chain(settings.short_stacks.iter().map(trail)).collect();
        let options = TraceOptions { counters: true };
        let query = batch.class.query();
        // On the CPU: every device must agree with it.
        let expected = self
            .traceable
            .structure()
            .trace(Walk::default(), query, &batch.rays, options)
            .map_err(GpuError::from)?;
        let mut counted = Vec::new();
        for &(_, walk) in &walks {
            let traced = self.traceable.trace(walk, query, &batch.rays, options)?;
            judge.compare(self.traceable.device(), &batch.rays, &expected, &traced).map_err(|what| {
                TrailError::Disagrees {
                    walk: walk.to_string(),
                    device: self.traceable.device().to_string(),
                    structure: StructureSpec::Bvh(self.options).to_string(),
                    class: batch.class.name(),
                    what,
                }
            })?;
            counted.push(traced.totals().unwrap_or_default());
        }
        let times = self.time(batch, &walks, settings.rounds, watch)?;
        let full_visits = counted[0].inner_visits;
        let full_times = times[0].clone();
        Ok(walks
            .iter()
            .zip(&counted)
            .zip(&times)
            .map(|((&(short_stack, _), totals), times)| {
                self.row(batch, short_stack, totals, full_visits, times, &full_times)
            })
            .collect())
    }

    /// The seconds of each walk in each round.
    fn time(
        &self,
        batch: &Batch,
        walks: &[(ShortStack, Walk)],
        rounds: usize,
        watch: &Watch<'_>,
    ) -> Result<Vec<Vec<f64>>, TrailError> {
        let mut times = vec![Vec::with_capacity(rounds); walks.len()];
        for round in 0..rounds {
            let what = format!("timing {} rays, {}", batch.class, StructureSpec::Bvh(self.options));
            if watch(Progress { what: &what, done: round, total: rounds }) == ControlFlow::Break(()) {
                return Err(TrailError::Stopped);
            }
            for (&(_, walk), times) in walks.iter().zip(&mut times) {
                let start = Instant::now();
                self.traceable.trace(walk, batch.class.query(), &batch.rays, TraceOptions::default())?;
                times.push(start.elapsed().as_secs_f64());
            }
        }
        Ok(times)
    }

    fn row(
        &self,
        batch: &Batch,
        short_stack: ShortStack,
        totals: &CounterTotals,
        full_visits: u64,
        times: &[f64],
        full_times: &[f64],
    ) -> TrailRow {
        let report = self.traceable.structure().report();
        let rays = batch.rays.len() as f64;
        let mean = |sum: u64| sum as f64 / rays;
        // A tree of one leaf has no inner visit, with any stack.
        let ratio_inner =
            if full_visits == 0 { 1.0 } else { totals.inner_visits as f64 / full_visits as f64 };
        let ratios: Vec<f64> = times.iter().zip(full_times).map(|(time, full)| time / full).collect();
        let entries = match short_stack {
            ShortStack::Entries(entries) => Some(entries),
            ShortStack::Full => None,
        };
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
        let builder = Builder::NAMES.iter().find(|(_, builder)| *builder == self.options.builder);
        TrailRow {
            scene: self.name.into(),
            builder: builder.map_or("", |(name, _)| name),
            max_leaf: self.options.max_leaf,
            rays: batch.class.name(),
            short_stack,
            inner_visits: mean(totals.inner_visits),
            leaf_visits: mean(totals.leaf_visits),
            primitive_tests: mean(totals.primitive_tests),
            restarts: mean(totals.restarts),
            ratio_inner,
            rays_per_s: Spread::of(times).map(|seconds| rays / seconds.median),
            device: self.traceable.device().to_string(),
            ratio_time: Spread::of(&ratios),
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

    fn settings() -> TrailSettings {
        TrailSettings { rays: 600, leaf_caps: vec![1, 4], ..TrailSettings::new() }
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

    #[test]
    fn an_empty_scene_and_a_stop_are_errors() {
        let empty = run("nothing", &Scene::default(), &settings(), &on);
        assert!(matches!(empty, Err(TrailError::Empty)));
        let scene = Scene::from_mesh(meshes::icosphere(1));
        let stopped = run("sphere", &scene, &settings(), &|_| ControlFlow::Break(()));
        assert!(matches!(stopped, Err(TrailError::Stopped)));
    }
}
