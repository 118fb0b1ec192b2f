//! Primary hits by drawing every triangle (Reichl et al. 2010, section 4.2.2).
//!
//! A picture's rays come from one eye through places of one plane, so a triangle can be asked which rays it may meet, in place
//! of a ray which triangles. What is asked at last is the same: the ray, by the walks' own test ([`ropewalk::triangle`]), so a
//! hit has the bits that a walk gives it. Two ways:
//!
//! * **By the processor** ([`software`]): every ray that a triangle might meet, rounding included, is tested against it, and the
//!   tie rule decides. So the hits are those of a walk, everywhere, to the bit.
//! * **By a graphics adapter** ([`adapter`]): its rasteriser names the nearest triangle of every pixel; the ray is tested against
//!   that one. A rasteriser snaps corners to a 256th of a pixel and keeps depths of 24 bits. Where the ray misses what was
//!   drawn it is traced, and counted; where it meets what was drawn although something else is closer, or nothing was drawn,
//!   the hit differs from the traced one: at edges, and where surfaces lie within rounding of one another. [`compare`]
//!   counts those.
//!
//! | file | concept |
//! |---|---|
//! | `drawing` | the triangles of a structure, by instance, ready to be drawn |
//! | `order` | instances from front to back |
//! | `sight` | from a frame to the picture, with bounds of all rounding |
//! | `footprint` | which pixels a triangle may touch |
//! | `software`, `tile` | drawing by the processor |
//! | `adapter` | drawing by a graphics adapter |
//! | `at_eye` | triangles on which the eye lies |
//! | `compare` | drawn against traced |
//!
//! **Holes.** A hit that a caller's filter refuses is none, as in filtered queries: the processor goes on to the next triangle,
//! behind the adapter's back the ray is traced.
//!
//! **Measured** on 2026-11-22, an AMD EPYC (family 26), 512 by 512 rays. By one thread of the processor, against one kd-tree: the robots of
//! BART (71,580 triangles) 30 ms drawn, 88 ms traced; its kitchen (110,540) 48 and 109 ms. Against two levels, where every ray must
//! be taken to every object that is drawn before it: 76 and 135 ms, 95 and 150 ms. By lavapipe, 256 by 256 rays: the robots 11 ms drawn,
//! 92 ms traced by its kernel; of 65,536 rays 9 have another hit (23 of two levels), and 13 are traced instead.
//!
//! **Cost.** Every triangle of every instance in view is looked at for every run of pixels: linear where tracing is
//! logarithmic. It pays for the up to some 100,000 triangles of the paper, not for millions.

mod adapter;
mod at_eye;
mod compare;
mod drawing;
mod footprint;
mod order;
mod sight;
mod software;
#[cfg(test)]
mod tests;
mod tile;

pub use compare::{PrimaryComparison, PrimaryTime};
pub(crate) use drawing::Drawing;

use crate::camera::Pinhole;
use glam::Vec2;
use ropewalk::{Hit, Ray, Status};
use std::ops::Range;

/// Says of a hit that the surface has a hole there.
pub(crate) type Holes<'a> = dyn Fn(&Ray, &Hit) -> bool + Sync + 'a;

/// The primary rays of a run of pixels.
pub(crate) struct Request<'a> {
    /// The camera of which they are.
    pub(crate) pinhole: &'a Pinhole,
    /// Pixels in a row of the picture.
    pub(crate) width: u32,
    /// The run, from the top left.
    pub(crate) pixels: Range<usize>,
    /// Where the samples of a pixel lie, from its corner.
    pub(crate) subpixels: &'a [Vec2],
    /// The rays: the samples of a pixel beside each other.
    pub(crate) rays: &'a [Ray],
    /// Which hits are none.
    pub(crate) is_hole: Option<&'a Holes<'a>>,
}

/// What was found, for each ray.
#[derive(Debug)]
pub(crate) struct Rasterised {
    /// The hits.
    pub(crate) hits: Vec<Hit>,
    /// Whether they are complete.
    pub(crate) status: Vec<Status>,
    /// Rays that were traced after all.
    pub(crate) traced_instead: u64,
}

impl Request<'_> {
    /// The pixels' rows, the last one included. The run must not be empty.
    fn rows(&self) -> [u32; 2] {
        let width = self.width as usize;
        [self.pixels.start / width, (self.pixels.end - 1) / width].map(|row| row as u32)
    }

    /// The place among the rays of a pixel's first sample; `None` for a pixel outside of the run.
    fn first_sample(&self, column: u32, row: u32) -> Option<usize> {
        let pixel = row as usize * self.width as usize + column as usize;
        self.pixels.contains(&pixel).then(|| (pixel - self.pixels.start) * self.subpixels.len())
    }
}
