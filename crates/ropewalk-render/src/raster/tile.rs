//! A square of the picture while it is drawn: its rays, what each has met so far, and how far that is.

use super::drawing::{Drawing, Part};
use super::footprint::{Footprint, Window};
use super::{Holes, Request};
use ropewalk::two_level::EnteredInstance;
use ropewalk::{FlatTriangle, Hit, PreparedRay, Ray};

/// A square of the picture.
pub(super) struct Tile {
    pub(super) window: Window,
    samples: usize,
    /// The place among all rays of each of the tile's, or [`Tile::NOWHERE`] where a pixel is not in the run.
    places: Vec<usize>,
    rays: Vec<Option<PreparedRay>>,
    hits: Vec<Hit>,
    /// No ray of the tile can meet anything of interest behind this.
    far: f32,
    /// Hits that came since `far` was found.
    news: usize,
    frames: Frames,
}

/// The rays in the frame of the instance that is being drawn, taken there when they are wanted first.
#[derive(Default)]
struct Frames {
    rays: Vec<Option<EnteredInstance>>,
    /// For which instance each was taken there.
    stamps: Vec<u32>,
    stamp: u32,
}

impl Tile {
    const NOWHERE: usize = usize::MAX;

    /// The rays of a window of the picture.
    pub(super) fn new(window: Window, request: &Request<'_>) -> Self {
        let [left, top, right, bottom] = window.pixels;
        let samples = request.subpixels.len();
        let columns_and_rows = (top..=bottom).flat_map(|row| (left..=right).map(move |column| (column, row)));
        let places: Vec<usize> = columns_and_rows
            .flat_map(|(column, row)| {
                let first = request.first_sample(column, row);
                (0..samples).map(move |sample| first.map_or(Self::NOWHERE, |first| first + sample))
            })
            .collect();
        let rays: Vec<_> = places.iter().map(|&it| request.rays.get(it).and_then(PreparedRay::new)).collect();
        let hits = vec![Hit::MISS; places.len()];
        Self { window, samples, places, rays, hits, far: f32::INFINITY, news: 0, frames: Frames::default() }
    }

    /// No ray of the tile can meet anything of interest behind this.
    pub(super) const fn far(&self) -> f32 {
        self.far
    }

    /// What each ray met, with the ray's place among all. Rays that are not valid are left out.
    pub(super) fn answers(&self) -> impl Iterator<Item = (usize, Hit)> {
        let answered = |((&place, ray), &hit): ((&usize, &Option<PreparedRay>), &Hit)| {
            (place != Self::NOWHERE && ray.is_some()).then_some((place, hit))
        };
        self.places.iter().zip(&self.rays).zip(&self.hits).filter_map(answered)
    }

    /// Draws triangles, some of one part after some of another, from front to back.
    pub(super) fn draw(
        &mut self,
        drawing: &Drawing<'_>,
        order: &[u32],
        footprints: &mut [&Footprint],
        request: &Request<'_>,
    ) {
        footprints.sort_unstable_by(|a, b| a.rank.cmp(&b.rank).then(a.nearest.total_cmp(&b.nearest)));
        for of_part in footprints.chunk_by(|a, b| a.rank == b.rank) {
            let Some(part) =
                order.get(of_part[0].rank as usize).and_then(|&part| drawing.parts.get(part as usize))
            else {
                continue;
            };
            self.frames.next(self.rays.len(), part.place.is_some());
            for footprint in of_part {
                // Those that follow are no nearer.
                if footprint.nearest > self.far {
                    break;
                }
                let Some(triangle) = drawing.triangles.get(footprint.triangle as usize) else { continue };
                self.draw_triangle(drawing, part, triangle, footprint, request);
                if self.news >= self.hits.len() {
                    self.measure();
                }
            }
            self.measure();
        }
    }

    fn draw_triangle(
        &mut self,
        drawing: &Drawing<'_>,
        part: &Part,
        triangle: &FlatTriangle,
        footprint: &Footprint,
        request: &Request<'_>,
    ) {
        let [left, top, right, _] = self.window.pixels;
        let (in_row, samples) = ((right - left + 1) as usize, self.samples);
        let window = self.window;
        footprint.for_each_pixel(&window, |column, row| {
            let first = ((row - top) as usize * in_row + (column - left) as usize) * samples;
            for index in first..first + samples {
                let best = self.hits[index];
                let Some(ray) = &self.rays[index] else { continue };
                if footprint.nearest > best.t {
                    continue;
                }
                let question = &request.rays[self.places[index]];
                let limit = best.t.min(ray.t_max);
                let hit = match part.place {
                    None => drawing.intersect(triangle, ray, limit),
                    Some(_) => self
                        .frames
                        .ray(index, || drawing.enter(part, question, ray))
                        .and_then(|entered| entered.intersect(triangle, limit)),
                };
                if let Some(hit) = hit
                    && hit.precedes(&best)
                    && !is_hole(request.is_hole, question, &hit)
                {
                    self.hits[index] = hit;
                    self.news += 1;
                }
            }
        });
    }

    /// Finds how far the farthest ray reaches, where hits came.
    fn measure(&mut self) {
        if self.news > 0 {
            let rays = self.rays.iter().zip(&self.hits).filter(|(ray, _)| ray.is_some());
            self.far = rays.map(|(_, hit)| hit.t).fold(0.0, f32::max);
            self.news = 0;
        }
    }
}

/// Whether a hit is none.
#[inline(always)]
pub(super) fn is_hole(holes: Option<&Holes<'_>>, ray: &Ray, hit: &Hit) -> bool {
    holes.is_some_and(|is_hole| is_hole(ray, hit))
}

impl Frames {
    /// Forgets the rays of one instance; makes room for those of another where it has a frame of its own.
    fn next(&mut self, rays: usize, has_frame: bool) {
        if has_frame && self.rays.len() < rays {
            self.rays.resize(rays, None);
            self.stamps.resize(rays, 0);
        }
        self.stamp = match self.stamp.checked_add(1) {
            Some(next) => next,
            None => {
                self.stamps.fill(0);
                1
            }
        };
    }

    #[inline]
    fn ray(
        &mut self,
        index: usize,
        enter: impl FnOnce() -> Option<EnteredInstance>,
    ) -> Option<&EnteredInstance> {
        if self.stamps[index] != self.stamp {
            self.stamps[index] = self.stamp;
            self.rays[index] = enter();
        }
        self.rays[index].as_ref()
    }
}
