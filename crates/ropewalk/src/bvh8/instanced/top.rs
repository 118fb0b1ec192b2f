//! The tree over instances: packed nodes one behind the other, and in place of leaves words that name an instance.
//!
//! Built by the binned builder ([`crate::bvh8::build::binned`]), which stops at eight instances: these are the places of one node, so that
//! splitting them further would gain little, and would take most of the time. Each instance has a place of its own, because to
//! enter one costs as much as some nodes.

use crate::bvh8::arena::Arena;
use crate::bvh8::build::binned::{BinnedOptions, build_boxes};
use crate::bvh8::build::reference::Reference;
use crate::bvh8::node::{PackedNode, UNIT, Word};
use crate::bvh8::order::push_order;
use crate::bvh8::report;
use crate::bvh8::tree::{Child, MAX_LEVELS, Tree, TreeNode, WIDTH};
use crate::memory::with_capacity;
use crate::parallel::{extend, fill_chunks};
use crate::two_level::Placed;
use crate::{Aabb, BuildError, BuildReport};

/// Nodes that a thread packs at a time.
const CHUNK: usize = 1024;
/// The units of a node.
const UNITS: usize = size_of::<PackedNode>() / UNIT;

/// The tree.
#[derive(Clone, Debug)]
pub(in super::super) struct Top {
    /// Nodes only. A word is a node's, as in every arena, or a leaf's of one: then its place is that of an instance among those that
    /// are placed.
    pub(in super::super) arena: Arena,
    pub(super) bounds: Aabb,
    /// Of the nodes alone.
    pub(super) report: BuildReport,
}

impl Default for Top {
    fn default() -> Self {
        Self { arena: Arena::new(0), bounds: Aabb::EMPTY, report: BuildReport::default() }
    }
}

impl Top {
    /// Builds the tree over what is placed.
    pub(super) fn over(placed: &[Placed]) -> Result<Self, BuildError> {
        let mut boxes = with_capacity(placed.len());
        extend(&mut boxes, placed, |place, placed| Reference::new(&placed.bounds(), place as u32));
        let tree = spread(build_boxes(boxes, &BinnedOptions::FAST)?, placed);
        let (report, bounds) = report::measure(&tree, BuildReport::default());
        if report.depth > MAX_LEVELS {
            let (count, limit) = (report.depth as usize, MAX_LEVELS as usize);
            return Err(BuildError::TooMany { what: "levels", count, limit });
        }
        // A leaf is no more than a word.
        let report = BuildReport { nodes: tree.nodes.len(), ..report };
        Ok(Self { arena: pack(&tree), bounds, report })
    }

    pub(in super::super) const fn is_empty(&self) -> bool {
        self.arena.len() == 0
    }

    pub(super) const fn bytes(&self) -> usize {
        self.arena.len()
    }

    /// The instance that a leaf's word names, by its place.
    #[inline(always)]
    pub(in super::super) const fn place(word: Word) -> usize {
        word.offset() / UNIT
    }
}

/// Gives each instance of a leaf a place of its own: in the leaf's node where there is room, else in a node below.
fn spread(tree: Tree, placed: &[Placed]) -> Tree {
    let Tree { mut nodes, order } = tree;
    let single = |node: &mut TreeNode, place: usize, at: u32| {
        node.set(place, &placed[order[at as usize] as usize].bounds(), Child::leaf(at, 1));
    };
    for index in 0..nodes.len() {
        let children = nodes[index].len();
        let mut filled = children;
        for place in 0..children {
            let Child { link, count } = nodes[index].children[place];
            if count > 1 && filled + count as usize - 1 <= WIDTH {
                single(&mut nodes[index], place, link);
                for at in link + 1..link + count {
                    single(&mut nodes[index], filled, at);
                    filled += 1;
                }
            } else if count > 1 {
                let mut below = TreeNode::EMPTY;
                (0..count).for_each(|at| single(&mut below, at as usize, link + at));
                nodes[index].children[place] = Child::inner(nodes.len() as u32);
                nodes.push(below);
            }
        }
    }
    Tree { nodes, order }
}

fn pack(tree: &Tree) -> Arena {
    let mut arena = Arena::new(tree.nodes.len() * size_of::<PackedNode>());
    let nodes: &mut [PackedNode] = bytemuck::cast_slice_mut(arena.words_mut());
    fill_chunks(nodes, CHUNK, |first, nodes| {
        for (packed, node) in nodes.iter_mut().zip(&tree.nodes[first..]) {
            let filled = node.len();
            for (word, child) in packed.children.iter_mut().zip(node.children).take(filled) {
                *word = match child.is_leaf() {
                    true => Word::leaf(tree.order[child.link as usize], 1).0,
                    false => Word::node(child.link * UNITS as u32).0,
                };
            }
            (packed.bounds, packed.order) = (node.bounds, push_order(&node.bounds, filled));
        }
    });
    arena
}
