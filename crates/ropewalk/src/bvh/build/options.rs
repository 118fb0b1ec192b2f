//! The knobs of a builder.

use crate::BuildError;
use crate::bvh::MAX_DEPTH;

/// Which child comes first where exactly one of two children is a leaf.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LeafOrder {
    /// As the split made them: the lower side of the axis first.
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

/// The options of the binned SAH builder.
///
/// ```
/// use ropewalk::BuildOptions;
/// let small_leaves = BuildOptions { max_leaf: 1, ..BuildOptions::default() };
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildOptions {
    /// The most triangles in a leaf, 1 to 255.
    pub max_leaf: u32,
    /// The depth that no leaf exceeds, 1 to [`MAX_DEPTH`]; it is kept even where a leaf must grow for it.
    pub max_depth: u32,
    /// Candidate planes an axis, 2 to 32.
    pub bins: u32,
    /// Which child comes first.
    pub leaf_order: LeafOrder,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self { max_leaf: 4, max_depth: 48, bins: 16, leaf_order: LeafOrder::Split }
    }
}

impl BuildOptions {
    /// The most bins an axis.
    pub const MAX_BINS: usize = 32;

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
        range("bins", self.bins, 2, Self::MAX_BINS as u32)
    }
}
