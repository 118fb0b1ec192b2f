//! What is asked of a render.

use crate::camera::CameraChoice;
use crate::error::RenderError;
use crate::integrator::{Integrator, MOST_BOUNCES, Primary, TreeSettings};
use crate::lights::LightChoice;
use crate::view::View;
use ropewalk::Walk;

/// The longest side of a picture, in pixels.
pub const LARGEST_SIDE: u32 = 65_536;
/// The most pixels of a picture: 2^27, a little over 16K; its film takes 2.7 GB.
pub const LARGEST_PIXEL_COUNT: u64 = 1 << 27;
/// The most samples a pixel.
pub const MOST_SAMPLES: u32 = 1024;
/// The largest exposure in stops, either way.
const LARGEST_EXPOSURE: f32 = 30.0;
/// The most ambient rays a pixel.
const MOST_AMBIENT_RAYS: u32 = 4096;

/// What is asked of a render.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// Pixels in a row, up to [`LARGEST_SIDE`].
    pub width: u32,
    /// Rows, up to [`LARGEST_SIDE`].
    pub height: u32,
    /// Samples a pixel: a square number up to [`MOST_SAMPLES`]. With 1, shadows have hard edges.
    pub samples: u32,
    /// What the picture shows.
    pub view: View,
    /// How light is followed.
    pub integrator: Integrator,
    /// What a tree of rays follows; of a path its bounces alone.
    pub tree: TreeSettings,
    /// How primary hits are found.
    pub primary: Primary,
    /// How rays go through the structure.
    pub walk: Walk,
    /// From where.
    pub camera: CameraChoice,
    /// Lit by what.
    pub light: LightChoice,
    /// Stops of exposure: 1 is twice as bright.
    pub exposure: f32,
    /// Rays into the sky a pixel, rounded up to a multiple of the samples; 0 lets the sky reach everything.
    pub ambient_rays: u32,
    /// Whether the film also gets what surfaces are, whatever the light: colour, normal, who they are.
    pub layers: bool,
}

impl Default for RenderSettings {
    /// 1280x720, 9 samples, shaded.
    fn default() -> Self {
        Self {
            width: 1280,
            height: 720,
            samples: 9,
            view: View::Shaded,
            integrator: Integrator::default(),
            tree: TreeSettings::default(),
            primary: Primary::default(),
            walk: Walk::default(),
            camera: CameraChoice::default(),
            light: LightChoice::default(),
            exposure: 0.0,
            ambient_rays: 18,
            layers: false,
        }
    }
}

impl RenderSettings {
    /// Checks every number.
    ///
    /// # Errors
    /// Names the first that cannot be served, and what can.
    pub fn check(&self) -> Result<(), RenderError> {
        let (width, height) = (self.width, self.height);
        let side = 1..=LARGEST_SIDE;
        if !side.contains(&width)
            || !side.contains(&height)
            || u64::from(width) * u64::from(height) > LARGEST_PIXEL_COUNT
        {
            return Err(RenderError::Size { width, height });
        }
        let root = self.samples.isqrt();
        if root == 0 || self.samples > MOST_SAMPLES || root * root != self.samples {
            return Err(RenderError::Samples { samples: self.samples });
        }
        if self.exposure.is_nan() || self.exposure.abs() > LARGEST_EXPOSURE {
            return Err(RenderError::Setting {
                setting: "the exposure",
                value: self.exposure.to_string(),
                wanted: "it must lie between -30 and 30 stops",
            });
        }
        if self.ambient_rays > MOST_AMBIENT_RAYS {
            return Err(RenderError::Setting {
                setting: "the number of ambient rays a pixel",
                value: self.ambient_rays.to_string(),
                wanted: "it must lie between 0 and 4096",
            });
        }
        if self.tree.bounces > MOST_BOUNCES {
            return Err(RenderError::Setting {
                setting: "the number of bounces",
                value: self.tree.bounces.to_string(),
                wanted: "it must lie between 0 and 16",
            });
        }
        if !(0.0..1.0).contains(&self.tree.smallest_weight) {
            return Err(RenderError::Setting {
                setting: "the smallest weight of a ray",
                value: self.tree.smallest_weight.to_string(),
                wanted: "it must lie between 0 and 1, below 1",
            });
        }
        self.light.check()
    }

    /// Samples along one side of a pixel.
    pub(crate) fn samples_per_side(&self) -> u32 {
        self.samples.isqrt()
    }

    /// Ambient rays for each sample.
    pub(crate) fn ambient_rays_per_sample(&self) -> u32 {
        self.ambient_rays.div_ceil(self.samples.max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_served_is_named_with_its_limit() {
        let good = RenderSettings::default();
        assert!(good.check().is_ok());
        let message = |settings: RenderSettings| settings.check().unwrap_err().to_string();
        for (width, height) in [(0, 0), (0, 720), (65_537, 1), (65_536, 65_536), (u32::MAX, u32::MAX)] {
            let text = message(RenderSettings { width, height, ..good.clone() });
            assert!(text.contains(&format!("{width}x{height}")) && text.contains("65536"), "{text}");
        }
        for samples in [0, 2, 8, 1025, u32::MAX] {
            let text = message(RenderSettings { samples, ..good.clone() });
            assert!(text.contains(&samples.to_string()) && text.contains("1, 4, 9, 16"), "{text}");
        }
        for exposure in [f32::NAN, f32::INFINITY, 31.0] {
            assert!(message(RenderSettings { exposure, ..good.clone() }).contains("stops"));
        }
        assert!(message(RenderSettings { ambient_rays: 5000, ..good.clone() }).contains("4096"));
        assert!(RenderSettings { width: 65_536, height: 2048, samples: 1024, ..good }.check().is_ok());
    }

    #[test]
    fn ambient_rays_are_shared_out() {
        let settings = |samples, ambient_rays| RenderSettings { samples, ambient_rays, ..Default::default() };
        assert_eq!(settings(9, 16).ambient_rays_per_sample(), 2);
        assert_eq!(settings(1, 16).ambient_rays_per_sample(), 16);
        assert_eq!(settings(16, 0).ambient_rays_per_sample(), 0);
    }
}
