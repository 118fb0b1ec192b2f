//! Several rays in turn on one core: while one waits for memory, the others work.
//!
//! A ray's next node is known when its last step ends, is asked for at once, and needed only when all others have
//! made a step: the misses of one ray hide behind the work of the rest. What each ray needs lies in a slot. A slot whose ray is
//! done takes the next one.
//!
//! Where leaves name vertices that lie elsewhere, and the tree is large, a leaf takes two turns: one to ask for its vertices, one
//! to test them.
//!
//! Round by round and plainly: sorting the slots by what they do next was slower in the prototype that this follows, because the
//! ends of its inner loops are not foreseen.

#[cfg(test)]
mod tests;

use super::Stack;
use super::boxes::{Boxes, Lanes, children};
use super::ray::WalkRay;
use super::single::{Place, visit_leaf};
use super::sink::{Any, Closest, Sink, is_blind};
use crate::bvh8::ROOT;
use crate::bvh8::arena::Reader;
use crate::bvh8::names::Names;
use crate::bvh8::node::DONE;
use crate::bvh8::simd::{Level, Task};
use crate::{Hit, NoProbe, PreparedRay, Ray};
use std::mem::MaybeUninit;
use std::ops::Range;

/// What a batch asks of each ray.
pub(super) trait Goal {
    type Sink: Sink + Copy;
    type Answer: Copy;
    fn sink(t_max: f32) -> Self::Sink;
    /// Of a sink that a ray has been led to, or of no ray at all.
    fn answer(sink: Option<&Self::Sink>, names: &Names) -> Self::Answer;
}

/// The closest hit.
pub(super) struct ClosestGoal;

impl Goal for ClosestGoal {
    type Sink = Closest;
    type Answer = Hit;

    #[inline(always)]
    fn sink(t_max: f32) -> Closest {
        Closest::new(t_max)
    }

    #[inline(always)]
    fn answer(sink: Option<&Closest>, names: &Names) -> Hit {
        sink.map_or(Hit::MISS, |sink| sink.answer(names))
    }
}

/// Whether there is a hit.
pub(super) struct AnyGoal;

impl Goal for AnyGoal {
    type Sink = Any;
    type Answer = bool;

    #[inline(always)]
    fn sink(t_max: f32) -> Any {
        Any::new(t_max)
    }

    #[inline(always)]
    fn answer(sink: Option<&Any>, _: &Names) -> bool {
        sink.is_some_and(|sink| sink.hit)
    }
}

/// A ray on its way. An odd number of cache lines apart from the next one: at 4096 bytes all slots would want the same few sets
/// of the cache, and batches took twice as long.
#[repr(C, align(64))]
struct Slot<S> {
    ray: WalkRay,
    sink: S,
    /// Which of the batch it is.
    index: usize,
    stack: Stack,
}

impl<S> Slot<S> {
    const LINES: usize = size_of::<Self>() / 64;
    const IS_ODD: () =
        assert!(Self::LINES % 2 == 1 && Self::LINES % 64 > 1, "slots share their sets of the cache");
}

/// The rays of a batch that have not begun.
struct Queue<'a> {
    names: &'a Names,
    rays: &'a [Ray],
    /// The next one, and where the run that it belongs to ends.
    next: usize,
    end: usize,
    /// Further runs.
    runs: std::slice::Iter<'a, Range<usize>>,
}

impl Queue<'_> {
    /// Puts the next ray that can be traced into a slot; those that cannot are answered on the way. False where there is none, and
    /// then nothing is written.
    #[inline(always)]
    fn load<G: Goal>(&mut self, slot: &mut MaybeUninit<Slot<G::Sink>>, answers: &mut [G::Answer]) -> bool {
        loop {
            while self.next == self.end {
                let Some(run) = self.runs.next() else { return false };
                (self.next, self.end) = (run.start, run.end);
            }
            let index = self.next;
            self.next += 1;
            let Some(ray) = self.rays.get(index) else { continue };
            if let Some(ray) = PreparedRay::new(ray)
                && !is_blind(&ray, self.names)
            {
                let slot = slot.as_mut_ptr();
                // SAFETY: the slot is there to be written. All of it is, but for the numbers of the stack, of which those above its
                // length are never read.
                unsafe {
                    (&raw mut (*slot).ray).write(WalkRay::new(&ray));
                    (&raw mut (*slot).sink).write(G::sink(ray.t_max));
                    (&raw mut (*slot).index).write(index);
                    Stack::begin(&raw mut (*slot).stack, ROOT.0);
                }
                return true;
            }
            answers[index] = G::answer(None, self.names);
        }
    }
}

