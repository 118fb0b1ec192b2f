//! Walks: the ways in which a point query goes through a binary BVH.
//!
//! The counterparts of [`crate::bvh::walk`], led by squared distances of boxes in the place of a ray's entries. The
//! visitor is the same trait, with the largest squared distance of interest for its `t_max`.
//!
//! | file | walk |
//! |---|---|
//! | `mod` | brute force: every triangle of every leaf |
//! | `stack` | nearer child first, culled again at pop |
//! | `restart_trail` | one bit a level and a short stack of any size, or none (Laine 2010) |
//!
//! **Why the trail may be used.** It wants three things of a search: no node twice; an order of the children that does
//! not change; and no near child culled that has a far child which is not. The order is that of the boxes' distances,
//! which no finding changes, the first child first at a tie. What is found only lowers the limit, the nearer child is
//! culled no sooner than the farther one, and a parent, being no farther than its children, no sooner than they
//! are. Culling is closed, so a box at the very limit is no exception.

mod restart_trail;
mod stack;

pub use restart_trail::PointRestartTrail;
pub use stack::PointStack;

use super::{PreparedPoint, box_distance_squared};
use crate::bvh::Node;
use crate::bvh::walk::Visitor;

/// A walk through valid nodes: see [`crate::Bvh`] for what valid means. A value holds the settings of the walk.
pub trait PointWalk: Copy + Sync {
    /// Shows the visitor every leaf that may hold something within its limit, until the visitor has seen enough.
    fn walk<V: Visitor>(self, nodes: &[Node], point: &PreparedPoint, visitor: &mut V);
}

/// Visits one leaf after the other without asking any box: every triangle is asked.
#[derive(Clone, Copy, Debug)]
pub struct PointBruteForce;

impl PointWalk for PointBruteForce {
    fn walk<V: Visitor>(self, nodes: &[Node], _point: &PreparedPoint, visitor: &mut V) {
        for leaf in nodes.iter().filter(|node| node.is_leaf()) {
            if visitor.leaf(leaf.link, leaf.count).is_break() {
                return;
            }
        }
    }
}

/// A child that waits, and the squared distance to its box.
#[derive(Clone, Copy, Default)]
struct Entry {
    node: u32,
    square: f32,
}

/// The children of an inner node, with the squared distances to their boxes, the nearer one first; the first child at
/// equal distance, so that the order is one for all devices.
#[inline(always)]
fn children(nodes: &[Node], current: u32, point: &PreparedPoint) -> (Entry, Entry) {
    let measure = |node: u32| {
        let [min, max] = nodes[node as usize].corners();
        Entry { node, square: box_distance_squared(point, min, max) }
    };
    let first = measure(current + 1);
    let second = measure(nodes[current as usize].link);
    if second.square < first.square { (second, first) } else { (first, second) }
}
