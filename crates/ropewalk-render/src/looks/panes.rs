//! Panes: clear surfaces that bend nothing (index of refraction 1), behind which light goes straight on. Rays to lights pass
//! through them and lose what the glass keeps; they are stopped by all other surfaces, also by glass that bends, since where
//! its light goes is not known. The twin of `looks_through` in the shaders.

use super::Looks;
use super::layout::{self, MATERIAL, TRIANGLE};
use crate::bsdf::Bsdf;
use glam::Vec3;
use ropewalk::Hit;

/// Light passes through panes up to this depth, mirrors before them counted.
pub(crate) const MOST_PANES: u32 = 32;

impl Looks {
    /// Whether some material is a pane, so that rays to lights must know what they meet.
    pub(crate) fn has_panes(&self) -> bool {
        self.word(layout::FLAGS) & layout::HAS_PANES != 0
    }

    /// The share of light that goes straight on through what is hit; zero for what is no pane, or not there.
    pub(crate) fn through(&self, hit: &Hit) -> Vec3 {
        let Some(rows) = self.rows(hit) else { return Vec3::ZERO };
        let material = self.word(rows.triangle + TRIANGLE - 1);
        let at = self.row(layout::MATERIALS, material, MATERIAL);
        let (ior, transmission) = (self.float(at + 15), self.float(at + 18));
        if ior != 1.0 || transmission <= 0.0 {
            return Vec3::ZERO;
        }
        let shaded = self.shaded(material, self.uv(rows.triangle, hit.barycentrics));
        Bsdf::new(&shaded, hit.front_face).through
    }
}
