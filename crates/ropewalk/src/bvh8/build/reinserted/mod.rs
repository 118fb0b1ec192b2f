//! The builder of the preset `high`: the tree of least expected cost for closest hits.
//!
//! Three steps. A binary tree is made from the top down, by object splits ([`builder`]). Subtrees then move to where they make the
//! boxes above them smaller ([`crate::bvh::build::reinsertion`]). At last the tree is collapsed to eight-wide nodes, and small subtrees to
//! leaves, where that costs least ([`collapse`]).
//!
//! Each step is the same for any number of threads, so the tree is.
//!
//! **No spatial splits**: after reinsertion cut boxes have next to nothing left to gain.
//! Measured on 2026-11-22 on an AMD EPYC (family 26), one thread, least processor time, leaves of up to 4, costs by the model
//! of [`cost`]; beside it binary trees of the binned builder and of the SBVH builder with 2 rounds, with the same collapse:
//!
//! | scene | binned | ms | SBVH | ms | 0 rounds | ms | 3 rounds | ms | and 30 percent | ms |
//! |---|---|---|---|---|---|---|---|---|---|---|
//! | bunny, 69,451 triangles | 10.42 | 25 | 10.31 | 194 | 10.40 | 12 | 10.34 | 24 | 10.34 | 60 |
//! | kitchen, 56,935 | 14.96 | 16 | 12.64 | 134 | 14.94 | 11 | 12.36 | 24 | 12.50 | 49 |
//! | the same off axis | 29.21 | 18 | 33.79 | 173 | 27.78 | 12 | 24.90 | 33 | 25.87 | 67 |
//! | dragon, 871,306 | 16.14 | 339 | 15.76 | 2321 | 16.11 | 201 | 15.86 | 383 | 15.86 | 954 |
//!
//! **Leaves of up to 8**, merged from up to 4 that the planes leave: 7 bytes a triangle fewer than with 4, and single rays 3 to 10
//! percent faster, batches 0 to 10, most off axis. Planes that leave 8 gain more there, and lose 5 percent in the kitchen (2026-11-23, AMD EPYC
//! of family 25, one thread, old and new in turn).
//!
//! The peak of memory is 81 to 99 bytes a triangle without reinsertion and 98 to 116 with it, the tree included. Parts of
//! triangles in place of parts of boxes would be worth their references off axis alone: the kitchen would cost 17.7 there,
//! 16.6 with 60 percent, and 12.5 as it stands (30 percent, 2 rounds).

pub(in crate::bvh8) mod builder;
pub(in crate::bvh8) mod collapse;
pub(in crate::bvh8) mod cost;
mod leaves;
mod object;
#[cfg(test)]
pub(in crate::bvh8) mod tests;

use crate::bvh::build::reinsertion;
use crate::bvh::{BuildOptions, MAX_DEPTH};
use crate::bvh8::tree::{LARGEST_LEAF, Tree};
use crate::processor::Processor;
use crate::{BuildError, FlatTriangle, Monitor};
use collapse::Plain;

/// The knobs of [`build_reinserted`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ReinsertedOptions {
    /// The most triangles in a leaf, 1 to 8.
    pub(crate) max_leaf: u32,
    /// So many references are not told apart by planes, 1 to `max_leaf`; the collapse merges what that leaves, where it pays.
    pub(crate) smallest_split: u32,
    /// Rounds of reinsertion, 0 to 32.
    pub(crate) reinsertion: u32,
}

impl Default for ReinsertedOptions {
    fn default() -> Self {
        Self { max_leaf: 8, smallest_split: 4, reinsertion: 3 }
    }
}

impl ReinsertedOptions {
    fn check(&self) -> Result<(), BuildError> {
        let range = |option, value: u32, smallest: u32, largest: u32| {
            if (smallest..=largest).contains(&value) {
                return Ok(());
            }
            let [value, smallest, largest] = [value, smallest, largest].map(|number| number as usize);
            Err(BuildError::Option { option, value, smallest, largest })
        };
        range("max-leaf", self.max_leaf, 1, LARGEST_LEAF)?;
        range("smallest-split", self.smallest_split, 1, self.max_leaf)?;
        range("reinsertion", self.reinsertion, 0, BuildOptions::MAX_REINSERTION)
    }
}

/// Builds the tree over triangles.
///
/// # Errors
/// When an option is out of range, or the monitor cancels.
pub(crate) fn build_reinserted(
    triangles: &[FlatTriangle],
    options: &ReinsertedOptions,
    monitor: &dyn Monitor,
) -> Result<Tree, BuildError> {
    build_at(triangles, options, monitor, Processor::detect())
}

fn build_at(
    triangles: &[FlatTriangle],
    options: &ReinsertedOptions,
    monitor: &dyn Monitor,
    processor: Processor,
) -> Result<Tree, BuildError> {
    options.check()?;
    let (mut nodes, mut order) = builder::build(triangles, options.smallest_split, monitor, processor)?;
    if options.reinsertion > 0 {
        let moves = BuildOptions {
            max_depth: MAX_DEPTH,
            reinsertion: options.reinsertion,
            ..BuildOptions::default()
        };
        nodes = reinsertion::optimise_at(&nodes, &mut order, &moves, monitor, processor)?;
    }
    Ok(collapse::collapse(&nodes, options.max_leaf, &Plain { order: &order }))
}
