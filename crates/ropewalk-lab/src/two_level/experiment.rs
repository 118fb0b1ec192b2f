//! The runs: rays, settings, answers, counts, times.

use super::agreement::Judge;
use super::batches::{self, Batch, Flat};
use super::heat::HeatMap;
use super::lane::{Counted, Lane};
use super::record::{TwoLevelFindings, TwoLevelScene};
use super::rows::{Facts, rows};
use super::setting::{Setting, bottom_name, every_bottom, settings as settings_of};
use super::sight::Sight;
use crate::bench::{Progress, Watch};
use crate::comparison::ComparisonError;
use ropewalk::two_level::{BottomSpec, Placed};
use ropewalk::{BuildError, NoMonitor, Scene, Structure, StructureSpec, TraceOptions, catalogue};
use ropewalk_gpu::{Device, GpuError};
use ropewalk_testkit::rays::RayClass;
use std::sync::Arc;

/// What is compared.
#[derive(Clone, Debug)]
pub struct TwoLevelSettings {
    /// The structures that objects have; the first is that of the heat maps.
    pub bottoms: Vec<BottomSpec>,
    /// Pixels a side.
    pub size: usize,
    /// Where it runs.
    pub devices: Vec<Device>,
    /// How often each walk is timed; 0 counts only.
    pub rounds: usize,
}

impl TwoLevelSettings {
    /// All structures and the paper's picture, on the CPU, without times.
    #[must_use]
    pub fn new() -> Self {
        Self { bottoms: every_bottom(), size: 512, devices: vec![Device::Cpu], rounds: 0 }
    }
}

impl Default for TwoLevelSettings {
    fn default() -> Self {
        Self::new()
    }
}

/// Compares two levels with one on a scene.
///
/// # Errors
/// When a structure cannot be built, a device fails, an answer is wrong, or the caller stops it.
pub fn run(
    name: &str,
    scene: &Scene,
    sight: &Sight,
    settings: &TwoLevelSettings,
    watch: &Watch<'_>,
) -> Result<TwoLevelFindings, ComparisonError> {
    let whole = scene.flatten().map_err(BuildError::from)?;
    if whole.triangles.is_empty() {
        return Err(ComparisonError::Empty);
    }
    step(watch, "making rays", 0, 1)?;
    let flat = Flat::new(scene, whole.triangles.clone())?;
    let batches = batches::make(&flat, sight, settings.size)?;
    let judge = Judge::new(&flat, scene, &whole, &settings.devices);
    drop(whole);
    let all = settings_of(&settings.bottoms);
    let built = build(scene, &all, watch)?;
    let mut counts: Vec<(Setting, Vec<Counted>)> = Vec::new();
    for (done, (setting, structure)) in all.iter().zip(&built).enumerate() {
        step(watch, &format!("counting {}", setting.structure), done, all.len())?;
        let same = counts.iter().find(|(other, _)| other.structure == setting.structure);
        let counted = match same {
            Some((_, counted)) => counted.clone(),
            None => batches
                .iter()
                .map(|batch| Counted::new(setting, structure, batch))
                .collect::<Result<_, _>>()
                .map_err(GpuError::from)?,
        };
        counts.push((*setting, counted));
    }
    let mut findings = TwoLevelFindings::default();
    let mut record = describe(name, scene, &flat, &all, &built, settings.size, &batches);
    let facts = Facts { scene: name, objects: record.objects, triangles: record.triangles };
    for device in &settings.devices {
        let mut lanes = Vec::new();
        for (done, ((setting, structure), (_, counted))) in all.iter().zip(&built).zip(&counts).enumerate() {
            step(watch, &format!("{}, {}", setting.structure, setting.walk), done, all.len())?;
            if !is_offered(setting, device) {
                record.not_offered.push(format!("{}, {} on {device}", setting.structure, setting.walk));
                continue;
            }
            let lane = lane(setting, structure, counted, device, &batches, &judge)?;
            record.differing += lane.differing.iter().sum::<usize>();
            lanes.push(lane);
        }
        time(&mut lanes, &batches, settings.rounds, watch)?;
        findings.rows.extend(rows(facts, &lanes, &batches, &counts));
    }
    findings.heat = heat(name, settings, &batches, &counts);
    findings.scenes.push(record);
    Ok(findings)
}