/// Rays at a time where the tree is not large.
pub(super) const FEW: usize = 8;
/// Where it is.
pub(super) const MANY: usize = 16;

/// A batch, `SLOTS` rays at a time.
pub(super) struct Interleaved<'a, 'b, R, G: Goal, const SLOTS: usize> {
    pub(super) place: Place<'a, R>,
    pub(super) rays: &'b [Ray],
    /// Which of them.
    pub(super) runs: &'b [Range<usize>],
    /// As many as there are rays.
    pub(super) answers: &'b mut [G::Answer],
}

impl<'a, R: Reader<'a>, G: Goal, const SLOTS: usize> Task for Interleaved<'a, '_, R, G, SLOTS> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self, level: L) {
        let Self { place, rays, runs, answers } = self;
        const { Slot::<G::Sink>::IS_ODD };
        let mut queue = Queue { names: place.names, rays, next: 0, end: 0, runs: runs.iter() };
        // Not set to zero: that would take as long as tens of rays.
        let mut slots: [MaybeUninit<Slot<G::Sink>>; SLOTS] = [const { MaybeUninit::uninit() }; SLOTS];
        let mut free = slots.iter_mut();
        // The slots with rays in them come first.
        let mut busy: [*mut Slot<G::Sink>; SLOTS] = [std::ptr::null_mut(); SLOTS];
        let mut count = 0;
        // Of each, the leaf whose vertices were asked for. No slot has the same leaf twice, but its next ray may.
        let mut asked = [DONE; SLOTS];
        while let Some(slot) = free.next()
            && queue.load::<G>(slot, answers)
        {
            busy[count] = slot.as_mut_ptr();
            count += 1;
        }
        while count > 0 {
            let mut turn = 0;
            while turn < count {
                // SAFETY: there are `count` busy slots, each its own, with a ray in it.
                let slot = unsafe { &mut **busy.get_unchecked(turn) };
                let word = slot.stack.pop();
                let next;
                if !word.is_leaf() {
                    // SAFETY: the word is the root's, or was read from a node of this arena.
                    let node = unsafe { place.view.node(word) };
                    let slabs = &slot.ray.slabs;
                    let lanes = Lanes::new(level, slabs);
                    let (entries, hit) = children(level, node, slabs, &lanes, slot.sink.t_max());
                    next = if G::Sink::ORDERED {
                        level.push_ordered(node.fan(), slabs.octant.shift, entries, hit, &mut slot.stack)
                    } else {
                        level.push_unordered(node.fan(), hit, &mut slot.stack)
                    };
                } else if word.0 != DONE {
                    if R::APART && SLOTS > FEW && asked[turn] != word.0 {
                        // SAFETY: the word was read from a node of this arena and is not the sentinel.
                        unsafe { place.view.prefetch_vertices(word) };
                        asked[turn] = word.0;
                        // The word is still there.
                        slot.stack.grow(1);
                        turn += 1;
                        continue;
                    }
                    let before = slot.sink.t_max();
                    // SAFETY: the word was read from a node of this arena and is not the sentinel.
                    let flow = unsafe {
                        visit_leaf(level, place, word, &slot.ray.prepared, &mut slot.sink, &mut NoProbe)
                    };
                    if flow.is_break() {
                        slot.stack.reset();
                    } else if G::Sink::ORDERED && slot.sink.t_max() < before {
                        level.cull(&mut slot.stack, slot.sink.t_max());
                    }
                    next = slot.stack.peek();
                } else {
                    answers[slot.index] = G::answer(Some(&slot.sink), place.names);
                    // SAFETY: a slot may be written anew; where it is not it stays as it is.
                    let slot = unsafe { &mut *std::ptr::from_mut(slot).cast() };
                    if queue.load::<G>(slot, answers) {
                        if R::APART {
                            asked[turn] = DONE;
                        }
                        turn += 1;
                    } else {
                        count -= 1;
                        busy.swap(turn, count);
                        if R::APART {
                            asked[turn] = asked[count];
                        }
                    }
                    continue;
                }
                place.view.prefetch(next);
                turn += 1;
            }
        }
    }
}
