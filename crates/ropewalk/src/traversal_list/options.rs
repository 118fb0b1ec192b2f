//! What lists are made of and how.

use super::Reach;
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

/// Which triangles a list leaves out, because no ray of its directions can see their front.
///
/// With any but `None` the triangles have one side: rays pass through them from behind, in all lists and all walks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Cull {
    /// None: triangles have two sides.
    #[default]
    None,
    /// Those whose front no direction of the list runs against: see [`intersect_front`](crate::FlatTriangle::intersect_front).
    Exact,
    /// Those whose normal lies in the list's own set of directions, by the paper's rule: 1 of 6 instead of 1 of 9.2.
    /// **It loses hits** (ALGORITHMS: C3). It is there to be measured; it has no name and no place in the catalogue.
    AsPrinted,
}

impl Cull {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] = &[("none", Self::None), ("exact", Self::Exact)];
}

/// Where rays may begin that start on a triangle: see [`super::heads`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Heads {
    /// With the first element.
    #[default]
    Disabled,
    /// Behind what lies below the triangle's plane.
    Simple,
    /// Besides, behind what lies behind the triangle for all directions of the list.
    Regular,
}

impl Heads {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] =
        &[("disabled", Self::Disabled), ("simple", Self::Simple), ("regular", Self::Regular)];
}

/// What is known of rays that start on a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Clearance {
    /// They begin on its surface, as near as rounding puts them: what touches its plane may be hit.
    #[default]
    Surface,
    /// They begin clearly above its plane, so that they cannot hit the triangle itself nor its neighbours below: see
    /// [`super::TraversalList::polygon_starts`], which gives no heads to rays that do not.
    Above,
}

impl Clearance {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] = &[("surface", Self::Surface), ("above", Self::Above)];
}

/// Settings of [`super::TraversalList`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ListOptions {
    /// The hierarchy.
    pub source: Source,
    /// What bounds its nodes.
    pub bounds: Bounds,
    /// What spheres hold.
    pub reach: Reach,
    /// How many lists there are.
    pub directions: Directions,
    /// The order of a node's children.
    pub order: ChildOrder,
    /// Octree: a triangle whose radius is at least this share of its node's, in percent, becomes a child of the node
    /// itself. 50 visits the least elements in every scene that was tried (ALGORITHMS: T12).
    pub big: u32,
    /// What lists leave out.
    pub cull: Cull,
    /// Whether each triangle has heads of its own.
    pub heads: Heads,
    /// Where rays begin for which these heads are.
    pub clearance: Clearance,
    /// Cells a side of the screen, each with heads of its own for primary rays; 0 for none. The camera is not known when a
    /// list is built, so this is for those who know it: see [`super::TraversalList::frustum_heads`].
    pub frustum_grid: u32,
    /// The instance with which a second layer begins: those before it make the first, which is for what does not move.
    /// `None` for one layer of all.
    pub moving: Option<u32>,
}

impl Default for ListOptions {
    /// The paper's choice, with eight lists instead of six, which visit less in every scene (ALGORITHMS: 4.2).
    fn default() -> Self {
        Self {
            source: Source::Octree,
            bounds: Bounds::Sphere,
            reach: Reach::Boxes,
            directions: Directions::Eight,
            order: ChildOrder::EarliestFirst,
            big: 50,
            cull: Cull::None,
            heads: Heads::Disabled,
            clearance: Clearance::Surface,
            frustum_grid: 0,
            moving: None,
        }
    }
}

impl ListOptions {
    /// The least and the most that [`ListOptions::big`] may be.
    pub const BIG: [u32; 2] = [1, 1000];

    /// The most cells a side of the screen.
    pub const MOST_FRUSTUM_GRID: u32 = 64;

    /// The lists that visit the least elements of all that were tried: eight, of boxes over a tree with spatial splits,
    /// without what their directions cannot see, and with heads for rays that start on a triangle.
    pub const BEST: Self = Self {
        source: Source::Sbvh,
        bounds: Bounds::Aabb,
        reach: Reach::Boxes,
        directions: Directions::Eight,
        order: ChildOrder::EarliestFirst,
        big: 50,
        cull: Cull::Exact,
        heads: Heads::Regular,
        clearance: Clearance::Surface,
        frustum_grid: 0,
        moving: None,
    };

    /// The names of whole settings on the command line.
    pub const PRESETS: &[(&str, Self)] = &[("best", Self::BEST)];

    /// Refuses what is out of range.
    pub(super) fn check(&self) -> Result<(), BuildError> {
        let range = |option, value: u32, [smallest, largest]: [u32; 2]| {
            if (smallest..=largest).contains(&value) {
                return Ok(());
            }
            let [value, smallest, largest] = [value, smallest, largest].map(|number| number as usize);
            Err(BuildError::Option { option, value, smallest, largest })
        };
        range("big", self.big, Self::BIG)?;
        range("frustum-grid", self.frustum_grid, [0, Self::MOST_FRUSTUM_GRID])
    }

    /// Whether triangles have one side.
    #[must_use]
    pub const fn is_one_sided(&self) -> bool {
        !matches!(self.cull, Cull::None)
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
