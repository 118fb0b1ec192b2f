//! The kernels, compiled for the processors that matter and chosen at run time, so that a plain build is fast.

use super::bins::{Binning, Bins, Side, Split};
use super::grow::{Grower, Room};
#[cfg(target_arch = "x86_64")]
use super::lanes::Avx2;
use super::lanes::Portable;
use super::partition::partition;
use crate::bvh8::build::extent::Extent;
use crate::bvh8::build::reference::{Part, Reference};

/// What the processor can do.
#[derive(Clone, Copy, Debug)]
pub(super) enum Level {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
}

/// Runs `$body` with `$lanes` being those of the level.
macro_rules! at {
    ($level:expr, $lanes:ident => $body:expr) => {
        match $level {
            Level::Portable => {
                let $lanes = Portable;
                $body
            }
            #[cfg(target_arch = "x86_64")]
            Level::Avx2($lanes) => $lanes.run(
                #[inline(always)]
                || $body,
            ),
        }
    };
}

impl Level {
    /// All that this processor can do, the best last.
    #[cfg(test)]
    pub(super) fn all() -> Vec<Self> {
        vec![Self::Portable, Self::detect()]
    }

    /// The best that this processor can do.
    pub(super) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = Avx2::detect() {
            return Self::Avx2(avx2);
        }
        Self::Portable
    }

    /// See [`Bins::fill`].
    pub(super) fn fill(self, sets: &mut [Bins; 2], binning: &Binning, references: &[Reference]) {
        at!(self, lanes => Bins::fill(lanes, sets, binning, references));
    }

    /// See [`Bins::merge`].
    pub(super) fn merge(self, bins: &mut Bins, other: &Bins, binning: &Binning) {
        at!(self, lanes => bins.merge(lanes, other, binning.bins));
    }

    /// See [`Bins::best_split`].
    pub(super) fn best_split(self, bins: &Bins, binning: &Binning) -> Option<Split> {
        at!(self, lanes => bins.best_split(lanes, binning))
    }

    /// See [`partition`].
    pub(super) fn partition(self, references: &mut [Reference], side: Side) -> (usize, [Extent; 2]) {
        at!(self, lanes => partition(lanes, references, side))
    }

    /// See [`Grower::grow`].
    pub(super) fn grow(
        self,
        grower: &Grower,
        references: &mut [Reference],
        part: &Part,
        depth: u32,
        room: &mut Room,
    ) {
        at!(self, lanes => grower.grow(lanes, references, part, depth, room));
    }
}
