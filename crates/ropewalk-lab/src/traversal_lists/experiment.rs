//! The runs: stages, rays, settings, answers, counts, times.

use super::batches::{Batch, Class, counted, frame};
use super::lane::{Cost, Lane};
use super::orbit::Orbit;
use super::record::{CopyRow, ListComparison, ListRow, ListScene};
use super::reference::Reference;
use super::settings::{Setting, Table, settings as settings_of};
use super::stage::Stage;
use super::truth::Truth;
use super::verdict::Verdict;
use crate::bench::{Progress, Watch};
use crate::comparison::ComparisonError;
use ropewalk::{BuildError, NoMonitor, Scene, Structure, StructureSpec};
use ropewalk_gpu::{Device, GpuError};
use std::sync::Arc;

/// What is compared.
#[derive(Clone, Debug)]
pub struct ListSettings {
    /// The tables that are made.
    pub tables: Vec<Table>,
    /// Pixels a side of the views of which elements are counted.
    pub side: usize,
    /// Cells a side of the screen where frustums are culled.
    pub grid: u32,
    /// Pixels a side of the frame that is timed.
    pub frame: usize,
    /// Tests of triangles that brute force may make for each part of the rays, of which there are eight a stage.
    pub brute_force: usize,
    /// Where it runs.
    pub devices: Vec<Device>,
    /// How often each frame is timed; 0 counts only.
    pub rounds: usize,
}

impl ListSettings {
    /// The reference measurements' views and the paper's frames, without times.
    #[must_use]
    pub fn new() -> Self {
        Self {
            tables: Table::EVERY.to_vec(),
            side: 144,
            grid: 16,
            frame: 1024,
            // Of a second on two cores; seven times as many held the runs up for longer than what they are about.
            brute_force: 64_000_000,
            devices: vec![Device::Cpu],
            rounds: 0,
        }
    }
}

impl Default for ListSettings {
    fn default() -> Self {
        Self::new()
    }
}

/// Compares the options of traversal lists on a scene.
///
/// # Errors
/// When a structure cannot be built, a device fails, an answer is wrong, or the caller stops it.
pub fn run(
    name: &str,
    scene: Scene,
    settings: &ListSettings,
    watch: &Watch<'_>,
) -> Result<ListComparison, ComparisonError> {
    let stage = Stage::new(scene);
    if stage.alone.flatten().map_err(BuildError::from)?.triangles.is_empty() {
        return Err(ComparisonError::Empty);
    }
    let triangles = stage.alone.triangle_count();
    let reference = Reference::of(triangles, stage.bounds.size());
    let mut record = ListScene {
        scene: name.into(),
        triangles,
        view: settings.side,
        frame: (settings.rounds > 0).then_some(settings.frame),
        rays: 0,
        brute_force_rays: 0,
    };
    let mut comparison = ListComparison::default();
    for on_ground in [true, false] {
        let has_own = |table: Table| table.has_ground() == on_ground;
        let mut tables: Vec<Table> =
            settings.tables.iter().copied().filter(|&table| has_own(table)).collect();
        // The reference has the columns of one scene without ground too.
        let is_known = reference.is_some_and(|reference| reference.alone.is_some());
        if !on_ground && is_known && settings.tables.contains(&Table::Columns) {
            tables.insert(0, Table::Columns);
        }
        if tables.is_empty() {
            continue;
        }
        let scene = if on_ground { &stage.on_ground } else { &stage.alone };
        let floor = Floor::new(name, scene, on_ground, reference, &stage, settings, watch)?;
        record.rays += floor.rays;
        record.brute_force_rays += floor.brute_force_rays;
        for table in tables {
            let (rows, copies) = floor.compare(table, settings, watch)?;
            comparison.rows.extend(rows);
            comparison.copies.extend(copies);
        }
    }
    comparison.scenes.push(record);
    Ok(comparison)
}

