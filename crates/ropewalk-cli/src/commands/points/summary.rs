//! What was done, for people and for scripts.

use super::Arguments;
use super::answer::Answered;
use super::question::Question;
use crate::arrays::answers_file::PointsAnswer;
use crate::arrays::rows::Rows;
use crate::table::{seconds, thousands};
use ropewalk::{CounterTotals, PointQuery, PointSearch};
use ropewalk_gpu::Traceable;
use serde::Serialize;
use std::fmt::Write;
use std::time::Duration;

/// The document of `--json`, and what the text is made of.
#[derive(Debug, Serialize)]
pub(super) struct Summary {
    scene: String,
    points: usize,
    invalid_points: usize,
    query: &'static str,
    /// Of `k-nearest`.
    k: Option<usize>,
    max_distance: Option<f32>,
    structure: String,
    walk: String,
    device: String,
    /// Points with anything within reach; not told by `inside`.
    points_found: Option<usize>,
    /// Points inside of the surface or on it, where the side was asked for.
    points_inside: Option<usize>,
    /// Triangles found for all points, by `k-nearest`.
    answers: Option<usize>,
    /// What the closed surface encloses; negative where it is inside out.
    volume: Option<f64>,
    load_seconds: f64,
    build_seconds: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    surface_seconds: Option<f64>,
    search_seconds: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    device_seconds: Option<f64>,
    points_per_second: f64,
    output: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    stats: Option<Stats>,
}

/// What the walk did: means over all points.
#[derive(Debug, Serialize)]
struct Stats {
    inner_visits_per_point: f64,
    leaf_visits_per_point: f64,
    primitive_tests_per_point: f64,
    restarts_per_point: f64,
    deepest_stack: u32,
}

impl Stats {
    fn new(totals: &CounterTotals) -> Self {
        // Of no points every sum is zero.
        let mean = |sum: u64| sum as f64 / totals.rays.max(1) as f64;
        Self {
            inner_visits_per_point: mean(totals.inner_visits),
            leaf_visits_per_point: mean(totals.leaf_visits),
            primitive_tests_per_point: mean(totals.primitive_tests),
            restarts_per_point: mean(totals.restarts),
            deepest_stack: totals.stack_depth,
        }
    }
}

impl Summary {
    pub(super) fn new(
        arguments: &Arguments,
        points: &Rows<PointQuery>,
        traceable: &Traceable,
        answered: &Answered,
        load_time: Duration,
        build_time: Duration,
    ) -> Self {
        let (count, time) = (points.rows.len(), answered.time.as_secs_f64());
        let is_nearest = arguments.query == Question::Search(PointSearch::Nearest);
        Self {
            scene: arguments.scene.to_string(),
            points: count,
            invalid_points: points.invalid,
            query: arguments.query.name(),
            k: is_nearest.then(|| arguments.k()),
            max_distance: arguments.max_distance,
            structure: arguments.structure.to_string(),
            walk: arguments.walk().to_string(),
            device: traceable.device().to_string(),
            points_found: answered.answer.found(),
            points_inside: answered.answer.inside(),
            answers: match &answered.answer {
                PointsAnswer::Nearest(lists) => Some(lists.points.len()),
                _ => None,
            },
            volume: answered.surface.map(|surface| surface.volume),
            load_seconds: load_time.as_secs_f64(),
            build_seconds: build_time.as_secs_f64(),
            surface_seconds: answered.surface.map(|surface| surface.time.as_secs_f64()),
            search_seconds: time,
            device_seconds: answered.device_time.map(|time| time.as_secs_f64()),
            points_per_second: if time > 0.0 { count as f64 / time } else { 0.0 },
            output: arguments.output.display().to_string(),
            stats: answered.totals.as_ref().map(Stats::new),
        }
    }

    pub(super) fn to_text(&self) -> String {
        let mut text = String::new();
        let (counted, what) = match (self.points_inside, self.points_found) {
            (Some(inside), _) => (inside, format!("are inside of {}", self.scene)),
            (None, found) => (found.unwrap_or(0), format!("find {} within reach", self.scene)),
        };
        let share = 100.0 * counted as f64 / self.points.max(1) as f64;
        let _ = writeln!(
            text,
            "{}: {} of {} points {what} ({share:.1}%)",
            self.output,
            thousands(counted),
            thousands(self.points)
        );
        if let Some(answers) = self.answers {
            let _ = writeln!(text, "answers   {}", thousands(answers));
        }
        if let Some(volume) = self.volume {
            let _ = writeln!(text, "volume    {volume}");
        }
        if self.invalid_points > 0 {
            let invalid = thousands(self.invalid_points);
            let _ = writeln!(text, "invalid   {invalid} points, answered as if nothing was there");
        }
        let k = self.k.map(|k| format!(", k = {}", thousands(k))).unwrap_or_default();
        let reach = self.max_distance.map(|reach| format!(", at most {reach} away")).unwrap_or_default();
        let _ = writeln!(
            text,
            "asked     {}{k}{reach} of {} with the walk {}",
            self.query, self.structure, self.walk
        );
        let _ = writeln!(text, "device    {}", self.device);
        let surface =
            self.surface_seconds.map(|time| format!("connect {}, ", seconds(time))).unwrap_or_default();
        let _ = writeln!(
            text,
            "time      load {}, build {}, {surface}search {} ({:.2} Mpoints/s)",
            seconds(self.load_seconds),
            seconds(self.build_seconds),
            seconds(self.search_seconds),
            self.points_per_second / 1e6
        );
        if let Some(stats) = &self.stats {
            let _ = writeln!(
                text,
                "a point   {:.2} inner visits, {:.2} leaf visits, {:.2} primitive tests, {:.2} restarts; deepest stack \
                 {}",
                stats.inner_visits_per_point,
                stats.leaf_visits_per_point,
                stats.primitive_tests_per_point,
                stats.restarts_per_point,
                stats.deepest_stack
            );
        }
        text
    }
}
