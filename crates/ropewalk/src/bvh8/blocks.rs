//! Where the blocks of a packed tree lie: each is a node with its leaves right behind it, in whole cache lines, in the order of
//! the tree.

use super::node::{LARGEST_ARENA, UNIT};
use super::tree::{Tree, TreeNode};
use crate::memory::with_capacity;
use crate::parallel::join;
use std::ops::Range;

/// Words of a unit.
pub(super) const UNIT_WORDS: usize = UNIT / 4;
/// Blocks that one thread writes.
const SEQUENTIAL: usize = 2048;

/// Where each block begins, in units.
pub(super) struct Blocks {
    offsets: Vec<u32>,
    /// Words of all blocks.
    words: usize,
}

impl Blocks {
    /// Lays out the blocks of a tree, of which each takes as many words as `words_of` says; tells how many bytes all of
    /// them would take where that is too much.
    pub(super) fn new(tree: &Tree, words_of: impl Fn(&TreeNode) -> usize) -> Result<Self, usize> {
        let (mut offsets, mut words) = (with_capacity(tree.nodes.len()), 0);
        for node in &tree.nodes {
            offsets.push((words / UNIT_WORDS) as u32);
            words += words_of(node);
            if 4 * words > LARGEST_ARENA {
                return Err(4 * tree.nodes.iter().map(words_of).sum::<usize>());
            }
        }
        Ok(Self { offsets, words })
    }

    /// Words of all blocks.
    pub(super) const fn words(&self) -> usize {
        self.words
    }

    /// Where a block begins, in units.
    #[inline(always)]
    pub(super) fn offset(&self, block: usize) -> u32 {
        self.offsets[block]
    }

    /// Where a block begins, in words.
    #[inline(always)]
    pub(super) fn word_of(&self, block: usize) -> usize {
        self.offsets.get(block).map_or(self.words, |&offset| offset as usize * UNIT_WORDS)
    }

    /// Where all blocks begin, in units.
    pub(super) fn into_offsets(self) -> Vec<u32> {
        self.offsets
    }

    /// Hands out the blocks and their words in parts, side by side where there are threads.
    pub(super) fn write(&self, words: &mut [u32], write: &(impl Fn(Range<usize>, &mut [u32]) + Sync)) {
        self.write_part(0..self.offsets.len(), words, write);
    }

    fn write_part(
        &self,
        part: Range<usize>,
        words: &mut [u32],
        write: &(impl Fn(Range<usize>, &mut [u32]) + Sync),
    ) {
        if part.len() <= SEQUENTIAL {
            write(part, words);
            return;
        }
        let middle = part.start + part.len() / 2;
        let (low, high) = words.split_at_mut(self.word_of(middle) - self.word_of(part.start));
        join(
            || self.write_part(part.start..middle, low, write),
            || self.write_part(middle..part.end, high, write),
        );
    }
}
