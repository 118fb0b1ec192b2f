//! What paths ask of a surface: where to go on, how likely that was, and how much light goes between two directions.
//!
//! Four ways lead on: scattered (by the cosine; what bounces between facets goes with it), mirrored by a rough surface
//! (by the facets that the eye sees: Heitz 2018, in the form of Dupuy and Benyoub 2023), mirrored sharply, and
//! through. Which one is taken is chosen by how much light each is expected to bring. The last two have one direction
//! and no chance that could be compared with others.
//!
//! Directions are unit vectors; chances are by solid angle.

use super::arithmetic::{mirrored, unit};
use super::fresnel::{refract, schlick_mean};
use super::shading::highlight;
use super::{Bsdf, Energy};
use crate::path::sequence::{circle, cosine_direction};
use crate::sampling::frame;
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Surfaces smoother than this are mirrors for paths: at 0.06 the highlight is a quarter of a degree wide, and f32
/// still tells its middle from its rim.
pub(crate) const SMOOTHEST: f32 = 0.06;

/// The least chance of the facets of a rough surface, as a share of that of scattering.
const LEAST_FACETS: f32 = 0.25;

/// Where a path goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    pub(crate) direction: Vec3,
    /// By what the light from there is multiplied.
    pub(crate) weight: Vec3,
    /// How likely this direction was; `None` where there is only one.
    pub(crate) chance: Option<f32>,
    /// Whether it leads to the other side of the surface.
    pub(crate) is_through: bool,
}

/// How likely each way is. They add up to one.
#[derive(Clone, Copy, Debug)]
struct Ways {
    scattered: f32,
    rough: f32,
    mirrored: f32,
}

fn mean(color: Vec3) -> f32 {
    (color.x + color.y + color.z) * (1.0 / 3.0)
}

impl Bsdf {
    pub(super) fn is_rough(&self) -> bool {
        !self.is_sharp && self.roughness >= SMOOTHEST
    }

    fn ways(&self, energy: &Energy, cos_eye: f32) -> Option<Ways> {
        let fresnel = self.fresnel(cos_eye);
        let mut scattered = mean(self.diffuse * (Vec3::ONE - fresnel));
        let mut sharp = mean(fresnel);
        let through = mean(self.through * (Vec3::ONE - fresnel));
        let mut rough = 0.0;
        if self.is_rough() {
            let share = energy.share(self.roughness, cos_eye);
            scattered += sharp * (1.0 - share);
            rough = sharp * share;
            sharp = 0.0;
            // Facets that are seen at grazing angles mirror far more than the surface does on the whole: where they were
            // chosen seldom, each would count for too much.
            if self.grazing > 0.0 {
                rough = rough.max(scattered * LEAST_FACETS);
            }
        }
        let sum = scattered + rough + sharp + through;
        (sum > 0.0).then(|| Ways { scattered: scattered / sum, rough: rough / sum, mirrored: sharp / sum })
    }

    /// Light that is not lost between facets, as [`Bsdf::direct`] measures it. Rays to lights add it to that.
    pub(crate) fn between_facets(&self, energy: &Energy, normal: Vec3, to_eye: Vec3, to_light: Vec3) -> Vec3 {
        let (cos_eye, cos_light) = (normal.dot(to_eye), normal.dot(to_light));
        if !self.is_rough() || cos_light <= 0.0 {
            return Vec3::ZERO;
        }
        let fresnel = schlick_mean(self.specular, self.grazing);
        energy.between_facets(self.roughness, fresnel, cos_eye, cos_light) * cos_light
    }

    /// The share of the radiance from `to_light`, by solid angle, that goes towards the eye, the cosine included.
    /// Without what has only one direction.
    pub(crate) fn evaluate(&self, energy: &Energy, normal: Vec3, to_eye: Vec3, to_light: Vec3) -> Vec3 {
        let (cos_eye, cos_light) = (normal.dot(to_eye).max(1e-3), normal.dot(to_light));
        if cos_light <= 0.0 {
            return Vec3::ZERO;
        }
        let white = if self.is_rough() {
            self.direct_with(self.roughness, normal, to_eye, to_light)
                + self.between_facets(energy, normal, to_eye, to_light)
        } else {
            self.scattered(cos_eye, cos_light) * cos_light
        };
        white * FRAC_1_PI
    }

