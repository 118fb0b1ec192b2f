//! kd-trees: planes across the axes split the scene's box into cells, and each leaf names the triangles of its cell.
//!
//! 8 bytes a node ([`KdNode`], Wald 2004), 4 a reference, 48 a triangle, each triangle once.
//!
//! | file | concept |
//! |---|---|
//! | `node` | 8 bytes |
//! | `options` | the knobs of the builder |
//! | `build` | the surface area heuristic in O(n log n), with perfect splits |
//! | `places` | of each node its parent and its cell; made when first asked for |
//! | `ropes` | of each leaf what lies beyond its six faces; made when first asked for |
//! | `validate`, `report` | the rules of the structure, and what came of a build |
//! | `walk` | the ways through it, a file each |
//! | `trace` | one ray or many |
//!
//! **Invariants** of every [`KdTree`], kept by the builder and checked by [`KdTree::validate`]: nodes lie in depth-first
//! order, the lower child beside its parent; a plane lies in the cell that it splits; no leaf is deeper than [`MAX_DEPTH`],
//! so that no walk's stack or trail can overflow; the leaves' references lie in the order of the leaves; no leaf names a
//! triangle twice; and **a triangle is in each leaf whose cell its box overlaps**. One that only ends at a plane is below
//! it, one that begins there above it, one that lies in it on one of the two sides.
//!
//! **Why boxes, and not the triangles themselves.** The contract of [`crate::triangle`] is that a ray has the same hit, to
//! the bit, in every structure. A hit's `t` is moved into the interval in which the ray is in the triangle's own box, and may
//! be any `t` of that interval: where a ray runs along the triangle's plane, it is noise. So at each such `t` some leaf that
//! names the triangle must be open to the ray, and it is:
//!
//! > A cell's interval is the padded slab test of the cell's box, computed plane by plane on the way down. Let `t` lie in the
//! > padded interval of a box, and cut the box by a plane. Then `t` lies in the padded interval of one of the parts: both
//! > compute where the ray meets the plane, the near part with the origin that puts it later, the far part with the one that
//! > puts it earlier, or with the same one. By induction over the planes on the way down, `t` lies in the interval of a
//! > leaf's cell cut with the triangle's box, and so in the interval of the cell.
//!
//! Culling is closed, so what has been found culls no cell in which a hit as near may lie. With the parts of triangles
//! that lie in a cell there is no such rule: see [`crate::bvh`]'s spatial splits, where that lost hits.

mod build;
mod cells;
mod node;
mod options;
mod places;
mod report;
mod ropes;
mod trace;
mod validate;
pub mod walk;

pub use node::KdNode;
pub use options::{Depth, KdOptions};
pub use places::KdPlace;
pub use ropes::OUTSIDE;

use crate::{Aabb, BuildError, BuildReport, FlatTriangle, Monitor, NoMonitor, Scene, ValidationError};
use std::sync::OnceLock;

/// The deepest leaf that a tree may have, the root being at depth 0. A trail of 64 bits leads there.
pub const MAX_DEPTH: u32 = 60;

/// A kd-tree over the triangles of a scene.
///
/// ```
/// use ropewalk::{KdOptions, Mesh, Ray, Scene, glam::Vec3};
/// let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
/// let tree = Scene::from_mesh(mesh).build_kd(&KdOptions::default())?;
/// let hit = tree.closest(&Ray::new(Vec3::new(0.2, 0.3, 5.0), -Vec3::Z));
/// assert_eq!((hit.t, hit.primitive_index), (5.0, 0));
/// # Ok::<(), ropewalk::BuildError>(())
/// ```
#[derive(Clone, Debug)]
pub struct KdTree {
    nodes: Vec<KdNode>,
    references: Vec<u32>,
    triangles: Vec<FlatTriangle>,
    bounds: Aabb,
    /// How many references are passive.
    passive: usize,
    report: BuildReport,
    places: OnceLock<Vec<KdPlace>>,
    ropes: OnceLock<Vec<[u32; 6]>>,
}

