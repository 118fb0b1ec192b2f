//! Bounding volume hierarchies of 4 or 8 children a node, collapsed from binary ones.
//!
//! A wide node is `width` places beside each other, each a [`Node`] of 32 bytes: 128 bytes a node of 4, 256 one of 8.
//! A ray that visits one tests all its children's boxes, so it makes about half the visits of a binary tree with 4
//! children, a third with 8 (ALGORITHMS: 4.4).
//!
//! **Invariants** of every [`WideBvh`], kept by the collapse and checked by [`WideBvh::validate`]: wide node 0 is the
//! root; a place holds a leaf (its `count` triangles from `link` on), or an inner node (`count` 0, `link` the index of
//! its wide node, which is larger than that of its parent), or nothing ([`is_empty`]); every wide node has a child, and
//! places that hold nothing come last; a child's box lies in its parent's, and a triangle's in its leaf's; every wide
//! node but the root is the child of one other; every triangle is in exactly one leaf; no path from the root has more
//! than [`MAX_LEVELS`] wide nodes. A scene that fits one leaf has one wide node with one child, an empty scene none.
//! Over a binary tree with spatial splits a triangle may stand in several leaves, as it does there.

mod collapse;
mod options;
mod refit;
mod report;
mod validate;
pub mod walk;

pub use options::{Collapse, WideOptions, Width};

use crate::bvh::validate::count_distinct;
use crate::bvh::{Bvh, MAX_DEPTH, Node};
use crate::clock::Clock;
use crate::{Aabb, BuildError, BuildReport, FlatTriangle, Monitor, NoMonitor, Scene, ValidationError};

/// The `link` of a place without a child: no child leads to the root.
pub const EMPTY: u32 = 0;

/// The most wide nodes on a path from the root. Each stands for at least one node of the binary path, so no collapse
/// makes more.
pub const MAX_LEVELS: u32 = MAX_DEPTH;

/// Whether a place of a wide node holds nothing. Its box means nothing; the collapse writes zeros.
#[inline(always)]
#[must_use]
pub const fn is_empty(place: &Node) -> bool {
    place.count == 0 && place.link == EMPTY
}

/// A bounding volume hierarchy of 4 or 8 children a node over the triangles of a scene.
#[derive(Clone, Debug)]
pub struct WideBvh {
    width: Width,
    children: Vec<Node>,
    triangles: Vec<FlatTriangle>,
    report: BuildReport,
    stack_entries: u32,
}

impl WideBvh {
    /// Collapses a binary tree. The report is that of the binary tree's build, with the collapse's time added to the
    /// builder's and with the sizes of the new tree.
    #[must_use]
    pub fn from_bvh(bvh: &Bvh, width: Width, how: Collapse) -> Self {
        Self::collapse(bvh.nodes(), bvh.triangles().to_vec(), bvh.report(), width, how)
    }

    /// Takes children and triangles that were made elsewhere.
    ///
    /// # Errors
    /// When they break a rule of the structure.
    pub fn from_parts(
        width: Width,
        children: Vec<Node>,
        triangles: Vec<FlatTriangle>,
    ) -> Result<Self, ValidationError> {
        validate::validate(width, &children, &triangles)?;
        let report = BuildReport { triangles: count_distinct(&triangles), ..BuildReport::default() };
        Ok(Self::measured(width, children, triangles, report))
    }

    fn collapse(
        nodes: &[Node],
        triangles: Vec<FlatTriangle>,
        binary: &BuildReport,
        width: Width,
        how: Collapse,
    ) -> Self {
        let clock = Clock::start();
        let children = collapse::collapse(nodes, width, how);
        let mut this = Self::measured(width, children, triangles, *binary);
        this.report.build_time += clock.elapsed();
        this
    }

    /// Of a valid tree: takes the input, the times and the number of different triangles from `report`, and measures the
    /// rest.
    fn measured(
        width: Width,
        children: Vec<Node>,
        triangles: Vec<FlatTriangle>,
        report: BuildReport,
    ) -> Self {
        let (report, stack_entries) = report::measure(width, &children, &triangles, report);
        Self { width, children, triangles, report, stack_entries }
    }

    /// Children a node.
    #[must_use]
    pub const fn width(&self) -> Width {
        self.width
    }

    /// The children of all wide nodes: those of wide node `i` are `width` from `i * width` on.
    #[must_use]
    pub fn children(&self) -> &[Node] {
        &self.children
    }

    /// The triangles, in the order of the leaves.
    #[must_use]
    pub fn triangles(&self) -> &[FlatTriangle] {
        &self.triangles
    }

    /// How the structure was built, and what came of it. Here `nodes` counts wide nodes and leaves, and `depth` the
    /// wide nodes from the root to the deepest leaf.
    #[must_use]
    pub fn report(&self) -> &BuildReport {
        &self.report
    }

    /// The most entries that the stack of a walk can hold: the largest sum, over the nodes on a path from the root
    /// down, of their children but one.
    #[must_use]
    pub const fn stack_entries(&self) -> u32 {
        self.stack_entries
    }

    /// Whether some triangle stands in more than one leaf: see [`crate::Builder::Sbvh`].
    #[must_use]
    pub const fn has_repeats(&self) -> bool {
        self.report.references > self.report.triangles
    }

    /// The box around everything.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.children.get(..self.width.children()).map_or(Aabb::EMPTY, bounds_of)
    }

    /// Checks every rule of the structure.
    ///
    /// # Errors
    /// Names the first wide node that breaks one.
    pub fn validate(&self) -> Result<(), ValidationError> {
        validate::validate(self.width, &self.children, &self.triangles)
    }
}

/// The box around the children of a wide node.
fn bounds_of(children: &[Node]) -> Aabb {
    children.iter().filter(|child| !is_empty(child)).map(Node::bounds).fold(Aabb::EMPTY, Aabb::union)
}

impl Scene {
    /// Builds a wide BVH over all instances.
    ///
    /// # Errors
    /// When the scene or an option is out of range.
    pub fn build_wide(&self, options: &WideOptions) -> Result<WideBvh, BuildError> {
        self.build_wide_monitored(options, &NoMonitor)
    }

    /// Builds a wide BVH over all instances, under the eyes of a monitor that may cancel the build of the binary tree
    /// that it is collapsed from.
    ///
    /// # Errors
    /// When the scene or an option is out of range, or the monitor cancels.
    pub fn build_wide_monitored(
        &self,
        options: &WideOptions,
        monitor: &dyn Monitor,
    ) -> Result<WideBvh, BuildError> {
        let (nodes, triangles, report) = self.build_monitored(&options.build, monitor)?.into_parts();
        Ok(WideBvh::collapse(&nodes, triangles, &report, options.width, options.collapse))
    }
}