    /// How likely [`step`](Self::step) goes along `to_light` among the directions it has a chance for.
    pub(crate) fn chance(&self, energy: &Energy, normal: Vec3, to_eye: Vec3, to_light: Vec3) -> f32 {
        let cos_light = normal.dot(to_light);
        let Some(ways) = self.ways(energy, normal.dot(to_eye)).filter(|_| cos_light > 0.0) else {
            return 0.0;
        };
        let mut chance = ways.scattered * cos_light * FRAC_1_PI;
        if ways.rough > 0.0 {
            chance += ways.rough * facet_chance(self.roughness, normal, to_eye, to_light);
        }
        chance
    }

    /// Where a path goes on; `None` where it ends. `choice` chooses the way, `square` the direction.
    pub(crate) fn step(
        &self,
        energy: &Energy,
        normal: Vec3,
        to_eye: Vec3,
        choice: f32,
        square: Vec2,
    ) -> Option<Step> {
        let cos_eye = normal.dot(to_eye);
        let ways = self.ways(energy, cos_eye)?;
        let spread = |direction: Vec3| {
            let chance = self.chance(energy, normal, to_eye, direction);
            let weight = self.evaluate(energy, normal, to_eye, direction) / chance;
            (chance > 0.0 && weight.is_finite()).then_some(Step {
                direction,
                weight,
                chance: Some(chance),
                is_through: false,
            })
        };
        if choice < ways.scattered {
            return spread(cosine_direction(normal, square));
        }
        let choice = choice - ways.scattered;
        if choice < ways.rough {
            return spread(from_facet(self.roughness, normal, to_eye, square));
        }
        let fresnel = self.fresnel(cos_eye);
        let through_chance = 1.0 - ways.scattered - ways.rough - ways.mirrored;
        // Rounding may leave a hair between the last way and one.
        if choice - ways.rough < ways.mirrored || !self.is_clear() || through_chance < 1e-6 {
            let direction = mirrored(normal, to_eye);
            let weight = fresnel / ways.mirrored;
            return (ways.mirrored > 0.0).then_some(Step {
                direction,
                weight,
                chance: None,
                is_through: false,
            });
        }
        let direction = refract(-to_eye, normal, self.eta)?;
        let weight = self.through * (Vec3::ONE - fresnel) / through_chance;
        Some(Step { direction, weight, chance: None, is_through: true })
    }
}

/// The share of the radiance from `to_light` that facets send towards the eye which mirror all light; without the cosine.
pub(super) fn facets(roughness: f32, normal: Vec3, to_eye: Vec3, to_light: Vec3) -> f32 {
    let half = unit(to_eye + to_light);
    highlight(roughness * roughness, normal.dot(half), normal.dot(to_light), normal.dot(to_eye).max(1e-3))
        * FRAC_1_PI
}

/// The direction into which a facet mirrors, one of those that the eye sees.
pub(super) fn from_facet(roughness: f32, normal: Vec3, to_eye: Vec3, square: Vec2) -> Vec3 {
    let alpha = roughness * roughness;
    let (tangent, bitangent) = frame(normal);
    let flat =
        Vec3::new(tangent.dot(to_eye) * alpha, bitangent.dot(to_eye) * alpha, normal.dot(to_eye).max(1e-3));
    let flat = unit(flat);
    // An even point of the part of a sphere that the flattened eye sees as a mirror.
    let height = (1.0 - square.y) * (1.0 + flat.z) - flat.z;
    let around = circle(square.x) * (1.0 - height * height).max(0.0).sqrt();
    let between = Vec3::new(around.x, around.y, height) + flat;
    let facet = Vec3::new(between.x * alpha, between.y * alpha, between.z.max(0.0));
    let facet = unit(facet);
    let facet = tangent * facet.x + bitangent * facet.y + normal * facet.z;
    mirrored(facet, to_eye)
}

/// How likely [`from_facet`] gives a direction.
pub(super) fn facet_chance(roughness: f32, normal: Vec3, to_eye: Vec3, to_light: Vec3) -> f32 {
    let between = to_eye + to_light;
    let square = between.dot(between);
    if square < 1e-12 {
        return 0.0;
    }
    let alpha = roughness * roughness;
    let squared = alpha * alpha;
    let cos = normal.dot(between / square.sqrt()).clamp(0.0, 1.0);
    let fall = cos * cos * (squared - 1.0) + 1.0;
    let density = squared * FRAC_1_PI / (fall * fall);
    let cos_eye = normal.dot(to_eye).max(1e-3);
    density / (2.0 * (cos_eye + (squared + (1.0 - squared) * cos_eye * cos_eye).sqrt()))
}
