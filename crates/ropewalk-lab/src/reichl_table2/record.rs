//! What is kept of the runs: a row a scene, configuration, structure and device; and of primary hits a row a scene, structure and
//! device.

use crate::Spread;
use crate::comparison::{Column, maybe, write_columns};
use serde::Serialize;
use std::io::{self, Write};

/// All that was found out of one scene, or of several.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ReichlTable2Findings {
    /// What was rendered.
    pub scenes: Vec<ReichlTable2Scene>,
    /// A row a configuration, structure and device.
    pub rows: Vec<ReichlTable2Row>,
    /// Primary hits drawn beside traced.
    pub primary: Vec<PrimaryRow>,
}

/// A scene, and how it was seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReichlTable2Scene {
    /// The scene's file or name.
    pub scene: String,
    /// Objects that are placed: instances.
    pub objects: usize,
    /// Triangles, those of each instance counted.
    pub triangles: usize,
    /// Lights of the file; where there are none, a studio's stand in.
    pub lights: usize,
    /// Pixels a side.
    pub size: u32,
    /// The paper's scene that it is, or stands for.
    pub paper_scene: Option<&'static str>,
}

/// One row. Counts are a ray, over all that the picture's walks did.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReichlTable2Row {
    /// The scene's file or name.
    pub scene: String,
    /// What is followed.
    pub configuration: &'static str,
    /// What was built, as it is written on the command line.
    pub structure: String,
    /// `cpu`, or the adapter.
    pub device: String,
    /// How it was walked.
    pub walk: String,
    /// Pixels a side.
    pub size: u32,
    /// Frames a second: the median of the rounds.
    pub frames_per_s: Option<f64>,
    /// The speed over that of one kd-tree in the same round, the median.
    pub relative_to_single_kd: Option<f64>,
    /// How far the rounds lie apart: the speed over that of one kd-tree.
    pub relative_spread: Option<Spread>,
    /// The paper's frames a second.
    pub paper_frames_per_s: Option<f64>,
    /// The paper's speed over that of one kd-tree.
    pub paper_relative: Option<f64>,
    /// Rays a picture behind the primary hits; of primary shading the primary rays.
    pub rays: u64,
    /// Inner nodes visited, a ray.
    pub inner_visits: f64,
    /// Leaves visited, a ray.
    pub leaf_visits: f64,
    /// Triangles tested, a ray.
    pub primitive_tests: f64,
    /// Objects' structures entered, a ray; none where there is one structure.
    pub objects_entered: Option<f64>,
    /// Inner nodes over those of one kd-tree.
    pub inner_visits_relative: Option<f64>,
    /// Triangles tested over those with one kd-tree.
    pub primitive_tests_relative: Option<f64>,
    /// Pixels that differ visibly from the picture of one kd-tree on the CPU.
    pub different_pixels: usize,
    /// Seconds that the build took.
    pub build_s: f64,
    /// Rounds.
    pub rounds: usize,
    /// Threads of the CPU.
    pub threads: Option<usize>,
}

/// Primary hits drawn beside traced.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PrimaryRow {
    /// The scene's file or name.
    pub scene: String,
    /// What is traced, as it is written on the command line.
    pub structure: String,
    /// `cpu`, or the adapter.
    pub device: String,
    /// Pixels a side.
    pub size: u32,
    /// Rays from the eye.
    pub rays: u64,
    /// Those that hit something.
    pub hits: u64,
    /// Those whose drawn hit is another than the traced one.
    pub different: u64,
    /// Those with the same triangle and other last bits.
    pub rounded: u64,
    /// Those that drawing left undecided, so that they were traced.
    pub traced_instead: u64,
    /// Milliseconds to trace a picture's primary hits: the median of the rounds.
    pub traced_ms: Option<f64>,
    /// Milliseconds to draw them.
    pub rasterised_ms: Option<f64>,
    /// How much faster drawing is, the median of the rounds.
    pub gain: Option<f64>,
    /// The largest gain that the paper has seen.
    pub paper_gain: f64,
    /// Milliseconds to make the triangles ready to be drawn, once.
    pub preparation_ms: Option<f64>,
}

/// The spread is left to JSON.
const COLUMNS: [Column<ReichlTable2Row>; 21] = [
    ("scene", |row| row.scene.clone()),
    ("configuration", |row| row.configuration.into()),
    ("structure", |row| row.structure.clone()),
    ("device", |row| row.device.clone()),
    ("walk", |row| row.walk.clone()),
    ("size", |row| row.size.to_string()),
    ("frames_per_s", |row| maybe(row.frames_per_s)),
    ("relative_to_single_kd", |row| maybe(row.relative_to_single_kd)),
    ("paper_frames_per_s", |row| maybe(row.paper_frames_per_s)),
    ("paper_relative", |row| maybe(row.paper_relative)),
    ("rays", |row| row.rays.to_string()),
    ("inner_visits", |row| row.inner_visits.to_string()),
    ("leaf_visits", |row| row.leaf_visits.to_string()),
    ("primitive_tests", |row| row.primitive_tests.to_string()),
    ("objects_entered", |row| maybe(row.objects_entered)),
    ("inner_visits_relative", |row| maybe(row.inner_visits_relative)),
    ("primitive_tests_relative", |row| maybe(row.primitive_tests_relative)),
    ("different_pixels", |row| row.different_pixels.to_string()),
    ("build_s", |row| row.build_s.to_string()),
    ("rounds", |row| row.rounds.to_string()),
    ("threads", |row| maybe(row.threads)),
];

const PRIMARY_COLUMNS: [Column<PrimaryRow>; 14] = [
    ("scene", |row| row.scene.clone()),
    ("structure", |row| row.structure.clone()),
    ("device", |row| row.device.clone()),
    ("size", |row| row.size.to_string()),
    ("rays", |row| row.rays.to_string()),
    ("hits", |row| row.hits.to_string()),
    ("different", |row| row.different.to_string()),
    ("rounded", |row| row.rounded.to_string()),
    ("traced_instead", |row| row.traced_instead.to_string()),
    ("traced_ms", |row| maybe(row.traced_ms)),
    ("rasterised_ms", |row| maybe(row.rasterised_ms)),
    ("gain", |row| maybe(row.gain)),
    ("paper_gain", |row| row.paper_gain.to_string()),
    ("preparation_ms", |row| maybe(row.preparation_ms)),
];

/// Writes the rows as CSV.
///
/// # Errors
/// When the writer fails.
pub fn write_csv(rows: &[ReichlTable2Row], writer: impl Write) -> io::Result<()> {
    write_columns(&COLUMNS, rows, writer)
}

/// Writes the rows of primary hits as CSV.
///
/// # Errors
/// When the writer fails.
pub fn write_primary_csv(rows: &[PrimaryRow], writer: impl Write) -> io::Result<()> {
    write_columns(&PRIMARY_COLUMNS, rows, writer)
}
