//! The restart trail (Laine 2010): any BVH without a full stack.
//!
//! One bit a level says what is done: 0, the near child is not finished (or there has been nothing yet); 1, the near
//! child is finished, or there is only one child to visit. When the stack has nothing more to give, the walk goes back
//! to the root, and the trail leads it to where it was. The stack may therefore have any size, none included: it is a
//! ring whose oldest entry is dropped when a new one finds no room ([`ShortStack`]).
//!
//! **What the paper leaves open**, and what holds here (ALGORITHMS: C2):
//! * near and far depend on the seeker and the boxes alone, never on what has been found; the first child is near at a
//!   tie. What is found only lowers the limit, so the near child is culled no sooner than the far one;
//! * culling is closed (`entry <= t_max`): a parent of a hit is never culled behind it;
//! * **far levels**: where one child is hit of a node whose near child was finished by a pop, the hits since then cull the
//!   far one, and the node is finished. The paper remembers the level of the last pop alone. That is enough while no hit
//!   culls a box on the way to it. With spatial splits one can: a leaf holds a part of a triangle, of which another part
//!   is nearer, and then a restart meets far levels above the last one whose far child is culled. With the last level
//!   alone 250 leaves were entered again around the dragon (100,000 closest points, no stack, SBVH), so a register
//!   marks them all;
//! * an entry that is culled when it is popped has its bit of the trail like one that is visited, so each discarded
//!   entry is followed by its own update of the trail. With a stack that never drops anything, the sequence of nodes
//!   is that of [`super::Ordered`].
//!
//! **Registers** ([`Trail`]): the printed formulas are wrong (`&= ~levelReg` clears what it then sets; the lowest bit
//! by `temp` misses bit 0); here it is `(trail & -level) + level` and `trail & -trail`. 32 bits serve trees of depth
//! 31, 64 bits of depth 63, the array any depth up to [`MAX_DEPTH`].
//!
//! Without a stack about 1.6 to 3.2 times the inner visits of a full stack, with one entry 1.1 to 1.7, with three at
//! most 1.14: `ropewalk lab restart-trail` measures it. Points pay more: around the Stanford bunny and dragon 7.5 to 10.7
//! times without a stack and 1.5 to 1.7 with four entries (`ropewalk lab closest-point`); "closest-point and kNN
//! searches" are the paper's second piece of future work. The twin is `walk_bvh_restart_trail.wgsl`.

use super::ordered::Entry;
use super::short_stack::ShortStack;
use super::{BvhWalk, Seeker, Visitor};
use crate::batch::{Batch, Traversal};
use crate::bvh::{Bvh, MAX_DEPTH, Node};
use crate::catalogue::{TrailOptions, TrailRegister};
use crate::{TraceError, Traced};

/// Traces a batch with the register that was asked for, or the smallest that serves the tree.
pub(super) fn trace(bvh: &Bvh, options: TrailOptions, batch: Batch<'_>) -> Result<Traced, TraceError> {
    let room = options.short_stack;
    Ok(match options.register_for(bvh.report().depth)? {
        TrailRegister::U32 => bvh.by(RestartTrail::<TrailU32>::new(room)).trace(batch),
        TrailRegister::U64 => bvh.by(RestartTrail::<TrailU64>::new(room)).trace(batch),
        TrailRegister::Array | TrailRegister::Auto => {
            bvh.by(RestartTrail::<ArrayTrail>::new(room)).trace(batch)
        }
    })
}

/// The bits of the trail, and the level at which the walk is.
///
/// A level's bit belongs to the parent of the current node; level 0 is the sentinel, above the root.
pub trait Trail: Copy {
    /// The depth of the deepest leaf that the trail can lead to.
    const LEVELS: u32;

    /// Nothing done, at the root.
    fn new() -> Self;
    /// Goes down to a child. To be called before the bit of the node is asked or set.
    fn descend(&mut self);
    /// Whether the near child of the node that was left by the last [`Trail::descend`] is finished.
    fn is_near_done(&self) -> bool;
    /// Notes that the node has one child to visit.
    fn set_single(&mut self);
    /// Whether a pop led to the far child at this level: the near one is finished.
    fn is_far_level(&self) -> bool;
    /// Notes that the current node is finished, and goes up to the level of the next one; whether there is one.
    fn finish(&mut self) -> bool;
    /// Goes to the root, to be led down again.
    fn restart(&mut self);
}

/// The trail as bytes, as the paper's figure 2 words it: the reference of the registers.
#[derive(Clone, Copy, Debug)]
pub struct ArrayTrail {
    bits: [bool; MAX_DEPTH as usize + 1],
    level: usize,
    /// The levels at which the far child's turn has come.
    far: [bool; MAX_DEPTH as usize + 1],
    /// No deeper bit is set.
    deepest: usize,
}

impl Trail for ArrayTrail {
    const LEVELS: u32 = MAX_DEPTH;

    #[inline(always)]
    fn new() -> Self {
        let none = [false; MAX_DEPTH as usize + 1];
        Self { bits: none, level: 0, far: none, deepest: 0 }
    }

    #[inline(always)]
    fn descend(&mut self) {
        self.level += 1;
        self.deepest = self.deepest.max(self.level);
    }

    #[inline(always)]
    fn is_near_done(&self) -> bool {
        self.bits[self.level]
    }

    #[inline(always)]
    fn set_single(&mut self) {
        self.bits[self.level] = true;
    }

    #[inline(always)]
    fn is_far_level(&self) -> bool {
        self.far[self.level]
    }

