//! Light at the places that a batch of primary rays has found: shadow rays to every light, short rays into the
//! sky, and what the materials send on to the eye.
//!
//! Everything is done for a whole batch at a time, since a device answers batches: one batch of shadow rays a
//! light, one of ambient rays a round. The order of the sums is fixed, so the result is too.

use crate::begin::Begin;
use crate::brdf::Finish;
use crate::error::RenderError;
use crate::lights::Lighting;
use crate::sampling::{self, Purpose};
use crate::sky::Sky;
use crate::stage::Stage;
use crate::statistics::Statistics;
use crate::surface::SurfacePoint;
use crate::tracing::Tracing;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use ropewalk::{Ray, Status};
use std::time::Instant;

/// How far the sky's light can be blocked, as a share of the scene's size. Rays have lengths up to this, most of
/// them much shorter, so that what is near blocks more than what is far: corners are dark, rooms stay light.
pub(crate) const AMBIENT_REACH: f32 = 0.3;
/// The share of the sky's light that reaches a place none of it reaches straight: what walls throw on.
pub(crate) const BOUNCED: f32 = 0.25;
/// The most radiance of a sample: a highlight may not outweigh all other samples of its pixel.
pub(crate) const BRIGHTEST: f32 = 6.0;
/// The colour of what could not be computed. Nobody takes it for a part of the picture.
pub(crate) const BROKEN: Vec3 = Vec3::new(1.0, 0.0, 1.0);

/// What is shaded with.
pub(crate) struct Shader<'a> {
    pub(crate) stage: &'a Stage,
    pub(crate) tracing: Tracing<'a>,
    pub(crate) lighting: Lighting,
    pub(crate) finishes: Vec<Finish>,
    pub(crate) samples: u32,
    pub(crate) ambient_rays_per_sample: u32,
}

/// A place to shade, and the sample that sees it.
pub(crate) struct Place {
    pub(crate) point: SurfacePoint,
    /// The pixel's column and row.
    pub(crate) pixel: (u32, u32),
    /// The number of the sample in its pixel.
    pub(crate) sample: u32,
    /// What would be seen without the place.
    pub(crate) background: Vec3,
}

/// A ray that asks whether light arrives, and the light.
struct ShadowRay {
    place: u32,
    ray: Ray,
    light: Vec3,
}

/// What has arrived at a place.
#[derive(Clone, Copy, Default)]
struct Gathered {
    /// With everything in the way that is.
    lit: Vec3,
    /// As if nothing were.
    open: Vec3,
    /// Whether an answer was missing.
    broken: bool,
}

