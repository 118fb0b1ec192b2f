//! What is kept of the runs: one row a scene, setting, class of rays and device; and one a number of objects that move.

use super::heat::HeatMap;
use crate::Spread;
use crate::comparison::{Column, maybe, write_columns};
use serde::Serialize;
use std::io::{self, Write};

/// All that was found out of one scene, or of several.
#[derive(Clone, Debug, Default, Serialize)]
pub struct TwoLevelFindings {
    /// What was asked.
    pub scenes: Vec<TwoLevelScene>,
    /// A row a setting, class of rays and device.
    pub rows: Vec<TwoLevelRow>,
    /// The pixels of each colour of the heat maps.
    pub heat: Vec<HeatMap>,
    /// The top level, by the number of objects.
    pub rebuilds: Vec<RebuildRow>,
}

/// A scene, and how it was seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TwoLevelScene {
    /// The scene's file or name.
    pub scene: String,
    /// Objects that are placed: instances.
    pub objects: usize,
    /// Shapes of objects, each built once.
    pub shapes: usize,
    /// Triangles, those of each instance counted.
    pub triangles: usize,
    /// Shapes that lie in a frame of their own, because their oriented box is the smaller one.
    pub turned: usize,
    /// The areas of all instances' boxes in the scene, with oriented boxes over without.
    pub box_area_ratio: f64,
    /// Pixels a side.
    pub size: usize,
    /// Rays of each class.
    pub rays: Vec<(&'static str, usize)>,
    /// Answers that are right and not the flattened BVH's, over all rows.
    pub differing: usize,
    /// What a device has no walk for.
    pub not_offered: Vec<String>,
}

/// One row. Averages are over all rays of the class, also those that hit nothing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TwoLevelRow {
    /// The scene's file or name.
    pub scene: String,
    /// Objects that are placed.
    pub objects: usize,
    /// Triangles, those of each instance counted.
    pub triangles: usize,
    /// What was built, as it is written on the command line.
    pub structure: String,
    /// What each object has; none where there is one structure over everything.
    pub bottom: Option<String>,
    /// Whether objects lie in their oriented boxes; none where there are no objects.
    pub oriented_boxes: Option<bool>,
    /// The class of the rays.
    pub rays: &'static str,
    /// Objects' structures entered, a ray.
    pub objects_entered: Option<f64>,
    /// The deepest stack of a ray in the top level, or in a single BVH: entries, the mean over rays.
    pub bvh_depth_avg: Option<f64>,
    /// The largest.
    pub bvh_depth_max: Option<u32>,
    /// The variance.
    pub bvh_depth_var: Option<f64>,
    /// The deepest stack of a ray in the objects' structures, whatever they are, or in a single kd-tree.
    pub kd_depth_avg: Option<f64>,
    /// The largest.
    pub kd_depth_max: Option<u32>,
    /// The variance.
    pub kd_depth_var: Option<f64>,
    /// The most bytes that both stacks of a ray took in one ring.
    pub smart_stack_max_bytes: Option<u32>,
    /// Rays a second: the median of the rounds.
    pub rays_per_s: Option<f64>,
    /// The speed over that of one kd-tree in the same round, the median.
    pub relative_to_single_kd: Option<f64>,
    /// The speed over that of one BVH.
    pub relative_to_single_bvh: Option<f64>,
    /// `cpu`, or the adapter.
    pub device: String,
    /// How it was walked.
    pub walk: String,
    /// Rays.
    pub ray_count: usize,
    /// Those that hit something.
    pub rays_that_hit: usize,
    /// Objects' structures entered, of the rays that hit something.
    pub objects_entered_per_hit: Option<f64>,
    /// Objects whose boxes were tested, a ray.
    pub objects_tested: Option<f64>,
    /// Nodes of the top level, or of a single BVH, a ray.
    pub bvh_visits: f64,
    /// Nodes of the objects' structures, or of a single kd-tree, a ray.
    pub kd_visits: f64,
    /// Triangles tested, a ray.
    pub primitive_tests: f64,
    /// What a ray costs by the model of nodes.
    pub cost: f64,
    /// By the model the speed over that of one kd-tree: its cost over this one.
    pub cost_relative_to_single_kd: f64,
    /// The same of one kd-tree no deeper than 20, as the paper has it.
    pub cost_relative_to_single_kd_20: f64,
    /// The same of one BVH.
    pub cost_relative_to_single_bvh: f64,
    /// The speed over that of one kd-tree no deeper than 20.
    pub relative_to_single_kd_20: Option<f64>,
    /// How far the rounds lie apart: the speed over that of one kd-tree.
    pub relative_spread: Option<Spread>,
    /// Entries that left a ring of the paper's 256 bytes, of all rays.
    pub smart_stack_swaps: Option<u64>,
    /// Answers that are right and not the flattened BVH's: at grazes, and where triangles lie in one place.
    pub differing: usize,
    /// Seconds that the build took.
    pub build_s: f64,
    /// Threads of the CPU.
    pub threads: Option<usize>,
}

