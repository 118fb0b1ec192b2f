//! From counts and times to the rows of the record, with what the paper and the reference say beside them.

use super::batches::{Batch, Class};
use super::copier::Copier;
use super::experiment::Floor;
use super::lane::{Cost, Lane};
use super::paper::{TABLE_1, TABLE_2, TABLE_3};
use super::record::{CopyRow, ListRow};
use super::settings::{Setting, Table};
use crate::Spread;
use crate::comparison::{ComparisonError, builder_name};
use ropewalk::traversal_list::{Bounds, ChildOrder, Cull, Heads, ListOptions, Source};
use ropewalk::{Structure, TraversalList};
use ropewalk_gpu::Device;
use std::sync::Arc;
use std::time::Instant;

impl Floor<'_> {
    /// The row of a setting and class; `times` are the seconds of the frames.
    pub(super) fn row(&self, lane: &Lane<'_>, batch: &Batch, cost: &Cost, times: &[f64]) -> ListRow {
        let (setting, structure) = (lane.setting, &*lane.structure);
        let triangles = self.scene.triangle_count();
        let report = structure.report();
        let mean = |count: u64| count as f64 / batch.len().max(1) as f64;
        let (inner_visits, primitive_tests) =
            (mean(cost.totals.inner_visits), mean(cost.totals.primitive_tests));
        let list = list_of(structure);
        let boxes = if list.is_some() { 1.0 } else { 2.0 };
        let elements_per_ray = boxes * inner_visits + primitive_tests;
        let reference = self
            .reference
            .filter(|_| setting.table == Table::Columns)
            .and_then(|reference| reference.elements(self.on_ground, batch.class, &setting.name));
        let frame_time = Spread::of(times);
        let paper = self.paper(setting, batch.class);
        let options = setting.lists();
        let is_exact = options.is_some_and(|options| options.cull == Cull::Exact);
        let lists = options.map(|options| options.directions.lists());
        let culled = self.reference.filter(|_| is_exact).zip(lists);
        let shared = |list: &TraversalList| size_of_val(list.vertices()) + size_of_val(list.identities());
        ListRow {
            scene: self.name.into(),
            triangles,
            ground: self.on_ground,
            table: setting.table,
            setting: setting.name.clone(),
            structure: setting.structure.to_string(),
            walk: lane.walk().to_string(),
            source: options.map_or_else(
                || setting.structure.build_options().map_or("", |build| builder_name(build.builder)),
                |options| named(Source::NAMES, &options.source),
            ),
            bounds: options.map_or("aabb", |options| named(Bounds::NAMES, &options.bounds)),
            spheres: setting.spheres(),
            directions: lists,
            order: options.map(|options| named(ChildOrder::NAMES, &options.order)),
            cull: options.map_or("none", cull_name),
            heads: options.map_or("disabled", |options| named(Heads::NAMES, &options.heads)),
            frustum_grid: options.map_or(0, |options| options.frustum_grid),
            rays: batch.class.name(),
            ray_count: batch.len(),
            elements_per_ray,
            inner_visits,
            primitive_tests,
            culled_share: list.map_or(0.0, TraversalList::culled_share),
            reference_culled_share: culled
                .and_then(|(reference, lists)| reference.culled(lists))
                .map(|percent| percent / 100.0),
            reference_elements: self
                .reference
                .filter(|_| setting.table == Table::Columns && setting.name == "1")
                .and_then(|reference| reference.list),
            elements: list.map_or(0, |list| list.elements().len()),
            list_bytes: list.map_or(report.bytes, |list| size_of_val(list.elements())),
            shared_bytes: list.map_or(0, shared),
            heads_bytes: lane.heads_bytes(),
            fps: frame_time.map(|seconds| 1.0 / seconds.median),
            rays_per_s: frame_time.map(|seconds| batch.len() as f64 / seconds.median),
            device: lane.traceable.device().to_string(),
            frame_ms: frame_time.map(|seconds| seconds.map(|seconds| 1e3 * seconds)),
            threads: matches!(lane.traceable.device(), Device::Cpu).then(rayon::current_num_threads),
            build_s: report.build_time.as_secs_f64(),
            reference,
            deviation_percent: reference.map(|reference| 100.0 * (elements_per_ray / reference - 1.0)),
            paper_fps: paper.map(|(fps, _)| fps),
            paper_rays_per_s: paper.map(|(_, mrays_per_s)| 1e6 * mrays_per_s),
            lost_hits: cost.lost,
        }
    }

    /// Frames a second and millions of rays a second in the paper.
    fn paper(&self, setting: &Setting, class: Class) -> Option<(f64, f64)> {
        let options = setting.lists().filter(|_| class == Class::Frame)?;
        match setting.table {
            // Of the bunny, which the paper measured without ground.
            Table::Table1 => {
                let is_bunny = self.scene.triangle_count() + 2 == TABLE_2[2].triangles;
                let row = TABLE_1.iter().filter(|_| is_bunny).find(|row| {
                    let of_setting = (options.order, options.cull, options.heads, options.frustum_grid > 0);
                    (row.order, row.cull, row.heads, row.frustum) == of_setting
                });
                row.map(|row| (row.fps, row.mrays_per_s))
            }
            Table::Columns if setting.name == "6 all" && self.on_ground => {
                let triangles = self.scene.triangle_count();
                let frame = TABLE_2.iter().find(|frame| frame.triangles == triangles);
                frame.map(|frame| (frame.fps, frame.mrays_per_s))
            }
            _ => None,
        }
    }

    /// The copy of a lane's lists, where its frames were timed.
    pub(super) fn copy(
        &self,
        lane: &Lane<'_>,
        times: &[f64],
        rounds: usize,
    ) -> Result<Option<CopyRow>, ComparisonError> {
        let (Some(frame), Some(list)) = (Spread::of(times), list_of(&lane.structure)) else {
            return Ok(None);
        };
        let device = lane.traceable.device();
        let mut copies = Vec::new();
        let mut copier = Copier::new(list);
        for _ in 0..rounds {
            let start = Instant::now();
            match device {
                Device::Cpu => copier.copy(list),
                Device::Gpu(_) => drop(device.prepare(Arc::clone(&lane.structure))?),
            }
            copies.push(start.elapsed().as_secs_f64());
        }
        let copy_ms = Spread::of(&copies).map_or(0.0, |copy| 1e3 * copy.median);
        let frame_ms = 1e3 * frame.median;
        let triangles = self.scene.triangle_count();
        let is_papers = lane.setting.name == "6 all";
        let paper = TABLE_3.iter().find(|row| is_papers && row.triangles == triangles);
        Ok(Some(CopyRow {
            scene: self.name.into(),
            triangles,
            setting: lane.setting.name.clone(),
            device: device.to_string(),
            bytes: copier.bytes(),
            copy_ms,
            frame_ms,
            ratio_percent: 100.0 * copy_ms / frame_ms,
            paper_copy_ms: paper.map(|row| row.copy_ms),
            paper_frame_ms: paper.map(|row| row.frame_ms),
            paper_ratio_percent: paper.map(|row| 100.0 * row.copy_ms / row.frame_ms),
        }))
    }
}

fn list_of(structure: &Structure) -> Option<&TraversalList> {
    match structure {
        Structure::List(list) => Some(list),
        _ => None,
    }
}

/// The name of a choice on the command line.
fn named<T: PartialEq>(names: &[(&'static str, T)], choice: &T) -> &'static str {
    names.iter().find(|(_, other)| other == choice).map_or("", |(name, _)| name)
}

/// The paper's rule has no name on the command line.
fn cull_name(options: &ListOptions) -> &'static str {
    match options.cull {
        Cull::AsPrinted => "as-printed",
        _ => named(Cull::NAMES, &options.cull),
    }
}