/// A scene with its ground or without, and the rays.
pub(super) struct Floor<'a> {
    pub(super) name: &'a str,
    pub(super) scene: &'a Scene,
    pub(super) on_ground: bool,
    pub(super) reference: Option<&'static Reference>,
    batches: Vec<Batch>,
    verdict: Verdict,
    rays: usize,
    brute_force_rays: usize,
}

fn step(watch: &Watch<'_>, what: &str, done: usize, total: usize) -> Result<(), ComparisonError> {
    if watch(Progress { what, done, total }).is_break() { Err(ComparisonError::Stopped) } else { Ok(()) }
}

impl<'a> Floor<'a> {
    fn new(
        name: &'a str,
        scene: &'a Scene,
        on_ground: bool,
        reference: Option<&'static Reference>,
        stage: &Stage,
        settings: &ListSettings,
        watch: &Watch<'_>,
    ) -> Result<Self, ComparisonError> {
        let verdict = Verdict::new(&scene.flatten().map_err(BuildError::from)?, &settings.devices);
        let truth = Truth::new(scene)?;
        let orbit = Orbit::around(&stage.bounds, &scene.bounds(), settings.grid);
        step(watch, "making rays", 0, 1)?;
        let mut batches = counted(&orbit, settings.side, &truth).map_err(GpuError::from)?;
        let parts: Vec<_> = batches.iter().flat_map(|batch| &batch.parts).collect();
        let mut brute_force_rays = 0;
        for (done, part) in parts.iter().enumerate() {
            step(watch, "holding answers against every triangle", done, parts.len())?;
            let (two_sided, one_sided) = (&part.two_sided, &part.one_sided);
            let confirmed = truth.confirm(part.query, &part.rays, two_sided, one_sided, settings.brute_force);
            brute_force_rays += confirmed.map_err(|what| ComparisonError::Disagrees {
                walk: "stack".into(),
                device: Device::Cpu.to_string(),
                structure: StructureSpec::default().to_string(),
                asked: "rays against every triangle".into(),
                what,
            })?;
        }
        if settings.rounds > 0 {
            batches.extend(frame(&orbit, settings.frame, &truth).map_err(GpuError::from)?);
        }
        let rays = batches.iter().map(Batch::len).sum();
        Ok(Self { name, scene, on_ground, reference, batches, verdict, rays, brute_force_rays })
    }

    fn compare(
        &self,
        table: Table,
        settings: &ListSettings,
        watch: &Watch<'_>,
    ) -> Result<(Vec<ListRow>, Vec<CopyRow>), ComparisonError> {
        let tried = settings_of(table, settings.grid);
        let total = tried.len() * settings.devices.len();
        let mut built: Vec<(StructureSpec, Arc<Structure>)> = Vec::new();
        let (mut rows, mut copies) = (Vec::new(), Vec::new());
        for device in &settings.devices {
            let mut lanes = Vec::new();
            for (done, setting) in tried.iter().enumerate() {
                step(watch, &format!("{}, {}", table.name(), setting.name), done, total)?;
                let structure = self.build(setting, &mut built)?;
                lanes.push(Lane::new(setting, device, structure, &self.batches)?);
            }
            let mut costs: Vec<Vec<Option<Cost>>> = Vec::new();
            for (done, lane) in lanes.iter().enumerate() {
                step(watch, &format!("counting {}, {}", table.name(), lane.setting.name), done, total)?;
                let cost = |(index, batch): (usize, &Batch)| {
                    let is_asked = lane.setting.asks(batch.class);
                    is_asked.then(|| lane.count(index, batch, &self.verdict)).transpose()
                };
                costs.push(self.batches.iter().enumerate().map(cost).collect::<Result<_, _>>()?);
            }
            let times = self.time(&lanes, settings.rounds, watch)?;
            for ((lane, costs), times) in lanes.iter().zip(&costs).zip(&times) {
                for (batch, cost) in self.batches.iter().zip(costs) {
                    let times = if batch.class == Class::Frame { times.as_slice() } else { &[] };
                    rows.extend(cost.as_ref().map(|cost| self.row(lane, batch, cost, times)));
                }
                if table == Table::Columns && self.on_ground {
                    copies.extend(self.copy(lane, times, settings.rounds)?);
                }
            }
        }
        Ok((rows, copies))
    }

