//! Packing a tree into its arena: each node with its leaves right behind it, in the order of the tree.
//!
//! A [block](super::blocks) is a node of 256 bytes, its leaves on boundaries of 16 bytes, and what is missing to a whole cache line.
//!
//! The triangles of leaves lie anywhere, so those of a leaf some leaves ahead are asked for. All of it is compiled for the
//! processor's vector instructions.

use super::arena::{Arena, LINE, prefetch};
use super::blocks::Blocks;
use super::leaf::{self, BYTES, MARGIN};
use super::node::{PackedNode, UNIT, Word};
use super::order::push_order;
use super::places;
use super::simd::{Detected, Level, Task, dispatch};
use super::tree::{Tree, TreeNode, WIDTH};
use crate::FlatTriangle;
use std::ops::Range;

/// So many references lie between asking for a triangle and reading it: those of about two blocks.
const AHEAD: usize = 32;

/// The arena of a tree, and where in it, in units of 16 bytes, each block begins; or how many bytes it would need where that is too
/// much. Triangles whose numbers are not given have them in place of those of their primitives.
pub(super) fn pack(
    tree: &Tree,
    triangles: &[FlatTriangle],
    numbers: Option<&[u32]>,
) -> Result<(Arena, Vec<u32>), usize> {
    let blocks = Blocks::new(tree, block_words)?;
    let words = blocks.words();
    let mut arena = Arena::new(if words == 0 { 0 } else { 4 * words + MARGIN });
    let level = Detected::or_best(None);
    let packing = Packing { tree, triangles, numbers, blocks: &blocks };
    blocks.write(&mut arena.words_mut()[..words], &|range, words| {
        dispatch(level, Part { packing: &packing, range, words });
    });
    Ok((arena, blocks.into_offsets()))
}

fn block_words(node: &TreeNode) -> usize {
    let leaves: usize = node.children.iter().map(|child| leaf_bytes(child.count as usize)).sum();
    (size_of::<PackedNode>() + leaves).next_multiple_of(LINE) / 4
}

const fn leaf_bytes(count: usize) -> usize {
    (BYTES * count).next_multiple_of(UNIT)
}

struct Packing<'a> {
    tree: &'a Tree,
    triangles: &'a [FlatTriangle],
    numbers: Option<&'a [u32]>,
    blocks: &'a Blocks,
}

/// Some blocks and their words.
struct Part<'a> {
    packing: &'a Packing<'a>,
    range: Range<usize>,
    words: &'a mut [u32],
}

impl Task for Part<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self, _: L) {
        let Self { packing, range, words: mut rest } = self;
        for index in range {
            let length = packing.blocks.word_of(index + 1) - packing.blocks.word_of(index);
            let (block, behind) = rest.split_at_mut(length);
            packing.write_block(index, block);
            rest = behind;
        }
    }
}

impl Packing<'_> {
    #[inline(always)]
    fn write_block(&self, index: usize, block: &mut [u32]) {
        let (node, filled) = places::in_order(&self.tree.nodes[index]);
        let order = push_order(&node.bounds, filled);
        let mut packed = PackedNode { bounds: node.bounds, children: [0; WIDTH], order };
        let (head, mut leaves) = block.split_at_mut(size_of::<PackedNode>() / 4);
        let mut place = self.blocks.offset(index) as usize + size_of::<PackedNode>() / UNIT;
        for (word, child) in packed.children.iter_mut().zip(node.children).take(filled) {
            if child.is_leaf() {
                let count = child.count as usize;
                *word = Word::leaf(place as u32, child.count).0;
                let (leaf, behind) = leaves.split_at_mut(leaf_bytes(count) / 4);
                self.write_leaf(child.link as usize, count, leaf);
                leaves = behind;
                place += leaf_bytes(count) / UNIT;
            } else {
                *word = Word::node(self.blocks.offset(child.link as usize)).0;
            }
        }
        head.copy_from_slice(bytemuck::cast_slice(std::slice::from_ref(&packed)));
    }

    /// Writes the leaf of some references.
    #[inline(always)]
    fn write_leaf(&self, first: usize, count: usize, leaf: &mut [u32]) {
        match count {
            1 => self.write_leaf_of::<1>(first, leaf),
            2 => self.write_leaf_of::<2>(first, leaf),
            3 => self.write_leaf_of::<3>(first, leaf),
            4 => self.write_leaf_of::<4>(first, leaf),
            5 => self.write_leaf_of::<5>(first, leaf),
            6 => self.write_leaf_of::<6>(first, leaf),
            7 => self.write_leaf_of::<7>(first, leaf),
            _ => self.write_leaf_of::<8>(first, leaf),
        }
    }

    #[inline(always)]
    fn write_leaf_of<const COUNT: usize>(&self, first: usize, leaf: &mut [u32]) {
        let order = &self.tree.order;
        for &triangle in order.iter().skip(first + AHEAD).take(COUNT) {
            let triangle = std::ptr::from_ref(&self.triangles[triangle as usize]);
            // Every other one goes on in the next line.
            prefetch(triangle);
            prefetch(triangle.cast::<u32>().wrapping_add(size_of::<FlatTriangle>() / 4 - 1));
        }
        let Some(members) = order[first..].first_chunk::<COUNT>() else { return };
        // Loops and not closures, which the compiler does not always put into the code for a level of vector instructions.
        let mut triangles = [&self.triangles[members[0] as usize]; COUNT];
        for (triangle, &member) in triangles.iter_mut().zip(members) {
            *triangle = &self.triangles[member as usize];
        }
        let mut numbers = [0; COUNT];
        for (place, number) in numbers.iter_mut().enumerate() {
            *number = match self.numbers {
                Some(numbers) => numbers[members[place] as usize],
                None => triangles[place].primitive,
            };
        }
        leaf::write(leaf, triangles, numbers);
    }
}