/// The top level over so many boxes that move, in one thread.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RebuildRow {
    /// Objects.
    pub objects: usize,
    /// Milliseconds to build it from scratch: the median of the rounds.
    pub rebuild_ms: f64,
    /// Milliseconds to move the boxes of the tree that is there.
    pub refit_ms: f64,
    /// What of it goes to a device: 32 bytes a changed node and 96 an instance, of a rebuild.
    pub upload_bytes: usize,
    /// Milliseconds to refit, and to build anew what that made bad.
    pub restructure_ms: f64,
    /// Milliseconds of all that a frame needs: every transform set, and the top level rebuilt.
    pub frame_ms: f64,
    /// What goes to a device after a refit.
    pub refit_upload_bytes: usize,
    /// What goes to a device after restructuring.
    pub restructure_upload_bytes: usize,
    /// The expected cost of a ray after a refit in the last round, over that after a rebuild.
    pub refit_cost_ratio: f64,
    /// The same after restructuring.
    pub restructure_cost_ratio: f64,
    /// The paper's milliseconds of a rebuild.
    pub paper_rebuild_ms: Option<f64>,
    /// Rounds.
    pub rounds: usize,
    /// Threads.
    pub threads: usize,
    /// Where it ran.
    pub device: &'static str,
}

/// The spread is left to JSON.
const COLUMNS: [Column<TwoLevelRow>; 36] = [
    ("scene", |row| row.scene.clone()),
    ("objects", |row| row.objects.to_string()),
    ("triangles", |row| row.triangles.to_string()),
    ("structure", |row| row.structure.clone()),
    ("bottom", |row| row.bottom.clone().unwrap_or_default()),
    ("oriented_boxes", |row| maybe(row.oriented_boxes)),
    ("rays", |row| row.rays.into()),
    ("objects_entered", |row| maybe(row.objects_entered)),
    ("bvh_depth_avg", |row| maybe(row.bvh_depth_avg)),
    ("bvh_depth_max", |row| maybe(row.bvh_depth_max)),
    ("bvh_depth_var", |row| maybe(row.bvh_depth_var)),
    ("kd_depth_avg", |row| maybe(row.kd_depth_avg)),
    ("kd_depth_max", |row| maybe(row.kd_depth_max)),
    ("kd_depth_var", |row| maybe(row.kd_depth_var)),
    ("smart_stack_max_bytes", |row| maybe(row.smart_stack_max_bytes)),
    ("rays_per_s", |row| maybe(row.rays_per_s)),
    ("relative_to_single_kd", |row| maybe(row.relative_to_single_kd)),
    ("relative_to_single_bvh", |row| maybe(row.relative_to_single_bvh)),
    ("device", |row| row.device.clone()),
    ("walk", |row| row.walk.clone()),
    ("ray_count", |row| row.ray_count.to_string()),
    ("rays_that_hit", |row| row.rays_that_hit.to_string()),
    ("objects_entered_per_hit", |row| maybe(row.objects_entered_per_hit)),
    ("objects_tested", |row| maybe(row.objects_tested)),
    ("bvh_visits", |row| row.bvh_visits.to_string()),
    ("kd_visits", |row| row.kd_visits.to_string()),
    ("primitive_tests", |row| row.primitive_tests.to_string()),
    ("cost", |row| row.cost.to_string()),
    ("cost_relative_to_single_kd", |row| row.cost_relative_to_single_kd.to_string()),
    ("cost_relative_to_single_kd_20", |row| row.cost_relative_to_single_kd_20.to_string()),
    ("cost_relative_to_single_bvh", |row| row.cost_relative_to_single_bvh.to_string()),
    ("relative_to_single_kd_20", |row| maybe(row.relative_to_single_kd_20)),
    ("smart_stack_swaps", |row| maybe(row.smart_stack_swaps)),
    ("differing", |row| row.differing.to_string()),
    ("build_s", |row| row.build_s.to_string()),
    ("threads", |row| maybe(row.threads)),
];

