//! The top level: a binary BVH over boxes, exactly one entry a leaf, for hierarchies that follow every frame.
//!
//! An entry is a box and its place in the list of boxes that was given; what stands behind it is the caller's business.
//!
//! **Invariants**, checked by [`TopLevel::validate`]: `2 n - 1` nodes of 32 bytes for `n` entries, in depth-first order, the
//! first child beside its parent; each entry in exactly one leaf, [`Node::leaf`] with the entry as `link` and 1 as `count`; a
//! child's box in its parent's; no leaf deeper than [`MAX_DEPTH`]. The same boxes make the same tree, for any number of
//! threads, and whatever the structure held before.
//!
//! **Three ways to follow a scene.** [`TopLevel::rebuild`] builds from scratch, [`TopLevel::refit`] moves the boxes of the tree as
//! it is, and [`TopLevel::restructure`] builds those subtrees anew that refitting has made bad. All three work in memory that is
//! kept: once warm, they allocate nothing. What they change adds up to a list of ranges, for partial uploads
//! ([`TopLevel::changed`]).
//!
//! **Expected and measured.** A build costs `n log n`: some 15 ns an entry and level while nodes are large (`build`), 25 ns below 256
//! entries, where every plane is weighed, and next to nothing below five, where the best tree is written at once (`few`). The
//! targets were 0.35 ms for 1,000 entries and 5 ms for 10,000; tinybvh takes 0.31 to 0.45 and 4.2 to 4.7, Embree 0.44 to 0.75 and 3.4 to 7,
//! both with the transforms set. Measured on 2026-11-22 on an AMD EPYC (family 26), one thread, other boxes in each build or refit.
//! Cost and drift are by the surface area heuristic; the sweep is [`crate::Builder::SweepSah`] with leaves of one, over the same boxes:
//!
//! | boxes | entries | rebuild | refit | cost | sweep's cost |
//! |---|---|---|---|---|---|
//! | of like sizes | 100 | 0.012 ms | 0.001 ms | 10.96 | 10.97 |
//! | | 1,000 | 0.17 ms | 0.012 ms | 30.26 | 30.20 |
//! | | 10,000 | 2.3 ms | 0.14 ms | 73.64 | 73.54 |
//! | | 100,000 | 28 ms | 1.6 ms | 169.2 | 168.9 |
//! | of very different sizes | 1,000 | 0.17 ms | 0.012 ms | 34.28 | 34.68 |
//! | | 10,000 | 2.4 ms | 0.13 ms | 195.0 | 196.3 |
//! | | 100,000 | 29 ms | 1.6 ms | 1477 | 1490 |
//! | on a plain, one of 100 large | 1,000 | 0.17 ms | 0.013 ms | 17.13 | 16.66 |
//! | | 10,000 | 2.4 ms | 0.13 ms | 47.02 | 46.61 |
//! | | 100,000 | 29 ms | 1.6 ms | 303.7 | 289.7 |
//!
//! The sweep takes 0.75, 11 and 115 ms for that. 16 bins alone, as [`crate::Builder::BinnedSah`] has them, take 0.19, 4.3 and 46 ms, and their
//! trees cost 51.9 and 349 in the last two rows. The first refit after a build takes two to three times as long as the next ones: it
//! remembers how good the tree was.

mod build;
mod changes;
mod cost;
mod few;
mod open;
mod refit;
mod restructure;
#[cfg(test)]
mod tests;
mod validate;

pub use open::{OpenEntry, Openable, rebraid, subdivide};
pub use restructure::Restructuring;

use crate::bvh::Node;
use crate::bvh::build::reference::Reference;
use crate::{Aabb, ValidationError};
use bytemuck::Zeroable;
use changes::Changes;
use restructure::Measure;
use std::ops::Range;
use thiserror::Error;

/// The deepest leaf, the root being at depth 0: less than the stacks of all walks hold ([`crate::bvh::MAX_DEPTH`]) and than the
/// registers of restart trails lead.
pub const MAX_DEPTH: u32 = 48;

/// Why a top level did not follow its boxes. It has not changed.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum TopLevelError {
    /// A box that no ray can enter, or that is everywhere.
    #[error("the box of entry {entry} is empty, or not finite: leave the entry out")]
    Box {
        /// The entry.
        entry: usize,
    },
    /// More entries than 32-bit links lead to.
    #[error("there are {entries} entries, and {limit} at most can be addressed: split the scene")]
    TooMany {
        /// How many there are.
        entries: usize,
        /// How many there may be.
        limit: usize,
    },
    /// Entries have come or gone, which refitting cannot follow.
    #[error("the top level was built over {was} boxes, and {is} were given: rebuild it")]
    OtherCount {
        /// How many there were.
        was: usize,
        /// How many there are.
        is: usize,
    },
}

