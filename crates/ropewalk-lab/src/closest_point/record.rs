//! What is kept of the comparison: one record a scene, and one row a scene, builder, leaf cap, walk and device.

use crate::Spread;
use crate::comparison::{Column, maybe, write_columns};
use serde::Serialize;
use std::io::{self, Write};

/// The comparison of one scene, or of several.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PointComparison {
    /// What was asked of each scene, and who confirmed the answers.
    pub scenes: Vec<PointScene>,
    /// The walks.
    pub rows: Vec<PointRow>,
}

/// What was asked of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PointScene {
    /// The scene's file or name.
    pub scene: String,
    /// Its triangles.
    pub triangles: usize,
    /// How many points were asked.
    pub points: usize,
    /// What they were made from.
    pub seed: u64,
    /// Points whose answers are brute force's, to the bit.
    pub brute_force_points: usize,
    /// Points whose answers the f64 oracle found right.
    pub oracle_points: usize,
    /// Answers of all rows that are not the same to the bit: none but on graphics hardware, where they are as near as
    /// rounding allows. What is farther off is an error, and leaves no record.
    pub differences: usize,
}

/// One row. All counts are means a point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PointRow {
    /// The scene's file or name.
    pub scene: String,
    /// Triangles of the tree, each counted once.
    pub triangles: usize,
    /// What made the tree.
    pub builder: &'static str,
    /// Its leaf cap.
    pub max_leaf: u32,
    /// The walk.
    pub walk: String,
    /// `cpu`, or the adapter.
    pub device: String,
    /// Points of the batch.
    pub points: usize,
    /// Nodes whose children's boxes were measured.
    pub inner_visits: f64,
    /// Leaves entered.
    pub leaf_visits: f64,
    /// Triangles measured.
    pub primitive_tests: f64,
    /// Restarts from the root.
    pub restarts: f64,
    /// Inner visits, over those of the full stack on the same tree.
    pub ratio_inner: f64,
    /// Points a second, from the call to the answers in memory: the median of the rounds.
    pub points_per_s: Option<f64>,
    /// The time, over that of the full stack in the same round: the median, and how far the rounds lie apart.
    pub ratio_time: Option<Spread>,
    /// Threads of the CPU.
    pub threads: Option<usize>,
    /// References to triangles in the tree's leaves: more than triangles after spatial splits.
    pub references: usize,
    /// The depth of its deepest leaf.
    pub depth: u32,
    /// The most entries that any point's stack held.
    pub deepest_stack: u32,
    /// Answers that are not the reference's to the bit, and as near as graphics hardware must come.
    pub differing: usize,
}

/// The spread of the times is left to JSON.
const COLUMNS: [Column<PointRow>; 19] = [
    ("scene", |row| row.scene.clone()),
    ("triangles", |row| row.triangles.to_string()),
    ("builder", |row| row.builder.into()),
    ("max_leaf", |row| row.max_leaf.to_string()),
    ("walk", |row| row.walk.clone()),
    ("device", |row| row.device.clone()),
    ("points", |row| row.points.to_string()),
    ("inner_visits", |row| row.inner_visits.to_string()),
    ("leaf_visits", |row| row.leaf_visits.to_string()),
    ("primitive_tests", |row| row.primitive_tests.to_string()),
    ("restarts", |row| row.restarts.to_string()),
    ("ratio_inner", |row| row.ratio_inner.to_string()),
    ("points_per_s", |row| maybe(row.points_per_s)),
    ("ratio_time", |row| maybe(row.ratio_time.map(|ratio| ratio.median))),
    ("threads", |row| maybe(row.threads)),
    ("references", |row| row.references.to_string()),
    ("depth", |row| row.depth.to_string()),
    ("deepest_stack", |row| row.deepest_stack.to_string()),
    ("differing", |row| row.differing.to_string()),
];

/// Writes the rows as CSV, a heading first.
///
/// # Errors
/// When the writer fails.
pub fn write_csv(rows: &[PointRow], writer: impl Write) -> io::Result<()> {
    write_columns(&COLUMNS, rows, writer)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A row for tests.
    pub(in crate::closest_point) fn row(walk: &str, ratio_inner: f64) -> PointRow {
        PointRow {
            scene: "a, \"room\"".into(),
            triangles: 10,
            builder: "sbvh",
            max_leaf: 4,
            walk: walk.into(),
            device: "cpu".into(),
            points: 200,
            inner_visits: 20.0 * ratio_inner,
            leaf_visits: 2.0,
            primitive_tests: 5.0,
            restarts: 1.5,
            ratio_inner,
            points_per_s: Some(2.5e5),
            ratio_time: Spread::of(&[1.0, 1.25, 1.5]),
            threads: Some(2),
            references: 12,
            depth: 4,
            deepest_stack: 3,
            differing: 0,
        }
    }

    #[test]
    fn every_field_of_a_row_has_its_column() {
        let mut bytes = Vec::new();
        write_csv(&[row("restart-trail:short-stack=0", 1.5)], &mut bytes).unwrap();
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let names: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
        let record = reader.records().next().unwrap().unwrap();
        let json = serde_json::to_value(row("restart-trail:short-stack=0", 1.5)).unwrap();
        for (name, value) in json.as_object().unwrap() {
            let place = names.iter().position(|other| other == name).unwrap_or_else(|| panic!("no {name}"));
            match (name.as_str(), value.as_f64()) {
                ("ratio_time", _) => assert_eq!(&record[place], "1.25"),
                (_, Some(number)) => assert_eq!(record[place].parse(), Ok(number), "{name}"),
                _ => assert_eq!(Some(&record[place]), value.as_str(), "{name}"),
            }
        }
        assert_eq!(names.len(), json.as_object().unwrap().len());
    }
}
