//! The runs: structures, pictures, counts, times.

use super::agreement::compare;
use super::configuration::Configuration;
use super::counting::Counting;
use super::paper::{DRAWING_GAIN, frames_per_second};
use super::record::{PrimaryRow, ReichlTable2Findings, ReichlTable2Row, ReichlTable2Scene};
use crate::Spread;
use crate::bench::{Progress, Watch};
use crate::comparison::ComparisonError;
use crate::two_level::PaperScene;
use ropewalk::{
    BuildError, CounterTotals, KdOptions, NoMonitor, Structure, StructureSpec, TwoLevelOptions, Walk,
};
use ropewalk_gpu::{Device, Traceable};
use ropewalk_render::{
    CameraChoice, Kept, Picture, Primary, PrimaryComparison, RenderSettings, Renderer, Stage, Trace,
};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

/// What is compared.
#[derive(Clone, Debug)]
pub struct ReichlTable2Settings {
    /// Pixels a side.
    pub size: u32,
    /// From where.
    pub camera: CameraChoice,
    /// Where it runs.
    pub devices: Vec<Device>,
    /// How often each picture is timed; 0 counts only.
    pub rounds: usize,
}

impl ReichlTable2Settings {
    /// The paper's picture, on the CPU, without times.
    #[must_use]
    pub fn new() -> Self {
        Self { size: 512, camera: CameraChoice::default(), devices: vec![Device::Cpu], rounds: 0 }
    }
}

impl Default for ReichlTable2Settings {
    fn default() -> Self {
        Self::new()
    }
}

/// A structure, and what was rendered with it on the CPU.
struct Contender {
    spec: StructureSpec,
    walk: Walk,
    structure: Arc<Structure>,
    /// For each configuration.
    counted: Vec<(Picture, CounterTotals)>,
}

/// One kd-tree, as deep as its triangles ask for, against which all is compared; and two levels of such trees in oriented boxes.
fn structures() -> [StructureSpec; 2] {
    [StructureSpec::KdTree(KdOptions::default()), StructureSpec::TwoLevel(TwoLevelOptions::default())]
}

/// Renders a scene with one kd-tree and with two levels.
///
/// # Errors
/// When a structure cannot be built, a device fails, the pictures are not the same, or the caller stops it.
pub fn run(
    name: &str,
    stage: &Stage,
    settings: &ReichlTable2Settings,
    watch: &Watch<'_>,
) -> Result<ReichlTable2Findings, ComparisonError> {
    let triangles = stage.scene().flatten().map_err(BuildError::from)?.triangles.len();
    if triangles == 0 {
        return Err(ComparisonError::Empty);
    }
    let contenders = count(stage, settings, watch)?;
    let mut findings = ReichlTable2Findings::default();
    findings.scenes.push(ReichlTable2Scene {
        scene: name.into(),
        objects: stage.scene().instances.len(),
        triangles,
        lights: stage.model().lights.len(),
        size: settings.size,
        paper_scene: PaperScene::like(name).map(|paper| paper.scene),
    });
    for device in &settings.devices {
        let run = Run { name, stage, settings, device, contenders: &contenders };
        let prepared = run.prepare()?;
        findings.rows.extend(run.pictures(&prepared, watch)?);
        findings.primary.extend(run.primary(&prepared, watch)?);
    }
    Ok(findings)
}

fn step(watch: &Watch<'_>, what: &str, done: usize, total: usize) -> Result<(), ComparisonError> {
    if watch(Progress { what, done, total }).is_break() { Err(ComparisonError::Stopped) } else { Ok(()) }
}

fn on(_: usize, _: usize) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// The settings of a picture.
fn picture_settings(
    settings: &ReichlTable2Settings,
    configuration: Configuration,
    walk: Walk,
) -> RenderSettings {
    let (width, height) = (settings.size, settings.size);
    let camera = settings.camera.clone();
    configuration.settings(&RenderSettings { width, height, camera, walk, ..RenderSettings::default() })
}

/// Builds the structures, and renders every configuration with each on the CPU.
fn count(
    stage: &Stage,
    settings: &ReichlTable2Settings,
    watch: &Watch<'_>,
) -> Result<Vec<Contender>, ComparisonError> {
    let mut contenders: Vec<Contender> = Vec::new();
    for (done, spec) in structures().into_iter().enumerate() {
        step(watch, &format!("building {spec}"), done, 2)?;
        let structure = Arc::new(spec.build(stage.scene(), &NoMonitor)?);
        let walk = spec.kind().default_walk();
        let mut counted = Vec::new();
        for (done, configuration) in Configuration::EVERY.into_iter().enumerate() {
            step(
                watch,
                &format!("counting {}, {spec}", configuration.name()),
                done,
                Configuration::EVERY.len(),
            )?;
            let counting = Counting::new(&structure);
            let mut of_picture = picture_settings(settings, configuration, walk);
            if configuration == Configuration::PrimaryShading {
                of_picture.primary = Primary::Traced;
            }
            let picture = Renderer::new(stage, &counting).render(&of_picture, &on)?;
            counted.push((picture, counting.take()));
        }
        contenders.push(Contender { spec, walk, structure, counted });
    }
    Ok(contenders)
}

