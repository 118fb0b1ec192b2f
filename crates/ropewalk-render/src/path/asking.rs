//! Rays from a place of a path to what shines.
//!
//! Of a file's lights one is asked, picked by what it would bring if nothing were in its way. Of surfaces that shine one
//! point is asked, and of the lamp of the surroundings one direction. Paths find those two by themselves too, so both ways
//! count by their chances.

use super::PathTracer;
use super::sequence::circle;
use super::vertex::{Asked, Decision, Path, Site};
use crate::bsdf::arithmetic::unit;
use crate::light::Lights;
use crate::looks::Looks;
use crate::sampling::frame;
use glam::{Vec2, Vec3};
use ropewalk::Ray;
use std::f32::consts::TAU;

/// Highlights of the file's lights are at least as wide as this roughness makes them where a surface is seen by way of
/// another: metal seen in metal would sparkle. No light is lost by that.
const LEAST_ROUGHNESS_BEHIND: f32 = 0.35;

/// The share that one of two ways to find a light counts, by their chances (Veach 1997, the power of two).
pub(super) fn balance(chance: f32, other: f32) -> f32 {
    let ratio = other / chance;
    1.0 / (1.0 + ratio * ratio)
}

/// How likely a direction to the lamp of the surroundings is asked for, whose rim has this cosine.
fn lamp_chance(rim: f32) -> f32 {
    1.0 / (TAU * (1.0 - rim))
}

/// The share that the surroundings count where a path has found them by itself: the rest was asked for.
pub(super) fn share_of_miss(lights: &Lights, path: &Path) -> f32 {
    match (path.chance, lights.environment.lamp()) {
        (Some(chance), Some((middle, rim))) if path.ray.dir.dot(middle) > rim => {
            balance(chance, lamp_chance(rim))
        }
        _ => 1.0,
    }
}

impl PathTracer {
    /// Asks one of the lights for its light: one picked by what it would bring.
    pub(super) fn ask_source(&self, lights: &Lights, site: &Site<'_>, clipped: &mut u32) -> Option<Asked> {
        let place = &site.place;
        let square = site.square(Decision::SourcePoint);
        let brought = |number: usize| {
            let incoming = lights.sources.get(number)?.towards(place.origin_outside, square)?;
            let direct = match site.path.depth {
                0 => site.bsdf.direct(site.normal, place.to_eye, incoming.to_light),
                _ => {
                    let roughness = site.bsdf.roughness.max(LEAST_ROUGHNESS_BEHIND);
                    site.bsdf.direct_with(roughness, site.normal, place.to_eye, incoming.to_light)
                }
            };
            let white =
                direct + site.bsdf.between_facets(&self.energy, site.normal, place.to_eye, incoming.to_light);
            let light = white * incoming.light;
            let brightness = light.x + light.y + light.z;
            (brightness > 0.0 && brightness.is_finite()).then_some((incoming, light, brightness))
        };
        let all = || (0..lights.sources.len()).filter_map(brought);
        let sum: f32 = all().map(|(_, _, brightness)| brightness).sum();
        let mut rest = site.number(Decision::Source) * sum;
        let mut picked = None;
        for one in all() {
            picked = Some(one);
            rest -= one.2;
            if rest < 0.0 {
                break;
            }
        }
        let (incoming, light, brightness) = picked?;
        // Just short of the light, which may stand on a lamp's own surface.
        let ray = Ray::new(place.origin_outside, incoming.to_light).window(0.0, incoming.distance * 0.999);
        let light = site.weight * light * (sum / brightness);
        Some(Asked { ray, light: self.limited(light, site.path.depth, clipped) })
    }

    /// Asks a point of a surface that shines for its light.
    pub(super) fn ask_emitter(&self, looks: &Looks, site: &Site<'_>, clipped: &mut u32) -> Option<Asked> {
        let place = &site.place;
        let picked =
            self.emitters.pick(site.number(Decision::Emitter), site.square(Decision::EmitterPoint))?;
        let to_point = picked.position - place.origin_outside;
        if to_point.is_nan() || to_point.dot(to_point) <= 1e-30 {
            return None;
        }
        let there = looks.place(&Ray::new(place.origin_outside, to_point), &picked.hit)?;
        // To the side of it that is seen from here, so that it does not stand in its own way.
        let way = there.origin_outside - place.origin_outside;
        let square = way.dot(way);
        let to_light = unit(way);
        let cos_there = -there.geometric_normal.dot(to_light);
        if !(square > 1e-30 && cos_there > 0.0) || looks.is_cut_out(&picked.hit) {
            return None;
        }
        let chance = picked.density * square / cos_there;
        let shown = site.bsdf.evaluate(&self.energy, site.normal, place.to_eye, to_light);
        let light = site.weight * shown * there.material.emissive / chance;
        if light == Vec3::ZERO || !light.is_finite() {
            return None;
        }
        let other = site.bsdf.chance(&self.energy, site.normal, place.to_eye, to_light);
        let ray = Ray::new(place.origin_outside, to_light).window(0.0, square.sqrt());
        // The last place of a path has only this way to it.
        let share = if site.path.depth < self.bounces { balance(chance, other) } else { 1.0 };
        Some(Asked { ray, light: self.limited(light * share, site.path.depth, clipped) })
    }

    /// All light that would arrive on the ground that catches shadows if nothing were in the way; never zero.
    pub(super) fn open_light(&self, lights: &Lights, site: &Site<'_>) -> Vec3 {
        let mut open = self.open_sky;
        for source in &lights.sources {
            if let Some(incoming) = source.towards(site.place.origin_outside, Vec2::splat(0.5)) {
                open += incoming.light * site.normal.dot(incoming.to_light).max(0.0);
            }
        }
        open.max(Vec3::splat(1e-30))
    }

    /// Asks for the light of the lamp of the surroundings.
    pub(super) fn ask_lamp(&self, lights: &Lights, site: &Site<'_>, clipped: &mut u32) -> Option<Asked> {
        let (middle, rim) = lights.environment.lamp()?;
        let square = site.square(Decision::LampPoint);
        let cos = 1.0 - square.x * (1.0 - rim);
        let around = circle(square.y) * (1.0 - cos * cos).max(0.0).sqrt();
        let (tangent, bitangent) = frame(middle);
        let to_lamp = unit(tangent * around.x + bitangent * around.y + middle * cos);
        let shown = site.bsdf.evaluate(&self.energy, site.normal, site.place.to_eye, to_lamp);
        let chance = lamp_chance(rim);
        let light = site.weight * shown * lights.environment.radiance(to_lamp) / chance;
        if light == Vec3::ZERO || !light.is_finite() {
            return None;
        }
        let other = site.bsdf.chance(&self.energy, site.normal, site.place.to_eye, to_lamp);
        let share = if site.path.depth < self.bounces { balance(chance, other) } else { 1.0 };
        let ray = Ray::new(site.place.origin_outside, to_lamp);
        Some(Asked { ray, light: self.limited(light * share, site.path.depth, clipped) })
    }
}
