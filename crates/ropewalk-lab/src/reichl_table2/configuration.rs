//! What of the tree of rays is followed: the columns of the paper's Table 2.

use ropewalk_render::{Integrator, Primary, RenderSettings, TreeSettings};

/// How much of a picture's light is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Configuration {
    /// What the eye sees, lit by lights that nothing stands before.
    PrimaryShading,
    /// The same with a ray to every light.
    ShadowOnly,
    /// What the eye sees, and what is mirrored there, without shadows.
    ReflectOnly,
    /// Shadows, mirrors and glass, five bounces deep.
    FiveBounces,
}

impl Configuration {
    /// Every configuration, in the paper's order.
    pub const EVERY: [Self; 4] =
        [Self::PrimaryShading, Self::ShadowOnly, Self::ReflectOnly, Self::FiveBounces];

    /// The paper's name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PrimaryShading => "primary shading",
            Self::ShadowOnly => "shadow only",
            Self::ReflectOnly => "reflect only",
            Self::FiveBounces => "5 bounces + shadow",
        }
    }

    /// What of the tree is followed.
    #[must_use]
    pub fn tree(self) -> TreeSettings {
        let (bounces, shadows, reflections, refractions) = match self {
            Self::PrimaryShading => (0, false, false, false),
            Self::ShadowOnly => (0, true, false, false),
            Self::ReflectOnly => (1, false, true, false),
            Self::FiveBounces => (5, true, true, true),
        };
        TreeSettings { bounces, shadows, reflections, refractions, ..TreeSettings::default() }
    }

    /// A picture of one ray a pixel, its primary hits drawn.
    pub(super) fn settings(self, like: &RenderSettings) -> RenderSettings {
        RenderSettings {
            samples: 1,
            integrator: Integrator::RayTree,
            tree: self.tree(),
            primary: Primary::Rasterised,
            ..like.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_configuration_follows_what_its_name_says() {
        for configuration in Configuration::EVERY {
            let (name, tree) = (configuration.name(), configuration.tree());
            let (has_shadows, has_mirrors) = (name.contains("shadow"), name.contains("reflect"));
            assert_eq!(tree.shadows, has_shadows, "{name}");
            assert_eq!(tree.reflections, has_mirrors || name.starts_with('5'), "{name}");
            assert!(configuration.settings(&RenderSettings::default()).check().is_ok(), "{name}");
        }
    }
}
