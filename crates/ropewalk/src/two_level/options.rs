//! What a two-level structure is made of.

use crate::BuildError;
use crate::bvh::BuildOptions;
use crate::kd_tree::KdOptions;
use crate::traversal_list::ListOptions;
use crate::wide_bvh::WideOptions;

/// What is built over the triangles of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BottomSpec {
    /// A kd-tree: the paper's choice.
    KdTree(KdOptions),
    /// A binary BVH.
    Bvh(BuildOptions),
    /// A BVH of 4 or 8 children a node.
    WideBvh(WideOptions),
    /// Traversal lists.
    List(ListOptions),
}

impl Default for BottomSpec {
    fn default() -> Self {
        Self::KdTree(KdOptions::default())
    }
}

impl BottomSpec {
    /// Whether triangles have one side.
    #[must_use]
    pub const fn is_one_sided(&self) -> bool {
        match self {
            Self::KdTree(_) | Self::Bvh(_) | Self::WideBvh(_) => false,
            Self::List(options) => options.is_one_sided(),
        }
    }
}

/// Which objects have which bottom structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bottoms {
    /// All the same.
    Each(BottomSpec),
    /// Kd-tree, BVH, SBVH, wide BVH, list, and again from the first, object after object: for tests, and to show that
    /// they mix.
    Mixed,
}

impl Bottoms {
    /// What an object gets.
    #[must_use]
    pub fn of(self, object: usize) -> BottomSpec {
        match self {
            Self::Each(bottom) => bottom,
            Self::Mixed => match object % 5 {
                0 => BottomSpec::default(),
                1 => BottomSpec::Bvh(BuildOptions::default()),
                2 => {
                    BottomSpec::Bvh(BuildOptions { builder: crate::Builder::Sbvh, ..BuildOptions::default() })
                }
                3 => BottomSpec::WideBvh(WideOptions::default()),
                _ => BottomSpec::List(ListOptions::default()),
            },
        }
    }
}

/// Whether the top level sees parts of large objects, which it finds in their own trees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Opening {
    /// Each instance is one entry of the top level.
    #[default]
    Never,
    /// What is worth most is opened first (partial re-braiding: Benthin et al. 2017), until there are so many entries for each
    /// instance on the average.
    ByCost(u32),
    /// Each instance that is as large as a quarter of the scene is opened into so many parts, whether that helps or not (Reichl
    /// et al. 2010, section 5.3).
    Blindly(u32),
}

impl Opening {
    /// The least and the most parts.
    pub const PARTS: [u32; 2] = [2, 64];
}

/// The settings of a two-level structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoLevelOptions {
    /// What is built over each object.
    pub bottoms: Bottoms,
    /// Whether an object's structure lies in the frame of its oriented box, where that box is smaller.
    pub oriented: bool,
    /// Whether large objects are opened. Kd-trees and binary BVHs can be; other objects stay whole.
    pub opening: Opening,
}

impl Default for TwoLevelOptions {
    /// The paper's choice: kd-trees, in oriented boxes.
    fn default() -> Self {
        Self { bottoms: Bottoms::Each(BottomSpec::default()), oriented: true, opening: Opening::Never }
    }
}

impl TwoLevelOptions {
    /// Refuses what is out of range. The objects' options are checked when their structures are built.
    pub(super) fn check(&self) -> Result<(), BuildError> {
        let [smallest, largest] = Opening::PARTS;
        match self.opening {
            Opening::ByCost(parts) | Opening::Blindly(parts) if !(smallest..=largest).contains(&parts) => {
                let [value, smallest, largest] = [parts, smallest, largest].map(|number| number as usize);
                Err(BuildError::Option { option: "parts", value, smallest, largest })
            }
            _ => Ok(()),
        }
    }

    /// Whether triangles have one side.
    #[must_use]
    pub const fn is_one_sided(&self) -> bool {
        match &self.bottoms {
            Bottoms::Each(bottom) => bottom.is_one_sided(),
            Bottoms::Mixed => false,
        }
    }
}
