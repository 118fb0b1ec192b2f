//! The knobs of the binned builder.

use super::bins::MAX_BINS;
use crate::BuildError;
use crate::bvh8::build::draft::Costs;
use crate::bvh8::tree::LARGEST_LEAF;

/// What the binned builder weighs, and how finely.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BinnedOptions {
    /// Candidate planes an axis, and one: 2 to 32.
    pub(crate) bins: u32,
    /// The most triangles in a leaf, 1 to 8.
    pub(crate) max_leaf: u32,
    /// A range of so many triangles is not split further, 1 to `max_leaf`.
    pub(crate) smallest_split: u32,
    /// What the visit of a node costs, whatever its children, 1 to 1000: relative to the two below.
    pub(crate) node_cost: u32,
    /// What the visit of a leaf costs, 1 to 1000.
    pub(crate) leaf_cost: u32,
    /// What a triangle adds to that, 0 to 1000.
    pub(crate) triangle_cost: u32,
}

impl BinnedOptions {
    /// Good trees in little time.
    pub(crate) const BALANCED: Self =
        Self { bins: 32, max_leaf: 8, smallest_split: 4, node_cost: 10, leaf_cost: 10, triangle_cost: 0 };
    /// Fewer planes, and leaves that are taken as they come.
    pub(crate) const FAST: Self = Self { bins: 16, max_leaf: 8, smallest_split: 8, ..Self::BALANCED };

    /// Balanced, with leaves of up to eight where one costs less than a node: half as many nodes.
    pub(crate) const COMPACT: Self = Self { max_leaf: 8, smallest_split: 4, ..Self::BALANCED };

    pub(super) fn check(&self) -> Result<(), BuildError> {
        let range = |option, value: u32, smallest, largest: u32| {
            if (smallest..=largest).contains(&value) {
                return Ok(());
            }
            let [value, smallest, largest] = [value, smallest, largest].map(|number| number as usize);
            Err(BuildError::Option { option, value, smallest, largest })
        };
        range("bins", self.bins, 2, MAX_BINS as u32)?;
        range("max-leaf", self.max_leaf, 1, LARGEST_LEAF)?;
        range("smallest-split", self.smallest_split, 1, self.max_leaf)?;
        range("node-cost", self.node_cost, 1, 1000)?;
        range("leaf-cost", self.leaf_cost, 1, 1000)?;
        range("triangle-cost", self.triangle_cost, 0, 1000)
    }

    pub(super) fn costs(&self) -> Costs {
        let [node, leaf, triangle] =
            [self.node_cost, self.leaf_cost, self.triangle_cost].map(|cost| cost as f32);
        Costs::new(node, leaf, triangle, self.max_leaf)
    }
}
