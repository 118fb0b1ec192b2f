//! Walks: the ways in which a ray goes through a wide BVH.
//!
//! They lead the same [`Visitor`]s as the walks of binary trees do. An inner visit tests the boxes of all children of
//! one wide node.
//!
//! | file | walk | source |
//! |---|---|---|
//! | `ordered` | a stack; hit children nearest first, culled again at pop | the usual best |
//! | `restart_trail` | four bits a level and a short stack of any size, or none | Laine 2010, Vaidyanathan et al. 2019 |
//!
//! All start at the root's children: there is no box around the root.
//!
//! **The order of the hit children.** [`HitChildren`] sorts them by where the ray enters them, equals by their place.
//! The entry into a box depends on the ray's line and `t_min`, not on `t_max`, and a child is hit while its entry is
//! at most `t_max`. So all that a shorter ray changes in the order is that it ends earlier: whatever has been hit
//! meanwhile, the hit children of a node are a prefix of those it had before. The restart trail builds on it.

mod batch;
mod children;
mod ordered;
mod restart_trail;
mod single;
mod trail;

pub use children::{HitChildren, Target, Waiting};
pub use ordered::Ordered;
pub use restart_trail::RestartTrail;
pub use trail::{ArrayTrail, Trail, TrailU64};

use super::is_empty;
use crate::PreparedRay;
use crate::bvh::Node;
use crate::bvh::walk::Visitor;

/// The wide nodes of a valid tree: see [`super::WideBvh`] for what valid means.
#[derive(Clone, Copy, Debug)]
pub struct WideNodes<'a, const WIDTH: usize> {
    /// The children of each wide node.
    pub nodes: &'a [[Node; WIDTH]],
    /// The most wide nodes on a path from the root.
    pub levels: u32,
    /// The most entries that a stack can hold: see [`super::WideBvh::stack_entries`].
    pub stack_entries: u32,
}

/// A walk through wide nodes. A value holds the settings of the walk.
pub trait WideWalk: Copy + Sync {
    /// Shows the visitor every leaf that the ray may hit something in, until the visitor has seen enough.
    fn walk<const WIDTH: usize, V: Visitor>(
        self,
        tree: WideNodes<'_, WIDTH>,
        ray: &PreparedRay,
        visitor: &mut V,
    );
}

/// Visits one leaf after the other without asking any box: every triangle is tested.
#[derive(Clone, Copy, Debug)]
pub struct BruteForce;

impl WideWalk for BruteForce {
    fn walk<const WIDTH: usize, V: Visitor>(
        self,
        tree: WideNodes<'_, WIDTH>,
        _ray: &PreparedRay,
        visitor: &mut V,
    ) {
        for leaf in tree.nodes.as_flattened().iter().filter(|child| child.is_leaf()) {
            if visitor.leaf(leaf.link, leaf.count).is_break() {
                return;
            }
        }
    }
}
