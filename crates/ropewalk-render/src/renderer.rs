//! The render loop: runs of pixels, from the top left, each a batch of primary rays with all that follows.

use crate::begin::Begin;
use crate::brdf::Finish;
use crate::camera::{self, Pinhole};
use crate::error::RenderError;
use crate::film::Film;
use crate::ground;
use crate::lights::Lighting;
use crate::picture::Picture;
use crate::sampling;
use crate::settings::RenderSettings;
use crate::shade::{self, BROKEN, Place, Shader};
use crate::stage::Stage;
use crate::statistics::Statistics;
use crate::trace::Trace;
use crate::view::{self, DATA_BACKGROUND, View};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use ropewalk::{Answer, CounterTotals, Counters, Hit, Query, Ray, Status, TraceOptions};
use std::ops::{ControlFlow, Range};
use std::time::Instant;

/// Primary rays in a batch: enough to keep a GPU busy, few enough that progress moves and that the places, about
/// 150 bytes each with their rays, take 20 MB whatever the picture's size.
const BATCH: usize = 1 << 17;

/// Renders pictures of a stage.
pub struct Renderer<'a> {
    stage: &'a Stage,
    tracer: &'a dyn Trace,
}

/// What primary rays found.
struct Seen {
    rays: Vec<Ray>,
    hits: Vec<Hit>,
    status: Vec<Status>,
    counters: Option<Vec<Counters>>,
}

impl<'a> Renderer<'a> {
    /// A renderer of `stage` on a device that holds the structure built over [`Stage::scene`].
    #[must_use]
    pub fn new(stage: &'a Stage, tracer: &'a dyn Trace) -> Self {
        Self { stage, tracer }
    }

    /// Renders one picture. `progress` is told, after each batch, how many rows are done and how many there are;
    /// `Break` ends the render and keeps what is finished.
    ///
    /// # Errors
    /// When a setting is out of range, the camera is not there, or the device fails.
    pub fn render(
        &self,
        settings: &RenderSettings,
        progress: &(dyn Fn(usize, usize) -> ControlFlow<()> + Sync),
    ) -> Result<Picture, RenderError> {
        settings.check()?;
        let (width, height) = (settings.width, settings.height);
        let aspect = (f64::from(width) / f64::from(height)) as f32;
        let camera = camera::resolve(&settings.camera, self.stage, self.tracer, settings.walk, aspect)?;
        let sees_ground = settings.view == View::Shaded
            && self.stage.catcher().is_some_and(|catcher| catcher.is_seen_from(camera.position));
        let mask = if sees_ground { Ray::ALL } else { Ray::ALL & !ground::MASK };
        let pinhole = Pinhole::new(&camera, width, height)?.with_mask(mask);
        let lighting = Lighting::new(self.stage, &camera, &settings.light, settings.samples == 1);
        let mut notes = Vec::new();
        if self.stage.bounds().is_empty() {
            notes.push("the scene has no triangle that can be seen: the picture shows the background".into());
        }
        if lighting.left_out > 0 {
            let what = format!(
                "{} lights of the file give no light or are no numbers and are left out",
                lighting.left_out
            );
            notes.push(what);
        }
        let shader = Shader {
            stage: self.stage,
            tracer: self.tracer,
            walk: settings.walk,
            lighting,
            finishes: self.stage.model().materials.iter().map(Finish::new).collect(),
            samples: settings.samples,
            ambient_rays_per_sample: settings.ambient_rays_per_sample(),
        };
        let mut film = Film::new(width, height, settings.view == View::Visits)?;
        let mut statistics = Statistics::default();
        let pixels = film.pixels();
        let run = (BATCH / settings.samples as usize).max(1);
        let mut done = 0;
        let mut partial = false;
        while done < pixels {
            let range = done..(done + run).min(pixels);
            let seen = self.look(&pinhole, settings, range.clone(), &mut statistics)?;
            let colors = self.colors(&shader, settings, range.clone(), &seen, &mut statistics)?;
            let clock = Instant::now();
            let (samples, ground) = (settings.samples as usize, self.stage.ground_instance());
            expose(&mut film, range.clone(), samples, ground, &seen, &colors, &mut statistics);
            statistics.shading_time += clock.elapsed();
            done = range.end;
            if progress(done / width as usize, height as usize).is_break() && done < pixels {
                partial = true;
                break;
            }
        }
        let legend = view::colorize(settings.view, &mut film);
        if !statistics.incomplete.is_none() {
            notes.push(format!("{}; what they were to show is magenta", statistics.incomplete));
        }
        Ok(Picture {
            film,
            view: settings.view,
            exposure: settings.exposure,
            camera,
            legend,
            statistics,
            finished_rows: (done / width as usize) as u32,
            partial,
            notes,
        })
    }

