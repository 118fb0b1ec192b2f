//! Packed bounding volume hierarchies of 8 children a node, for the CPU: walked by vectors, several rays in turn.
//!
//! The fastest way to trace on a CPU. A node is 256 bytes: the sides of eight boxes, coordinate beside coordinate, what is in
//! them, and in which order rays of each octant of directions take them (`node`); a leaf is up to eight triangles of 40 bytes right
//! behind its node (`leaf`); all lie in one piece of memory, in huge pages where there are any (`arena`). A compact tree takes
//! half of that, with nodes of 128 bytes and shared vertices (`compact`). One visit tests eight boxes, or eight triangles'
//! edges, at once (`simd`), and a batch leads 8 or 16 rays in turn, so that the misses of one hide behind the work of the others
//! (`walk`). Triangles that move are followed in place ([`Bvh8::refit`]), and instances of objects have a level of their own
//! ([`Instanced`]). After Embree (Wald et al. 2014), tinybvh (Bikker 2024) and Dietrich et al. 2007.
//!
//! **Hits are those of every other structure**, bit for bit, at every level of vector instructions: boxes are tested with the
//! operations of the scalar test, and the scalar test decides on every triangle whose edges a ray may have hit.
//!
//! **Invariants**: those of `tree`, and that every word leads to a node or a leaf of the same arena, which only `layout` and `compact` write.

#[expect(unsafe_code, reason = "nodes and leaves are read by words that packing has checked")]
mod arena;
mod blocks;
mod build;
mod compact;
mod convert;
mod instanced;
mod layout;
#[expect(unsafe_code, reason = "rows are read by the numbers of the leaf's own triangles")]
mod leaf;
mod names;
mod network;
mod node;
mod options;
mod order;
mod places;
mod refit;
mod report;
#[expect(unsafe_code, reason = "vector instructions, behind a token that proves that they are there")]
mod simd;
pub(crate) mod tree;
mod validate;
#[expect(unsafe_code, reason = "walks read nodes by words that they have read from nodes")]
mod walk;

pub use instanced::Instanced;
pub use options::{Bvh8Options, Preset};
pub use simd::SimdLevel;

use crate::bvh::Bvh;
use crate::clock::Clock;
use crate::flatten::NumberedScene;
use crate::wide_bvh::{Collapse, WideBvh, Width};
use crate::{Aabb, BuildError, BuildReport, FlatTriangle, Monitor, NoMonitor, Scene};
use arena::Arena;
use build::binned::{BinnedOptions, build_binned};
use build::morton::{MortonOptions, build_morton};
use build::reinserted::{ReinsertedOptions, build_reinserted};
use names::Names;
use node::Word;
use simd::Detected;
use tree::Tree;

/// Where every walk begins.
const ROOT: Word = Word::node(0);

const fn too_many(what: &'static str, count: usize, limit: usize) -> BuildError {
    BuildError::TooMany { what, count, limit }
}

/// A packed bounding volume hierarchy over the triangles of a scene.
#[derive(Clone, Debug)]
pub struct Bvh8 {
    arena: Arena,
    /// Where in the arena, in units of 16 bytes, each node's block begins: in the order of the memory, children after their parents. None
    /// of a compact tree.
    blocks: Vec<u32>,
    names: Names,
    form: Form,
    level: Detected,
    bounds: Aabb,
    report: BuildReport,
}

/// How a tree lies in its arena.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// Nodes of 256 bytes, and leaves that have their vertices ([`layout`]).
    Full,
    /// Nodes of 128 bytes, and leaves that name their vertices ([`compact`]).
    Compact {
        /// The first word of the vertices.
        vertices: usize,
        /// How many there are.
        count: usize,
    },
}

impl Bvh8 {
    /// Packs a wide tree; `None` for the best vector instructions that the machine has.
    ///
    /// # Errors
    /// When the tree is too deep or too large to be packed.
    pub fn from_wide(wide: &WideBvh, level: Option<SimdLevel>) -> Result<Self, BuildError> {
        let (names, numbers) = Names::of(wide.triangles())
            .ok_or_else(|| too_many("numbers of triangles", u32::MAX as usize + 1, u32::MAX as usize))?;
        let names = (names, Some(numbers.as_slice()));
        Self::pack(&convert::tree_of(wide), wide.triangles(), names, wide.report(), level)
    }