/// A binary BVH with one entry a leaf.
///
/// ```
/// use ropewalk::{Aabb, glam::Vec3, two_level::TopLevel};
/// let unit_at = |x: f32| Aabb::new(Vec3::X * x, Vec3::X * x + 1.0);
/// let mut top = TopLevel::build(&[unit_at(0.0), unit_at(4.0), unit_at(2.0)])?;
/// assert_eq!(top.nodes().len(), 5);
/// top.refit(&[unit_at(0.5), unit_at(4.0), unit_at(2.0)])?;
/// assert_eq!(top.bounds(), Aabb::new(Vec3::X * 0.5, Vec3::new(5.0, 1.0, 1.0)));
/// # Ok::<(), ropewalk::two_level::top_level::TopLevelError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct TopLevel {
    nodes: Vec<Node>,
    /// The cost when the whole was built.
    built_cost: f64,
    /// Of each node the efficiency when it was built, once that was asked for: see [`restructure`].
    built_efficiency: Vec<f32>,
    changes: Changes,
    /// Room to work in.
    references: Vec<Reference>,
    measures: Vec<Measure>,
    rebuilt: Vec<Node>,
}

impl TopLevel {
    /// What building everything has to save, as a part of the cost, to be worth it: see [`TopLevel::restructure`].
    pub const TOLERANCE: f32 = 0.05;
    /// The most entries.
    pub const ENTRY_LIMIT: usize = 1 << 31;

    /// Builds over boxes; entry `i` is box `i`. None make an empty structure without nodes.
    ///
    /// # Errors
    /// When a box is empty or not finite, or there are too many.
    pub fn build(boxes: &[Aabb]) -> Result<Self, TopLevelError> {
        let mut top = Self::default();
        top.rebuild(boxes)?;
        Ok(top)
    }

    /// Builds from scratch, over any number of boxes, in the memory that is there.
    ///
    /// # Errors
    /// When a box is empty or not finite, or there are too many. Then nothing has changed.
    pub fn rebuild(&mut self, boxes: &[Aabb]) -> Result<(), TopLevelError> {
        if boxes.len() > Self::ENTRY_LIMIT {
            return Err(TopLevelError::TooMany { entries: boxes.len(), limit: Self::ENTRY_LIMIT });
        }
        let part = build::refer_to(boxes, &mut self.references)?;
        self.nodes.resize((2 * boxes.len()).saturating_sub(1), Node::zeroed());
        if !boxes.is_empty() {
            build::build(&mut self.nodes, 0, &mut self.references, &part, 0);
        }
        self.built_cost = self.cost();
        self.built_efficiency.clear();
        self.changes.set_all(self.nodes.len());
        Ok(())
    }

    /// The nodes, in depth-first order; none when there are no entries.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The number of entries.
    #[must_use]
    pub fn entries(&self) -> usize {
        self.nodes.len().div_ceil(2)
    }

    /// The box around everything.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, Node::bounds)
    }

    /// The depth of the deepest leaf; the root's is 0.
    #[must_use]
    pub fn depth(&self) -> u32 {
        cost::depth(&self.nodes)
    }

    /// What a random ray that meets the root's box is expected to cost by the surface area heuristic: 1 for the boxes of a
    /// node's two children, 1 for an entry.
    #[must_use]
    pub fn cost(&self) -> f64 {
        cost::of(&self.nodes)
    }

    /// The cost when the whole was built the last time.
    #[must_use]
    pub const fn built_cost(&self) -> f64 {
        self.built_cost
    }

    /// How many times the cost is what it was when the whole was built: 1 just after that, and for an empty structure.
    #[must_use]
    pub fn drift(&self) -> f64 {
        if self.built_cost > 0.0 { self.cost() / self.built_cost } else { 1.0 }
    }

    /// The ranges of nodes that have changed since [`TopLevel::forget_changes`], in order and apart from each other. Short
    /// stretches of nodes that have not changed may lie in them.
    #[must_use]
    pub fn changed(&self) -> &[Range<usize>] {
        self.changes.ranges()
    }

    /// Begins a new list of changes: what was changed so far has been uploaded.
    pub fn forget_changes(&mut self) {
        self.changes.clear();
    }

    /// Checks every rule of the structure.
    ///
    /// # Errors
    /// Names the first node that breaks one.
    pub fn validate(&self) -> Result<(), ValidationError> {
        validate::validate(&self.nodes)
    }
}
