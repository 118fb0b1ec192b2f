//! What is kept of the comparison: one row a scene, setting, class of rays and device; and the copies.

use super::Table;
use crate::Spread;
use crate::comparison::{Column, maybe, write_columns};
use serde::Serialize;
use std::io::{self, Write};

/// All that was found out of one scene, or of several.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ListComparison {
    /// What was asked.
    pub scenes: Vec<ListScene>,
    /// A row a setting, class of rays and device.
    pub rows: Vec<ListRow>,
    /// The times of copies.
    pub copies: Vec<CopyRow>,
}

/// A scene, and what its answers were held against.
#[derive(Clone, Debug, Serialize)]
pub struct ListScene {
    /// The scene's file or name.
    pub scene: String,
    /// Triangles without a ground.
    pub triangles: usize,
    /// Pixels a side of the views in which elements are counted.
    pub view: usize,
    /// Pixels a side of the frame that is timed, where one is.
    pub frame: Option<usize>,
    /// Rays whose answers every setting had to give, over both stages.
    pub rays: usize,
    /// Those of them that were held against every triangle, of two sides and of one.
    pub brute_force_rays: usize,
}

/// One row. Counts are means a ray.
#[derive(Clone, Debug, Serialize)]
pub struct ListRow {
    /// The scene's file or name.
    pub scene: String,
    /// Its triangles, with the ground's where it stands on one.
    pub triangles: usize,
    /// Whether it stands on the ground.
    pub ground: bool,
    /// The table to which the row belongs.
    pub table: Table,
    /// The setting's name in the table.
    pub setting: String,
    /// What was built, as it is written on the command line; the paper's rule of culling has no name there.
    pub structure: String,
    /// How it was walked.
    pub walk: String,
    /// What the lists come from.
    pub source: &'static str,
    /// What bounds their nodes.
    pub bounds: &'static str,
    /// What spheres hold of triangles, where nodes have spheres: their `boxes`, or their `vertices` alone.
    pub spheres: Option<&'static str>,
    /// How many lists there are; none where it is no lists.
    pub directions: Option<usize>,
    /// The order of children.
    pub order: Option<&'static str>,
    /// What lists leave out.
    pub cull: &'static str,
    /// Heads of polygons.
    pub heads: &'static str,
    /// Cells a side of the screen.
    pub frustum_grid: u32,
    /// The class of the rays.
    pub rays: &'static str,
    /// How many there are.
    pub ray_count: usize,
    /// List elements visited. Where it is no lists, what is tested: both boxes of an inner visit, and triangles.
    pub elements_per_ray: f64,
    /// Of these, visits of inner nodes.
    pub inner_visits: f64,
    /// Of these, tests of triangles.
    pub primitive_tests: f64,
    /// The share of triangles that the lists leave out, 0 to 1.
    pub culled_share: f64,
    /// The same of the reference measurements.
    pub reference_culled_share: Option<f64>,
    /// Elements of all lists.
    pub elements: usize,
    /// Those of the reference measurements.
    pub reference_elements: Option<usize>,
    /// Their bytes.
    pub list_bytes: usize,
    /// Bytes of the vertices and of who the triangles are, which all lists share.
    pub shared_bytes: usize,
    /// Bytes of the heads: of all polygons, and of the cells of one view.
    pub heads_bytes: usize,
    /// Frames a second: camera rays and shadow rays of one view, one after the other; the median of the rounds.
    pub fps: Option<f64>,
    /// Rays a second, from the call to the answers in memory.
    pub rays_per_s: Option<f64>,
    /// `cpu`, or the adapter.
    pub device: String,
    /// Milliseconds of a frame: the median, and how far the rounds lie apart.
    pub frame_ms: Option<Spread>,
    /// Threads of the CPU.
    pub threads: Option<usize>,
    /// Seconds that the build took, with the heads of all polygons.
    pub build_s: f64,
    /// Elements a ray of the reference measurements.
    pub reference: Option<f64>,
    /// How far the count is from that, in percent.
    pub deviation_percent: Option<f64>,
    /// The paper's frames a second.
    pub paper_fps: Option<f64>,
    /// The paper's rays a second.
    pub paper_rays_per_s: Option<f64>,
    /// Rays with another answer than they must have: those that the paper's rule of culling loses, or spheres that hold
    /// vertices alone.
    pub lost_hits: usize,
}

/// The time to copy lists beside that of a frame.
#[derive(Clone, Debug, Serialize)]
pub struct CopyRow {
    /// The scene's file or name.
    pub scene: String,
    /// Triangles with the ground's two.
    pub triangles: usize,
    /// The setting's name.
    pub setting: String,
    /// `cpu`, where it is a copy in memory, or the adapter, where it is the upload.
    pub device: String,
    /// What is copied: elements, vertices, who the triangles are, and heads of polygons.
    pub bytes: usize,
    /// Milliseconds of the copy: the median of the rounds.
    pub copy_ms: f64,
    /// Milliseconds of a frame.
    pub frame_ms: f64,
    /// The copy over the frame, in percent.
    pub ratio_percent: f64,
    /// The paper's milliseconds of the copy.
    pub paper_copy_ms: Option<f64>,
    /// The paper's milliseconds of a frame.
    pub paper_frame_ms: Option<f64>,
    /// The paper's copy over its frame, in percent.
    pub paper_ratio_percent: Option<f64>,
}