    /// What a setting is walked on: once for all settings that are built alike.
    fn build(
        &self,
        setting: &Setting,
        built: &mut Vec<(StructureSpec, Arc<Structure>)>,
    ) -> Result<Arc<Structure>, BuildError> {
        let spec = setting.built();
        if let Some((_, structure)) = built.iter().find(|(other, _)| *other == spec) {
            return Ok(Arc::clone(structure));
        }
        let structure = Arc::new(spec.build(self.scene, &NoMonitor)?);
        built.push((spec, Arc::clone(&structure)));
        Ok(structure)
    }

    /// The seconds of the frames of each lane. Each round has every lane once, so that a machine that slows down slows all
    /// of them alike.
    fn time(
        &self,
        lanes: &[Lane<'_>],
        rounds: usize,
        watch: &Watch<'_>,
    ) -> Result<Vec<Vec<f64>>, ComparisonError> {
        let mut times = vec![Vec::with_capacity(rounds); lanes.len()];
        let frame = self.batches.iter().enumerate().find(|(_, batch)| batch.class == Class::Frame);
        let Some((index, batch)) = frame else { return Ok(times) };
        for round in 0..rounds {
            step(watch, "timing frames", round, rounds)?;
            for (lane, times) in lanes.iter().zip(&mut times) {
                if lane.setting.is_timed {
                    times.push(lane.time(index, batch)?);
                }
            }
        }
        Ok(times)
    }
}

#[cfg(test)]
mod tests {
    use super::super::settings::VERTICES;
    use super::*;
    use glam::Vec3;
    use ropewalk::Mesh;
    use ropewalk_testkit::meshes;
    use std::ops::ControlFlow;

