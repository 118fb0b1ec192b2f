//! The builder of the preset `fastest`: triangles are sorted along a space-filling curve, and the order is the tree.
//!
//! Four steps. Every triangle gets a Morton code from the centre of its box ([`code`]), and the codes are sorted by radix
//! ([`radix`]). The sorted list is halved at the planes of the curve down to treelets of at most 32 triangles, which make a
//! binary tree (Lauterbach et al. 2009), and of each treelet the best way to cut it into leaves is found by dynamic
//! programming ([`treelet`], [`cuts`]). At last the tree is collapsed to eight-wide nodes where that costs least, as in
//! [`super::reinserted`]; a treelet becomes a node of leaves, or leaves in the node above it.
//!
//! Measured on 2026-11-22 on an AMD EPYC (family 26), one thread, processor time, leaves of up to 4; the cost is by the model
//! of [`super::reinserted::cost`], beside that of the binned SAH builder of binary trees with the same collapse:
//!
//! | scene | ms | cost | binned: ms | cost |
//! |---|---|---|---|---|
//! | bunny, 69,451 triangles | 3.0 | 11.95 | 25 | 10.42 |
//! | kitchen, 56,935 | 2.5 | 21.37 | 16 | 14.96 |
//! | the same off axis | 3.1 | 34.92 | 18 | 29.21 |
//! | dragon, 871,306 | 82 | 18.62 | 339 | 16.14 |
//!
//! On another one (family 25), and since treelets are cut with the processor's vectors and each part of the tree is copied once
//! (2026-11-23), the three take 3.2, 2.5 and 63 ms there instead of 4.0, 3.5 and 101.
//!
//! A tree of the binned builder over the treelets instead of the curve's lowers the cost by 5 to 10 percent and takes 40
//! percent longer. Treelets of 24 cost 1 to 4 percent less and take 15 percent longer.
//!
//! Each step is the same for any number of threads, so the tree is. Beside the tree it takes 16 bytes a triangle for the
//! sort, and later 8 for the order and some 20 for the treelets: at most 72 to 79 in all, the tree included.

mod code;
mod cuts;
mod radix;
#[cfg(test)]
mod tests;
mod treelet;

use super::reinserted::collapse::collapse;
use crate::bvh8::tree::{LARGEST_LEAF, Tree};
use crate::{BuildError, FlatTriangle, Monitor};
use treelet::Treelets;

/// The knobs of [`build_morton`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MortonOptions {
    /// The most triangles in a leaf, 1 to 8.
    pub(crate) max_leaf: u32,
}

impl Default for MortonOptions {
    fn default() -> Self {
        Self { max_leaf: 4 }
    }
}

/// Builds the tree over triangles.
///
/// # Errors
/// When an option is out of range, or the monitor cancels.
pub(crate) fn build_morton(
    triangles: &[FlatTriangle],
    options: &MortonOptions,
    monitor: &dyn Monitor,
) -> Result<Tree, BuildError> {
    let max_leaf = options.max_leaf;
    if !(1..=LARGEST_LEAF).contains(&max_leaf) {
        let [value, largest] = [max_leaf, LARGEST_LEAF].map(|number| number as usize);
        return Err(BuildError::Option { option: "max-leaf", value, smallest: 1, largest });
    }
    let keys = radix::sorted(code::keys(triangles));
    if monitor.progress(0, triangles.len()).is_break() {
        return Err(BuildError::Cancelled);
    }
    let treelets = Treelets::cut(triangles, &keys, max_leaf, monitor)?;
    Ok(collapse(treelets.nodes(), max_leaf, &treelets))
}
