//! Binary bounding volume hierarchies: [`Node`], builders, validation, walks.
//!
//! 32 bytes a node and 48 a triangle; with leaves of up to 4 triangles about 70 bytes a triangle in all.
//!
//! **Invariants** of every [`Bvh`], kept by the builders and checked by [`Bvh::validate`]: nodes lie in
//! depth-first order with the first child beside its parent; a child's box lies in its parent's and a
//! triangle's in its leaf's; every triangle is in exactly one leaf; no leaf is deeper than [`MAX_DEPTH`], so no
//! walk's stack can overflow. With spatial splits ([`Builder::Sbvh`]) a triangle may stand in several leaves, each
//! of which holds a part of it, and all of which together cover it; its hits are still reported once.

pub(crate) mod build;
mod node;
mod refit;
mod report;
pub(crate) mod validate;
pub mod walk;

pub use build::options::{BuildOptions, Builder, LeafOrder};
pub(crate) use build::tree_over;
pub use node::Node;
pub use report::BuildReport;
pub use walk::StackOrder;

use crate::{Aabb, BuildError, FlatTriangle, Monitor, NoMonitor, Scene, ValidationError};
use std::sync::OnceLock;

/// The deepest leaf that any builder may make, the root being at depth 0. Walks have stacks of this many
/// entries: a walk postpones at most one child a level.
pub const MAX_DEPTH: u32 = 64;

/// A binary bounding volume hierarchy over the triangles of a scene.
#[derive(Clone, Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    triangles: Vec<FlatTriangle>,
    report: BuildReport,
    /// Where each node's subtree ends, for [`walk::SkipPointers`]; there when it was first asked for.
    skips: OnceLock<Vec<u32>>,
}

impl Bvh {
    /// Takes nodes and triangles that were made elsewhere.
    ///
    /// # Errors
    /// When they break a rule of the structure.
    pub fn from_parts(nodes: Vec<Node>, triangles: Vec<FlatTriangle>) -> Result<Self, ValidationError> {
        validate::validate(&nodes, &triangles)?;
        let report = BuildReport::measure(&nodes, &triangles, validate::count_distinct(&triangles));
        Ok(Self { nodes, triangles, report, skips: OnceLock::new() })
    }

    /// Takes the structure apart: nodes, triangles, report.
    pub(crate) fn into_parts(self) -> (Vec<Node>, Vec<FlatTriangle>, BuildReport) {
        (self.nodes, self.triangles, self.report)
    }

    /// The nodes, in depth-first order; none when there are no triangles.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The triangles, in the order of the leaves.
    #[must_use]
    pub fn triangles(&self) -> &[FlatTriangle] {
        &self.triangles
    }

    /// How the structure was built, and what came of it.
    #[must_use]
    pub fn report(&self) -> &BuildReport {
        &self.report
    }

    /// Where each node's subtree ends among the nodes. Worked out when it is first asked for, 4 bytes a node.
    #[must_use]
    pub fn skips(&self) -> &[u32] {
        self.skips.get_or_init(|| walk::skip_pointers(&self.nodes))
    }

    /// Whether some triangle stands in more than one leaf: see [`Builder::Sbvh`].
    #[must_use]
    pub const fn has_repeats(&self) -> bool {
        self.report.references > self.report.triangles
    }

    /// The box around everything.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, Node::bounds)
    }

    /// Checks every rule of the structure.
    ///
    /// # Errors
    /// Names the first node that breaks one.
    pub fn validate(&self) -> Result<(), ValidationError> {
        validate::validate(&self.nodes, &self.triangles)
    }
}

impl Scene {
    /// Builds a binary BVH over all instances.
    ///
    /// # Errors
    /// When the scene or an option is out of range.
    pub fn build(&self, options: &BuildOptions) -> Result<Bvh, BuildError> {
        self.build_monitored(options, &NoMonitor)
    }

    /// Builds a binary BVH over all instances, under the eyes of a monitor that may cancel it.
    ///
    /// # Errors
    /// When the scene or an option is out of range, or the monitor cancels.
    pub fn build_monitored(&self, options: &BuildOptions, monitor: &dyn Monitor) -> Result<Bvh, BuildError> {
        build::build(self, options, monitor)
    }
}
