//! The tables of the report.

use super::heat::HeatMap;
use super::paper::PaperScene;
use super::record::{RebuildRow, TwoLevelRow};
use std::fmt::Write;

/// Two levels by the ordinary walk, no object opened: what the tables of counts are about.
fn is_plain(row: &TwoLevelRow) -> bool {
    row.bottom.is_some() && !row.walk.starts_with("smart-stack") && !row.structure.contains("opening=")
}

fn yes_or_no(value: Option<bool>) -> &'static str {
    match value {
        Some(true) => "yes",
        Some(false) => "no",
        None => "",
    }
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".into(), |value| format!("{value:.digits$}"))
}

fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "-".into(), |value| format!("{:.1} %", 100.0 * value))
}

/// Table 1.
pub(super) fn depths(text: &mut String, scene: &str, rows: &[&TwoLevelRow]) {
    let _ = writeln!(text, "### Table 1: the deepest stack of a ray\n");
    let _ = writeln!(
        text,
        "Entries, of all rays: average, maximum, variance. One ring for both stacks takes at most so many bytes; the paper's has 256.\n"
    );
    let _ = writeln!(
        text,
        "| objects have | oriented boxes | rays | top: avg | max | var | objects: avg | max | var | ring, bytes |"
    );
    let _ = writeln!(text, "|---|---|---|---:|---:|---:|---:|---:|---:|---:|");
    for row in rows.iter().filter(|row| is_plain(row)) {
        let count = |value: Option<u32>| value.map_or_else(|| "-".into(), |value| value.to_string());
        let swaps = match row.smart_stack_swaps {
            Some(swaps) if swaps > 0 => format!(" ({swaps} entries left it)"),
            _ => String::new(),
        };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {}{swaps} |",
            row.bottom.as_deref().unwrap_or_default(),
            yes_or_no(row.oriented_boxes),
            row.rays,
            number(row.bvh_depth_avg, 3),
            count(row.bvh_depth_max),
            number(row.bvh_depth_var, 3),
            number(row.kd_depth_avg, 3),
            count(row.kd_depth_max),
            number(row.kd_depth_var, 3),
            count(row.smart_stack_max_bytes),
        );
    }
    if let Some(paper) = PaperScene::like(scene) {
        let ([top_avg, top_max, top_var], [kd_avg, kd_max, kd_var]) = (paper.bvh_depth, paper.kd_depth);
        let _ = writeln!(
            text,
            "| the paper's {} | | primary | {top_avg} | {top_max} | {top_var} | {kd_avg} | {kd_max} | {kd_var} | |",
            paper.scene
        );
    }
    let _ = writeln!(text);
}

/// Objects entered, with oriented boxes and without.
pub(super) fn objects(text: &mut String, scene: &str, rows: &[&TwoLevelRow]) {
    let _ = writeln!(text, "### Objects' structures that a ray enters\n");
    let _ = writeln!(text, "Averages over all rays, and over those that hit something.\n");
    let _ = writeln!(
        text,
        "| objects have | rays | without oriented boxes | with | with over without | of hits, without | of hits, with |"
    );
    let _ = writeln!(text, "|---|---|---:|---:|---:|---:|---:|");
    for with in rows.iter().filter(|row| is_plain(row) && row.oriented_boxes == Some(true)) {
        let is_other = |row: &&&TwoLevelRow| {
            is_plain(row)
                && (&row.bottom, row.rays) == (&with.bottom, with.rays)
                && row.oriented_boxes == Some(false)
        };
        let Some(without) = rows.iter().find(is_other) else { continue };
        let ratio = without.objects_entered.filter(|&count| count > 0.0).zip(with.objects_entered);
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} |",
            with.bottom.as_deref().unwrap_or_default(),
            with.rays,
            number(without.objects_entered, 3),
            number(with.objects_entered, 3),
            number(ratio.map(|(without, with)| with / without), 3),
            number(without.objects_entered_per_hit, 3),
            number(with.objects_entered_per_hit, 3),
        );
    }
    let _ = writeln!(text);
    if let Some(paper) = PaperScene::like(scene)
        && let Some(entered) = paper.objects_entered
    {
        let _ = writeln!(
            text,
            "The paper's {}: {entered} kd-trees a shadow ray, over rays that it does not name.\n",
            paper.scene
        );
    }
}

