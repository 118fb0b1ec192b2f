//! What is kept of the comparison: one row a scene, builder, leaf cap, class of rays, short stack and device.

use crate::Spread;
use serde::{Serialize, Serializer};
use std::fmt;
use std::io::{self, Write};

/// How many entries a stack may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ShortStack {
    /// The restart trail with so many.
    Entries(u32),
    /// The stack walk, which never drops any.
    Full,
}

impl fmt::Display for ShortStack {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Entries(entries) => formatter.pad(&entries.to_string()),
            Self::Full => formatter.pad("full"),
        }
    }
}

impl Serialize for ShortStack {
    /// A number, or the word `full`.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Entries(entries) => serializer.serialize_u32(*entries),
            Self::Full => serializer.serialize_str("full"),
        }
    }
}

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

/// Writes the rows as CSV, a heading first. The spread of the times is left to JSON.
///
/// # Errors
/// When the writer fails.
pub fn write_csv(rows: &[TrailRow], writer: impl Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record([
        "scene",
        "builder",
        "max_leaf",
        "rays",
        "short_stack",
        "inner_visits",
        "leaf_visits",
        "primitive_tests",
        "restarts",
        "ratio_inner",
        "rays_per_s",
        "device",
        "ratio_time",
        "threads",
        "ray_count",
        "triangles",
        "references",
        "in_band",
        "reference_ratio",
        "deviation_percent",
    ])?;
    let maybe = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
    for row in rows {
        csv.write_record([
            row.scene.clone(),
            row.builder.into(),
            row.max_leaf.to_string(),
            row.rays.into(),
            row.short_stack.to_string(),
            row.inner_visits.to_string(),
            row.leaf_visits.to_string(),
            row.primitive_tests.to_string(),
            row.restarts.to_string(),
            row.ratio_inner.to_string(),
            maybe(row.rays_per_s),
            row.device.clone(),
            maybe(row.ratio_time.map(|ratio| ratio.median)),
            row.threads.map(|threads| threads.to_string()).unwrap_or_default(),
            row.ray_count.to_string(),
            row.triangles.to_string(),
            row.references.to_string(),
            row.in_band.map(|within| within.to_string()).unwrap_or_default(),
            maybe(row.reference_ratio),
            maybe(row.deviation_percent),
        ])?;
    }
    csv.flush()
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
    fn a_stack_is_a_number_or_a_word() {
        let json = serde_json::to_value([ShortStack::Entries(3), ShortStack::Full]).unwrap();
        assert_eq!(json, serde_json::json!([3, "full"]));
        assert!(ShortStack::Entries(16) < ShortStack::Full);
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
