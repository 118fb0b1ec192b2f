//! Walks: the ways in which a ray goes through a binary BVH.
//!
//! A walk knows nodes and boxes. What happens in a leaf, how far a hit limits the search, and what is counted is
//! the business of its [`Visitor`]: [`TriangleVisitor`] for the triangles of a flattened scene; a top level
//! whose leaves are objects brings another one.
//!
//! Each file holds one walk, in the form in which its source gives it:
//!
//! | file | walk | source |
//! |---|---|---|
//! | `recursive` | depth-first recursion | blog 2022 |
//! | `postponed` | a stack; leaves are handled at their parent; culling and sorting can be added | blog 2022 |
//! | `ordered` | a stack; leaves are ordered like inner nodes and entries are culled again at pop | the usual best |
//! | `restart_trail` | one bit a level and a short stack of any size, or none | Laine 2010 |
//!
//! All start at the root's children: the root's own box is not tested. A stack entry is two words.

mod batch;
mod collect;
mod ordered;
mod postponed;
mod recursive;
mod restart_trail;
pub(crate) mod short_stack;
mod single;
mod visitor;

pub use collect::{AllHits, AnyHit, ClosestHit, Collect, HitCount, Summary};
pub use ordered::Ordered;
pub use postponed::Postponed;
pub use recursive::Recursive;
pub use restart_trail::{ArrayTrail, RestartTrail, Trail, TrailU32, TrailU64};
pub use visitor::{TriangleVisitor, Visitor};

use super::Node;
use crate::PreparedRay;
use crate::aabb::{Interval, slab_test};

/// How the stack walk orders and culls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum StackOrder {
    /// First child first; nothing is culled.
    Unordered,
    /// First child first; boxes behind the closest hit are culled.
    Culled,
    /// Culled, and of two inner children the nearer one first.
    Sorted,
    /// The nearer child first, leaves too; entries are culled again when they are popped.
    #[default]
    Ordered,
}

impl StackOrder {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] = &[
        ("unordered", Self::Unordered),
        ("culled", Self::Culled),
        ("sorted", Self::Sorted),
        ("ordered", Self::Ordered),
    ];
}

/// A walk through valid nodes: see [`super::Bvh`] for what valid means. A value holds the settings of the walk.
pub trait BvhWalk: Copy + Sync {
    /// Shows the visitor every leaf that the ray may hit something in, until the visitor has seen enough.
    fn walk<V: Visitor>(self, nodes: &[Node], ray: &PreparedRay, visitor: &mut V);
}

/// Visits one leaf after the other without asking any box: every triangle is tested.
#[derive(Clone, Copy, Debug)]
pub struct BruteForce;

impl BvhWalk for BruteForce {
    fn walk<V: Visitor>(self, nodes: &[Node], _ray: &PreparedRay, visitor: &mut V) {
        for leaf in nodes.iter().filter(|node| node.is_leaf()) {
            if visitor.leaf(leaf.link, leaf.count).is_break() {
                return;
            }
        }
    }
}

/// The padded slab test of a node's box.
#[inline(always)]
pub(crate) fn test(node: &Node, ray: &PreparedRay, t_max: f32) -> Interval {
    let [min, max] = node.corners();
    slab_test(ray, min, max, t_max)
}
