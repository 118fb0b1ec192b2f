//! What the eye's rays find, for a run of pixels at a time: by tracing them, or by drawing the scene.

use crate::begin::Begin;
use crate::camera::Pinhole;
use crate::error::RenderError;
use crate::integrator::Primary;
use crate::raster::{self, Drawing};
use crate::sampling;
use crate::settings::RenderSettings;
use crate::statistics::Statistics;
use crate::tracing::Tracing;
use crate::view::View;
use glam::Vec2;
use rayon::prelude::*;
use ropewalk::{Answer, Counters, Hit, Query, Ray, Status, TraceOptions};
use std::ops::Range;
use std::time::Instant;

/// What primary rays found, the samples of a pixel beside each other.
pub(crate) struct Seen {
    pub(crate) rays: Vec<Ray>,
    pub(crate) hits: Vec<Hit>,
    pub(crate) status: Vec<Status>,
    pub(crate) counters: Option<Vec<Counters>>,
}

/// The eye, and how it looks.
pub(crate) struct Eye<'a> {
    pub(crate) pinhole: Pinhole,
    pub(crate) tracing: Tracing<'a>,
    /// The triangles, ready to be drawn, where that is asked for.
    pub(crate) drawing: Option<&'a Drawing<'a>>,
}

impl Eye<'_> {
    /// Looks through a run of pixels.
    pub(crate) fn look(
        &self,
        settings: &RenderSettings,
        range: Range<usize>,
        statistics: &mut Statistics,
    ) -> Result<Seen, RenderError> {
        let clock = Instant::now();
        let (width, samples, side) =
            (settings.width as usize, settings.samples as usize, settings.samples_per_side());
        let subpixels: Vec<Vec2> =
            (0..settings.samples).map(|index| sampling::subpixel(index, side)).collect();
        let (rays, places): (Vec<Ray>, Vec<Vec2>) = (range.start * samples..range.end * samples)
            .into_par_iter()
            .with_min_len(1024)
            .map(|index| {
                let (x, y) = column_and_row(index / samples, width);
                let place = Vec2::new(x as f32, y as f32) + subpixels[index % samples];
                (self.pinhole.ray(place), self.pinhole.part(place))
            })
            .unzip();
        statistics.primary_rays += rays.len() as u64;
        statistics.shading_time += clock.elapsed();
        let clock = Instant::now();
        let seen = match self.drawing {
            // What a walk did can only be told of a walk.
            Some(drawing) if settings.primary == Primary::Rasterised && settings.view != View::Visits => {
                self.draw(drawing, settings, range, &subpixels, rays, statistics)
            }
            _ => self.trace(settings, rays, &places),
        };
        statistics.primary_time += clock.elapsed();
        seen
    }

    fn trace(&self, settings: &RenderSettings, rays: Vec<Ray>, places: &[Vec2]) -> Result<Seen, RenderError> {
        let options = TraceOptions { counters: settings.view == View::Visits };
        let begin = Begin::AtEye { screen: &self.pinhole.screen(), places };
        let traced = self.tracing.trace(Query::Closest, &rays, &begin, options)?;
        let Answer::Closest(hits) = traced.answer else { return Ok(Seen::nothing(rays)) };
        Ok(Seen { rays, hits, status: traced.status, counters: traced.counters })
    }

    fn draw(
        &self,
        drawing: &Drawing<'_>,
        settings: &RenderSettings,
        pixels: Range<usize>,
        subpixels: &[Vec2],
        rays: Vec<Ray>,
        statistics: &mut Statistics,
    ) -> Result<Seen, RenderError> {
        let holes = self.tracing.looks.filter(|looks| looks.has_cut_outs());
        let is_hole = holes.map(|looks| move |_: &Ray, hit: &Hit| looks.is_cut_out(hit));
        let request = raster::Request {
            pinhole: &self.pinhole,
            width: settings.width,
            pixels,
            subpixels,
            rays: &rays,
            is_hole: is_hole.as_ref().map(|is_hole| is_hole as &raster::Holes<'_>),
        };
        let trace = |rays: &[Ray]| {
            let nowhere = vec![None; rays.len()];
            self.tracing.trace(Query::Closest, rays, &Begin::OnTriangles(&nowhere), TraceOptions::default())
        };
        let drawn = drawing.hits(&request, &trace)?;
        statistics.primary_traced_instead += drawn.traced_instead;
        if drawn.hits.len() != rays.len() || drawn.status.len() != rays.len() {
            return Ok(Seen::nothing(rays));
        }
        Ok(Seen { rays, hits: drawn.hits, status: drawn.status, counters: None })
    }
}

impl Seen {
    /// Rays without an answer: what they were to show is magenta.
    fn nothing(rays: Vec<Ray>) -> Self {
        let count = rays.len();
        Self { rays, hits: vec![Hit::MISS; count], status: vec![Status::INVALID_RAY; count], counters: None }
    }
}

/// The column and the row of a pixel.
pub(crate) fn column_and_row(pixel: usize, width: usize) -> (u32, u32) {
    ((pixel % width) as u32, (pixel / width) as u32)
}
