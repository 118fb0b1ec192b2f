//! What lists are made of and how.

use crate::{BuildError, BuildOptions, Builder};

/// The hierarchy that the lists go through depth first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Source {
    /// Groups of eight about the centre of their box (Toczek 2010, section 2.2).
    #[default]
    Octree,
    /// A binary tree by the surface area heuristic.
    Sah,
    /// A binary tree with spatial splits.
    Sbvh,
}

impl Source {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] = &[("octree", Self::Octree), ("sah", Self::Sah), ("sbvh", Self::Sbvh)];
}

/// What bounds an inner node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Bounds {
    /// A sphere.
    #[default]
    Sphere,
    /// A box with planes on a grid: see [`super::packed_box`].
    Aabb,
}

impl Bounds {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] = &[("sphere", Self::Sphere), ("aabb", Self::Aabb)];
}

/// Which child of a node comes first in a list. Both compare where children lie along the list's direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ChildOrder {
    /// The one that begins first.
    #[default]
    EarliestFirst,
    /// The one that ends first, so that the one that ends last is the last.
    LatestLast,
}

impl ChildOrder {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] =
        &[("earliest-first", Self::EarliestFirst), ("latest-last", Self::LatestLast)];
}

/// How many lists there are: into which sets the directions of rays are divided (Toczek 2010, figure 2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Directions {
    /// One list for all rays.
    One,
    /// Two: forwards and backwards along x.
    Two,
    /// Six: by the largest component of the direction.
    Six,
    /// Eight: by the signs of the three components.
    #[default]
    Eight,
}

impl Directions {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] =
        &[("1", Self::One), ("2", Self::Two), ("6", Self::Six), ("8", Self::Eight)];

    /// The number of lists.
    #[must_use]
    pub const fn lists(self) -> usize {
        match self {
            Self::One => 1,
            Self::Two => 2,
            Self::Six => 6,
            Self::Eight => 8,
        }
    }
}

/// Settings of [`super::TraversalList`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ListOptions {
    /// The hierarchy.
    pub source: Source,
    /// What bounds its nodes.
    pub bounds: Bounds,
    /// How many lists there are.
    pub directions: Directions,
    /// The order of a node's children.
    pub order: ChildOrder,
    /// Octree: a triangle whose radius is at least this share of its node's, in percent, becomes a child of the node
    /// itself. 50 visits the least elements in every scene that was tried (ALGORITHMS: T12).
    pub big: u32,
}

impl Default for ListOptions {
    /// The paper's choice, with eight lists instead of six, which visit less in every scene (ALGORITHMS: 4.2).
    fn default() -> Self {
        Self {
            source: Source::Octree,
            bounds: Bounds::Sphere,
            directions: Directions::Eight,
            order: ChildOrder::EarliestFirst,
            big: 50,
        }
    }
}

impl ListOptions {
    /// The least and the most that [`ListOptions::big`] may be.
    pub const BIG: [u32; 2] = [1, 1000];

    /// Refuses what is out of range.
    pub(super) fn check(&self) -> Result<(), BuildError> {
        let [smallest, largest] = Self::BIG;
        if (smallest..=largest).contains(&self.big) {
            return Ok(());
        }
        Err(BuildError::Option {
            option: "big",
            value: self.big as usize,
            smallest: smallest as usize,
            largest: largest as usize,
        })
    }

    /// How the binary tree is built that the lists come from, if they come from one. A list has one triangle an element,
    /// so a larger leaf would be one more node, and no cheaper.
    #[must_use]
    pub fn build_options(&self) -> Option<BuildOptions> {
        let builder = match self.source {
            Source::Octree => return None,
            Source::Sah => Builder::SweepSah,
            Source::Sbvh => Builder::Sbvh,
        };
        Some(BuildOptions { builder, max_leaf: 1, ..BuildOptions::default() })
    }
}
