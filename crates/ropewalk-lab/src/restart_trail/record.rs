//! What is kept of the comparison: one row a scene, builder, leaf cap, class of rays, short stack and device.

use crate::Spread;
use crate::comparison::{Column, ShortStack, maybe, write_columns};
use serde::Serialize;
use std::io::{self, Write};

/// One row. All counts are means a ray.
#[derive(Clone, Debug, Serialize)]
pub struct TrailRow {
    /// The scene's file or name.
    pub scene: String,
    /// What made the tree.
    pub builder: &'static str,
    /// Its leaf cap.
    pub max_leaf: u32,
    /// The class of the rays.
    pub rays: &'static str,
    /// The size of the stack.
    pub short_stack: ShortStack,
    /// Whether entries are culled again when they are popped; the full stack's too.
    pub culls_at_pop: bool,
    /// Nodes whose children's boxes were tested.
    pub inner_visits: f64,
    /// Leaves entered.
    pub leaf_visits: f64,
    /// Triangles tested.
    pub primitive_tests: f64,
    /// Restarts from the root.
    pub restarts: f64,
    /// Inner visits, over those of the full stack.
    pub ratio_inner: f64,
    /// Rays a second, from the call to the answers in memory: the median of the rounds.
    pub rays_per_s: Option<f64>,
    /// `cpu`, or the adapter.
    pub device: String,
    /// The time, over that of the full stack in the same round: the median, and how far the rounds lie apart.
    pub ratio_time: Option<Spread>,
    /// Threads of the CPU.
    pub threads: Option<usize>,
    /// What is asked.
    pub query: &'static str,
    /// Rays of the batch.
    pub ray_count: usize,
    /// Rays whose answers were compared with the full stack's.
    pub verified: usize,
    /// Triangles of the tree, each counted once.
    pub triangles: usize,
    /// References to triangles in its leaves: more than triangles after spatial splits.
    pub references: usize,
    /// The depth of its deepest leaf.
    pub depth: u32,
    /// The most entries that any ray's stack held.
    pub deepest_stack: u32,
    /// Whether the ratio lies in the band that a correct walk keeps to, where there is one for the size.
    pub in_band: Option<bool>,
    /// Whether it lies in the paper's band, where the paper gives one.
    pub in_published_band: Option<bool>,
    /// The ratio of the reference measurements, where they have the scene, tree and class.
    pub reference_ratio: Option<f64>,
    /// How far the ratio is from that, in percent.
    pub deviation_percent: Option<f64>,
}

/// The spread of the times is left to JSON.
const COLUMNS: [Column<TrailRow>; 21] = [
    ("scene", |row| row.scene.clone()),
    ("builder", |row| row.builder.into()),
    ("max_leaf", |row| row.max_leaf.to_string()),
    ("rays", |row| row.rays.into()),
    ("short_stack", |row| row.short_stack.to_string()),
    ("culls_at_pop", |row| row.culls_at_pop.to_string()),
    ("inner_visits", |row| row.inner_visits.to_string()),
    ("leaf_visits", |row| row.leaf_visits.to_string()),
    ("primitive_tests", |row| row.primitive_tests.to_string()),
    ("restarts", |row| row.restarts.to_string()),
    ("ratio_inner", |row| row.ratio_inner.to_string()),
    ("rays_per_s", |row| maybe(row.rays_per_s)),
    ("device", |row| row.device.clone()),
    ("ratio_time", |row| maybe(row.ratio_time.map(|ratio| ratio.median))),
    ("threads", |row| maybe(row.threads)),
    ("ray_count", |row| row.ray_count.to_string()),
    ("triangles", |row| row.triangles.to_string()),
    ("references", |row| row.references.to_string()),
    ("in_band", |row| maybe(row.in_band)),
    ("reference_ratio", |row| maybe(row.reference_ratio)),
    ("deviation_percent", |row| maybe(row.deviation_percent)),
];

/// Writes the rows as CSV, a heading first.
///
/// # Errors
/// When the writer fails.
pub fn write_csv(rows: &[TrailRow], writer: impl Write) -> io::Result<()> {
    write_columns(&COLUMNS, rows, writer)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A row for tests.
    pub(in crate::restart_trail) fn row(short_stack: ShortStack, ratio_inner: f64) -> TrailRow {
        TrailRow {
            scene: "a, \"room\"".into(),
            builder: "sweep",
            max_leaf: 4,
            rays: "primary",
            short_stack,
            culls_at_pop: true,
            inner_visits: 20.0 * ratio_inner,
            leaf_visits: 2.0,
            primitive_tests: 5.0,
            restarts: 1.5,
            ratio_inner,
            rays_per_s: Some(2.5e6),
            device: "cpu".into(),
            ratio_time: Spread::of(&[1.0, 1.25, 1.5]),
            threads: Some(2),
            query: "closest",
            ray_count: 100,
            verified: 100,
            triangles: 10,
            references: 12,
            depth: 4,
            deepest_stack: 3,
            in_band: Some(true),
            in_published_band: None,
            reference_ratio: Some(2.0),
            deviation_percent: Some(5.0),
        }
    }

    #[test]
    fn names_with_commas_stay_whole_in_csv() {
        let mut bytes = Vec::new();
        write_csv(&[row(ShortStack::Full, 1.0)], &mut bytes).unwrap();
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let names = reader.headers().unwrap().clone();
        let record = reader.records().next().unwrap().unwrap();
        let field = |name: &str| &record[names.iter().position(|other| other == name).unwrap()];
        assert_eq!(field("scene"), "a, \"room\"");
        assert_eq!((field("short_stack"), field("ratio_time"), field("in_band")), ("full", "1.25", "true"));
    }
}
