//! Walks: the ways in which a ray or a point goes through a binary BVH.
//!
//! A walk knows nodes. Where a box begins is asked of the [`Seeker`], a ray or a point. What happens in a leaf, how far
//! what was found limits the search, and what is counted is the business of the [`Visitor`]: [`TriangleVisitor`] for
//! the triangles of a flattened scene, [`crate::point::PointVisitor`] for their nearest points; a top level whose leaves
//! are objects brings another one.
//!
//! Each file holds one walk, in the form in which its source gives it:
//!
//! | file | walk | of | source |
//! |---|---|---|---|
//! | `recursive` | depth-first recursion | rays | blog 2022 |
//! | `postponed` | a stack; leaves are handled at their parent; culling and sorting can be added | rays | blog 2022 |
//! | `ordered` | a stack; leaves are ordered like inner nodes and entries are culled again at pop | both | the usual best |
//! | `skip_pointers` | no stack and one order: a pointer leads past what is missed | both | Toczek 2010 |
//! | `restart_trail` | one bit a level and a short stack of any size, or none | both | Laine 2010 |
//!
//! All start at the root's children: the root's own box is not tested. A stack entry is two words.

mod batch;
mod collect;
mod ordered;
mod postponed;
mod recursive;
mod restart_trail;
mod seeker;
pub(crate) mod short_stack;
mod single;
mod skip_pointers;
mod visitor;

pub use collect::{AllHits, AnyHit, ClosestHit, Collect, HitCount, Summary};
pub use ordered::{Ordered, OrderedFrom};
pub use postponed::Postponed;
pub use recursive::Recursive;
pub use restart_trail::{ArrayTrail, RestartTrail, Trail, TrailU32, TrailU64};
pub use seeker::Seeker;
pub use skip_pointers::SkipPointers;
pub(in crate::bvh) use skip_pointers::skip_pointers;
pub use visitor::{TriangleVisitor, Visitor};

use super::Node;
use crate::PreparedRay;

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

/// A walk of a seeker through valid nodes: see [`super::Bvh`] for what valid means. A value holds the settings of the
/// walk.
pub trait BvhWalk<S = PreparedRay>: Copy + Sync {
    /// Shows the visitor every leaf in which the seeker may find something, until the visitor has seen enough.
    fn walk<V: Visitor>(self, nodes: &[Node], seeker: &S, visitor: &mut V);
}

/// Visits one leaf after the other without asking any box: every triangle is tested.
#[derive(Clone, Copy, Debug)]
pub struct BruteForce;

impl<S> BvhWalk<S> for BruteForce {
    fn walk<V: Visitor>(self, nodes: &[Node], _seeker: &S, visitor: &mut V) {
        for leaf in nodes.iter().filter(|node| node.is_leaf()) {
            if visitor.leaf(leaf.link, leaf.count).is_break() {
                return;
            }
        }
    }
}
