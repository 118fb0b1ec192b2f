//! Compact trees: nodes of 128 bytes, and leaves that name vertices of a section of their own.
//!
//! What [`super::layout`] packs in full, in half of the memory: 26 to 29 bytes a triangle where that takes 55 to 59, if triangles
//! share their vertices. The same walks go through both ([`super::arena::Reader`]), and hits are the same, to the bit: boxes are
//! larger, never smaller ([`frame`]), and vertices are what they were.
//!
//! * A node has a byte for each side of its boxes (Mahovsky, Wyvill 2006; Ylitie, Karras, Laine 2017), counted in steps from a
//!   corner: two cache lines ([`node`]).
//! * A triangle takes 16 bytes: where its vertices are, and its number ([`super::leaf`]).
//! * Vertices with the same bits are one, 12 bytes ([`vertices`]): a closed mesh has half as many of them as triangles.
//!
//! **Cost.** A node's visit takes two thirds more vector instructions, and the triangles of a leaf are read from where their
//! vertices are. To find those that are the same takes a table and one thread. The tree cannot be refitted: vertices in one place
//! may part ([`crate::UpdateError::SharedVertices`]).
//!
//! **Invariants**: every box that a walk makes of a node contains the box that was packed, and so every triangle below; no vertex
//! is there twice; each triangle names three vertices of the section.

mod frame;
mod node;
mod pack;
#[cfg(test)]
mod tests;
mod validate;
mod vertices;

use super::names::Names;
use super::simd::Detected;
use super::tree::{self, Tree};
use super::{Bvh8, SimdLevel, report, too_many};
use crate::{BuildError, BuildReport, FlatTriangle};
pub(super) use node::CompactNode;
use pack::Packed;

impl Bvh8 {
    /// As [`Bvh8::pack`], of whole triangles that stand in one leaf each.
    pub(super) fn pack_compact(
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
        let Packed { arena, form } = pack::pack(tree, triangles, numbers)?;
        let report = BuildReport { bytes: arena.len() + names.bytes(), ..report };
        Ok(Self { arena, blocks: Vec::new(), names, form, level: Detected::or_best(level), bounds, report })
    }
}