    #[inline(always)]
    fn finish(&mut self) -> bool {
        while self.level > 0 && self.bits[self.level] {
            self.level -= 1;
        }
        // Nothing has been visited of the next branch.
        let below = self.level + 1..=self.deepest.max(self.level);
        self.bits[below.clone()].fill(false);
        self.far[below].fill(false);
        self.bits[self.level] = true;
        self.far[self.level] = true;
        self.deepest = self.level;
        self.level > 0
    }

    #[inline(always)]
    fn restart(&mut self) {
        self.level = 0;
    }
}

/// The trail in registers: the sentinel is the top bit, each level the next lower one.
macro_rules! register_trail {
    ($name:ident, $word:ty, $about:literal) => {
        #[doc = $about]
        #[derive(Clone, Copy, Debug)]
        pub struct $name {
            trail: $word,
            /// One bit.
            level: $word,
            /// The levels at which the far child's turn has come.
            far: $word,
        }

        impl $name {
            const SENTINEL: $word = 1 << (<$word>::BITS - 1);
        }

        impl Trail for $name {
            const LEVELS: u32 = <$word>::BITS - 1;

            #[inline(always)]
            fn new() -> Self {
                Self { trail: 0, level: Self::SENTINEL, far: 0 }
            }

            #[inline(always)]
            fn descend(&mut self) {
                self.level >>= 1;
            }

            #[inline(always)]
            fn is_near_done(&self) -> bool {
                self.trail & self.level != 0
            }

            #[inline(always)]
            fn set_single(&mut self) {
                self.trail |= self.level;
            }

            #[inline(always)]
            fn is_far_level(&self) -> bool {
                self.far & self.level != 0
            }

            #[inline(always)]
            fn finish(&mut self) -> bool {
                // Clears the levels below and carries through the ones above to the next zero. The carry out of the
                // top bit cannot happen: the walk is over when the sentinel is set.
                self.trail = (self.trail & self.level.wrapping_neg()).wrapping_add(self.level);
                self.level = self.trail & self.trail.wrapping_neg();
                self.far = (self.far & self.level.wrapping_neg()) | self.level;
                self.trail & Self::SENTINEL == 0
            }

            #[inline(always)]
            fn restart(&mut self) {
                self.level = Self::SENTINEL;
            }
        }
    };
}

register_trail!(TrailU32, u32, "The trail in 32-bit registers, for trees of depth 31.");
register_trail!(TrailU64, u64, "The trail in 64-bit registers, for trees of depth 63.");

/// The walk, with a trail of type `T` and a short stack in a ring of `ROOM` places.
///
/// Without `CULL_AT_POP` an entry is visited whatever has been found since it was pushed, as the paper has it: the same
/// answers with more visits, and the measure of what culling at pop is worth.
#[derive(Clone, Copy, Debug)]
pub struct RestartTrail<T, const ROOM: usize = 16, const CULL_AT_POP: bool = true> {
    capacity: usize,
    trail: std::marker::PhantomData<fn() -> T>,
}

impl<T: Trail, const ROOM: usize, const CULL_AT_POP: bool> RestartTrail<T, ROOM, CULL_AT_POP> {
    /// A walk whose stack holds the last `min(short_stack, ROOM)` entries. The tree must be no deeper than the
    /// trail's [`Trail::LEVELS`].
    #[must_use]
    pub const fn new(short_stack: u32) -> Self {
        Self { capacity: short_stack as usize, trail: std::marker::PhantomData }
    }
}

impl<S: Seeker, T: Trail + Sync, const ROOM: usize, const CULL_AT_POP: bool> BvhWalk<S>
    for RestartTrail<T, ROOM, CULL_AT_POP>
{
    #[inline(always)]
    fn walk<V: Visitor>(self, nodes: &[Node], seeker: &S, visitor: &mut V) {
        if nodes.is_empty() {
            return;
        }
        let mut trail = T::new();
        let mut stack = ShortStack::<Entry, ROOM>::new(self.capacity);
        let mut current = 0;
        loop {
            let node = &nodes[current as usize];
            if node.is_leaf() {
                if visitor.leaf(node.link, node.count).is_break() {
                    return;
                }
            } else {
                visitor.inner_visit(current);
                let (first, second) = (current + 1, node.link);
                let a = seeker.approach(&nodes[first as usize], visitor.t_max());
                let b = seeker.approach(&nodes[second as usize], visitor.t_max());
                match (a.is_hit(), b.is_hit()) {
                    (true, true) => {
                        // The first child at equal distance, so that the order is one for all devices.
                        let (near, far, entry) = if b.entry < a.entry {
                            (second, first, a.entry)
                        } else {
                            (first, second, b.entry)
                        };
                        trail.descend();
                        if trail.is_near_done() {
                            current = far;
                        } else {
                            current = near;
                            if self.capacity > 0 {
                                visitor.stack_depth(stack.push(Entry { node: far, entry }));
                            }
                        }
                        continue;
                    }
                    (true, false) | (false, true) => {
                        trail.descend();
                        if !trail.is_far_level() {
                            trail.set_single();
                            current = if a.is_hit() { first } else { second };
                            continue;
                        }
                        // Both were hit when the walk came by first, and the near one is finished: the hits since
                        // then cull the far one.
                    }
                    (false, false) => {}
                }
            }
            loop {
                if !trail.finish() {
                    return;
                }
                match stack.pop() {
                    None => {
                        trail.restart();
                        visitor.restart();
                        current = 0;
                        break;
                    }
                    // Closed: at equal t a smaller id may still win.
                    Some(far) if !CULL_AT_POP || far.entry <= visitor.t_max() => {
                        current = far.node;
                        break;
                    }
                    // Culled. It has its own bit of the trail, which the next round sets.
                    Some(_) => {}
                }
            }
        }
    }
}