    fn on(_: Progress<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn settings() -> ListSettings {
        ListSettings { side: 24, grid: 4, frame: 32, ..ListSettings::new() }
    }

    #[test]
    fn each_row_is_there_and_options_save_elements() {
        let scene = Scene::from_mesh(meshes::icosphere(3));
        let settings = ListSettings { rounds: 1, ..settings() };
        let ListComparison { scenes, rows, copies } = run("ball", scene, &settings, &on).unwrap();
        let [record] = scenes.as_slice() else { panic!("{scenes:?}") };
        assert_eq!(record.triangles, 1280);
        assert!(record.brute_force_rays > 6 * 24 * 24 && record.brute_force_rays < record.rays);
        let classes = ["primary", "shadow", "diffuse"];
        let of = |table: Table, setting: &str, rays: &str| {
            let is_it = |row: &&ListRow| row.table == table && row.setting == setting && row.rays == rays;
            let mut found = rows.iter().filter(is_it).filter(|row| row.spheres != Some(VERTICES));
            let row = found.next().unwrap_or_else(|| panic!("no row {table:?} {setting} {rays}"));
            assert!(found.next().is_none());
            row
        };
        assert_eq!(rows.len(), (2 * 7 * 3 + 4) + 16 * 4 + 2 * 3 + 4 * 4);
        for row in rows.iter().filter(|row| row.spheres == Some(VERTICES)) {
            // A ball has no triangles that a ray runs along, so that nothing is lost.
            assert_eq!((row.lost_hits, row.table), (0, Table::Columns), "{row:?}");
            let boxes = of(Table::Columns, &row.setting, row.rays);
            assert!(row.elements_per_ray < boxes.elements_per_ray, "{row:?}, {boxes:?}");
        }
        for class in classes {
            let elements = |setting| of(Table::Columns, setting, class).elements_per_ray;
            assert!(elements("6 all") < elements("6") && elements("8 all") < elements("8"), "{class}");
            assert!(elements("6") <= elements("1"), "{class}");
            let (best, skip) = (of(Table::Best, "best", class), of(Table::Best, "skip pointers", class));
            assert!(best.elements_per_ray < skip.elements_per_ray, "{class}");
        }
        for row in &rows {
            let is_timed = row.rays == "frame";
            assert_eq!((row.fps.is_some(), row.rays_per_s.is_some()), (is_timed, is_timed), "{row:?}");
            assert_eq!(row.ground, row.table.has_ground());
            assert_eq!(row.triangles, if row.ground { 1282 } else { 1280 });
            assert_eq!(row.list_bytes, if row.walk == "list" { 20 * row.elements } else { row.list_bytes });
            assert_eq!(row.culled_share > 0.0, row.cull != "none", "{row:?}");
            assert_eq!(row.heads_bytes > 0, row.heads != "disabled" || row.frustum_grid > 0, "{row:?}");
            assert!(row.elements_per_ray > 1.0 && row.ray_count > 0);
        }
        // A ball's normals are spread evenly.
        let culled = |setting| of(Table::Columns, setting, "primary").culled_share;
        assert!((culled("6 all") - 0.108).abs() < 0.01 && (culled("8 all") - 0.125).abs() < 0.01);
        assert!(of(Table::AsPrinted, "6 as printed", "primary").culled_share > 0.15);
        assert_eq!(copies.len(), 4);
        assert!(copies.iter().all(|copy| copy.copy_ms > 0.0 && copy.bytes > 20 * 1282));
    }

    /// A quad whose normal is of the sextant of the rays that see its front in one of the views: the printed rule takes it
    /// out of their list. By the exact rule none is lost, else there would be an error.
    #[test]
    fn hits_that_the_printed_rule_loses_are_counted() {
        let (across, along) = (Vec3::new(-0.95, 1.0, 0.0), Vec3::new(-0.95, 0.0, 1.0));
        let corners = vec![-across - along, across - along, across + along, along - across];
        let scene = Scene::from_mesh(Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]));
        assert!(scene.flatten().unwrap().triangles.iter().all(|it| it.front().cmpgt(Vec3::ZERO).all()));
        let settings = ListSettings { tables: vec![Table::AsPrinted, Table::Table1], ..settings() };
        let rows = run("quad", scene, &settings, &on).unwrap().rows;
        let lost = |setting: &str| -> usize {
            rows.iter().filter(|row| row.setting == setting).map(|row| row.lost_hits).sum()
        };
        assert!(lost("6 as printed") > 0, "{rows:?}");
        assert_eq!(lost("8 as printed"), 0, "an octant is its own dual");
        assert!(rows.iter().all(|row| row.lost_hits == 0 || row.cull == "as-printed"));
        assert!(rows.iter().any(|row| row.cull == "exact" && row.directions == Some(6)));
    }

    #[test]
    fn a_setting_that_answers_otherwise_is_an_error_that_names_it() {
        let stage = Stage::new(Scene::from_mesh(meshes::icosphere(2)));
        let settings = settings();
        let mut floor = Floor::new("ball", &stage.on_ground, true, None, &stage, &settings, &on).unwrap();
        assert!(floor.compare(Table::Best, &settings, &on).is_ok());
        let part = &mut floor.batches[0].parts[0];
        let ropewalk::Answer::Closest(hits) = &mut part.one_sided.answer else { panic!("{part:?}") };
        hits[300] =
            if hits[300].is_hit() { ropewalk::Hit::MISS } else { ropewalk::Hit { t: 1.0, ..hits[300] } };
        let text = floor.compare(Table::Best, &settings, &on).unwrap_err().to_string();
        assert!(text.contains("'best'") && text.contains("ray 300") && text.contains("list"), "{text}");
    }

    #[test]
    fn an_empty_scene_and_a_stop_are_errors() {
        let empty = run("nothing", Scene::default(), &settings(), &on);
        assert!(matches!(empty, Err(ComparisonError::Empty)));
        let scene = Scene::from_mesh(meshes::icosphere(1));
        let stopped = run("ball", scene, &settings(), &|_| ControlFlow::Break(()));
        assert!(matches!(stopped, Err(ComparisonError::Stopped)));
    }
}
