//! The blocks of an arena, written anew where they are: of every node its leaves, then its boxes and its order.
//!
//! Compiled for the tree's vector instructions, by [`Task`]. What the words say, where children begin and which triangles
//! a leaf has, stays as it is: that is what walks rely on.

use super::{BLOCKS, Moved};
use crate::Aabb;
use crate::bvh8::arena::{Arena, LINE, prefetch};
use crate::bvh8::leaf::{BYTES, ROWS};
use crate::bvh8::node::{PackedNode, UNIT, Word};
use crate::bvh8::order::push_order;
use crate::bvh8::simd::{Detected, Level, Task, dispatch};
use crate::bvh8::tree::{LARGEST_LEAF, WIDTH};
use crate::parallel::join;
use glam::{Vec3, Vec4};

/// Words of a unit and of a node.
const UNIT_WORDS: usize = UNIT / 4;
const NODE_WORDS: usize = size_of::<PackedNode>() / 4;

/// So many blocks lie between asking for something and reading it: three times, because a block tells its triangles, these
/// tell their vertices, and none of them is in the cache. Without that this pass took three times as long.
const AHEAD: usize = 3;
/// Blocks that are known before their turn.
const RING: usize = 8;
const _: () = assert!(RING > 2 * AHEAD);
/// The most triangles of a block.
const MOST: usize = WIDTH * LARGEST_LEAF as usize;
/// The most lines of a block.
const MOST_LINES: usize = (size_of::<PackedNode>() + MOST * BYTES).div_ceil(LINE) + 1;

/// What is written.
#[derive(Clone, Copy)]
pub(super) struct Blocks<'a> {
    pub(super) moved: &'a Moved<'a>,
    pub(super) level: Detected,
}

/// What came of some blocks.
#[derive(Default)]
struct Written {
    /// The sum of half the areas of their boxes, without those of the open nodes.
    half_areas: f64,
    /// Where the nodes begin that wait for children in other parts, from the last to the first.
    open: Vec<u32>,
}

impl Blocks<'_> {
    /// Writes all, and gives back the box around everything and the sum of half the areas of all boxes.
    pub(super) fn write(self, arena: &mut Arena, blocks: &[u32]) -> (Aabb, f64) {
        if blocks.is_empty() {
            return (Aabb::EMPTY, 0.0);
        }
        let mut parts = Vec::new();
        self.divide(arena.words_mut(), 0, blocks, &mut parts);
        let words = arena.words_mut();
        let mut half_areas: f64 = parts.iter().map(|part| part.half_areas).sum();
        // From the last to the first, so that children come before their parents here, too.
        for &block in parts.iter().rev().flat_map(|part| &part.open) {
            let mut node = node_of(words, block as usize * UNIT_WORDS);
            for place in 0..filled(&node) {
                let word = Word(node.children[place]);
                if !word.is_leaf() {
                    set(&mut node, place, box_of(words, word.offset() / 4));
                }
            }
            half_areas += finish(words, block as usize * UNIT_WORDS, &mut node);
        }
        let (low, high) = box_of(words, 0);
        (Aabb::new(low.truncate(), high.truncate()), half_areas)
    }

    /// Cuts the blocks into parts for threads; `words` begin at the word `origin`. As many calls deep as there are bits in the number of parts.
    fn divide(self, words: &mut [u32], origin: usize, blocks: &[u32], parts: &mut Vec<Written>) {
        if blocks.len() <= BLOCKS {
            parts.push(dispatch(self.level, Part { moved: self.moved, words, origin, blocks }));
            return;
        }
        let middle = (blocks.len() / 2).next_multiple_of(BLOCKS);
        let (first, second) = blocks.split_at(middle);
        let from = second[0] as usize * UNIT_WORDS;
        let (low, high) = words.split_at_mut(from - origin);
        let mut others = Vec::new();
        join(|| self.divide(low, origin, first, parts), || self.divide(high, from, second, &mut others));
        parts.append(&mut others);
    }
}

/// What is known of a block whose turn comes soon.
#[derive(Clone, Copy)]
struct Waiting {
    /// Its triangles.
    count: usize,
    names: [u32; MOST],
    corners: [[usize; 3]; MOST],
}

impl Waiting {
    const EMPTY: Self = Self { count: 0, names: [0; MOST], corners: [[0; 3]; MOST] };
}

/// Some blocks, to be written at some level.
struct Part<'a> {
    moved: &'a Moved<'a>,
    words: &'a mut [u32],
    /// The place of the first word in the arena.
    origin: usize,
    /// Where the blocks begin, in units.
    blocks: &'a [u32],
}

