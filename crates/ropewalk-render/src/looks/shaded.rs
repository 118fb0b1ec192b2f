//! The material at a place: the material of a triangle with its textures multiplied in. The twin of
//! `looks_shaded` in the shaders.

use super::layout::{self, MATERIAL};
use super::{Looks, texture};
use glam::{Vec2, Vec3};

/// The material at a place. All numbers are finite and in range: colors that reflect, roughness, metallic and transmission
/// from 0 to 1, light that is given off from 0 to 1e6, the index of refraction at least 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shaded {
    /// The color of diffuse reflection, or of metal.
    pub(crate) base_color: Vec3,
    /// Light given off.
    pub(crate) emissive: Vec3,
    /// The share of the ambient light that is sent on.
    pub(crate) ambient: Vec3,
    /// 0 for a mirror-smooth surface, 1 for a matt one.
    pub(crate) roughness: f32,
    /// 1 for metal.
    pub(crate) metallic: f32,
    /// The share of light that goes through.
    pub(crate) transmission: f32,
    /// The index of refraction, of what lies below the surface over what lies above it.
    pub(crate) ior: f32,
    /// The share of light that is reflected at normal incidence.
    pub(crate) specular: Vec3,
    /// Whether `specular` was given as a color by the file, and does not follow from the index of refraction or metal.
    pub(crate) gives_specular: bool,
    /// Whether surroundings are mirrored sharply whatever the roughness.
    pub(crate) mirrors_sharply: bool,
}

impl Default for Shaded {
    /// What has no material: matt and grey.
    fn default() -> Self {
        Self {
            base_color: Vec3::splat(0.6),
            emissive: Vec3::ZERO,
            ambient: Vec3::splat(0.6),
            roughness: 1.0,
            metallic: 0.0,
            transmission: 0.0,
            ior: 1.5,
            specular: Vec3::splat(0.04),
            gives_specular: false,
            mirrors_sharply: false,
        }
    }
}

/// `(1 - share) * a + share * b`, each component as a scalar product, whose order no shader compiler changes.
pub(super) fn mix(a: f32, b: f32, share: f32) -> f32 {
    Vec2::new(a, b).dot(Vec2::new(1.0 - share, share))
}

impl Looks {
    /// Material number `material` at texture coordinates `uv`.
    pub(crate) fn shaded(&self, material: u32, uv: Vec2) -> Shaded {
        let at = self.row(layout::MATERIALS, material, MATERIAL);
        let flags = self.word(at + 11);
        let mut base_color = self.vector(at);
        let mut emissive = self.vector(at + 4);
        let mut ambient = base_color;
        if flags & layout::GIVES_AMBIENT != 0 {
            ambient = self.vector(at + 8);
        }
        let mut roughness = self.float(at + 16);
        let mut metallic = self.float(at + 17);
        if let Some(texel) = texture::look_up(self, self.word(at + 20), uv) {
            base_color *= texel.truncate();
            ambient *= texel.truncate();
        }
        if let Some(texel) = texture::look_up(self, self.word(at + 21), uv) {
            emissive *= texel.truncate();
        }
        if let Some(texel) = texture::look_up(self, self.word(at + 22), uv) {
            roughness *= texel.y;
            metallic *= texel.z;
        }
        let gives_specular = flags & layout::GIVES_SPECULAR != 0;
        let mut specular = self.vector(at + 12);
        if !gives_specular {
            let dielectric = self.float(at + 19);
            specular = Vec3::new(
                mix(dielectric, base_color.x, metallic),
                mix(dielectric, base_color.y, metallic),
                mix(dielectric, base_color.z, metallic),
            );
        }
        Shaded {
            base_color,
            emissive,
            ambient,
            roughness,
            metallic,
            transmission: self.float(at + 18),
            ior: self.float(at + 15),
            specular,
            gives_specular,
            mirrors_sharply: flags & layout::MIRRORS_SHARPLY != 0,
        }
    }

    /// Whether a material has a hole at texture coordinates `uv`.
    pub(crate) fn is_hole(&self, material: u32, uv: Vec2) -> bool {
        let at = self.row(layout::MATERIALS, material, MATERIAL);
        let cutoff = self.float(at + 7);
        if cutoff <= 0.0 {
            return false;
        }
        let mut alpha = self.float(at + 3);
        if let Some(texel) = texture::look_up(self, self.word(at + 20), uv) {
            alpha *= texel.w;
        }
        alpha < cutoff
    }
}
