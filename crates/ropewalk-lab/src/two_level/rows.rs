//! From counts and times to rows.

use super::batches::Batch;
use super::lane::{Counted, Lane};
use super::record::TwoLevelRow;
use super::setting::{Setting, bottom_name, single_bvh, single_kd, single_kd_20};
use crate::Spread;
use ropewalk::{Structure, StructureSpec};
use ropewalk_gpu::Device;

/// What all rows of a scene have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facts<'a> {
    pub(super) scene: &'a str,
    pub(super) objects: usize,
    pub(super) triangles: usize,
}

/// The rows of a device, batch after batch. `costs` are those of all settings, also of such that the device has not.
pub(super) fn rows(
    facts: Facts<'_>,
    lanes: &[Lane<'_>],
    batches: &[Batch],
    costs: &[(Setting, Vec<Counted>)],
) -> Vec<TwoLevelRow> {
    let each = |(index, batch): (usize, &Batch)| {
        let row = move |lane: &Lane<'_>| row(facts, lane, lanes, index, batch, costs);
        lanes.iter().map(row).collect::<Vec<_>>()
    };
    batches.iter().enumerate().flat_map(each).collect()
}

fn row(
    facts: Facts<'_>,
    lane: &Lane<'_>,
    lanes: &[Lane<'_>],
    index: usize,
    batch: &Batch,
    costs: &[(Setting, Vec<Counted>)],
) -> TwoLevelRow {
    let Lane { setting, traceable, counted, differing, times } = lane;
    let empty = Counted::default();
    let counted = counted.get(index).unwrap_or(&empty);
    let times = times.get(index).map_or(&[][..], Vec::as_slice);
    let structure = traceable.structure();
    let is_kd = matches!(structure, Structure::KdTree(_));
    let (has_top, has_bottom) = (!is_kd, !matches!(structure, Structure::Bvh(_)));
    let levels = setting.levels();
    let of_levels = |value: f64| levels.is_some().then_some(value);
    let relative_cost = |single: StructureSpec| relative_cost(costs, single, index, counted.cost);
    let relative = |single: StructureSpec| relative_speed(lanes, single, index, times);
    let median = |spread: Option<Spread>| spread.map(|spread| spread.median);
    let to_kd = relative(single_kd());
    TwoLevelRow {
        scene: facts.scene.into(),
        objects: facts.objects,
        triangles: facts.triangles,
        structure: setting.structure.to_string(),
        bottom: setting.bottom().map(bottom_name),
        oriented_boxes: levels.map(|levels| levels.oriented),
        rays: batch.class.name(),
        objects_entered: of_levels(counted.mean(counted.entered)),
        bvh_depth_avg: has_top.then_some(counted.top.avg),
        bvh_depth_max: has_top.then_some(counted.top.max),
        bvh_depth_var: has_top.then_some(counted.top.var),
        kd_depth_avg: has_bottom.then_some(counted.bottom.avg),
        kd_depth_max: has_bottom.then_some(counted.bottom.max),
        kd_depth_var: has_bottom.then_some(counted.bottom.var),
        smart_stack_max_bytes: setting.has_ring().then_some(counted.stack_bytes),
        rays_per_s: Spread::of(times).map(|seconds| batch.rays.len() as f64 / seconds.median),
        relative_to_single_kd: median(to_kd),
        relative_to_single_bvh: median(relative(single_bvh())),
        device: traceable.device().to_string(),
        walk: setting.walk.to_string(),
        ray_count: counted.rays,
        rays_that_hit: counted.hits,
        objects_entered_per_hit: of_levels(counted.entered_by_hits as f64 / counted.hits.max(1) as f64),
        objects_tested: of_levels(counted.mean(counted.tested)),
        bvh_visits: counted.mean(counted.top_visits),
        kd_visits: counted.mean(counted.bottom_visits),
        primitive_tests: counted.mean(counted.primitive_tests),
        cost: counted.cost,
        cost_relative_to_single_kd: relative_cost(single_kd()),
        cost_relative_to_single_kd_20: relative_cost(single_kd_20()),
        cost_relative_to_single_bvh: relative_cost(single_bvh()),
        relative_to_single_kd_20: median(relative(single_kd_20())),
        relative_spread: to_kd,
        smart_stack_swaps: setting.has_ring().then_some(counted.swaps),
        differing: differing.get(index).copied().unwrap_or(0),
        build_s: structure.report().build_time.as_secs_f64(),
        threads: matches!(traceable.device(), Device::Cpu).then(rayon::current_num_threads),
    }
}

/// The cost of a single structure over that of a setting; 1 where neither costs anything.
fn relative_cost(costs: &[(Setting, Vec<Counted>)], single: StructureSpec, batch: usize, cost: f64) -> f64 {
    let of_single = costs.iter().find(|(setting, _)| setting.structure == single);
    match of_single.and_then(|(_, counted)| counted.get(batch)) {
        Some(counted) if cost > 0.0 => counted.cost / cost,
        _ => 1.0,
    }
}

/// The speed over that of a single structure on the same device, round for round.
fn relative_speed(lanes: &[Lane<'_>], single: StructureSpec, batch: usize, times: &[f64]) -> Option<Spread> {
    let of_single = lanes.iter().find(|lane| lane.setting.structure == single)?;
    let of_single = of_single.times.get(batch)?;
    let ratios: Vec<f64> = of_single.iter().zip(times).map(|(single, time)| single / time).collect();
    Spread::of(&ratios)
}