impl Task for Part<'_> {
    type Output = Written;

    #[inline(always)]
    fn run<L: Level>(mut self, _: L) -> Written {
        let mut written = Written::default();
        let mut ring = [Waiting::EMPTY; RING];
        for step in 0..self.blocks.len() + 3 * AHEAD {
            if let Some(index) = self.turn(step) {
                self.ask(index);
            }
            if let Some(index) = step.checked_sub(AHEAD).and_then(|step| self.turn(step)) {
                self.read_names(index, &mut ring[index % RING]);
            }
            if let Some(index) = step.checked_sub(2 * AHEAD).and_then(|step| self.turn(step)) {
                self.read_corners(&mut ring[index % RING]);
            }
            if let Some(index) = step.checked_sub(3 * AHEAD).and_then(|step| self.turn(step)) {
                self.write(index, &ring[index % RING], &mut written);
            }
        }
        written
    }
}

impl Part<'_> {
    /// Which block has a turn: the last one first.
    #[inline(always)]
    fn turn(&self, step: usize) -> Option<usize> {
        self.blocks.len().checked_sub(step + 1)
    }

    /// The first word of a block.
    #[inline(always)]
    fn at(&self, index: usize) -> usize {
        self.blocks[index] as usize * UNIT_WORDS - self.origin
    }

    /// Asks for the lines of a block.
    #[inline(always)]
    fn ask(&self, index: usize) {
        let end = if index + 1 < self.blocks.len() { self.at(index + 1) } else { self.words.len() };
        let block = &self.words[self.at(index)..end];
        for line in block.chunks(LINE / 4).take(MOST_LINES) {
            prefetch(line.as_ptr());
        }
    }

    /// Reads the names of a block's triangles, and asks for where their corners are named.
    #[inline(always)]
    fn read_names(&self, index: usize, waiting: &mut Waiting) {
        let children: [u32; WIDTH] = children_of(self.words, self.at(index));
        waiting.count = 0;
        for child in children {
            let word = Word(child);
            if word.is_leaf() {
                let count = word.count() as usize;
                let names = &self.words[word.offset() / 4 - self.origin + ROWS * count..][..count];
                for &name in names {
                    self.moved.prefetch_corners(name);
                    waiting.names[waiting.count % MOST] = name;
                    waiting.count += 1;
                }
            }
        }
    }

    /// Reads which vertices a block's triangles have, and asks for them.
    #[inline(always)]
    fn read_corners(&self, waiting: &mut Waiting) {
        for (&name, corners) in waiting.names.iter().zip(&mut waiting.corners).take(waiting.count) {
            *corners = self.moved.corners(name);
            for &mut corner in corners {
                self.moved.prefetch_vertex(corner);
            }
        }
    }

    /// Writes a block.
    #[inline(always)]
    fn write(&mut self, index: usize, waiting: &Waiting, written: &mut Written) {
        let at = self.at(index);
        let end = self.origin + self.words.len();
        let mut node = node_of(self.words, at);
        let (mut is_open, mut first) = (false, 0);
        for place in 0..filled(&node) {
            let word = Word(node.children[place]);
            let from = word.offset() / 4;
            if word.is_leaf() {
                let count = word.count() as usize;
                let leaf = &mut self.words[from - self.origin..][..ROWS * count];
                let corners = &waiting.corners[first..][..count];
                set(&mut node, place, write_leaf(leaf, corners, self.moved));
                first += count;
            } else if from >= end || is_among(&written.open, word) {
                is_open = true;
            } else {
                set(&mut node, place, box_of(self.words, from - self.origin));
            }
        }
        if is_open {
            written.open.push(self.blocks[index]);
            put(self.words, at, &node);
        } else {
            written.half_areas += finish(self.words, at, &mut node);
        }
    }
}

/// Whether a node is among those that are open.
#[inline(always)]
fn is_among(open: &[u32], word: Word) -> bool {
    let unit = (word.offset() / UNIT) as u32;
    !open.is_empty() && open.binary_search_by(|other| unit.cmp(other)).is_ok()
}