fn step(watch: &Watch<'_>, what: &str, done: usize, total: usize) -> Result<(), ComparisonError> {
    if watch(Progress { what, done, total }).is_break() { Err(ComparisonError::Stopped) } else { Ok(()) }
}

/// What each setting is walked on: once for all that are built alike.
fn build(scene: &Scene, all: &[Setting], watch: &Watch<'_>) -> Result<Vec<Arc<Structure>>, ComparisonError> {
    let mut built: Vec<Arc<Structure>> = Vec::new();
    for (done, setting) in all.iter().enumerate() {
        step(watch, &format!("building {}", setting.structure), done, all.len())?;
        let same = all.iter().zip(&built).find(|(other, _)| other.structure == setting.structure);
        let structure = match same {
            Some((_, structure)) => Arc::clone(structure),
            None => Arc::new(setting.structure.build(scene, &NoMonitor)?),
        };
        built.push(structure);
    }
    Ok(built)
}

fn is_offered(setting: &Setting, device: &Device) -> bool {
    batches::CLASSES.iter().all(|class| {
        catalogue::is_offered(setting.structure.kind(), setting.walk, class.query(), device.kind())
    })
}

/// A setting on a device, its answers compared.
fn lane<'a>(
    setting: &'a Setting,
    structure: &Arc<Structure>,
    counted: &'a [Counted],
    device: &Device,
    batches: &[Batch],
    judge: &Judge<'_>,
) -> Result<Lane<'a>, ComparisonError> {
    let traceable = device.prepare(Arc::clone(structure))?;
    let mut differing = Vec::new();
    for (index, batch) in batches.iter().enumerate() {
        let traced = traceable.trace(setting.walk, batch.query(), &batch.rays, TraceOptions::default())?;
        let compared = judge.compare(index, batch, &traced);
        differing.push(compared.map_err(|what| ComparisonError::Disagrees {
            walk: setting.walk.to_string(),
            device: device.to_string(),
            structure: setting.structure.to_string(),
            asked: format!("{} rays against {}", batch.class, StructureSpec::default()),
            what,
        })?);
    }
    let times = vec![Vec::new(); batches.len()];
    Ok(Lane { setting, traceable, counted, differing, times })
}

