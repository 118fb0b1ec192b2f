//! What a render did, in words and as a document.

use super::Arguments;
use crate::table::{seconds, thousands};
use ropewalk::CounterTotals;
use ropewalk_render::Picture;
use serde::Serialize;
use std::fmt::Write;

/// What was done, for people and for scripts.
#[derive(Debug, Default, Serialize)]
pub(super) struct Summary {
    scene: String,
    output: String,
    width: u32,
    height: u32,
    samples: u32,
    view: String,
    structure: String,
    walk: String,
    pub(super) device: String,
    camera: CameraRecord,
    #[serde(skip_serializing_if = "Option::is_none")]
    legend: Option<LegendRecord>,
    primary_rays: u64,
    shadow_rays: u64,
    ambient_rays: u64,
    pub(super) load_seconds: f64,
    pub(super) build_seconds: f64,
    primary_seconds: f64,
    occlusion_seconds: f64,
    shading_seconds: f64,
    pub(super) total_seconds: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    visits: Option<VisitsRecord>,
    finished_rows: u32,
    partial: bool,
    incomplete_rays: u64,
}

#[derive(Debug, Default, Serialize)]
struct CameraRecord {
    position: [f32; 3],
    forward: [f32; 3],
    up: [f32; 3],
    vertical_fov_degrees: f32,
}

/// What the ends of a colour scale mean.
#[derive(Debug, Serialize)]
struct LegendRecord {
    low: f32,
    high: f32,
    unit: &'static str,
}

/// What the walk did for a primary ray, on average.
#[derive(Debug, Serialize)]
struct VisitsRecord {
    inner_visits_per_ray: f64,
    leaf_visits_per_ray: f64,
    primitive_tests_per_ray: f64,
    deepest_stack: u32,
}

impl From<&CounterTotals> for VisitsRecord {
    fn from(totals: &CounterTotals) -> Self {
        let mean = |sum: u64| if totals.rays == 0 { 0.0 } else { sum as f64 / totals.rays as f64 };
        Self {
            inner_visits_per_ray: mean(totals.inner_visits),
            leaf_visits_per_ray: mean(totals.leaf_visits),
            primitive_tests_per_ray: mean(totals.primitive_tests),
            deepest_stack: totals.stack_depth,
        }
    }
}

impl Summary {
    pub(super) fn new(arguments: &Arguments, picture: &Picture) -> Self {
        let statistics = &picture.statistics;
        let camera = &picture.camera;
        Self {
            scene: arguments.scene.to_string(),
            output: arguments.output.display().to_string(),
            width: picture.film.width,
            height: picture.film.height,
            samples: arguments.samples,
            view: picture.view.to_string(),
            structure: arguments.structure.to_string(),
            walk: arguments.walk().to_string(),
            camera: CameraRecord {
                position: camera.position.to_array(),
                forward: camera.forward.to_array(),
                up: camera.up.to_array(),
                vertical_fov_degrees: camera.vertical_fov.to_degrees(),
            },
            legend: picture.legend.map(|legend| LegendRecord {
                low: legend.low,
                high: legend.high,
                unit: legend.unit,
            }),
            primary_rays: statistics.primary_rays,
            shadow_rays: statistics.shadow_rays,
            ambient_rays: statistics.ambient_rays,
            primary_seconds: statistics.primary_time.as_secs_f64(),
            occlusion_seconds: statistics.occlusion_time.as_secs_f64(),
            shading_seconds: statistics.shading_time.as_secs_f64(),
            visits: statistics.counters.as_ref().map(VisitsRecord::from),
            finished_rows: picture.finished_rows,
            partial: picture.partial,
            incomplete_rays: statistics.incomplete.rays,
            ..Self::default()
        }
    }

    pub(super) fn to_text(&self) -> String {
        let mut text = String::new();
        let _ = writeln!(
            text,
            "{}: {} at {}x{}, {} samples a pixel, on {}",
            self.output, self.scene, self.width, self.height, self.samples, self.device
        );
        let rays = self.primary_rays + self.shadow_rays + self.ambient_rays;
        let tracing = self.primary_seconds + self.occlusion_seconds;
        let rate = if tracing > 0.0 { rays as f64 / tracing / 1e6 } else { 0.0 };
        let _ = writeln!(
            text,
            "rays      {} primary, {} shadow, {} ambient ({rate:.2} Mrays/s)",
            thousands(self.primary_rays),
            thousands(self.shadow_rays),
            thousands(self.ambient_rays)
        );
        let _ = writeln!(
            text,
            "time      load {}, build {}, trace {}, shade {}, all {}",
            seconds(self.load_seconds),
            seconds(self.build_seconds),
            seconds(tracing),
            seconds(self.shading_seconds),
            seconds(self.total_seconds)
        );
        if let Some(visits) = &self.visits {
            let _ = writeln!(
                text,
                "a ray     {:.2} inner visits, {:.2} leaf visits, {:.2} primitive tests; deepest stack {}",
                visits.inner_visits_per_ray,
                visits.leaf_visits_per_ray,
                visits.primitive_tests_per_ray,
                visits.deepest_stack
            );
        }
        if let Some(legend) = &self.legend {
            let _ = writeln!(text, "scale     {} to {} {}", legend.low, legend.high, legend.unit);
        }
        text
    }
}
