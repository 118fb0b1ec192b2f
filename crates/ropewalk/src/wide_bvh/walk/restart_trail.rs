//! The restart trail of wide trees: any wide BVH without a full stack. Laine (2010) names it as future work;
//! Vaidyanathan, Woop and Benthin (2019) do it for hardware. This is the form of ALGORITHMS: C9b, with one correction.
//!
//! **What is remembered.** For each level of the current path from the root, the number of finished children of the
//! path's node there, and whether the child that the path takes is the last one ([`Trail`]). A short stack
//! ([`ShortStack`]) keeps the youngest of the children that wait; it drops its oldest where it is full.
//!
//! **Arrival** at an inner node whose `n` finished children are known: of its hit children, nearest first, the first
//! `n` are skipped. Is nothing left, the node is finished. Else the walk goes to the first of the rest and pushes the
//! others, farthest first, that one marked `last`; where there are no others, the level is flagged "no more".
//!
//! **Finish**: the deepest level above the current node that is not flagged gets one more finished child, and
//! everything below it is forgotten; is there none, the walk is over. The stack's youngest entry is the child to visit
//! next; is it marked `last`, the level is flagged. Is it culled, it is finished too, and the rule is applied again. Is
//! the stack exhausted, the walk goes back to the root and arrives at each node of the path once more.
//!
//! **Why it is right.** The order of a node's children depends on the ray and the boxes alone, and a shorter ray only
//! cuts its end off ([`super`]). Children are finished in that order. So at any time, in the order of *all* children
//! that were ever hit: the finished ones come first, then the one that the path takes, then those that wait; and what
//! a shorter ray removes is at the end. From this follow the cases that need thought:
//!
//! * *More children are finished than are hit now* (`n` is beyond the end): all that wait are culled, and so is the one
//!   that the path took when it came by first. The node is finished. C9b as printed forgets the number when it flags the
//!   level, and goes to the last child that is hit *now*: one that is finished already, whose subtree it enters again.
//! * *On a restart fewer children wait than before.* Those missing are culled for good. If none is left, the level is
//!   flagged now. Nothing of it can be in the stack, which was empty at the restart.
//! * *A flagged level is passed on a restart.* None waited there when it was flagged, so none waits now: it is flagged
//!   again, or its node is finished.
//! * *The stack has dropped some of a node's children.* Its oldest are the farthest of the uppermost level, so what it
//!   holds is always the youngest part of what an unlimited stack would hold. The youngest entry belongs to the deepest
//!   level that is not flagged, because a level is flagged exactly when none of its children waits; it is that level's
//!   next child.
//! * *A hit in front of the box it was found in* can be with spatial splits, where a leaf holds a part of a triangle.
//!   Then nodes of the current path may be culled. The first case finishes them.
//!
//! **It ends**: read from the root down, the numbers of finished children only ever grow, and no leaf is entered twice.
//! With a stack that never drops anything there is no restart, and the visits are those of [`super::Ordered`], in its
//! order.
//!
//! **It costs visits** of the nodes above at each restart: `ropewalk lab restart-trail` measures them. The table of
//! ALGORITHMS: 4.4 is of a walk that does not cull at pop. That one makes up to a quarter more visits with a full stack,
//! which a restart spares it in part, so its ratios look better: of diffuse rays in a kitchen, 8 children a node, 9.6
//! visits and 1.73, 1.23, 1.09, 1.04 times as many with 0 to 3 entries; with culling at pop 8.7 visits and 1.90, 1.34,
//! 1.16, 1.09 times as many, which are fewer from one entry on.

use super::{ArrayTrail, HitChildren, Target, Trail, TrailU64, Waiting, WideNodes, WideWalk};
use crate::batch::{Batch, Traversal};
use crate::bvh::walk::Visitor;
use crate::bvh::walk::short_stack::ShortStack;
use crate::catalogue::{TrailOptions, TrailRegister};
use crate::wide_bvh::WideBvh;
use crate::{PreparedRay, TraceError, Traced};
use std::marker::PhantomData;