/// Two levels beside one.
pub(super) fn speeds(text: &mut String, scene: &str, device: &str, rows: &[&TwoLevelRow]) {
    let _ = writeln!(text, "### Speed on {device}\n");
    let _ = writeln!(
        text,
        "By the model a kd-tree's node costs 1, a BVH's 2, a triangle 2, the box of an object 3. Over one structure: 100 % is its speed; kd 20 is one kd-tree no deeper than 20, the paper's.\n"
    );
    let _ = writeln!(
        text,
        "| structure | rays | nodes above | nodes below | triangles | cost | cost: over kd | over kd 20 | over bvh | Mrays/s | time: over kd | over kd 20 | over bvh |"
    );
    let _ = writeln!(text, "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|");
    for row in rows {
        let walk =
            if row.walk.starts_with("smart-stack") { format!(", {}", row.walk) } else { String::new() };
        let _ = writeln!(
            text,
            "| {}{walk} | {} | {:.2} | {:.2} | {:.2} | {:.1} | {} | {} | {} | {} | {} | {} | {} |",
            row.structure,
            row.rays,
            row.bvh_visits,
            row.kd_visits,
            row.primitive_tests,
            row.cost,
            percent(Some(row.cost_relative_to_single_kd)),
            percent(Some(row.cost_relative_to_single_kd_20)),
            percent(Some(row.cost_relative_to_single_bvh)),
            number(row.rays_per_s.map(|rate| rate / 1e6), 3),
            percent(row.relative_to_single_kd),
            percent(row.relative_to_single_kd_20),
            percent(row.relative_to_single_bvh),
        );
    }
    if let Some(paper) = PaperScene::like(scene) {
        let ratios: Vec<String> = paper.speed_ratios().iter().map(|&ratio| percent(Some(ratio))).collect();
        let _ = writeln!(
            text,
            "| the paper's {} | shadow, reflections, 5 bounces | | | | | | | | | | {} | |",
            paper.scene,
            ratios.join(", ")
        );
    }
    let _ = writeln!(text);
}

/// Figure 9.
pub(super) fn heat(text: &mut String, maps: &[&HeatMap]) {
    let Some(first) = maps.first() else { return };
    let _ = writeln!(text, "### Heat maps: structures entered by the ray of a pixel\n");
    let _ = writeln!(
        text,
        "Objects have {}. Shares are of the pixels that have a ray; all columns together are the {} pixels.\n",
        first.bottom,
        first.side * first.side
    );
    let _ = writeln!(
        text,
        "| rays | oriented boxes | no ray | blue, up to 3 | green, up to 6 | red, up to 9 | white, more |"
    );
    let _ = writeln!(text, "|---|---|---:|---:|---:|---:|---:|");
    for map in maps {
        let [none, counts @ ..] = map.histogram();
        let cells: Vec<String> =
            counts.iter().zip(map.shares()).map(|(count, share)| format!("{count} ({share:.1} %)")).collect();
        let oriented = yes_or_no(Some(map.oriented_boxes));
        let _ = writeln!(text, "| {} | {oriented} | {none} | {} |", map.rays, cells.join(" | "));
    }
    let _ = writeln!(text);
}

/// The top level, by the number of objects.
pub(super) fn rebuilds(text: &mut String, rows: &[RebuildRow]) {
    let Some(first) = rows.first() else { return };
    let _ = writeln!(text, "## Rebuilding the top level\n");
    let _ = writeln!(
        text,
        "Boxes that all move in each round, {} thread. A frame sets every transform and rebuilds. The upload is 32 bytes a changed node and 96 an object. Costs are what a ray is expected to cost, over those after a rebuild.\n",
        first.threads
    );
    let _ = writeln!(
        text,
        "| objects | rebuild, ms | the paper | refit, ms | restructure, ms | frame, ms | upload, bytes | after a refit | restructured | cost: refit | restructured |"
    );
    let _ = writeln!(text, "|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|");
    for row in rows {
        let paper = row.paper_rebuild_ms.map_or_else(|| "-".into(), |paper| paper.to_string());
        let _ = writeln!(
            text,
            "| {} | {:.3} | {paper} | {:.3} | {:.3} | {:.3} | {} | {} | {} | {:.3} | {:.3} |",
            row.objects,
            row.rebuild_ms,
            row.refit_ms,
            row.restructure_ms,
            row.frame_ms,
            row.upload_bytes,
            row.refit_upload_bytes,
            row.restructure_upload_bytes,
            row.refit_cost_ratio,
            row.restructure_cost_ratio
        );
    }
    let _ = writeln!(text);
}
