//! The kernels, compiled for the processors that matter and chosen at run time, so that a plain build is fast.

use super::bins::{Binning, Bins, Side, Split};
use super::grow::{Grower, Room};
use super::lanes::Portable;
use super::partition::partition;
use crate::bvh8::build::extent::Extent;
use crate::bvh8::build::reference::{Part, Reference};
use crate::processor::Processor;

/// Runs `$body` with `$lanes` being those of the processor.
macro_rules! at {
    ($processor:expr, $lanes:ident => $body:expr) => {
        match $processor {
            Processor::Any => {
                let $lanes = Portable;
                $body
            }
            #[cfg(target_arch = "x86_64")]
            Processor::Avx2($lanes) => $lanes.run(
                #[inline(always)]
                || $body,
            ),
            #[cfg(target_arch = "x86_64")]
            Processor::Avx512(avx512) => avx512.run(
                #[inline(always)]
                || {
                    let $lanes = avx512.avx2();
                    $body
                },
            ),
        }
    };
}

impl Processor {
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