const REBUILD_COLUMNS: [Column<RebuildRow>; 14] = [
    ("objects", |row| row.objects.to_string()),
    ("rebuild_ms", |row| row.rebuild_ms.to_string()),
    ("refit_ms", |row| row.refit_ms.to_string()),
    ("upload_bytes", |row| row.upload_bytes.to_string()),
    ("restructure_ms", |row| row.restructure_ms.to_string()),
    ("frame_ms", |row| row.frame_ms.to_string()),
    ("refit_upload_bytes", |row| row.refit_upload_bytes.to_string()),
    ("restructure_upload_bytes", |row| row.restructure_upload_bytes.to_string()),
    ("refit_cost_ratio", |row| row.refit_cost_ratio.to_string()),
    ("restructure_cost_ratio", |row| row.restructure_cost_ratio.to_string()),
    ("paper_rebuild_ms", |row| maybe(row.paper_rebuild_ms)),
    ("rounds", |row| row.rounds.to_string()),
    ("threads", |row| row.threads.to_string()),
    ("device", |row| row.device.into()),
];

/// Writes the rows as CSV, a heading first.
///
/// # Errors
/// When the writer fails.
pub fn write_csv(rows: &[TwoLevelRow], writer: impl Write) -> io::Result<()> {
    write_columns(&COLUMNS, rows, writer)
}

