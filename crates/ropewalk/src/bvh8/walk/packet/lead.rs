//! A packet's way through the tree.

use super::super::Stack;
use super::super::boxes::{Boxes, Lanes, children};
use super::super::ray::Slabs;
use super::super::single::Place;
use super::super::sink::Sink;
use super::super::stack::ROOM;
use super::super::triangles::{Edges, Triple};
use super::rays::Packet;
use super::{GROUPS, MOST_WORK, RAYS};
use crate::bvh8::ROOT;
use crate::bvh8::arena::Reader;
use crate::bvh8::leaf::Triangles;
use crate::bvh8::node::{DONE, Word};
use crate::bvh8::simd::Level;
use crate::bvh8::tree::WIDTH;

/// Leads a packet through the tree, and tells how much work that was; `None` where it spreads too much.
#[inline(always)]
pub(super) fn lead<'a, L: Level, R: Reader<'a>, S: Sink>(
    level: L,
    place: Place<'a, R>,
    packet: &mut Packet,
    sinks: &mut [S; RAYS],
    stack: &mut Stack,
    parents: &mut [u32; ROOM],
) -> Option<usize> {
    let slabs = packet.slabs;
    let lanes = Lanes::new(level, &slabs);
    let mut t_max = packet.close(u32::MAX);
    let (mut work, most_work) = (0, MOST_WORK * WIDTH * packet.groups);
    stack.reset();
    stack.push(ROOT.0, 0.0);
    loop {
        let (word, entry) = if S::ORDERED { stack.pop_with_entry() } else { (stack.pop(), 0.0) };
        if word.0 == DONE {
            return Some(work);
        }
        // Also where all rays are done.
        if entry > t_max {
            continue;
        }
        work += 1;
        if !word.is_leaf() {
            // SAFETY: the word is the root's, or was read from a node of this arena.
            let node = unsafe { place.view.node(word) };
            let (entries, hit) = children(level, node, &slabs, &lanes, t_max);
            let above = stack.len();
            parents[above..above + WIDTH].fill(word.0);
            if S::ORDERED {
                let _ = level.push_ordered(node.fan(), slabs.octant.shift, entries, hit, stack);
            } else {
                let _ = level.push_unordered(node.fan(), hit, stack);
            }
            continue;
        }
        if work > most_work {
            return None;
        }
        // SAFETY: a leaf's word was read from a node of this arena, and that node's word noted beside it.
        let (leaf, node) = unsafe { (place.view.leaf(word), place.view.node(Word(parents[stack.len()]))) };
        let (tested, changed) =
            visit_leaf(level, place, packet, sinks, leaf, &sides(level, node, word, &slabs));
        work += tested;
        if changed != 0 {
            t_max = packet.close(changed);
        }
    }
}

/// The near and far sides of a leaf's box, as its node has them.
#[inline(always)]
fn sides<L: Level, N: Boxes>(level: L, node: &N, word: Word, slabs: &Slabs) -> [Triple<L>; 2] {
    let mut place = 0;
    for other in 1..WIDTH {
        if node.fan().children[other] == word.0 {
            place = other;
        }
    }
    let (near, far) = (slabs.octant.near_rows, slabs.octant.far_rows);
    [
        [
            level.splat(node.side(0, near[0], place)),
            level.splat(node.side(1, near[1], place)),
            level.splat(node.side(2, near[2], place)),
        ],
        [
            level.splat(node.side(0, far[0], place)),
            level.splat(node.side(1, far[1], place)),
            level.splat(node.side(2, far[2], place)),
        ],
    ]
}

/// Tests a leaf's triangles; tells how many tests that took, and in which groups a window has become shorter, a bit each.
#[inline(always)]
fn visit_leaf<'a, L: Level, R: Reader<'a>, S: Sink>(
    level: L,
    place: Place<'a, R>,
    packet: &mut Packet,
    sinks: &mut [S; RAYS],
    leaf: R::Leaf,
    [near, far]: &[Triple<L>; 2],
) -> (usize, u32) {
    let (mut entered, mut groups) = (0_u32, packet.groups_that_enter(level, near, far));
    while groups != 0 {
        let group = groups.trailing_zeros() as usize % GROUPS;
        groups &= groups - 1;
        entered |= u32::from(packet.enters(level, group, near, far) != 0) << group;
    }
    if entered == 0 {
        return (1, 0);
    }
    let mut changed = 0;
    for triangle in 0..leaf.len() {
        let vertices = corners(level, leaf, triangle, packet.axes);
        let mut groups = entered;
        while groups != 0 {
            let group = groups.trailing_zeros() as usize % GROUPS;
            groups &= groups - 1;
            let lanes = packet.lanes(level, group);
            let edges = Edges::new(level, &vertices, &lanes.origin, &lanes.shears);
            let possible = edges.possible(level) & 0xff;
            if possible == 0 {
                continue;
            }
            let Some(crossings) = edges.settle(level, &vertices, &lanes, possible) else { continue };
            let number = leaf.name(triangle);
            let mut rays = crossings.lanes;
            while rays != 0 {
                let lane = rays.trailing_zeros() as usize % WIDTH;
                rays &= rays - 1;
                let ray = group * WIDTH + lane;
                if place.names.sees(packet.masks[ray], number) {
                    let flow = sinks[ray].offer(crossings.get(lane), number);
                    packet.t_max[group][lane] =
                        if flow.is_break() { f32::NEG_INFINITY } else { sinks[ray].t_max() };
                    changed |= 1 << group;
                }
            }
        }
    }
    (leaf.len() * entered.count_ones() as usize, changed)
}

/// The vertices of a triangle, each in all lanes.
#[inline(always)]
fn corners<L: Level, T: Triangles>(level: L, leaf: T, triangle: usize, axes: [usize; 3]) -> [Triple<L>; 3] {
    let (x, y, z) = (axes[0] % 3, axes[1] % 3, axes[2] % 3);
    [
        [
            level.splat(leaf.number(x, triangle)),
            level.splat(leaf.number(y, triangle)),
            level.splat(leaf.number(z, triangle)),
        ],
        [
            level.splat(leaf.number(3 + x, triangle)),
            level.splat(leaf.number(3 + y, triangle)),
            level.splat(leaf.number(3 + z, triangle)),
        ],
        [
            level.splat(leaf.number(6 + x, triangle)),
            level.splat(leaf.number(6 + y, triangle)),
            level.splat(leaf.number(6 + z, triangle)),
        ],
    ]
}