/// Writes the corners of a leaf's triangles, and gives back the box around them.
#[inline(always)]
fn write_leaf(words: &mut [u32], corners: &[[usize; 3]], moved: &Moved<'_>) -> (Vec4, Vec4) {
    // For each size code of its own, in which every store has a known place.
    match corners.len() {
        1 => write_rows::<1>(words, corners, moved),
        2 => write_rows::<2>(words, corners, moved),
        3 => write_rows::<3>(words, corners, moved),
        4 => write_rows::<4>(words, corners, moved),
        5 => write_rows::<5>(words, corners, moved),
        6 => write_rows::<6>(words, corners, moved),
        7 => write_rows::<7>(words, corners, moved),
        _ => write_rows::<{ LARGEST_LEAF as usize }>(words, corners, moved),
    }
}

/// The same for a leaf of `COUNT` triangles; an empty box where it has another size.
#[inline(always)]
fn write_rows<const COUNT: usize>(
    words: &mut [u32],
    corners: &[[usize; 3]],
    moved: &Moved<'_>,
) -> (Vec4, Vec4) {
    let (mut low, mut high) = (Vec4::INFINITY, Vec4::NEG_INFINITY);
    let rows = words.as_chunks_mut::<COUNT>().0.first_chunk_mut::<ROWS>();
    let (Some(rows), Some(corners)) = (rows, corners.first_chunk::<COUNT>()) else { return (low, high) };
    for triangle in 0..COUNT {
        let [a, b, c] = corners[triangle];
        let (a, b, c) = (moved.vertex(a), moved.vertex(b), moved.vertex(c));
        low = low.min(a).min(b).min(c);
        high = high.max(a).max(b).max(c);
        let numbers = [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z];
        for row in 0..ROWS {
            rows[row][triangle] = numbers[row].to_bits();
        }
    }
    (low, high)
}

/// The places that hold something.
#[inline(always)]
fn filled(node: &PackedNode) -> usize {
    let mut filled = 0;
    // What holds nothing has the root's word, and lies behind what holds something.
    for child in node.children {
        filled += usize::from(child != 0);
    }
    filled
}

#[inline(always)]
fn set(node: &mut PackedNode, place: usize, (low, high): (Vec4, Vec4)) {
    let place = place % WIDTH;
    node.bounds[0][place] = low.x;
    node.bounds[1][place] = low.y;
    node.bounds[2][place] = low.z;
    node.bounds[3][place] = high.x;
    node.bounds[4][place] = high.y;
    node.bounds[5][place] = high.z;
}

/// Writes a node all of whose boxes are known, and gives back the sum of half their areas.
#[inline(always)]
fn finish(words: &mut [u32], at: usize, node: &mut PackedNode) -> f64 {
    let filled = filled(node);
    node.order = push_order(&node.bounds, filled);
    put(words, at, node);
    let [low_x, low_y, low_z, high_x, high_y, high_z] = &node.bounds;
    let mut half_areas = 0.0;
    for place in 0..filled.min(WIDTH) {
        let size = [high_x[place] - low_x[place], high_y[place] - low_y[place], high_z[place] - low_z[place]];
        half_areas += f64::from(size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
    }
    half_areas
}

/// The box around the boxes of a node.
#[inline(always)]
fn box_of(words: &[u32], at: usize) -> (Vec4, Vec4) {
    let rows: &[f32] = bytemuck::cast_slice(&words[at..][..6 * WIDTH]);
    let low = Vec3::new(least(rows, 0), least(rows, 1), least(rows, 2));
    let high = Vec3::new(most(rows, 3), most(rows, 4), most(rows, 5));
    (low.extend(0.0), high.extend(0.0))
}

// No closures, which are not always put into the code that is compiled for a level of vector instructions.

#[inline(always)]
fn least(rows: &[f32], row: usize) -> f32 {
    Vec4::from_slice(&rows[8 * row..]).min(Vec4::from_slice(&rows[8 * row + 4..])).min_element()
}

#[inline(always)]
fn most(rows: &[f32], row: usize) -> f32 {
    Vec4::from_slice(&rows[8 * row..]).max(Vec4::from_slice(&rows[8 * row + 4..])).max_element()
}

#[inline(always)]
fn node_of(words: &[u32], at: usize) -> PackedNode {
    bytemuck::pod_read_unaligned(bytemuck::cast_slice(&words[at..][..NODE_WORDS]))
}

#[inline(always)]
fn children_of(words: &[u32], at: usize) -> [u32; WIDTH] {
    let mut children = [0; WIDTH];
    children.copy_from_slice(&words[at + 6 * WIDTH..][..WIDTH]);
    children
}

#[inline(always)]
fn put(words: &mut [u32], at: usize, node: &PackedNode) {
    words[at..][..NODE_WORDS].copy_from_slice(bytemuck::cast_slice(std::slice::from_ref(node)));
}