/// The spread of the times is left to JSON.
const COLUMNS: [Column<ListRow>; 36] = [
    ("scene", |row| row.scene.clone()),
    ("triangles", |row| row.triangles.to_string()),
    ("ground", |row| row.ground.to_string()),
    ("table", |row| row.table.name().into()),
    ("setting", |row| row.setting.clone()),
    ("structure", |row| row.structure.clone()),
    ("walk", |row| row.walk.clone()),
    ("source", |row| row.source.into()),
    ("bounds", |row| row.bounds.into()),
    ("spheres", |row| row.spheres.unwrap_or_default().into()),
    ("directions", |row| maybe(row.directions)),
    ("order", |row| maybe(row.order)),
    ("cull", |row| row.cull.into()),
    ("heads", |row| row.heads.into()),
    ("frustum_grid", |row| row.frustum_grid.to_string()),
    ("rays", |row| row.rays.into()),
    ("ray_count", |row| row.ray_count.to_string()),
    ("elements_per_ray", |row| row.elements_per_ray.to_string()),
    ("inner_visits", |row| row.inner_visits.to_string()),
    ("primitive_tests", |row| row.primitive_tests.to_string()),
    ("culled_share", |row| row.culled_share.to_string()),
    ("reference_culled_share", |row| maybe(row.reference_culled_share)),
    ("elements", |row| row.elements.to_string()),
    ("reference_elements", |row| maybe(row.reference_elements)),
    ("list_bytes", |row| row.list_bytes.to_string()),
    ("shared_bytes", |row| row.shared_bytes.to_string()),
    ("heads_bytes", |row| row.heads_bytes.to_string()),
    ("fps", |row| maybe(row.fps)),
    ("rays_per_s", |row| maybe(row.rays_per_s)),
    ("device", |row| row.device.clone()),
    ("threads", |row| maybe(row.threads)),
    ("reference", |row| maybe(row.reference)),
    ("deviation_percent", |row| maybe(row.deviation_percent)),
    ("paper_fps", |row| maybe(row.paper_fps)),
    ("paper_rays_per_s", |row| maybe(row.paper_rays_per_s)),
    ("lost_hits", |row| row.lost_hits.to_string()),
];

/// Writes the rows as CSV, a heading first.
///
/// # Errors
/// When the writer fails.
pub fn write_csv(rows: &[ListRow], writer: impl Write) -> io::Result<()> {
    write_columns(&COLUMNS, rows, writer)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A row for tests.
    pub(in crate::traversal_lists) fn row(
        setting: &str,
        rays: &'static str,
        elements_per_ray: f64,
    ) -> ListRow {
        ListRow {
            scene: "a, \"bunny\"".into(),
            triangles: 69_453,
            ground: true,
            table: Table::Columns,
            setting: setting.into(),
            structure: "list".into(),
            walk: "list".into(),
            source: "octree",
            bounds: "sphere",
            spheres: Some("boxes"),
            directions: Some(6),
            order: Some("earliest-first"),
            cull: "exact",
            heads: "regular",
            frustum_grid: 16,
            rays,
            ray_count: 100,
            elements_per_ray,
            inner_visits: 0.75 * elements_per_ray,
            primitive_tests: 0.25 * elements_per_ray,
            culled_share: 0.123,
            reference_culled_share: Some(0.12),
            elements: 1000,
            reference_elements: None,
            list_bytes: 20_000,
            shared_bytes: 3000,
            heads_bytes: 2400,
            fps: (rays == "frame").then_some(4.0),
            rays_per_s: (rays == "frame").then_some(2.5e6),
            device: "cpu".into(),
            frame_ms: Spread::of(&[250.0]),
            threads: Some(2),
            build_s: 0.5,
            reference: (rays != "frame").then_some(50.0),
            deviation_percent: (rays != "frame").then_some(2.0 * (elements_per_ray - 50.0)),
            paper_fps: Some(6.01),
            paper_rays_per_s: Some(11.52e6),
            lost_hits: 0,
        }
    }

    #[test]
    fn names_with_commas_stay_whole_in_csv() {
        let mut bytes = Vec::new();
        write_csv(&[row("6 all", "primary", 51.0)], &mut bytes).unwrap();
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let names = reader.headers().unwrap().clone();
        let record = reader.records().next().unwrap().unwrap();
        let field = |name: &str| &record[names.iter().position(|other| other == name).unwrap()];
        assert_eq!((field("scene"), field("table"), field("fps")), ("a, \"bunny\"", "columns", ""));
        assert_eq!((field("elements_per_ray"), field("deviation_percent")), ("51", "2"));
        let json = serde_json::to_value(row("6 all", "frame", 51.0)).unwrap();
        assert_eq!((&json["table"], &json["fps"]), (&"columns".into(), &4.0.into()));
    }
}
