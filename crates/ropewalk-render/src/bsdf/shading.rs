//! What a tree of rays asks of a surface: light that falls straight onto it, the weights of the rays that follow,
//! and what its surroundings add.
//!
//! **How rough surfaces mirror in a tree.** One ray cannot gather the wide cone that a rough surface mirrors. So the
//! share `(1 - roughness)^4` of what is mirrored is followed by a ray, sharp, and the rest is taken from the
//! surroundings, blurred, as if nothing were in the way. Polished metal (roughness 0.1) follows two thirds, satin
//! (0.3) a quarter, and matt metal none. Materials that mirror sharply follow all.

use super::{Bsdf, LEAST_ROUGHNESS, arithmetic};
use crate::light::Environment;
use glam::{Vec2, Vec3};

/// The most that a highlight may outshine a white matt surface by.
const BRIGHTEST: f32 = 1e6;

impl Bsdf {
    /// What goes towards the eye of light that would make a white matt surface facing it shine with a radiance of one.
    /// The cosine is in it.
    pub(crate) fn direct(&self, normal: Vec3, to_eye: Vec3, to_light: Vec3) -> Vec3 {
        self.direct_with(self.roughness.max(LEAST_ROUGHNESS), normal, to_eye, to_light)
    }

    /// [`direct`](Self::direct) with a highlight of this roughness.
    pub(crate) fn direct_with(&self, roughness: f32, normal: Vec3, to_eye: Vec3, to_light: Vec3) -> Vec3 {
        let cos_light = normal.dot(to_light);
        if cos_light <= 0.0 {
            return Vec3::ZERO;
        }
        let cos_eye = normal.dot(to_eye).max(1e-3);
        let between = to_light + to_eye;
        let square = between.dot(between);
        // Light from straight behind the surface has no half-way vector.
        let half = if square > 1e-12 { between / square.sqrt() } else { normal };
        let height = highlight(roughness * roughness, normal.dot(half), cos_light, cos_eye);
        let mirrored = self.fresnel(to_eye.dot(half)) * height;
        let sum = self.scattered(cos_eye, cos_light) + mirrored;
        (sum * cos_light).min(Vec3::splat(BRIGHTEST))
    }

    /// The weight of what a mirrored ray brings.
    pub(crate) fn mirror_weight(&self, cos_eye: f32) -> Vec3 {
        self.fresnel(cos_eye) * self.followed()
    }

    /// The weight of what a refracted ray brings.
    pub(crate) fn through_weight(&self, cos_eye: f32) -> Vec3 {
        self.through * (Vec3::ONE - self.fresnel(cos_eye))
    }

    /// The share of mirrored light that a ray is sent for.
    pub(crate) fn followed(&self) -> f32 {
        let smooth = 1.0 - self.roughness;
        let square = smooth * smooth;
        if self.is_sharp { 1.0 } else { square * square }
    }

    /// What goes towards the eye of the light that comes from everywhere around, nothing being in its way. With
    /// `follows_mirrors` the share that a mirrored ray brings is left out; without, it is taken from here too.
    pub(crate) fn surroundings(
        &self,
        normal: Vec3,
        to_eye: Vec3,
        environment: &Environment,
        follows_mirrors: bool,
    ) -> Vec3 {
        let cos_eye = normal.dot(to_eye).clamp(0.0, 1.0);
        let rest = 1.0 - cos_eye;
        let square = rest * rest;
        let fifth = square * square * rest;
        // A rough surface gathers its reflection from so wide a cone that little of the grazing gain is left.
        let grazing = Vec3::splat(self.grazing * (1.0 - self.roughness)).max(self.specular);
        let rough = self.specular + (grazing - self.specular) * fifth;
        let followed = self.followed();
        let sharp = self.fresnel(cos_eye) * followed;
        let blurred = rough * (1.0 - followed);
        let scattered = self.diffuse * (Vec3::ONE - sharp - blurred) * environment.scattered(normal);
        let here = if follows_mirrors { blurred } else { blurred + sharp };
        let direction = arithmetic::mirrored(normal, to_eye);
        let mirrored = here * environment.mirrored(direction, self.roughness);
        scattered + mirrored + self.ambient * environment.ambient()
    }
}

/// How much brighter than a white matt surface a surface of GGX microfacets shines that mirrors everything: pi times
/// the density of facets, times Hammon's fit of how many of them are seen and lit, over the two cosines.
pub(super) fn highlight(alpha: f32, cos_half: f32, cos_light: f32, cos_eye: f32) -> f32 {
    let squared = alpha * alpha;
    let cos = cos_half.clamp(0.0, 1.0);
    let fall = cos * cos * (squared - 1.0) + 1.0;
    let facets = squared / (fall * fall);
    let sums = Vec2::new(cos_light * cos_eye * 2.0, cos_light + cos_eye);
    facets / (sums.dot(Vec2::new(1.0 - alpha, alpha)) * 2.0)
}
