//! Packing a tree compactly: each node with its leaves right behind it, in the order of the tree, and behind all of them the
//! vertices.
//!
//! A [block](crate::bvh8::blocks) is a node of 128 bytes, its leaves, and what is missing to a whole cache line. Vertices lie in the order in which the
//! leaves first want them, so that those of a leaf are mostly neighbours. One thread finds out which are the same; then blocks
//! are written side by side.

use super::frame::quantise;
use super::node::CompactNode;
use super::vertices::Vertices;
use crate::bvh8::Form;
use crate::bvh8::arena::{Arena, LINE};
use crate::bvh8::blocks::{Blocks, UNIT_WORDS};
use crate::bvh8::leaf::IndexedLeaf;
use crate::bvh8::node::{Fan, LARGEST_ARENA, Word};
use crate::bvh8::order::push_order;
use crate::bvh8::places;
use crate::bvh8::tree::{Tree, TreeNode, WIDTH};
use crate::memory::with_capacity;
use crate::{BuildError, FlatTriangle};
use std::ops::Range;

/// Words of a node, of a triangle in a leaf, and of a vertex.
const NODE: usize = size_of::<CompactNode>() / 4;
const TRIANGLE: usize = IndexedLeaf::BYTES / 4;
const VERTEX: usize = 3;
/// So many vertices have places that a word can tell.
const MOST_VERTICES: usize = u32::MAX as usize / VERTEX;

/// A tree in its arena.
pub(super) struct Packed {
    pub(super) arena: Arena,
    pub(super) form: Form,
}

/// Packs a tree of which each reference stands in one leaf.
///
/// # Errors
/// When blocks or vertices are more than words can count.
pub(super) fn pack(
    tree: &Tree,
    triangles: &[FlatTriangle],
    numbers: Option<&[u32]>,
) -> Result<Packed, BuildError> {
    let too_many = |what, count, limit| BuildError::TooMany { what, count, limit };
    let blocks = Blocks::new(tree, block_words)
        .map_err(|bytes| too_many("bytes of a packed tree", bytes, LARGEST_ARENA))?;
    let mut vertices = Vertices::new(triangles.len() / 2);
    let mut corners = with_capacity(tree.order.len());
    for &triangle in &tree.order {
        let flat = &triangles[triangle as usize];
        corners.push([flat.v0, flat.v1, flat.v2].map(|vertex| vertices.index_of(vertex)));
        // Long before their indices could run out.
        if vertices.places().len() > MOST_VERTICES {
            return Err(too_many("different vertices at least", vertices.places().len(), MOST_VERTICES));
        }
    }
    let places = vertices.places().as_flattened();
    let words = blocks.words() + places.len() + IndexedLeaf::MARGIN / 4;
    if words > u32::MAX as usize {
        return Err(too_many("words of a packed tree", words, u32::MAX as usize));
    }
    let mut arena = Arena::new(if tree.nodes.is_empty() { 0 } else { 4 * words });
    let (nodes, behind) = arena.words_mut().split_at_mut(blocks.words());
    behind[..places.len()].copy_from_slice(places);
    let packing = Packing { tree, triangles, numbers, corners: &corners, blocks: &blocks };
    blocks.write(nodes, &|range, words| packing.write(range, words));
    Ok(Packed { arena, form: Form::Compact { vertices: blocks.words(), count: vertices.places().len() } })
}

fn block_words(node: &TreeNode) -> usize {
    let triangles: usize = node.children.iter().map(|child| child.count as usize).sum();
    (NODE + TRIANGLE * triangles).next_multiple_of(LINE / 4)
}

struct Packing<'a> {
    tree: &'a Tree,
    triangles: &'a [FlatTriangle],
    /// Where triangles do not have theirs in place of those of their primitives.
    numbers: Option<&'a [u32]>,
    /// The vertices of each reference.
    corners: &'a [[u32; 3]],
    /// Where each block begins; vertices lie behind all of them.
    blocks: &'a Blocks,
}

impl Packing<'_> {
    /// Writes some blocks into their words.
    fn write(&self, range: Range<usize>, words: &mut [u32]) {
        let mut rest = words;
        for index in range {
            let (block, behind) = rest.split_at_mut(block_words(&self.tree.nodes[index]));
            self.write_block(index, block);
            rest = behind;
        }
    }

    fn write_block(&self, index: usize, block: &mut [u32]) {
        let (node, filled) = places::in_order(&self.tree.nodes[index]);
        let mut fan = Fan { children: [0; WIDTH], order: push_order(&node.bounds, filled) };
        let (head, mut leaves) = block.split_at_mut(NODE);
        let first_vertex = self.blocks.words() as u32;
        let mut place = self.blocks.word_of(index) + NODE;
        for (word, child) in fan.children.iter_mut().zip(&node.children).take(filled) {
            if !child.is_leaf() {
                *word = Word::node(self.blocks.offset(child.link as usize)).0;
                continue;
            }
            *word = Word::leaf((place / UNIT_WORDS) as u32, child.count).0;
            let (leaf, behind) = leaves.split_at_mut(TRIANGLE * child.count as usize);
            for (at, entry) in (child.link as usize..).zip(leaf.chunks_exact_mut(TRIANGLE)) {
                let [a, b, c] = self.corners[at].map(|vertex| first_vertex + VERTEX as u32 * vertex);
                let triangle = self.tree.order[at] as usize;
                let number =
                    self.numbers.map_or(self.triangles[triangle].primitive, |numbers| numbers[triangle]);
                entry.copy_from_slice(&[a, b, c, number]);
            }
            place += leaf.len();
            leaves = behind;
        }
        let axes = [0, 1, 2].map(|axis| quantise(&node.bounds[axis], &node.bounds[3 + axis], filled));
        let packed = CompactNode::new(&axes, fan);
        head.copy_from_slice(bytemuck::cast_slice(std::slice::from_ref(&packed)));
    }
}
