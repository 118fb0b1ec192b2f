//! How light is followed, and by what.

use crate::error::RenderError;
use ropewalk_scene::{Material, Model};
use std::fmt;
use std::str::FromStr;

/// The most bounces of a ray tree or a path.
pub const MOST_BOUNCES: u32 = 16;

/// How light is followed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Integrator {
    /// One surface deep, under a studio's lamps and sky: what models without looks of their own are seen best by.
    #[default]
    Studio,
    /// Shadows, mirrors and glass by a tree of rays (Whitted 1980), as Reichl et al. 2010 have it.
    RayTree,
    /// All light there is, by random paths.
    Path,
}

impl Integrator {
    /// Every integrator.
    pub const EVERY: [Self; 3] = [Self::Studio, Self::RayTree, Self::Path];

    /// The one that suits a model: the tree of rays where the model has looks that a studio does not show, which are mirrors,
    /// glass, and textures; or where it has lights of its own and says what lies behind it, so that it is a scene and not a
    /// part on a table. Everything else is seen best in the studio.
    #[must_use]
    pub fn suited_to(model: &Model) -> Self {
        /// Metal that is smoother than this is a mirror: a sharp image is blurred by less than a sun's width.
        const MIRROR: f32 = 0.1;
        let has_looks = |material: &Material| {
            let mirrors = material.mirrors_sharply
                && material.specular.is_some_and(|specular| specular.max_element() > 0.0)
                || material.metallic >= 0.5 && material.roughness <= MIRROR;
            mirrors || material.transmission > 0.0 || material.base_color_texture.is_some()
        };
        let is_scene = !model.lights.is_empty() && model.background.is_some();
        if is_scene || model.materials.iter().any(has_looks) { Self::RayTree } else { Self::Studio }
    }

    /// The name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Studio => "studio",
            Self::RayTree => "ray-tree",
            Self::Path => "path",
        }
    }
}

/// In which order the rays of a tree are traced. The picture is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TreeOrder {
    /// The stack's kernel on a graphics adapter, the wavefront on the CPU.
    #[default]
    Auto,
    /// Each ray calls for those that follow it: the reference.
    Recursive,
    /// One stack a sample, from which rays of all kinds are taken and traced alike (Reichl et al. 2010, listing 1).
    Stack,
    /// All rays of a depth at once, sorted.
    Wavefront,
}

impl TreeOrder {
    /// Every order.
    pub const EVERY: [Self; 4] = [Self::Auto, Self::Recursive, Self::Stack, Self::Wavefront];

    /// The name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Recursive => "recursive",
            Self::Stack => "stack",
            Self::Wavefront => "wavefront",
        }
    }
}

/// How primary hits are found. They are the same, but for pixels whose sample lies within rounding of an edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Primary {
    /// By rays.
    #[default]
    Traced,
    /// By drawing every triangle.
    Rasterised,
}

impl Primary {
    /// Both ways.
    pub const EVERY: [Self; 2] = [Self::Traced, Self::Rasterised];

    /// The name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Traced => "traced",
            Self::Rasterised => "rasterised",
        }
    }
}

/// What a tree of rays follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeSettings {
    /// How often a ray may be mirrored or refracted, up to [`MOST_BOUNCES`]; what is cut off is counted.
    pub bounces: u32,
    /// Whether lights are asked for with rays; else they reach everything.
    pub shadows: bool,
    /// Whether mirrors send rays on.
    pub reflections: bool,
    /// Whether glass does.
    pub refractions: bool,
    /// Rays that carry less than this share of the picture's light are not followed; they are counted.
    pub smallest_weight: f32,
    /// In which order.
    pub order: TreeOrder,
}

impl Default for TreeSettings {
    /// Five bounces, as the paper's largest setting; nothing below what a byte of the picture shows.
    fn default() -> Self {
        Self {
            bounces: 5,
            shadows: true,
            reflections: true,
            refractions: true,
            smallest_weight: 1.0 / 512.0,
            order: TreeOrder::Auto,
        }
    }
}

macro_rules! words {
    ($($type:ident: $what:literal),*) => {$(
        impl fmt::Display for $type {
            fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.pad(self.name())
            }
        }

        impl FromStr for $type {
            type Err = RenderError;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                Self::EVERY.into_iter().find(|one| one.name() == text).ok_or_else(|| {
                    let names = Self::EVERY.map(Self::name).join(", ");
                    RenderError::Word(format!("{} can be {names}, not '{text}'", $what))
                })
            }
        }
    )*};
}

words!(Integrator: "the integrator", TreeOrder: "the order of rays", Primary: "primary hits");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_is_followed_as_its_looks_ask() {
        let with = |material: Material| Model { materials: vec![material], ..Model::default() };
        let plain = Material::default();
        let mut scene = with(plain.clone());
        assert_eq!(Integrator::suited_to(&scene), Integrator::Studio);
        scene.lights =
            vec![ropewalk_scene::Light::Point { position: glam::Vec3::ONE, color: glam::Vec3::ONE }];
        assert_eq!(Integrator::suited_to(&scene), Integrator::Studio);
        scene.background = Some(glam::Vec3::ZERO);
        assert_eq!(Integrator::suited_to(&scene), Integrator::RayTree);
        let specular = Some(glam::Vec3::splat(0.5));
        for material in [
            Material { transmission: 0.5, ..plain.clone() },
            Material { mirrors_sharply: true, specular, ..plain.clone() },
            Material { metallic: 1.0, roughness: 0.05, ..plain.clone() },
            Material { base_color_texture: Some(ropewalk_scene::TextureUse::plain(0)), ..plain.clone() },
        ] {
            assert_eq!(Integrator::suited_to(&with(material.clone())), Integrator::RayTree, "{material:?}");
        }
        let brushed = Material { metallic: 1.0, roughness: 0.4, specular, ..plain };
        assert_eq!(Integrator::suited_to(&with(brushed)), Integrator::Studio);
    }

    #[test]
    fn names_are_read_back_and_wrong_ones_are_answered_with_the_right() {
        for one in Integrator::EVERY {
            assert_eq!(one.to_string().parse::<Integrator>().unwrap(), one);
        }
        for one in TreeOrder::EVERY {
            assert_eq!(one.to_string().parse::<TreeOrder>().unwrap(), one);
        }
        for one in Primary::EVERY {
            assert_eq!(one.to_string().parse::<Primary>().unwrap(), one);
        }
        let error = "photons".parse::<Integrator>().unwrap_err().to_string();
        assert!(error.contains("studio, ray-tree, path"), "{error}");
    }
}
