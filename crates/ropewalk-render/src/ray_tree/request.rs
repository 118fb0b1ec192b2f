//! What a picture asks of its trees, as numbers and as the words that the kernel reads.
//!
//! **Words**, [`WORDS`] of them, in the table `request` of [`Looks`](crate::looks::Looks):
//!
//! | word | what |
//! |---|---|
//! | 0 | bounces |
//! | 1 | flags: 1 shadows, 2 reflections, 4 refractions |
//! | 2 | the smallest weight, a float |
//! | 3 | samples a pixel |
//! | 4 | rays into the sky a sample, at the first place |
//! | 5 | how far the sky's light can be blocked, a float |
//! | 6 | the share of the sky's light that is never blocked, a float |
//! | 7 | the share that each ray into the sky carries, a float: the rest over their number |
//! | 8 to 15 | 0 |

use crate::integrator::TreeSettings;
use crate::settings::RenderSettings;
use crate::shade::{AMBIENT_REACH, BOUNCED};
use crate::stage::Stage;

/// The number of words.
pub(crate) const WORDS: usize = 16;

/// What a picture asks of its trees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Request {
    pub(crate) tree: TreeSettings,
    /// Samples a pixel.
    pub(crate) samples: u32,
    /// Rays into the sky a sample.
    pub(crate) sky_rays: u32,
    /// How far the sky's light can be blocked.
    pub(crate) sky_reach: f32,
    /// The share of the sky's light that is never blocked.
    pub(crate) sky_open: f32,
    /// The share of it that each ray carries.
    pub(crate) sky_share: f32,
}

impl Request {
    pub(crate) fn new(stage: &Stage, settings: &RenderSettings) -> Self {
        let sky_rays = if settings.tree.shadows { settings.ambient_rays_per_sample() } else { 0 };
        let size = stage.bounds().size();
        let diagonal = if stage.bounds().is_empty() { 0.0 } else { size.length() };
        Self {
            tree: settings.tree,
            samples: settings.samples.max(1),
            sky_rays,
            sky_reach: AMBIENT_REACH * diagonal,
            sky_open: if sky_rays == 0 { 1.0 } else { BOUNCED },
            sky_share: if sky_rays == 0 { 0.0 } else { (1.0 - BOUNCED) / sky_rays as f32 },
        }
    }

    pub(crate) fn words(&self) -> [u32; WORDS] {
        let flag = |is_set: bool, flag: u32| if is_set { flag } else { 0 };
        let tree = &self.tree;
        let mut words = [0; WORDS];
        words[..8].copy_from_slice(&[
            tree.bounces,
            flag(tree.shadows, 1) | flag(tree.reflections, 2) | flag(tree.refractions, 4),
            tree.smallest_weight.to_bits(),
            self.samples,
            self.sky_rays,
            self.sky_reach.to_bits(),
            self.sky_open.to_bits(),
            self.sky_share.to_bits(),
        ]);
        words
    }

    /// The most rays that a stack holds which takes the last one first, with `lights` lights: at each depth one refracted
    /// ray waits, and the rays of one place come on top.
    pub(crate) fn most_waiting(&self, lights: usize) -> usize {
        self.tree.bounces as usize + lights + self.sky_rays as usize + 2
    }
}
