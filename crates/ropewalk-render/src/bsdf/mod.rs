//! How a surface sends light on: one model for the tree of rays, on the CPU and in its kernel, and for paths.
//!
//! **The parts.** Of the light that arrives, a share that grows towards grazing angles is mirrored (`fresnel`);
//! of the rest, clear materials let a part through, bent, and what is left is scattered by Lambert's law.
//!
//! | part | is | in a tree of rays | on a path |
//! |---|---|---|---|
//! | scattered | Lambert, times what is not mirrored on the way in and out | lights, surroundings | sampled by the cosine |
//! | mirrored, rough | GGX (Walter et al. 2007), Hammon's visibility (2017) | highlights of lights; a part is followed by a mirrored ray, the rest is the surroundings, blurred | sampled by visible normals, with Kulla and Conty's (2017) light between microfacets |
//! | mirrored, sharp | a mirror | a ray | a ray |
//! | let through | Snell's law | a ray | a ray |
//!
//! **What is mirrored.** Clear materials follow Fresnel's equations, stretched so that they start at the material's
//! own share at normal incidence where it has one; all others follow Schlick's curve. Materials that mirror sharply
//! without being clear come from files older than either, and mirror the same share at every angle.
//!
//! Clear materials are smooth: their roughness makes highlights wide and nothing else.
//!
//! **Invariants.** No more light leaves than arrives. Scattering and highlights are reciprocal. What is no number, or
//! out of range, in a material is brought into range: the answers are always numbers.
//!
//! **The same on both devices.** `direct`, `mirror_weight`, `through_weight`, `surroundings` and what they call
//! have twins of the same names in the kernel, which must give the same bits: f32, `+ - * /`, square roots, minimum
//! and maximum alone; sums of products are dots (`arithmetic`); constants come last in their products.

pub(crate) mod arithmetic;
mod energy;
pub(crate) mod fresnel;
mod lobes;
mod shading;

pub(crate) use energy::Energy;
pub(crate) use lobes::Step;

use crate::looks::Shaded;
use fresnel::{fresnel_at_normal, fresnel_of_border, schlick, schlick_mean};
use glam::Vec3;

/// Highlights of lights are at least as wide as this roughness makes them: smaller ones would be smaller than what
/// a pixel's samples can catch, since lights are small.
const LEAST_ROUGHNESS: f32 = 0.18;
/// The largest index of refraction: above that of every clear material.
const LARGEST_IOR: f32 = 10.0;

/// A material at a place, seen from one of its sides, worked out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bsdf {
    /// The share of light that is scattered in all directions, where nothing is mirrored.
    pub(crate) diffuse: Vec3,
    /// The share that is mirrored at normal incidence.
    pub(crate) specular: Vec3,
    /// The share that goes through, where nothing is mirrored; zero for what is not clear.
    pub(crate) through: Vec3,
    /// The share that is mirrored at grazing incidence, where it is more than `specular`.
    pub(crate) grazing: f32,
    /// The share of the ambient light of a file that is sent on.
    pub(crate) ambient: Vec3,
    /// From 0, mirror-smooth, to 1, matt.
    pub(crate) roughness: f32,
    /// Whether everything but lights is mirrored sharply, however wide the highlights are.
    pub(crate) is_sharp: bool,
    /// The index of refraction on the side of the eye over that on the other.
    pub(crate) eta: f32,
}

/// What is mirrored at normal incidence where the file does not say: of glass what its index of refraction says, less
/// the rougher it is, so that a matt surface is exactly Lambertian; of metal its colour.
fn specular_at_normal(base_color: Vec3, metallic: f32, roughness: f32, ior: f32) -> Vec3 {
    let glass = fresnel_at_normal(ior) * (1.0 - roughness);
    arithmetic::blend(Vec3::splat(glass), base_color, metallic)
}

impl Bsdf {
    /// Works out a material. `front` says whether the eye is on the outside.
    pub(crate) fn new(shaded: &Shaded, front: bool) -> Self {
        let base_color = share_of_each(shaded.base_color);
        let roughness = share(shaded.roughness, 1.0);
        let metallic = share(shaded.metallic, 0.0);
        let body = 1.0 - metallic;
        let transmission = share(shaded.transmission, 0.0) * body;
        let is_clear = transmission > 0.0;
        let is_sharp = shaded.mirrors_sharply || is_clear;
        let solid = 1.0 - transmission;
        let ior = if shaded.ior >= 1.0 { shaded.ior.min(LARGEST_IOR) } else { 1.0 };
        let specular = if shaded.gives_specular {
            share_of_each(shaded.specular)
        } else {
            specular_at_normal(base_color, metallic, roughness, ior)
        };
        // Files older than microfacets give each share by itself, and no colour for what goes through.
        let (diffuse, through) = if shaded.mirrors_sharply {
            ((base_color * body).min(Vec3::splat(solid)), Vec3::splat(transmission))
        } else {
            (base_color * (body * solid), base_color * transmission)
        };
        let largest = specular.x.max(specular.y).max(specular.z);
        Self {
            diffuse,
            specular,
            through,
            grazing: if shaded.mirrors_sharply { 0.0 } else { (largest * 50.0).min(1.0) },
            ambient: share_of_each(shaded.ambient),
            roughness,
            is_sharp,
            eta: if front { 1.0 / ior } else { ior },
        }
    }

    /// Whether light goes through.
    pub(crate) fn is_clear(&self) -> bool {
        self.through.x.max(self.through.y).max(self.through.z) > 0.0
    }

    /// The share that is mirrored at an angle of this cosine.
    pub(crate) fn fresnel(&self, cos: f32) -> Vec3 {
        if !self.is_clear() {
            return schlick(self.specular, self.grazing, cos);
        }
        let at_normal = fresnel_at_normal(self.eta);
        let here = fresnel_of_border(cos.clamp(0.0, 1.0), self.eta);
        let rise = ((here - at_normal) / (1.0 - at_normal)).max(0.0);
        arithmetic::blend(self.specular, Vec3::ONE, rise)
    }

    /// The part of light scattered back that is not lost to mirroring on its way in and out. It is made so that a white
    /// surface sends on all light, and is the same both ways (Shirley et al. 1997).
    fn scattered(&self, cos_eye: f32, cos_light: f32) -> Vec3 {
        let rest = (Vec3::ONE - self.fresnel(cos_eye)) * (Vec3::ONE - self.fresnel(cos_light));
        if self.is_clear() {
            return self.diffuse * rest;
        }
        let mean = Vec3::ONE - schlick_mean(self.specular, self.grazing);
        self.diffuse * (rest / mean.max(Vec3::splat(1e-4)))
    }
}

/// A number brought between 0 and 1.
fn share(value: f32, else_value: f32) -> f32 {
    if value >= 0.0 {
        value.min(1.0)
    } else if value < 0.0 {
        0.0
    } else {
        else_value
    }
}

fn share_of_each(color: Vec3) -> Vec3 {
    Vec3::new(share(color.x, 0.0), share(color.y, 0.0), share(color.z, 0.0))
}

#[cfg(test)]
mod tests;
