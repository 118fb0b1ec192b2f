//! What surfaces are made of.

use crate::TextureUse;
use glam::Vec3;

/// What a surface is made of. Colours are linear, not sRGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name in the file.
    pub name: String,
    /// The colour of diffuse reflection, or of metal.
    pub base_color: Vec3,
    /// A picture by which the base colour is multiplied; its alpha multiplies the opacity.
    pub base_color_texture: Option<TextureUse>,
    /// Light given off.
    pub emissive: Vec3,
    /// A picture by which the light given off is multiplied.
    pub emissive_texture: Option<TextureUse>,
    /// 0 for a mirror-smooth surface, 1 for a matt one.
    pub roughness: f32,
    /// 1 for metal.
    pub metallic: f32,
    /// A picture by whose green the roughness and by whose blue the metal is multiplied.
    pub metallic_roughness_texture: Option<TextureUse>,
    /// The share of light that is reflected at normal incidence, where the file gives it as a colour; else it follows from
    /// `ior`, or from the base colour of metal.
    pub specular: Option<Vec3>,
    /// Whether surroundings are mirrored sharply whatever the roughness, which then describes the highlights of lights alone:
    /// the shading of files older than microfacets (AFF; MTL with `illum` 3 and above).
    pub mirrors_sharply: bool,
    /// The share of [`Model::ambient`](crate::Model::ambient) that is sent on; the base colour where the file does not say. The
    /// picture of the base colour multiplies it too: BART's kitchen has a garden that is lit by nothing else.
    pub ambient: Option<Vec3>,
    /// The share of light that goes through.
    pub transmission: f32,
    /// The index of refraction; 1 lets light through without bending it.
    pub ior: f32,
    /// Where the alpha of the base colour is below this there is no surface; 0 for surfaces without holes.
    pub alpha_cutoff: f32,
    /// The alpha of the base colour, before its texture.
    pub opacity: f32,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec3::splat(0.6),
            base_color_texture: None,
            emissive: Vec3::ZERO,
            emissive_texture: None,
            roughness: 1.0,
            metallic: 0.0,
            metallic_roughness_texture: None,
            specular: None,
            mirrors_sharply: false,
            ambient: None,
            transmission: 0.0,
            ior: 1.5,
            alpha_cutoff: 0.0,
            opacity: 1.0,
        }
    }
}
