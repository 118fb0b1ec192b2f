//! What a render did, in words and as a document.

use super::Arguments;
use crate::table::{seconds, thousands};
use ropewalk::CounterTotals;
use ropewalk_render::{FrameStatistics, Noise, Picture, RenderSettings};
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
    integrator: String,
    structure: String,
    walk: String,
    pub(super) device: String,
    camera: CameraRecord,
    #[serde(skip_serializing_if = "Option::is_none")]
    legend: Option<LegendRecord>,
    primary_rays: u64,
    shadow_rays: u64,
    ambient_rays: u64,
    reflected_rays: u64,
    refracted_rays: u64,
    scattered_rays: u64,
    cut_by_depth: u64,
    cut_by_weight: u64,
    pub(super) load_seconds: f64,
    pub(super) build_seconds: f64,
    primary_seconds: f64,
    occlusion_seconds: f64,
    shading_seconds: f64,
    pub(super) total_seconds: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    visits: Option<VisitsRecord>,
    #[serde(skip_serializing_if = "Option::is_none")]
    noise: Option<NoiseRecord>,
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

/// How noisy the pixels are: standard errors of their brightness.
#[derive(Debug, Serialize)]
struct NoiseRecord {
    mean_standard_error: f64,
    largest_standard_error: f32,
    noisiest_pixel: [u32; 2],
}

impl From<&Noise> for NoiseRecord {
    fn from(noise: &Noise) -> Self {
        Self {
            mean_standard_error: noise.mean(),
            largest_standard_error: noise.largest,
            noisiest_pixel: [noise.noisiest.0, noise.noisiest.1],
        }
    }
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
    pub(super) fn new(arguments: &Arguments, settings: &RenderSettings, picture: &Picture) -> Self {
        let statistics = &picture.statistics;
        let camera = &picture.camera;
        Self {
            scene: arguments.scene.to_string(),
            output: arguments.output.display().to_string(),
            width: picture.film.width,
            height: picture.film.height,
            samples: arguments.samples,
            view: picture.view.to_string(),
            integrator: settings.integrator.to_string(),
            structure: arguments.structure().to_string(),
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
            reflected_rays: statistics.reflected_rays,
            refracted_rays: statistics.refracted_rays,
            scattered_rays: statistics.scattered_rays,
            cut_by_depth: statistics.cut_by_depth,
            cut_by_weight: statistics.cut_by_weight,
            primary_seconds: statistics.primary_time.as_secs_f64(),
            occlusion_seconds: statistics.occlusion_time.as_secs_f64(),
            shading_seconds: statistics.shading_time.as_secs_f64(),
            visits: statistics.counters.as_ref().map(VisitsRecord::from),
            noise: Some(&statistics.noise).filter(|noise| noise.pixels > 0).map(NoiseRecord::from),
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
        let followed = self.reflected_rays + self.refracted_rays + self.scattered_rays;
        let rays = self.primary_rays + self.shadow_rays + self.ambient_rays + followed;
        let tracing = self.primary_seconds + self.occlusion_seconds;
        let rate = if tracing > 0.0 { rays as f64 / tracing / 1e6 } else { 0.0 };
        let _ = writeln!(
            text,
            "rays      {} primary, {} shadow, {} ambient ({rate:.2} Mrays/s)",
            thousands(self.primary_rays),
            thousands(self.shadow_rays),
            thousands(self.ambient_rays)
        );
        if followed + self.cut_by_depth + self.cut_by_weight > 0 {
            let _ = writeln!(
                text,
                "          {} reflected, {} refracted, {} scattered; not followed: {} too deep, {} too faint",
                thousands(self.reflected_rays),
                thousands(self.refracted_rays),
                thousands(self.scattered_rays),
                thousands(self.cut_by_depth),
                thousands(self.cut_by_weight)
            );
        }
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
        if let Some(noise) = &self.noise {
            let [x, y] = noise.noisiest_pixel;
            let _ = writeln!(
                text,
                "noise     mean standard error {:.5}, noisiest pixel {x},{y} with {:.4}",
                noise.mean_standard_error, noise.largest_standard_error
            );
        }
        if let Some(legend) = &self.legend {
            let _ = writeln!(text, "scale     {} to {} {}", legend.low, legend.high, legend.unit);
        }
        text
    }
}

/// The head of the table of frames.
pub(super) const FRAME_HEADER: &str =
    " frame      time   moved refit built  update ms  upload KB  render ms      rays    memory  file\n";

/// The row of a frame.
pub(super) fn frame_row(statistics: &FrameStatistics, file: &str) -> String {
    let FrameStatistics { frame, time, instances_moved, objects_refitted, objects_rebuilt, .. } = statistics;
    let FrameStatistics { update_ms, render_ms, upload_bytes, .. } = statistics;
    let rays = statistics.primary_rays
        + statistics.shadow_rays
        + statistics.ambient_rays
        + statistics.reflected_rays
        + statistics.refracted_rays;
    let memory = statistics.resident_bytes.map_or("-".into(), |bytes| format!("{} MB", bytes >> 20));
    let upload = upload_bytes.div_ceil(1024);
    let rays = thousands(rays);
    format!(
        "{frame:>6} {time:>9.3} {instances_moved:>7} {objects_refitted:>5} {objects_rebuilt:>5} {update_ms:>10.2} \
         {upload:>10} {render_ms:>10.1} {rays:>9} {memory:>9}  {file}\n"
    )
}