    /// Traces the primary rays of a run of pixels.
    fn look(
        &self,
        pinhole: &Pinhole,
        settings: &RenderSettings,
        range: Range<usize>,
        statistics: &mut Statistics,
    ) -> Result<Seen, RenderError> {
        let clock = Instant::now();
        let (width, samples, side) =
            (settings.width as usize, settings.samples as usize, settings.samples_per_side());
        let subpixels: Vec<_> = (0..settings.samples).map(|index| sampling::subpixel(index, side)).collect();
        let (rays, places): (Vec<Ray>, Vec<Vec2>) = (range.start * samples..range.end * samples)
            .into_par_iter()
            .with_min_len(1024)
            .map(|index| {
                let (x, y) = column_and_row(index / samples, width);
                let place = Vec2::new(x as f32, y as f32) + subpixels[index % samples];
                (pinhole.ray(place), pinhole.part(place))
            })
            .unzip();
        statistics.primary_rays += rays.len() as u64;
        statistics.shading_time += clock.elapsed();
        let clock = Instant::now();
        let options = TraceOptions { counters: settings.view == View::Visits };
        let begin = Begin::AtEye { screen: &pinhole.screen(), places: &places };
        let traced = self
            .tracer
            .trace_begun(settings.walk, Query::Closest, &rays, &begin, options)
            .map_err(RenderError::Trace)?;
        statistics.primary_time += clock.elapsed();
        let counters = traced.counters;
        let counted = counters.as_ref().map_or(0, Vec::len);
        match traced.answer {
            Answer::Closest(hits)
                if hits.len() == rays.len()
                    && traced.status.len() == rays.len()
                    && (counted == rays.len() || !options.counters) =>
            {
                Ok(Seen { rays, hits, status: traced.status, counters })
            }
            _ => Err(RenderError::Trace("the device answered another question than was asked".into())),
        }
    }

    /// The colour of every sample of a run of pixels.
    fn colors(
        &self,
        shader: &Shader<'_>,
        settings: &RenderSettings,
        range: Range<usize>,
        seen: &Seen,
        statistics: &mut Statistics,
    ) -> Result<Vec<Vec3>, RenderError> {
        let clock = Instant::now();
        let (width, samples) = (settings.width as usize, settings.samples as usize);
        let pixel = |index: usize| column_and_row(range.start + index / samples, width);
        let behind = |index: usize| match settings.view {
            View::Shaded => shade::background(pixel(index), settings.width, settings.height),
            _ => DATA_BACKGROUND,
        };
        seen.status.iter().for_each(|&status| statistics.incomplete.count(status));
        // The places on surfaces; `None` inside for a hit that leads nowhere.
        let found: Vec<Option<Result<Place, ()>>> = (0..seen.rays.len())
            .into_par_iter()
            .with_min_len(1024)
            .map(|index| {
                let hit = &seen.hits[index];
                if !seen.status[index].is_complete() {
                    return Some(Err(()));
                }
                hit.is_hit().then(|| {
                    let point = self.stage.surface_point(&seen.rays[index], hit).ok_or(())?;
                    let sample = (index % samples) as u32;
                    Ok(Place { point, pixel: pixel(index), sample, background: behind(index) })
                })
            })
            .collect();
        let mut colors = Vec::with_capacity(found.len());
        let mut places = Vec::new();
        let mut place_of = Vec::new();
        let mut lost = 0;
        for (index, found) in found.into_iter().enumerate() {
            colors.push(match found {
                None => behind(index),
                Some(Err(())) => {
                    lost += u64::from(seen.status[index].is_complete());
                    BROKEN
                }
                Some(Ok(place)) => match settings.view {
                    View::Normals => view::normal_color(place.point.normal),
                    View::Ids => view::id_color(&seen.hits[index]),
                    View::Depth | View::Visits => Vec3::ZERO,
                    View::Shaded => {
                        places.push(place);
                        place_of.push(index);
                        Vec3::ZERO
                    }
                },
            });
        }
        statistics.incomplete.count_lost(lost);
        statistics.shading_time += clock.elapsed();
        if !places.is_empty() {
            for (index, color) in place_of.into_iter().zip(shader.shade(&places, statistics)?) {
                colors[index] = color;
            }
        }
        Ok(colors)
    }
}

/// Writes the means of a run's samples onto the film.
fn expose(
    film: &mut Film,
    range: Range<usize>,
    samples: usize,
    ground_instance: Option<u32>,
    seen: &Seen,
    colors: &[Vec3],
    statistics: &mut Statistics,
) {
    let share = 1.0 / samples as f32;
    for (pixel, first) in range.zip((0..).step_by(samples)) {
        let of_pixel = first..first + samples;
        let mut sum = Vec3::ZERO;
        for &color in &colors[of_pixel.clone()] {
            if color.is_finite() {
                sum += color;
            } else {
                statistics.not_finite += 1;
            }
        }
        film.color[pixel] = (sum * share).to_array();
        // The ground that only catches shadows counts as background.
        let model = seen.hits[of_pixel.clone()]
            .iter()
            .filter(|hit| hit.is_hit() && Some(hit.instance_index) != ground_instance);
        film.coverage[pixel] = model.clone().count() as f32 * share;
        film.depth[pixel] = model.map(|hit| hit.t).fold(f32::INFINITY, f32::min);
        if let (Some(counters), Some(visits)) = (&seen.counters, film.visits.get_mut(pixel)) {
            let work: u64 = counters[of_pixel]
                .iter()
                .map(|counters| u64::from(counters.inner_visits) + u64::from(counters.primitive_tests))
                .sum();
            *visits = work as f32 * share;
        }
    }
    if let Some(counters) = &seen.counters {
        let totals: CounterTotals = counters.iter().collect();
        let sum = statistics.counters.get_or_insert_default();
        sum.rays += totals.rays;
        sum.inner_visits += totals.inner_visits;
        sum.leaf_visits += totals.leaf_visits;
        sum.primitive_tests += totals.primitive_tests;
        sum.restarts += totals.restarts;
        sum.stack_depth = sum.stack_depth.max(totals.stack_depth);
        sum.objects_entered += totals.objects_entered;
    }
}

/// The column and the row of a pixel.
fn column_and_row(pixel: usize, width: usize) -> (u32, u32) {
    ((pixel % width) as u32, (pixel / width) as u32)
}