/// Times the lanes. Each round has every lane once, one after the other, so that a machine that slows down slows all alike.
fn time(
    lanes: &mut [Lane<'_>],
    batches: &[Batch],
    rounds: usize,
    watch: &Watch<'_>,
) -> Result<(), ComparisonError> {
    for round in 0..rounds {
        for (index, batch) in batches.iter().enumerate() {
            step(watch, &format!("timing {} rays", batch.class), round, rounds)?;
            for lane in lanes.iter_mut() {
                lane.time(index, batch)?;
            }
        }
    }
    Ok(())
}

/// What is known of the scene once it is built.
fn describe(
    name: &str,
    scene: &Scene,
    flat: &Flat,
    all: &[Setting],
    built: &[Arc<Structure>],
    size: usize,
    batches: &[Batch],
) -> TwoLevelScene {
    let of = |oriented: bool| {
        let is_meant = |(setting, _): &(&Setting, &Arc<Structure>)| {
            setting.levels().is_some_and(|levels| levels.oriented == oriented) && setting.is_plain()
        };
        all.iter().zip(built).find(is_meant).and_then(|(_, structure)| match &**structure {
            Structure::TwoLevel(levels) => Some(levels),
            _ => None,
        })
    };
    let area = |placed: &Placed| {
        let size = placed.bounds().size().as_dvec3();
        2.0 * (size.x * size.y + size.y * size.z + size.z * size.x)
    };
    let areas = |oriented| of(oriented).map(|levels| levels.placed().iter().map(area).sum::<f64>());
    let ratio = match (areas(true), areas(false)) {
        (Some(with), Some(without)) if without > 0.0 => with / without,
        _ => 1.0,
    };
    let turned = |levels: &ropewalk::TwoLevel| {
        levels.objects().iter().flatten().filter(|object| object.is_turned()).count()
    };
    TwoLevelScene {
        scene: name.into(),
        objects: of(true).map_or(scene.instances.len(), |levels| levels.placed().len()),
        shapes: of(true).map_or(scene.objects.len(), |levels| {
            levels.objects().iter().flatten().filter(|object| !object.is_empty()).count()
        }),
        triangles: flat.triangles.len(),
        turned: of(true).map_or(0, turned),
        box_area_ratio: ratio,
        size,
        rays: batches.iter().map(|batch| (batch.class.name(), batch.rays.len())).collect(),
        differing: 0,
        not_offered: Vec::new(),
    }
}

/// The heat maps of primary and shadow rays, with oriented boxes and without.
fn heat(
    name: &str,
    settings: &TwoLevelSettings,
    batches: &[Batch],
    counts: &[(Setting, Vec<Counted>)],
) -> Vec<HeatMap> {
    let Some(&bottom) = settings.bottoms.first() else { return Vec::new() };
    let mut maps = Vec::new();
    let is_drawn = |batch: &Batch| matches!(batch.class, RayClass::Primary | RayClass::Shadow);
    for (index, batch) in batches.iter().enumerate().filter(|(_, batch)| is_drawn(batch)) {
        for oriented in [false, true] {
            let counted = counts.iter().find(|(setting, _)| {
                setting.is_plain()
                    && setting.bottom() == Some(bottom)
                    && setting.levels().is_some_and(|levels| levels.oriented == oriented)
            });
            let Some(counted) = counted.and_then(|(_, counted)| counted.get(index)) else { continue };
            let names = (name, batch.class.name(), bottom_name(bottom));
            maps.push(HeatMap::new(names, oriented, settings.size, &batch.pixels, &counted.entered_each));
        }
    }
    maps
}

#[cfg(test)]
mod tests {
    use super::super::batches::tests::{balls, sight};
    use super::super::record::TwoLevelRow;
    use super::*;
    use glam::{Quat, Vec3};
    use ropewalk::{Answer, Hit, Mesh, Transform};
    use std::ops::ControlFlow;

    fn on(_: Progress<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn small() -> TwoLevelSettings {
        TwoLevelSettings { size: 24, ..TwoLevelSettings::new() }
    }

    #[test]
    fn each_row_is_there_and_says_what_it_must() {
        let settings = TwoLevelSettings { rounds: 1, ..small() };
        let TwoLevelFindings { scenes, rows, heat, rebuilds } =
            run("balls", &balls(), &sight(), &settings, &on).unwrap();
        assert_eq!((scenes.len(), rows.len(), heat.len(), rebuilds.len()), (1, 3 * 18, 4, 0));
        assert_eq!((scenes[0].objects, scenes[0].shapes, scenes[0].triangles), (4, 1, 4 * 320));
        assert_eq!(scenes[0].rays[0], ("primary", 24 * 24));
        assert!(scenes[0].not_offered.is_empty());
        for row in &rows {
            let TwoLevelRow { structure, bottom, .. } = row;
            let levels = structure.starts_with("two-level");
            assert_eq!((bottom.is_some(), row.oriented_boxes.is_some()), (levels, levels), "{row:?}");
            assert_eq!(row.objects_entered.is_some(), levels);
            assert!(row.rays_per_s.is_some_and(|rate| rate > 0.0) && row.relative_spread.is_some());
            assert!(row.cost > 0.0 && row.cost_relative_to_single_kd > 0.0);
            assert!(row.kd_depth_avg.is_some() || row.bvh_depth_avg.is_some());
            if structure == "kd-tree" {
                assert_eq!((row.cost_relative_to_single_kd, row.relative_to_single_kd), (1.0, Some(1.0)));
                assert_eq!((row.bvh_depth_max, row.smart_stack_max_bytes), (None, None));
            }
            if let Some(entered) = row.objects_entered {
                assert!(entered > 0.0 && entered <= row.objects_tested.unwrap());
                assert!(row.objects_entered_per_hit.unwrap() >= 1.0, "what is hit was entered");
                assert_eq!(row.bvh_depth_max.is_some(), row.kd_depth_max.is_some());
            }
        }
        let counts = |bottom: &str, walk: &str| {
            let of = |row: &&TwoLevelRow| row.bottom.as_deref() == Some(bottom) && row.walk.starts_with(walk);
            rows.iter().filter(of).count()
        };
        assert_eq!((counts("kd-tree", "smart-stack"), counts("list", "stack")), (3, 6));
        for map in &heat {
            assert_eq!(map.histogram().iter().sum::<usize>(), 24 * 24);
            assert_eq!(map.none > 0, map.rays == "shadow", "{map:?}");
        }
    }

    /// Rods that lie askew, near each other: in oriented boxes rays enter far fewer of them.
    #[test]
    fn oriented_boxes_spare_rays_turned_parts() {
        let corner = |index: u8| {
            let at = |bit: u8, size: f32| if index >> bit & 1 == 1 { size } else { -size };
            Quat::from_rotation_z(0.7) * Vec3::new(at(0, 4.0), at(1, 0.1), at(2, 0.1))
        };
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let mut scene = Scene::default();
        let rod = scene.add_object(Mesh::new((0..8).map(corner).collect(), triangles));
        for step in 0..12 {
            scene.add_instance(rod, Transform::from_translation(Vec3::X * 0.5 * step as f32));
        }
        let settings = TwoLevelSettings { bottoms: vec![BottomSpec::default()], ..small() };
        let found = run("rods", &scene, &sight(), &settings, &on).unwrap();
        let entered = |oriented: bool, rays: &str| {
            let of = |row: &&TwoLevelRow| row.oriented_boxes == Some(oriented) && row.rays == rays;
            found.rows.iter().find(of).and_then(|row| row.objects_entered).unwrap()
        };
        for rays in ["primary", "shadow", "diffuse"] {
            assert!(2.0 * entered(true, rays) < entered(false, rays), "{rays}: {:?}", found.rows);
        }
        assert_eq!(found.scenes[0].turned, 1);
    }

    #[test]
    fn a_wrong_answer_ends_the_run_and_is_named() {
        let scene = balls();
        let whole = scene.flatten().unwrap();
        let flat = Flat::new(&scene, whole.triangles.clone()).unwrap();
        let mut batches = batches::make(&flat, &sight(), 24).unwrap();
        let all = settings_of(&[BottomSpec::default()]);
        let setting = all.iter().find(|setting| setting.is_plain()).unwrap();
        let structure = Arc::new(setting.structure.build(&scene, &NoMonitor).unwrap());
        let judge = Judge::new(&flat, &scene, &whole, &[Device::Cpu]);
        let compare = |batches: &[Batch], judge: &Judge<'_>| {
            lane(setting, &structure, &[], &Device::Cpu, batches, judge).map(|lane| lane.differing.len())
        };
        assert_eq!(compare(&batches, &judge).unwrap(), 3);
        let Answer::Closest(hits) = &mut batches[0].expected.answer else { panic!("{batches:?}") };
        let place = hits.iter().position(Hit::is_hit).unwrap() + 1;
        hits[place] = Hit::MISS;
        let error = compare(&batches, &judge).unwrap_err();
        let text = error.to_string();
        assert!(
            text.starts_with("stack")
                && text.contains("on cpu, two-level, primary rays")
                && text.contains(&format!("ray {place} (")),
            "{text}"
        );
    }

    #[test]
    fn an_empty_scene_and_a_stop_are_errors() {
        let empty = run("nothing", &Scene::default(), &sight(), &small(), &on);
        assert!(matches!(empty, Err(ComparisonError::Empty)));
        let stopped = run("balls", &balls(), &sight(), &small(), &|_| ControlFlow::Break(()));
        assert!(matches!(stopped, Err(ComparisonError::Stopped)));
    }
}