/// Writes the rows of the rebuilds as CSV, a heading first.
///
/// # Errors
/// When the writer fails.
pub fn write_rebuild_csv(rows: &[RebuildRow], writer: impl Write) -> io::Result<()> {
    write_columns(&REBUILD_COLUMNS, rows, writer)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A row for tests: of two levels where `bottom` is given.
    pub(in crate::two_level) fn row(
        bottom: Option<&str>,
        oriented: bool,
        rays: &'static str,
        entered: f64,
    ) -> TwoLevelRow {
        let levels = bottom.is_some();
        TwoLevelRow {
            scene: "a, \"room\"".into(),
            objects: 12,
            triangles: 3400,
            structure: if levels { "two-level" } else { "kd-tree" }.into(),
            bottom: bottom.map(Into::into),
            oriented_boxes: levels.then_some(oriented),
            rays,
            objects_entered: levels.then_some(entered),
            bvh_depth_avg: levels.then_some(1.5),
            bvh_depth_max: levels.then_some(4),
            bvh_depth_var: levels.then_some(0.75),
            kd_depth_avg: Some(2.5),
            kd_depth_max: Some(9),
            kd_depth_var: Some(1.25),
            smart_stack_max_bytes: levels.then_some(120),
            rays_per_s: Some(2.5e6),
            relative_to_single_kd: Some(0.8),
            relative_to_single_bvh: Some(0.6),
            device: "cpu".into(),
            walk: "stack".into(),
            ray_count: 100,
            rays_that_hit: 80,
            objects_entered_per_hit: levels.then_some(1.25 * entered),
            objects_tested: levels.then_some(2.0 * entered),
            bvh_visits: 5.0,
            kd_visits: 20.0,
            primitive_tests: 4.0,
            cost: 40.0,
            cost_relative_to_single_kd: 0.75,
            cost_relative_to_single_kd_20: 0.9,
            cost_relative_to_single_bvh: 0.5,
            relative_to_single_kd_20: Some(0.95),
            relative_spread: Spread::of(&[0.7, 0.8, 0.9]),
            smart_stack_swaps: levels.then_some(0),
            differing: 3,
            build_s: 0.25,
            threads: Some(2),
        }
    }

    /// A row for tests.
    pub(in crate::two_level) fn rebuild_row(objects: usize, rebuild_ms: f64) -> RebuildRow {
        RebuildRow {
            objects,
            rebuild_ms,
            refit_ms: rebuild_ms / 10.0,
            upload_bytes: 32 * (2 * objects - 1) + 96 * objects,
            restructure_ms: rebuild_ms / 4.0,
            frame_ms: rebuild_ms * 1.5,
            refit_upload_bytes: 160 * objects,
            restructure_upload_bytes: 160 * objects,
            refit_cost_ratio: 1.5,
            restructure_cost_ratio: 1.25,
            paper_rebuild_ms: (objects == 1000).then_some(9.8),
            rounds: 5,
            threads: 1,
            device: "cpu",
        }
    }

    /// The names that the rows must have.
    #[test]
    fn rows_have_the_names_that_others_look_for() {
        let json = serde_json::to_value(row(Some("kd-tree"), true, "primary", 1.5)).unwrap();
        for name in [
            "scene",
            "objects",
            "triangles",
            "structure",
            "bottom",
            "oriented_boxes",
            "rays",
            "objects_entered",
            "bvh_depth_avg",
            "bvh_depth_max",
            "bvh_depth_var",
            "kd_depth_avg",
            "kd_depth_max",
            "kd_depth_var",
            "smart_stack_max_bytes",
            "rays_per_s",
            "relative_to_single_kd",
            "relative_to_single_bvh",
            "device",
        ] {
            assert!(json.get(name).is_some_and(|value| !value.is_null()), "{name}");
        }
        let json = serde_json::to_value(rebuild_row(1000, 0.3)).unwrap();
        for name in ["objects", "rebuild_ms", "refit_ms", "upload_bytes"] {
            assert!(json.get(name).is_some_and(serde_json::Value::is_number), "{name}");
        }
    }

    fn same_names(csv: &[u8], json: &serde_json::Value, left_to_json: &[&str]) {
        let mut reader = csv::Reader::from_reader(csv);
        let names: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
        let record = reader.records().next().unwrap().unwrap();
        let fields = json.as_object().unwrap();
        assert_eq!(names.len() + left_to_json.len(), fields.len());
        for (name, value) in fields.iter().filter(|(name, _)| !left_to_json.contains(&name.as_str())) {
            let place = names.iter().position(|other| other == name).unwrap_or_else(|| panic!("no {name}"));
            match value.as_f64() {
                Some(number) => assert_eq!(record[place].parse(), Ok(number), "{name}"),
                None => {
                    let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
                    assert_eq!(&record[place], if value.is_null() { "" } else { &text }, "{name}");
                }
            }
        }
    }

    #[test]
    fn every_field_of_a_row_has_its_column() {
        for row in [row(Some("bvh"), false, "shadow", 2.5), row(None, false, "primary", 0.0)] {
            let mut bytes = Vec::new();
            write_csv(std::slice::from_ref(&row), &mut bytes).unwrap();
            same_names(&bytes, &serde_json::to_value(&row).unwrap(), &["relative_spread"]);
        }
        let mut bytes = Vec::new();
        let row = rebuild_row(1000, 0.3);
        write_rebuild_csv(std::slice::from_ref(&row), &mut bytes).unwrap();
        same_names(&bytes, &serde_json::to_value(&row).unwrap(), &[]);
    }
}
