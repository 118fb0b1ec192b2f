//! One ray through two levels: the walk of one ray through the object's tree, from inside the same through the top one.

use super::find::{Find, Goal};
use super::levels::Levels;
use crate::bvh8::ROOT;
use crate::bvh8::arena::Reader;
use crate::bvh8::node::{DONE, Word};
use crate::bvh8::simd::{Level, Task};
use crate::bvh8::walk::Stack;
use crate::bvh8::walk::boxes::{Lanes, children};
use crate::bvh8::walk::ray::Slabs;
use crate::bvh8::walk::single::walk;
use crate::{NoProbe, PreparedRay, Probe, Ray};
use std::marker::PhantomData;

/// Leads a ray through both levels. The top one must not be empty; the ray is that of which the prepared one was made.
#[inline(always)]
fn lead<'a, L: Level, R: Reader<'a>, F: Find<'a>, P: Probe>(
    level: L,
    levels: Levels<'a, R>,
    (question, ray): (&Ray, &PreparedRay),
    find: &mut F,
    probe: &mut P,
) {
    let slabs = Slabs::new(ray);
    let lanes = Lanes::new(level, &slabs);
    let mut stack = Stack::new();
    let mut word = ROOT;
    loop {
        if !word.is_leaf() {
            probe.inner_visit();
            // SAFETY: the word is the root's, or was read from a node of this arena.
            let node = unsafe { levels.top.node(word) };
            let (entries, mask) = children(level, node, &slabs, &lanes, find.t_max());
            let hit = level.bits(mask);
            if hit == 0 {
                word = stack.pop();
            } else if hit & (hit - 1) == 0 {
                word = Word(node.children[hit.trailing_zeros() as usize % 8]);
            } else {
                word = if F::ORDERED {
                    level.push_ordered(node.fan(), slabs.octant.shift, entries, mask, &mut stack)
                } else {
                    level.push_unordered(node.fan(), mask, &mut stack)
                };
                // Of the sentinel too.
                probe.stack_depth(stack.len() - 1);
                stack.shrink_to(stack.len() - 1);
                levels.prefetch(stack.peek());
            }
            continue;
        }
        if word.0 == DONE {
            return;
        }
        if let Some(object) = levels.approach(word, question, ray, probe) {
            let before = find.t_max();
            let mut inside = object.inside(find);
            // Objects without nodes are not placed.
            walk(level, object.place, &object.ray, &mut inside, probe);
            let ended = inside.ended;
            probe.object_left();
            if ended {
                return;
            }
            if F::ORDERED && find.t_max() < before {
                level.cull(&mut stack, find.t_max());
            }
        }
        word = stack.pop();
    }
}

/// A walk of one ray, to be run at some level.
pub(super) struct One<'a, 'r, R, F, P> {
    pub(super) levels: Levels<'a, R>,
    pub(super) question: &'r Ray,
    pub(super) ray: &'r PreparedRay,
    pub(super) find: F,
    pub(super) probe: P,
}

impl<'a, R: Reader<'a>, F: Find<'a>, P: Probe> Task for One<'a, '_, R, F, P> {
    type Output = (F, P);

    #[inline(always)]
    fn run<L: Level>(mut self, level: L) -> (F, P) {
        lead(level, self.levels, (self.question, self.ray), &mut self.find, &mut self.probe);
        (self.find, self.probe)
    }
}

/// A batch, one ray after the other.
pub(super) struct Each<'a, 'b, R, G: Goal<'a>> {
    pub(super) levels: Levels<'a, R>,
    pub(super) rays: &'b [Ray],
    /// As many as there are rays.
    pub(super) answers: &'b mut [G::Answer],
    pub(super) goal: PhantomData<G>,
}

impl<'a, R: Reader<'a>, G: Goal<'a>> Task for Each<'a, '_, R, G> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self, level: L) {
        for (answer, question) in self.answers.iter_mut().zip(self.rays) {
            *answer = match PreparedRay::new(question) {
                Some(ray) => {
                    let mut goal = G::new(&ray);
                    lead(level, self.levels, (question, &ray), &mut goal, &mut NoProbe);
                    goal.answer()
                }
                None => G::NOTHING,
            };
        }
    }
}
