//! Packing a tree into its arena: each node with its leaves right behind it, in the order of the tree.
//!
//! A block is a node of 256 bytes, its leaves on boundaries of 16 bytes, and what is missing to a whole cache line. Where each begins
//! is a sum over the blocks before it; then blocks are written side by side.
//!
//! **Places** are put in the order in which any-hit walks want them (the last one is visited first): inner nodes before leaves, each by
//! growing area, so that what is likely to stop a ray is tried first.

use super::arena::{Arena, LINE};
use super::leaf::{self, BYTES, MARGIN};
use super::node::{LARGEST_ARENA, PackedNode, UNIT, Word};
use super::order::push_order;
use super::tree::{Child, Tree, TreeNode, WIDTH};
use crate::FlatTriangle;
use crate::parallel::join;

/// Blocks that one thread writes.
const SEQUENTIAL: usize = 2048;

/// The arena of a tree, and where in it, in units of 16 bytes, each block begins; or how many bytes it would need where that is too
/// much.
pub(super) fn pack(
    tree: &Tree,
    triangles: &[FlatTriangle],
    numbers: &[u32],
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
    let packing = Packing { tree, triangles, numbers, offsets: &offsets };
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
    numbers: &'a [u32],
    /// Where each block begins, in units.
    offsets: &'a [u32],
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
        let mut rest = words;
        for index in from..to {
            let end = if index + 1 < self.offsets.len() { self.word_of(index + 1) } else { usize::MAX };
            let length = (end - self.word_of(index)).min(rest.len());
            let (block, behind) = rest.split_at_mut(length);
            self.write_block(index, block);
            rest = behind;
        }
    }

    fn word_of(&self, index: usize) -> usize {
        self.offsets[index] as usize * UNIT / 4
    }

    fn write_block(&self, index: usize, block: &mut [u32]) {
        let node = in_order_of_places(&self.tree.nodes[index]);
        let order = push_order(&node.bounds, node.len());
        let mut packed = PackedNode { bounds: node.bounds, children: [0; WIDTH], order };
        let (head, mut leaves) = block.split_at_mut(size_of::<PackedNode>() / 4);
        let mut place = self.offsets[index] as usize + size_of::<PackedNode>() / UNIT;
        for (word, child) in packed.children.iter_mut().zip(node.children) {
            if child.is_nothing() {
                break;
            }
            if child.is_leaf() {
                let count = child.count as usize;
                let mut members = [([[0.0; 3]; 3], 0); WIDTH];
                for (member, &triangle) in
                    members.iter_mut().zip(&self.tree.order[child.link as usize..][..count])
                {
                    let flat = &self.triangles[triangle as usize];
                    *member = ([flat.v0, flat.v1, flat.v2], self.numbers[triangle as usize]);
                }
                *word = Word::leaf(place as u32, child.count).0;
                let (leaf, behind) = leaves.split_at_mut(leaf_bytes(count) / 4);
                leaf::write(leaf, &members[..count]);
                leaves = behind;
                place += leaf_bytes(count) / UNIT;
            } else {
                *word = Word::node(self.offsets[child.link as usize]).0;
            }
        }
        head.copy_from_slice(bytemuck::cast_slice(std::slice::from_ref(&packed)));
    }
}

/// The same node with its places put in order.
pub(super) fn in_order_of_places(node: &TreeNode) -> TreeNode {
    let filled = node.len();
    let mut places: [usize; WIDTH] = std::array::from_fn(|place| place);
    let areas: [f32; WIDTH] = std::array::from_fn(|place| {
        if place < filled { node.child_bounds(place).half_area() } else { f32::INFINITY }
    });
    let kind = |place: usize| (place >= filled, node.children[place].is_leaf());
    places.sort_by(|&a, &b| kind(a).cmp(&kind(b)).then(areas[a].total_cmp(&areas[b])).then(a.cmp(&b)));
    TreeNode {
        bounds: node.bounds.map(|row| places.map(|place| row[place])),
        children: places.map(|place| if place < filled { node.children[place] } else { Child::NOTHING }),
    }
}
