//! Walks: the ways in which a ray goes through a kd-tree.
//!
//! A walk knows nodes, and shows every leaf that may matter to a [`Visitor`], first and number of its references.
//!
//! **A cell's interval** is the padded slab test of the cell's box, computed plane by plane on the way down: the near child's
//! interval ends where the ray meets the plane, the far child's begins there, both padded and closed. A child is open when its
//! interval is not empty.
//!
//! | file | walk | finds the next leaf by | source |
//! |---|---|---|---|
//! | `stack` | a full stack of 12-byte entries | what waits | Wald 2004 |
//! | `restart_trail` | a bit a level, and a short stack or none | the trail | Laine 2010 |
//! | `restart` | nothing | the last leaf's exit, from the root | Foley and Sugerman 2005 |
//! | `backtrack` | parents and boxes | the last leaf's exit, from the ancestor that reaches beyond | Foley and Sugerman 2005 |
//! | `short_stack` | a ring of entries; a restart where it is exhausted | what waits, or the last leaf's exit, from the node that holds all that is left | Horn et al. 2007 |
//! | `ropes` | ropes and the leaves' boxes | the face through which the ray leaves the leaf | Popov et al. 2007 |
//!
//! **What they cost**, as inner visits against the stack's, primary to random rays in six scenes of 57,000 to 871,000 triangles (2026-11-22):
//! the trail without a stack 2.2 to 3.5 times, with four entries 1.00 to 1.15; restart 2.0 to 3.3; backtrack 1.6 to 2.0, ancestors
//! counted; a short stack of three entries 1.00 to 1.12; ropes 0.68 to 0.87. No stack ever held more than 15 entries.
//!
//! The first two go through the same leaves in the same order, for every ray. The other four know where they are by `t`
//! alone, which is not enough where padding decides; what they do then stands in `certain`.

pub(crate) mod backtrack;
mod certain;
pub(crate) mod crossing;
mod restart;
mod restart_trail;
mod ropes;
mod short_stack;
mod stack;
mod visitor;

pub use backtrack::Backtrack;
pub use certain::BAND;
pub use restart::Restart;
pub use restart_trail::RestartTrail;
pub use ropes::Ropes;
pub use short_stack::ShortStack;
pub use stack::{Stack, StackFrom};
pub use visitor::ReferenceVisitor;

use super::KdTree;
use crate::PreparedRay;
use crate::bvh::walk::{TrailU64, Visitor};

/// How a walk came to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// By itself.
    Own,
    /// It gave the ray over to the restart trail, which began at the root: leaves may have been visited twice.
    GivenOver,
}

/// A walk through kd-trees. A value holds the settings of the walk.
pub trait KdWalk: Copy + Sync {
    /// Whether the walk may show the visitor a leaf again.
    const SHOWS_AGAIN: bool = false;

    /// Shows the visitor every leaf in which the ray may find something, until the visitor has seen enough.
    fn walk<V: Visitor>(self, tree: &KdTree, ray: &PreparedRay, visitor: &mut V) -> Course;
}

/// Gives a ray over to the restart trail without a stack, from the root on, which counts as a restart. What was found stays found,
/// and shortens the ray.
#[cold]
#[inline(never)]
fn give_over<V: Visitor>(tree: &KdTree, ray: &PreparedRay, visitor: &mut V) -> Course {
    visitor.restart();
    RestartTrail::<TrailU64>::new(0).walk(tree, ray, visitor);
    Course::GivenOver
}
