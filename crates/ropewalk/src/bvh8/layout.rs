//! Packing a tree into its arena: each node with its leaves right behind it, in the order of the tree.
//!
//! A block is a node of 256 bytes, its leaves on boundaries of 16 bytes, and what is missing to a whole cache line. Where each begins
//! is a sum over the blocks before it; then blocks are written side by side.
//!
//! The triangles of leaves lie anywhere, so those of a leaf some leaves ahead are asked for. All of it is compiled for the
//! processor's vector instructions.

use super::arena::{Arena, LINE, prefetch};
use super::leaf::{self, BYTES, MARGIN};
use super::node::{LARGEST_ARENA, PackedNode, UNIT, Word};
use super::order::push_order;
use super::places;
use super::simd::{Detected, Level, Task, dispatch};
use super::tree::{Tree, TreeNode, WIDTH};
use crate::FlatTriangle;
use crate::parallel::join;

/// Blocks that one thread writes.
const SEQUENTIAL: usize = 2048;
/// So many references lie between asking for a triangle and reading it: those of about two blocks.
const AHEAD: usize = 32;

/// The arena of a tree, and where in it, in units of 16 bytes, each block begins; or how many bytes it would need where that is too
/// much. Triangles whose numbers are not given have them in place of those of their primitives.
pub(super) fn pack(
    tree: &Tree,
    triangles: &[FlatTriangle],
    numbers: Option<&[u32]>,
) -> Result<(Arena, Vec<u32>), usize> {
    let mut offsets = Vec::with_capacity(tree.nodes.len());
    let mut bytes = 0;
    for node in &tree.nodes {
        offsets.push((bytes / UNIT) as u32);
        bytes += block_bytes(node);
        if bytes > LARGEST_ARENA {
            return Err(tree.nodes.iter().map(block_bytes).sum());
        }
    }
    let mut arena = Arena::new(if bytes == 0 { 0 } else { bytes + MARGIN });
    let level = Detected::or_best(None);
    let packing = Packing { tree, triangles, numbers, offsets: &offsets, level };
    packing.write(0, tree.nodes.len(), &mut arena.words_mut()[..bytes / 4]);
    Ok((arena, offsets))
}

fn block_bytes(node: &TreeNode) -> usize {
    let leaves: usize = node.children.iter().map(|child| leaf_bytes(child.count as usize)).sum();
    (size_of::<PackedNode>() + leaves).next_multiple_of(LINE)
}

const fn leaf_bytes(count: usize) -> usize {
    (BYTES * count).next_multiple_of(UNIT)
}

struct Packing<'a> {
    tree: &'a Tree,
    triangles: &'a [FlatTriangle],
    numbers: Option<&'a [u32]>,
    /// Where each block begins, in units.
    offsets: &'a [u32],
    level: Detected,
}

/// Some blocks and their words.
struct Part<'a> {
    packing: &'a Packing<'a>,
    from: usize,
    to: usize,
    words: &'a mut [u32],
}

impl Task for Part<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self, _: L) {
        let Self { packing, from, to, words: mut rest } = self;
        for index in from..to {
            let end = if index + 1 < packing.offsets.len() { packing.word_of(index + 1) } else { usize::MAX };
            let length = (end - packing.word_of(index)).min(rest.len());
            let (block, behind) = rest.split_at_mut(length);
            packing.write_block(index, block);
            rest = behind;
        }
    }
}

impl Packing<'_> {
    /// Writes the blocks `from..to` into their words.
    fn write(&self, from: usize, to: usize, words: &mut [u32]) {
        if to - from > SEQUENTIAL {
            let middle = from + (to - from) / 2;
            let (low, high) = words.split_at_mut(self.word_of(middle) - self.word_of(from));
            join(|| self.write(from, middle, low), || self.write(middle, to, high));
            return;
        }
        dispatch(self.level, Part { packing: self, from, to, words });
    }

    #[inline(always)]
    fn word_of(&self, index: usize) -> usize {
        self.offsets[index] as usize * UNIT / 4
    }

    #[inline(always)]
    fn write_block(&self, index: usize, block: &mut [u32]) {
        let (node, filled) = places::in_order(&self.tree.nodes[index]);
        let order = push_order(&node.bounds, filled);
        let mut packed = PackedNode { bounds: node.bounds, children: [0; WIDTH], order };
        let (head, mut leaves) = block.split_at_mut(size_of::<PackedNode>() / 4);
        let mut place = self.offsets[index] as usize + size_of::<PackedNode>() / UNIT;
        for (word, child) in packed.children.iter_mut().zip(node.children).take(filled) {
            if child.is_leaf() {
                let count = child.count as usize;
                *word = Word::leaf(place as u32, child.count).0;
                let (leaf, behind) = leaves.split_at_mut(leaf_bytes(count) / 4);
                self.write_leaf(child.link as usize, count, leaf);
                leaves = behind;
                place += leaf_bytes(count) / UNIT;
            } else {
                *word = Word::node(self.offsets[child.link as usize]).0;
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