/// A device on which all is rendered.
struct Run<'a> {
    name: &'a str,
    stage: &'a Stage,
    settings: &'a ReichlTable2Settings,
    device: &'a Device,
    contenders: &'a [Contender],
}

impl Run<'_> {
    fn prepare(&self) -> Result<Vec<Traceable>, ComparisonError> {
        let prepare = |contender: &Contender| self.device.prepare(Arc::clone(&contender.structure));
        Ok(self.contenders.iter().map(prepare).collect::<Result<_, _>>()?)
    }

    /// Holds the pictures against that of one kd-tree on the CPU, then takes the times.
    fn pictures(
        &self,
        prepared: &[Traceable],
        watch: &Watch<'_>,
    ) -> Result<Vec<ReichlTable2Row>, ComparisonError> {
        let kept: Vec<Kept> = prepared.iter().map(|_| Kept::default()).collect();
        let renderers: Vec<Renderer<'_>> = prepared
            .iter()
            .zip(&kept)
            .map(|(traceable, kept)| Renderer::new(self.stage, traceable as &dyn Trace).keeping(kept))
            .collect();
        let mut rows = Vec::new();
        for (column, configuration) in Configuration::EVERY.into_iter().enumerate() {
            let render = |lane: usize| {
                let of_picture = picture_settings(self.settings, configuration, self.contenders[lane].walk);
                renderers[lane].render(&of_picture, &on)
            };
            let has_mirrors = configuration.tree().reflections;
            let mut different = Vec::new();
            for (lane, contender) in self.contenders.iter().enumerate() {
                let what = format!("rendering {}, {}", configuration.name(), contender.spec);
                step(watch, &what, lane, self.contenders.len())?;
                let disagrees = |what: String| ComparisonError::Disagrees {
                    walk: contender.walk.to_string(),
                    device: self.device.to_string(),
                    structure: contender.spec.to_string(),
                    asked: format!("{} against {} on the CPU", configuration.name(), structures()[0]),
                    what,
                };
                let expected = &self.contenders[0].counted[column].0;
                // On the CPU both have been rendered; what is drawn is held against what was traced, too.
                compare(expected, &contender.counted[column].0, has_mirrors).map_err(disagrees)?;
                different.push(compare(expected, &render(lane)?, has_mirrors).map_err(disagrees)?);
            }
            let mut times = vec![Vec::new(); renderers.len()];
            for round in 0..self.settings.rounds {
                step(watch, &format!("timing {}", configuration.name()), round, self.settings.rounds)?;
                for (lane, times) in times.iter_mut().enumerate() {
                    let clock = Instant::now();
                    render(lane)?;
                    times.push(clock.elapsed().as_secs_f64());
                }
            }
            for (lane, different) in different.into_iter().enumerate() {
                rows.push(self.row(configuration, column, lane, &times, different));
            }
        }
        Ok(rows)
    }

    fn row(
        &self,
        configuration: Configuration,
        column: usize,
        lane: usize,
        times: &[Vec<f64>],
        different_pixels: usize,
    ) -> ReichlTable2Row {
        let contender = &self.contenders[lane];
        let totals = &contender.counted[column].1;
        let single = &self.contenders[0].counted[column].1;
        let rays = totals.rays.max(1) as f64;
        let a_ray = |count: u64| count as f64 / rays;
        let over = |count: u64, of_single: u64| {
            (of_single > 0).then(|| a_ray(count) / (of_single as f64 / single.rays.max(1) as f64))
        };
        let ratios: Vec<f64> =
            times[0].iter().zip(&times[lane]).map(|(single, time)| single / time).collect();
        let relative = Spread::of(&ratios);
        let paper = frames_per_second(self.name, configuration);
        let place = usize::from(lane > 0);
        let is_two_level = matches!(*contender.structure, Structure::TwoLevel(_));
        ReichlTable2Row {
            scene: self.name.into(),
            configuration: configuration.name(),
            structure: contender.spec.to_string(),
            device: self.device.to_string(),
            walk: contender.walk.to_string(),
            size: self.settings.size,
            frames_per_s: Spread::of(&times[lane]).map(|seconds| 1.0 / seconds.median),
            relative_to_single_kd: relative.map(|spread| spread.median),
            relative_spread: relative,
            paper_frames_per_s: paper.map(|frames| frames[place]),
            paper_relative: paper.map(|[single, two_level]| [1.0, two_level / single][place]),
            rays: totals.rays,
            inner_visits: a_ray(totals.inner_visits),
            leaf_visits: a_ray(totals.leaf_visits),
            primitive_tests: a_ray(totals.primitive_tests),
            objects_entered: is_two_level.then(|| a_ray(totals.objects_entered)),
            inner_visits_relative: over(totals.inner_visits, single.inner_visits),
            primitive_tests_relative: over(totals.primitive_tests, single.primitive_tests),
            different_pixels,
            build_s: contender.structure.report().build_time.as_secs_f64(),
            rounds: self.settings.rounds,
            threads: matches!(self.device, Device::Cpu).then(rayon::current_num_threads),
        }
    }

    /// Primary hits drawn and traced.
    fn primary(&self, prepared: &[Traceable], watch: &Watch<'_>) -> Result<Vec<PrimaryRow>, ComparisonError> {
        let mut rows = Vec::new();
        for (lane, (contender, traceable)) in self.contenders.iter().zip(prepared).enumerate() {
            step(watch, &format!("primary hits, {}", contender.spec), lane, self.contenders.len())?;
            let of_picture = picture_settings(self.settings, Configuration::PrimaryShading, contender.walk);
            let compare = || PrimaryComparison::new(self.stage, traceable, &of_picture);
            let rounds: Vec<PrimaryComparison> =
                (0..self.settings.rounds.max(1)).map(|_| compare()).collect::<Result<_, _>>()?;
            let Some(first) = rounds.first() else { continue };
            let is_timed = self.settings.rounds > 0;
            let median = |time: &dyn Fn(&PrimaryComparison) -> f64| {
                let times: Vec<f64> = rounds.iter().map(time).collect();
                Spread::of(&times).filter(|_| is_timed).map(|spread| spread.median)
            };
            rows.push(PrimaryRow {
                scene: self.name.into(),
                structure: contender.spec.to_string(),
                device: self.device.to_string(),
                size: self.settings.size,
                rays: first.rays,
                hits: first.hits,
                different: first.different,
                rounded: first.rounded,
                traced_instead: first.traced_instead,
                traced_ms: median(&|round| 1e3 * round.traced.picture.as_secs_f64()),
                rasterised_ms: median(&|round| 1e3 * round.rasterised.picture.as_secs_f64()),
                gain: median(&|round| {
                    round.traced.picture.as_secs_f64() / round.rasterised.picture.as_secs_f64().max(1e-9)
                }),
                paper_gain: DRAWING_GAIN,
                preparation_ms: median(&|round| 1e3 * round.rasterised.preparation.as_secs_f64()),
            });
        }
        Ok(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{markdown, write_csv, write_primary_csv};
    use super::*;
    use ropewalk_render::StageOptions;
    use ropewalk_scene::builtin;

    #[test]
    fn each_row_is_there_and_says_what_it_must() {
        let stage = Stage::new(builtin::builtin("assembly").unwrap(), &StageOptions::default());
        let settings = ReichlTable2Settings { size: 40, rounds: 1, ..ReichlTable2Settings::new() };
        let watch = |_: Progress<'_>| ControlFlow::Continue(());
        let found = run("car.glb", &stage, &settings, &watch).unwrap();
        assert_eq!((found.scenes.len(), found.rows.len(), found.primary.len()), (1, 8, 2));
        for row in &found.rows {
            assert!(row.frames_per_s.is_some_and(|frames| frames > 0.0), "{row:?}");
            assert!(row.paper_frames_per_s.is_some(), "the name is that of a car");
            assert_eq!(row.objects_entered.is_some(), row.structure.starts_with("two-level"));
            assert!(row.rays > 0 && row.inner_visits > 0.0 && row.primitive_tests > 0.0, "{row:?}");
        }
        let of = |name: &str| found.rows.iter().find(|row| row.configuration == name).unwrap();
        assert_eq!(of("primary shading").rays, 40 * 40);
        assert!(of("5 bounces + shadow").rays > of("shadow only").rays);
        for row in &found.primary {
            assert_eq!(
                (row.rays, row.different, row.rounded, row.traced_instead),
                (1600, 0, 0, 0),
                "{row:?}"
            );
        }
        let text = markdown(&found);
        for words in ["car.glb", "5 bounces + shadow", "277.72", "42.1 %", "drawn beside traced"] {
            assert!(text.contains(words), "{words}: {text}");
        }
        let lines = |write: &dyn Fn(&mut Vec<u8>) -> std::io::Result<()>| {
            let mut bytes = Vec::new();
            write(&mut bytes).unwrap();
            String::from_utf8(bytes).unwrap().lines().count()
        };
        assert_eq!(lines(&|bytes| write_csv(&found.rows, bytes)), 9);
        assert_eq!(lines(&|bytes| write_primary_csv(&found.primary, bytes)), 3);
    }

    #[test]
    fn nothing_to_see_and_a_wish_to_stop_are_told() {
        let empty = Stage::new(ropewalk_scene::Model::default(), &StageOptions::default());
        let settings = ReichlTable2Settings { size: 8, ..ReichlTable2Settings::new() };
        let on = |_: Progress<'_>| ControlFlow::Continue(());
        assert!(matches!(run("nothing", &empty, &settings, &on), Err(ComparisonError::Empty)));
        let stage = Stage::new(builtin::builtin("cubes").unwrap(), &StageOptions::default());
        let stop = |_: Progress<'_>| ControlFlow::Break(());
        assert!(matches!(run("cubes", &stage, &settings, &stop), Err(ComparisonError::Stopped)));
    }
}