    /// Collapses and packs a binary tree; `None` for the best vector instructions that the machine has.
    ///
    /// # Errors
    /// When the tree is too deep or too large to be packed.
    pub fn from_bvh(bvh: &Bvh, level: Option<SimdLevel>) -> Result<Self, BuildError> {
        Self::from_wide(&WideBvh::from_bvh(bvh, Width::Eight, Collapse::Sah), level)
    }

    /// Takes the input, the times and the number of different triangles from `known`. Triangles whose numbers are not given have them
    /// in place of those of their primitives.
    fn pack(
        tree: &Tree,
        triangles: &[FlatTriangle],
        (names, numbers): (Names, Option<&[u32]>),
        known: &BuildReport,
        level: Option<SimdLevel>,
    ) -> Result<Self, BuildError> {
        let (report, bounds) = report::measure(tree, *known);
        if report.depth > tree::MAX_LEVELS {
            return Err(too_many("levels", report.depth as usize, tree::MAX_LEVELS as usize));
        }
        let (arena, blocks) = layout::pack(tree, triangles, numbers)
            .map_err(|bytes| too_many("bytes of a packed tree", bytes, node::LARGEST_ARENA))?;
        let bytes = arena.len() + size_of_val(blocks.as_slice()) + names.bytes();
        let report = BuildReport { bytes, ..report };
        let level = Detected::or_best(level);
        Ok(Self { arena, blocks, names, form: Form::Full, level, bounds, report })
    }

    /// The vector instructions that walks use.
    #[must_use]
    pub const fn level(&self) -> SimdLevel {
        self.level.level()
    }

    /// The same tree, walked with other vector instructions; with the best where the machine does not have them.
    #[must_use]
    pub fn at(self, level: SimdLevel) -> Self {
        Self { level: Detected::or_best(Some(level)), ..self }
    }

    /// How the structure was built, and what came of it. Here `nodes` counts nodes and leaves, `depth` the nodes from the root to
    /// the deepest leaf, and `sah_cost` 1 for a node and 1 for a leaf, whose triangles are tested at once.
    #[must_use]
    pub const fn report(&self) -> &BuildReport {
        &self.report
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

    const fn is_empty(&self) -> bool {
        self.arena.len() == 0
    }
}

impl Scene {
    /// Builds a packed tree over all instances.
    ///
    /// # Errors
    /// When the scene is out of range.
    pub fn build_packed(&self, options: &Bvh8Options) -> Result<Bvh8, BuildError> {
        self.build_packed_monitored(options, &NoMonitor)
    }

    /// Builds a packed tree over all instances, under the eyes of a monitor that may cancel it.
    ///
    /// # Errors
    /// When the scene is out of range, or the monitor cancels.
    pub fn build_packed_monitored(
        &self,
        options: &Bvh8Options,
        monitor: &dyn Monitor,
    ) -> Result<Bvh8, BuildError> {
        let clock = Clock::start();
        let NumberedScene { triangles, left_out, report: input } = self.flatten_numbered()?;
        let flatten_time = clock.elapsed();
        let clock = Clock::start();
        let tree = match options.preset {
            Preset::Fastest => build_morton(&triangles, &MortonOptions::default(), monitor)?,
            Preset::Fast => build_binned(&triangles, &BinnedOptions::FAST, monitor)?,
            Preset::Balanced => build_binned(&triangles, &BinnedOptions::BALANCED, monitor)?,
            Preset::High => build_reinserted(&triangles, &ReinsertedOptions::default(), monitor)?,
            Preset::Compact => build_binned(&triangles, &BinnedOptions::COMPACT, monitor)?,
        };
        let known = BuildReport { input, flatten_time, triangles: triangles.len(), ..BuildReport::default() };
        let names = (Names::of_scene(self, left_out), None);
        let pack = if options.preset == Preset::Compact { Bvh8::pack_compact } else { Bvh8::pack };
        let mut bvh = pack(&tree, &triangles, names, &known, options.level)?;
        bvh.report.build_time = clock.elapsed();
        Ok(bvh)
    }
}