impl Shader<'_> {
    /// The radiance at each place.
    pub(crate) fn shade(
        &self,
        places: &[Place],
        statistics: &mut Statistics,
    ) -> Result<Vec<Vec3>, RenderError> {
        let mut gathered = vec![Gathered::default(); places.len()];
        for (number, _) in self.lighting.sources.iter().enumerate() {
            self.gather_light(number, places, &mut gathered, statistics)?;
        }
        self.gather_sky(places, &mut gathered, statistics)?;
        let clock = Instant::now();
        let colors = places
            .par_iter()
            .zip(&gathered)
            .with_min_len(1024)
            .map(|(place, gathered)| self.color(place, gathered));
        let colors = colors.collect();
        statistics.shading_time += clock.elapsed();
        Ok(colors)
    }

    fn finish(&self, point: &SurfacePoint) -> &Finish {
        const PLAIN: Finish = Finish::MATT;
        self.finishes.get(point.material as usize).unwrap_or(&PLAIN)
    }

    fn gather_light(
        &self,
        number: usize,
        places: &[Place],
        gathered: &mut [Gathered],
        statistics: &mut Statistics,
    ) -> Result<(), RenderError> {
        let clock = Instant::now();
        let source = &self.lighting.sources[number];
        let shadow_rays: Vec<ShadowRay> = places
            .par_iter()
            .enumerate()
            .with_min_len(1024)
            .filter_map(|(index, place)| {
                // Each light starts elsewhere in the pattern, or all penumbras would have the same grain.
                let sample = (place.sample + 7 * number as u32) % self.samples;
                let square = sampling::point(Purpose::Light, place.pixel, sample, self.samples);
                let incoming = source.towards(place.point.origin, square)?;
                let light =
                    self.finish(&place.point).direct(&place.point, incoming.to_light) * incoming.irradiance;
                if light == Vec3::ZERO {
                    return None;
                }
                // Just short of the light, which may stand on a lamp's own surface.
                let ray =
                    Ray::new(place.point.origin, incoming.to_light).window(0.0, incoming.distance * 0.999);
                Some(ShadowRay { place: index as u32, ray, light })
            })
            .collect();
        let rays: Vec<Ray> = shadow_rays.iter().map(|shadow| shadow.ray).collect();
        let left = |shadow: &ShadowRay| places[shadow.place as usize].point.triangle;
        let left: Vec<_> = shadow_rays.iter().map(left).collect();
        statistics.shadow_rays += rays.len() as u64;
        statistics.shading_time += clock.elapsed();
        let (blocked, status) = self.trace(&rays, &left, statistics)?;
        for ((shadow, blocked), status) in shadow_rays.iter().zip(blocked).zip(status) {
            if let Some(gathered) = gathered.get_mut(shadow.place as usize) {
                gathered.open += shadow.light;
                if !blocked {
                    gathered.lit += shadow.light;
                }
                gathered.broken |= !status.is_complete();
            }
        }
        Ok(())
    }

    fn gather_sky(
        &self,
        places: &[Place],
        gathered: &mut [Gathered],
        statistics: &mut Statistics,
    ) -> Result<(), RenderError> {
        let rounds = self.ambient_rays_per_sample;
        let count = rounds * self.samples;
        let reach = AMBIENT_REACH * self.stage.bounds().size().length();
        let mut blocked_rounds = vec![0_u32; places.len()];
        let left: Vec<_> = places.iter().map(|place| place.point.triangle).collect();
        for round in 0..rounds {
            let clock = Instant::now();
            let rays: Vec<Ray> = places
                .par_iter()
                .with_min_len(1024)
                .map(|place| {
                    let index = place.sample * rounds + round;
                    let square = sampling::point(Purpose::Sky, place.pixel, index, count);
                    let direction = sampling::cosine_direction(place.point.normal, square);
                    // What would go below the triangle is mirrored up again.
                    let below = direction.dot(place.point.geometric_normal).min(0.0);
                    let direction = direction - place.point.geometric_normal * (2.0 * below);
                    let length = sampling::fraction(place.pixel, index);
                    Ray::new(place.point.origin, direction).window(0.0, reach * length * length)
                })
                .collect();
            statistics.ambient_rays += rays.len() as u64;
            statistics.shading_time += clock.elapsed();
            let (blocked, status) = self.trace(&rays, &left, statistics)?;
            for (((sum, gathered), blocked), status) in
                blocked_rounds.iter_mut().zip(&mut *gathered).zip(blocked).zip(status)
            {
                *sum += u32::from(blocked);
                gathered.broken |= !status.is_complete();
            }
        }
        let clock = Instant::now();
        gathered.par_iter_mut().zip(places).zip(blocked_rounds).with_min_len(1024).for_each(
            |((gathered, place), blocked)| {
                let sky = self.finish(&place.point).ambient(&place.point, &self.lighting.sky);
                let seen = if rounds == 0 { 1.0 } else { 1.0 - blocked as f32 / rounds as f32 };
                gathered.open += sky;
                gathered.lit += sky * (BOUNCED + (1.0 - BOUNCED) * seen);
            },
        );
        statistics.shading_time += clock.elapsed();
        Ok(())
    }

    fn color(&self, place: &Place, gathered: &Gathered) -> Vec3 {
        if gathered.broken {
            return BROKEN;
        }
        match self.stage.catcher() {
            Some(catcher) if place.point.is_ground => {
                let strength = catcher.strength(place.point.position);
                let share = gathered.lit / gathered.open.max(Vec3::splat(f32::MIN_POSITIVE));
                place.background * Vec3::ONE.lerp(share, strength)
            }
            _ => (gathered.lit + self.finish(&place.point).emissive).min(Vec3::splat(BRIGHTEST)),
        }
    }

    /// Asks whether anything is in the way of each ray, of which each has left a triangle.
    fn trace(
        &self,
        rays: &[Ray],
        left: &[Option<(u32, u32, u32)>],
        statistics: &mut Statistics,
    ) -> Result<(Vec<bool>, Vec<Status>), RenderError> {
        if rays.is_empty() {
            return Ok((Vec::new(), Vec::new()));
        }
        let clock = Instant::now();
        let (blocked, status) = self.tracing.blocked_of(rays, &Begin::OnTriangles(left))?;
        statistics.occlusion_time += clock.elapsed();
        status.iter().for_each(|&status| statistics.incomplete.count(status));
        Ok((blocked, status))
    }
}

/// What is seen behind everything at a pixel.
pub(crate) fn background(pixel: (u32, u32), width: u32, height: u32) -> Vec3 {
    Sky::background(Vec2::new((pixel.0 as f32 + 0.5) / width as f32, (pixel.1 as f32 + 0.5) / height as f32))
}
