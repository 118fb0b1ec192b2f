//! Drawn against traced: how many hits differ, how many rays were traced after all, how long each way takes.

use super::{Drawing, Holes, Rasterised, Request};
use crate::begin::Begin;
use crate::camera::{self, Pinhole};
use crate::error::RenderError;
use crate::sampling;
use crate::settings::RenderSettings;
use crate::stage::Stage;
use crate::trace::Trace;
use glam::Vec2;
use ropewalk::{Answer, Hit, Query, Ray, Status, TraceOptions, Traced};
use std::fmt;
use std::time::{Duration, Instant};

/// Pixels that are looked at together: a picture of the paper's size at once.
const PIXELS: usize = 512 * 512;

/// How drawn primary hits compare with traced ones, and what each way takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PrimaryComparison {
    /// Rays from the eye.
    pub rays: u64,
    /// Those that hit something when they are traced.
    pub hits: u64,
    /// Rays whose hit is another: another triangle, or none in place of one.
    pub different: u64,
    /// Rays that hit the same triangle with other bits. There are none where a device rounds as the processor does.
    pub rounded: u64,
    /// Rays that drawing left undecided, so that they were traced.
    pub traced_instead: u64,
    /// What tracing takes.
    pub traced: PrimaryTime,
    /// What drawing takes.
    pub rasterised: PrimaryTime,
}

/// What one way of finding a picture's primary hits takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PrimaryTime {
    /// What is done once for a structure.
    pub preparation: Duration,
    /// What is done for a picture.
    pub picture: Duration,
}

impl PrimaryComparison {
    /// Finds the primary hits of a picture in both ways, after a round of each that is not timed.
    ///
    /// # Errors
    /// When a setting is out of range, the camera is not there, or the device fails.
    pub fn new(stage: &Stage, tracer: &dyn Trace, settings: &RenderSettings) -> Result<Self, RenderError> {
        settings.check()?;
        let aspect = (f64::from(settings.width) / f64::from(settings.height)) as f32;
        let camera = camera::resolve(&settings.camera, stage, tracer, settings.walk, aspect)?;
        let pinhole = Pinhole::new(&camera, settings.width, settings.height)?;
        let clock = Instant::now();
        let drawing = Drawing::new(tracer)?;
        let preparation = clock.elapsed();
        let mut both = Ways { tracer, settings, pinhole, drawing, holes: None }.compare()?;
        both.rasterised.preparation = preparation;
        Ok(both)
    }

    /// Adds what comes of comparing some rays' hits.
    fn add(&mut self, traced: &[Hit], drawn: &Rasterised) -> Result<(), RenderError> {
        if traced.len() != drawn.hits.len() {
            return Err(RenderError::Raster(format!(
                "{} hits were drawn where {} were traced",
                drawn.hits.len(),
                traced.len()
            )));
        }
        for (a, b) in traced.iter().zip(&drawn.hits) {
            self.rays += 1;
            self.hits += u64::from(a.is_hit());
            if a.id() != b.id() {
                self.different += 1;
            } else if a.to_words() != b.to_words() {
                self.rounded += 1;
            }
        }
        self.traced_instead += drawn.traced_instead;
        Ok(())
    }
}

impl fmt::Display for PrimaryComparison {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rays, hits, different, rounded, traced_instead, .. } = self;
        write!(
            formatter,
            "{rays} rays, {hits} of which hit: {different} hits differ, {rounded} in their last bits, {traced_instead} rays traced instead"
        )
    }
}

/// Both ways, ready.
struct Ways<'a> {
    tracer: &'a dyn Trace,
    settings: &'a RenderSettings,
    pinhole: Pinhole,
    drawing: Drawing<'a>,
    holes: Option<&'a Holes<'a>>,
}

