//! The knobs of a builder.

use crate::BuildError;
use crate::bvh::MAX_DEPTH;

/// Which child comes first where exactly one of two children is a leaf.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LeafOrder {
    /// As the split made them, the lower side of the axis first; after reinsertion the smaller child first.
    #[default]
    Split,
    /// The leaf first: the "leaf-left trick" of the blog of 2022, by which neighbouring GPU lanes meet their
    /// leaves at the same place of the loop.
    Left,
}

impl LeafOrder {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] = &[("split", Self::Split), ("left", Self::Left)];
}

/// What makes the tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Builder {
    /// The surface area heuristic at planes between bins (Wald 2007): fast.
    #[default]
    BinnedSah,
    /// The surface area heuristic at every centre: a little better, some times slower.
    SweepSah,
    /// Object and spatial splits (Stich et al. 2009): triangles that straddle a plane may go to both sides, which
    /// makes smaller boxes at the cost of references.
    Sbvh,
}

impl Builder {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] =
        &[("binned", Self::BinnedSah), ("sweep", Self::SweepSah), ("sbvh", Self::Sbvh)];
}

/// The options of a builder of binary BVHs.
///
/// ```
/// use ropewalk::{BuildOptions, Builder};
/// let small_leaves = BuildOptions { max_leaf: 1, ..BuildOptions::default() };
/// let for_a_building = BuildOptions { builder: Builder::Sbvh, reinsertion: 2, ..BuildOptions::default() };
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildOptions {
    /// What makes the tree.
    pub builder: Builder,
    /// The most triangles in a leaf, 1 to 255.
    pub max_leaf: u32,
    /// The depth that no leaf exceeds, 1 to [`MAX_DEPTH`]; it is kept even where a leaf must grow for it.
    pub max_depth: u32,
    /// Candidate planes an axis, 2 to 32: of the binned builder, and of the spatial splits of the SBVH. The sweep
    /// builder tries every plane.
    pub bins: u32,
    /// The most references that spatial splits may add, in percent of the triangles, 0 to 400. Only the SBVH
    /// builder makes any.
    pub duplication: u32,
    /// Rounds of reinsertion (Meister and Bittner 2018) after the build, 0 to 32: each moves subtrees to where they
    /// make the boxes above them smaller.
    pub reinsertion: u32,
    /// Which child comes first.
    pub leaf_order: LeafOrder,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            builder: Builder::BinnedSah,
            max_leaf: 4,
            max_depth: 48,
            bins: 16,
            duplication: 50,
            reinsertion: 0,
            leaf_order: LeafOrder::Split,
        }
    }
}

impl BuildOptions {
    /// The most bins an axis.
    pub const MAX_BINS: usize = 32;
    /// The most that spatial splits may be allowed to add, in percent of the triangles.
    pub const MAX_DUPLICATION: u32 = 400;
    /// The most rounds of reinsertion.
    pub const MAX_REINSERTION: u32 = 32;

    pub(super) fn check(&self) -> Result<(), BuildError> {
        let range = |option, value: u32, smallest, largest| {
            if (smallest..=largest).contains(&value) {
                return Ok(());
            }
            let [value, smallest, largest] = [value, smallest, largest].map(|number| number as usize);
            Err(BuildError::Option { option, value, smallest, largest })
        };
        range("max-leaf", self.max_leaf, 1, 255)?;
        range("max-depth", self.max_depth, 1, MAX_DEPTH)?;
        range("bins", self.bins, 2, Self::MAX_BINS as u32)?;
        range("duplication", self.duplication, 0, Self::MAX_DUPLICATION)?;
        range("reinsertion", self.reinsertion, 0, Self::MAX_REINSERTION)
    }
}
