//! What surrounds the scene: the studio's sky, or the same from all sides. Its functions have twins in the kernel.

use crate::lights::Lighting;
use crate::sky::{LAMP_SIZE, Sky};
use crate::stage::Stage;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// The surroundings of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Environment {
    /// The studio.
    Studio(Sky),
    /// The same from all sides.
    Even {
        /// The radiance that rays see which leave the scene.
        radiance: Vec3,
        /// The radiance that a matt surface gets from it where rays do not gather it.
        scattered: Vec3,
        /// The file's ambient light, of which each material says how much it sends on.
        ambient: Vec3,
    },
}

impl Environment {
    /// The file's, where it says what surrounds the scene; else the studio.
    ///
    /// A file's background and ambient light are given in the unit of its lights, so they are scaled as those are.
    pub(crate) fn new(stage: &Stage, lighting: &Lighting) -> Self {
        if let Some(radiance) = lighting.even {
            return Self::Even { radiance, scattered: radiance, ambient: Vec3::ZERO };
        }
        let model = stage.model();
        if model.background.is_none() && model.ambient.is_none() {
            return Self::Studio(lighting.sky);
        }
        // A light of colour one, straight above, gives a white matt surface the radiance one in such files.
        let scale = lighting.scale.map_or(1.0, |scale| scale * FRAC_1_PI);
        let color = |color: Option<Vec3>| {
            let color = color.filter(|color| color.is_finite()).unwrap_or(Vec3::ZERO);
            (color.max(Vec3::ZERO) * scale).min(Vec3::splat(1e6))
        };
        Self::Even { radiance: color(model.background), scattered: Vec3::ZERO, ambient: color(model.ambient) }
    }

    /// The radiance that a ray sees which leaves the scene.
    pub(crate) fn radiance(&self, direction: Vec3) -> Vec3 {
        self.mirrored(direction, 0.0)
    }

    /// The radiance that a surface of some roughness sees in its mirror direction.
    pub(crate) fn mirrored(&self, direction: Vec3, roughness: f32) -> Vec3 {
        match self {
            Self::Studio(sky) => sky.reflected(direction, roughness),
            Self::Even { radiance, .. } => *radiance,
        }
    }

    /// The mean radiance that a matt surface sees.
    pub(crate) fn scattered(&self, normal: Vec3) -> Vec3 {
        match self {
            Self::Studio(sky) => sky.diffuse(normal),
            Self::Even { scattered, .. } => *scattered,
        }
    }

    /// Light that reaches every place alike.
    pub(crate) fn ambient(&self) -> Vec3 {
        match self {
            Self::Studio(_) => Vec3::ZERO,
            Self::Even { ambient, .. } => *ambient,
        }
    }

    /// The brightest part: the direction to its middle, and the cosine to its rim.
    pub(crate) fn lamp(&self) -> Option<(Vec3, f32)> {
        match self {
            Self::Studio(sky) => Some((sky.key, 1.0 - LAMP_SIZE)),
            Self::Even { .. } => None,
        }
    }

    /// Whether rays into the sky may find something in its way.
    pub(crate) fn is_studio(&self) -> bool {
        matches!(self, Self::Studio(_))
    }

    /// The words from the kind on: see [`crate::light`].
    pub(super) fn words(&self) -> Vec<u32> {
        let (kind, up, key, radiance, scattered, ambient) = match *self {
            Self::Studio(Sky { up, key, .. }) => (0, up, key, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO),
            Self::Even { radiance, scattered, ambient } => {
                (1, Vec3::Y, Vec3::Y, radiance, scattered, ambient)
            }
        };
        let vectors = [up, key, radiance, ambient].into_iter().chain(Sky::COLORS).chain([scattered]);
        let words = vectors.flat_map(|vector| vector.to_array().map(f32::to_bits));
        std::iter::once(kind).chain(words).collect()
    }
}