impl Ways<'_> {
    fn compare(&self) -> Result<PrimaryComparison, RenderError> {
        let mut sum = PrimaryComparison::default();
        let side = self.settings.samples_per_side();
        let subpixels: Vec<Vec2> =
            (0..self.settings.samples).map(|index| sampling::subpixel(index, side)).collect();
        let pixels = self.settings.width as usize * self.settings.height as usize;
        let run = (PIXELS / subpixels.len()).max(1);
        for start in (0..pixels).step_by(run) {
            let range = start..(start + run).min(pixels);
            let width = self.settings.width;
            let places: Vec<Vec2> = range
                .clone()
                .flat_map(|pixel| {
                    let corner = Vec2::new((pixel % width as usize) as f32, (pixel / width as usize) as f32);
                    subpixels.iter().map(move |&step| corner + step)
                })
                .collect();
            let rays: Vec<Ray> = places.iter().map(|&place| self.pinhole.ray(place)).collect();
            let parts: Vec<Vec2> = places.iter().map(|&place| self.pinhole.part(place)).collect();
            let request = Request {
                pinhole: &self.pinhole,
                width,
                pixels: range,
                subpixels: &subpixels,
                rays: &rays,
                is_hole: self.holes,
            };
            for is_timed in [false, true] {
                let clock = Instant::now();
                let traced = self.traced(&rays, &parts)?;
                let traced_time = clock.elapsed();
                let clock = Instant::now();
                let drawn = self.drawing.hits(&request, &|rays| self.closest(rays))?;
                let drawn_time = clock.elapsed();
                if is_timed {
                    sum.add(&traced, &drawn)?;
                    sum.traced.picture += traced_time;
                    sum.rasterised.picture += drawn_time;
                }
            }
        }
        Ok(sum)
    }

    fn closest(&self, rays: &[Ray]) -> Result<Traced, RenderError> {
        self.tracer
            .trace_batch(self.settings.walk, Query::Closest, rays, TraceOptions::default())
            .map_err(RenderError::Trace)
    }

    /// The hits of rays that are known to begin at the eye.
    fn traced(&self, rays: &[Ray], places: &[Vec2]) -> Result<Vec<Hit>, RenderError> {
        let begin = Begin::AtEye { screen: &self.pinhole.screen(), places };
        let traced = self
            .tracer
            .trace_begun(self.settings.walk, Query::Closest, rays, &begin, TraceOptions::default())
            .map_err(RenderError::Trace)?;
        match traced.answer {
            Answer::Closest(hits) if traced.status.iter().all(|status| *status == Status::COMPLETE) => {
                Ok(hits)
            }
            _ => Err(RenderError::Raster("the device did not answer every ray".into())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wrong triangle, a wrong bit and a missing hit are noticed.
    #[test]
    fn wrong_hits_are_noticed() {
        let hit = Hit { t: 2.0, primitive_index: 1, geometry_index: 0, instance_index: 4, ..Hit::MISS };
        let traced = [hit, hit, hit, Hit::MISS];
        let compare = |hits: [Hit; 4]| {
            let mut sum = PrimaryComparison::default();
            let status = vec![Status::COMPLETE; 4];
            sum.add(&traced, &Rasterised { hits: hits.to_vec(), status, traced_instead: 0 }).unwrap();
            (sum.rays, sum.hits, sum.different, sum.rounded)
        };
        assert_eq!(compare(traced), (4, 3, 0, 0));
        assert_eq!(compare([Hit { primitive_index: 2, ..hit }, hit, hit, Hit::MISS]), (4, 3, 1, 0));
        assert_eq!(compare([hit, Hit::MISS, hit, hit]), (4, 3, 2, 0));
        assert_eq!(compare([hit, hit, Hit { t: 2.0_f32.next_up(), ..hit }, Hit::MISS]), (4, 3, 0, 1));
        let few = Rasterised { hits: vec![hit], status: vec![Status::COMPLETE], traced_instead: 0 };
        assert!(PrimaryComparison::default().add(&traced, &few).is_err());
    }
}