/// Traces a batch with the register that was asked for, or the smallest that serves the tree.
pub(super) fn trace(bvh: &WideBvh, options: TrailOptions, batch: Batch<'_>) -> Result<Traced, TraceError> {
    let short_stack = options.short_stack;
    Ok(match options.wide_register_for(bvh.report().depth)? {
        TrailRegister::U64 => bvh.by(RestartTrail::<TrailU64>::new(short_stack)).trace(batch),
        // There are no 32 bits for wide trees: the catalogue refuses them.
        TrailRegister::Array | TrailRegister::Auto | TrailRegister::U32 => {
            bvh.by(RestartTrail::<ArrayTrail>::new(short_stack)).trace(batch)
        }
    })
}

/// The walk, with a trail of type `T` and a short stack in a ring of `ROOM` places.
#[derive(Clone, Copy, Debug)]
pub struct RestartTrail<T, const ROOM: usize = 16> {
    capacity: usize,
    trail: PhantomData<fn() -> T>,
}

impl<T: Trail, const ROOM: usize> RestartTrail<T, ROOM> {
    /// A walk whose stack holds the last `min(short_stack, ROOM)` entries. Where a tree has more levels than the trail,
    /// [`ArrayTrail`] takes its place.
    #[must_use]
    pub const fn new(short_stack: u32) -> Self {
        Self { capacity: short_stack as usize, trail: PhantomData }
    }
}

impl<T: Trail, const ROOM: usize> WideWalk for RestartTrail<T, ROOM> {
    #[inline(always)]
    fn walk<const WIDTH: usize, V: Visitor>(
        self,
        tree: WideNodes<'_, WIDTH>,
        ray: &PreparedRay,
        visitor: &mut V,
    ) {
        if tree.levels <= T::LEVELS {
            walk::<T, ROOM, WIDTH, V>(self.capacity, tree, ray, visitor);
        } else {
            walk::<ArrayTrail, ROOM, WIDTH, V>(self.capacity, tree, ray, visitor);
        }
    }
}

#[inline(always)]
fn walk<T: Trail, const ROOM: usize, const WIDTH: usize, V: Visitor>(
    capacity: usize,
    tree: WideNodes<'_, WIDTH>,
    ray: &PreparedRay,
    visitor: &mut V,
) {
    if tree.nodes.is_empty() {
        return;
    }
    let mut trail = T::new();
    let mut stack = ShortStack::<Waiting, ROOM>::new(capacity);
    let mut current = Target::ROOT;
    loop {
        if current.is_leaf() {
            if visitor.leaf(current.link, current.count).is_break() {
                return;
            }
        } else {
            visitor.inner_visit(current.link);
            let hit = HitChildren::of(&tree.nodes[current.link as usize], ray, visitor.t_max());
            let hit = hit.sorted();
            if let Some([next, others @ ..]) = hit.get(trail.next(hit.len())..) {
                push(&mut stack, others, visitor);
                if others.is_empty() {
                    trail.set_last();
                }
                trail.descend();
                current = next.target;
                continue;
            }
        }
        loop {
            if !trail.finish() {
                return;
            }
            let Some(child) = stack.pop() else {
                trail.restart();
                visitor.restart();
                current = Target::ROOT;
                break;
            };
            if child.last {
                trail.set_last();
            }
            trail.descend();
            // Closed: at equal t a smaller id may still win. One that is culled is finished like one that was visited.
            if child.entry <= visitor.t_max() {
                current = child.target;
                break;
            }
        }
    }
}

/// Pushes the children that wait, farthest first.
#[inline(always)]
fn push<const ROOM: usize, V: Visitor>(
    stack: &mut ShortStack<Waiting, ROOM>,
    others: &[Waiting],
    visitor: &mut V,
) {
    let Some((farthest, nearer)) = others.split_last() else { return };
    let mut held = stack.push(Waiting { last: true, ..*farthest });
    for child in nearer.iter().rev() {
        held = stack.push(*child);
    }
    if held > 0 {
        visitor.stack_depth(held);
    }
}
