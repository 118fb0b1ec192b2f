//! The knobs of a wide BVH.

use crate::bvh::BuildOptions;

/// Children a node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Width {
    /// Four.
    Four,
    /// Eight.
    #[default]
    Eight,
}

impl Width {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] = &[("4", Self::Four), ("8", Self::Eight)];

    /// The number.
    #[must_use]
    pub const fn children(self) -> usize {
        match self {
            Self::Four => 4,
            Self::Eight => 8,
        }
    }
}

/// How a binary tree becomes a wide one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Collapse {
    /// The child with the largest area is replaced by its own children while there is room: greedy.
    #[default]
    Area,
    /// The cuts of the binary tree by which the surface area heuristic expects the least cost (Wald, Benthin, Boulos
    /// 2008; Ylitie, Karras, Laine 2017).
    Sah,
}

impl Collapse {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] = &[("area", Self::Area), ("sah", Self::Sah)];
}

/// The options of a wide BVH.
///
/// ```
/// use ropewalk::WideOptions;
/// use ropewalk::wide_bvh::{Collapse, Width};
/// let four = WideOptions { width: Width::Four, collapse: Collapse::Sah, ..WideOptions::default() };
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WideOptions {
    /// Children a node.
    pub width: Width,
    /// How the binary tree is collapsed.
    pub collapse: Collapse,
    /// How the binary tree is built.
    pub build: BuildOptions,
}