impl KdTree {
    /// Takes nodes, references and triangles that were made elsewhere. The root's cell is the box around the triangles.
    ///
    /// # Errors
    /// When they break a rule of the structure.
    pub fn from_parts(
        nodes: Vec<KdNode>,
        references: Vec<u32>,
        triangles: Vec<FlatTriangle>,
    ) -> Result<Self, ValidationError> {
        let bounds = triangles.iter().fold(Aabb::EMPTY, |bounds, it| bounds.union(it.triangle().bounds()));
        validate::validate(&nodes, &references, &triangles, &bounds)?;
        let passive = report::count_passive(&nodes, &references, &triangles, &bounds);
        Ok(Self::assemble(nodes, references, triangles, bounds, passive))
    }

    /// Puts valid parts together, and measures them.
    fn assemble(
        nodes: Vec<KdNode>,
        references: Vec<u32>,
        triangles: Vec<FlatTriangle>,
        bounds: Aabb,
        passive: usize,
    ) -> Self {
        let report = report::measure(&nodes, &references, &triangles, &bounds);
        let (places, ropes) = (OnceLock::new(), OnceLock::new());
        Self { nodes, references, triangles, bounds, passive, report, places, ropes }
    }

    /// The nodes, in depth-first order; none when there are no triangles.
    #[must_use]
    pub fn nodes(&self) -> &[KdNode] {
        &self.nodes
    }

    /// The triangles of the leaves, by index, leaf after leaf.
    #[must_use]
    pub fn references(&self) -> &[u32] {
        &self.references
    }

    /// The triangles, in the order of [`Scene::flatten`].
    #[must_use]
    pub fn triangles(&self) -> &[FlatTriangle] {
        &self.triangles
    }

    /// How the tree was built, and what came of it. `references` counts those of all leaves, and `bytes` leaves out what is
    /// made when it is first asked for.
    #[must_use]
    pub const fn report(&self) -> &BuildReport {
        &self.report
    }

    /// How many references name a triangle of which only the box overlaps the leaf's cell: the price of exactness.
    #[must_use]
    pub const fn passive_references(&self) -> usize {
        self.passive
    }

    /// Whether some triangle stands in more than one leaf.
    #[must_use]
    pub const fn has_repeats(&self) -> bool {
        self.report.references > self.report.triangles
    }

    /// The box around everything.
    #[must_use]
    pub const fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The parent and the cell of each node. Worked out when it is first asked for, 32 bytes a node.
    #[must_use]
    pub fn places(&self) -> &[KdPlace] {
        self.places.get_or_init(|| places::places(&self.nodes, &self.bounds))
    }

    /// What lies beyond the faces of each leaf, in the order of the leaves: -x, +x, -y, +y, -z, +z, a node or [`OUTSIDE`].
    /// Worked out when it is first asked for, 24 bytes a leaf.
    #[must_use]
    pub fn ropes(&self) -> &[[u32; 6]] {
        self.ropes.get_or_init(|| ropes::ropes(&self.nodes, self.places()))
    }

    /// Checks every rule of the structure.
    ///
    /// # Errors
    /// Names the first node that breaks one.
    pub fn validate(&self) -> Result<(), ValidationError> {
        validate::validate(&self.nodes, &self.references, &self.triangles, &self.bounds)
    }
}

impl Scene {
    /// Builds a kd-tree over all instances.
    ///
    /// # Errors
    /// When the scene or an option is out of range.
    pub fn build_kd(&self, options: &KdOptions) -> Result<KdTree, BuildError> {
        self.build_kd_monitored(options, &NoMonitor)
    }

    /// Builds a kd-tree over all instances, under the eyes of a monitor that may cancel it.
    ///
    /// # Errors
    /// When the scene or an option is out of range, or the monitor cancels.
    pub fn build_kd_monitored(
        &self,
        options: &KdOptions,
        monitor: &dyn Monitor,
    ) -> Result<KdTree, BuildError> {
        build::build(self, options, monitor)
    }
}
