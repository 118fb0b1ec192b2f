//! A ray on its way through two levels, step by step, as one of several that are led in turn.

use super::find::Find;
use super::levels::{Approach, Levels};
use crate::bvh8::ROOT;
use crate::bvh8::arena::Reader;
use crate::bvh8::node::{DONE, Word};
use crate::bvh8::simd::Level;
use crate::bvh8::walk::Stack;
use crate::bvh8::walk::boxes::{Boxes, Lanes, children};
use crate::bvh8::walk::ray::Slabs;
use crate::bvh8::walk::single::visit_leaf;
use crate::{PreparedRay, Probe, Ray};

/// A ray on its way. Stacks come last: of them the lowest places matter.
#[repr(align(64))]
pub(super) struct Course<'a, R, F> {
    slabs: Slabs,
    question: Ray,
    ray: PreparedRay,
    pub(super) find: F,
    /// Where the ray is inside an instance.
    entered: Option<Entered<'a, R>>,
    top: Stack,
    bottom: Stack,
}

/// A ray in the space of an instance's object.
struct Entered<'a, R> {
    slabs: Slabs,
    object: Approach<'a, R>,
    /// How far the scene was of interest when the ray entered.
    before: f32,
}

/// Whether a ray goes on.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    Made,
    Done,
}

impl<'a, R: Reader<'a>, F: Find<'a>> Course<'a, R, F> {
    /// At the root of the top level, which must not be empty.
    #[inline(always)]
    pub(super) fn new(question: &Ray, ray: PreparedRay, find: F) -> Self {
        let slabs = Slabs::new(&ray);
        let mut top = Stack::new();
        top.push(ROOT.0, 0.0);
        Self { slabs, question: *question, ray, find, entered: None, top, bottom: Stack::new() }
    }

    /// Takes another ray's place.
    #[inline(always)]
    pub(super) fn begin(&mut self, question: &Ray, ray: PreparedRay, find: F) {
        (self.slabs, self.question, self.ray) = (Slabs::new(&ray), *question, ray);
        (self.find, self.entered) = (find, None);
        self.top.reset();
        self.top.push(ROOT.0, 0.0);
    }

    /// Visits one node or one leaf. After [`Step::Done`] nothing is to be visited.
    #[inline(always)]
    pub(super) fn step<L: Level, P: Probe>(
        &mut self,
        level: L,
        levels: Levels<'a, R>,
        probe: &mut P,
    ) -> Step {
        if self.entered.is_some() {
            self.step_inside(level, levels, probe)
        } else {
            self.step_above(level, levels, probe)
        }
    }

    #[inline(always)]
    fn step_above<L: Level, P: Probe>(&mut self, level: L, levels: Levels<'a, R>, probe: &mut P) -> Step {
        let word = self.top.pop();
        if !word.is_leaf() {
            // SAFETY: the word is the root's, or was read from a node of this arena.
            let node = unsafe { levels.top.node(word) };
            visit::<L, _, F, P>(level, node, &self.slabs, self.find.t_max(), &mut self.top, probe);
        } else if word.0 == DONE {
            return Step::Done;
        } else {
            self.enter(levels, word, probe);
        }
        if let Some(entered) = &self.entered {
            entered.object.place.view.prefetch(ROOT);
        } else {
            levels.prefetch(self.top.peek());
        }
        Step::Made
    }

    /// Goes into the instance of a leaf, where the ray meets it.
    #[inline(always)]
    fn enter<P: Probe>(&mut self, levels: Levels<'a, R>, word: Word, probe: &mut P) {
        let Some(object) = levels.approach(word, &self.question, &self.ray, probe) else { return };
        let slabs = Slabs::new(&object.ray);
        self.entered = Some(Entered { slabs, object, before: self.find.t_max() });
        self.bottom.reset();
        self.bottom.push(ROOT.0, 0.0);
    }

    #[inline(always)]
    fn step_inside<L: Level, P: Probe>(&mut self, level: L, levels: Levels<'a, R>, probe: &mut P) -> Step {
        let Some(entered) = &self.entered else { return Step::Done };
        let word = self.bottom.pop();
        let limit = entered.object.moving.limit(self.find.t_max());
        if !word.is_leaf() {
            // SAFETY: the word is the root's, or was read from a node of this arena. Objects without nodes are not placed.
            let node = unsafe { entered.object.place.view.node(word) };
            visit::<L, _, F, P>(level, node, &entered.slabs, limit, &mut self.bottom, probe);
        } else if word.0 == DONE {
            probe.object_left();
            let before = entered.before;
            self.entered = None;
            if F::ORDERED && self.find.t_max() < before {
                level.cull(&mut self.top, self.find.t_max());
            }
            levels.prefetch(self.top.peek());
            return Step::Made;
        } else {
            let Approach { ray, place, moving, .. } = &entered.object;
            let mut inside = entered.object.inside(&mut self.find);
            // SAFETY: the word was read from a node of this arena and is not the sentinel.
            let flow = unsafe { visit_leaf(level, *place, word, ray, &mut inside, probe) };
            if flow.is_break() {
                return Step::Done;
            }
            let after = moving.limit(self.find.t_max());
            if F::ORDERED && after < limit {
                level.cull(&mut self.bottom, after);
            }
        }
        entered.object.place.view.prefetch(self.bottom.peek());
        Step::Made
    }
}

/// Pushes the children of a node that the ray meets.
#[inline(always)]
fn visit<'a, L: Level, N: Boxes, F: Find<'a>, P: Probe>(
    level: L,
    node: &N,
    slabs: &Slabs,
    limit: f32,
    stack: &mut Stack,
    probe: &mut P,
) {
    probe.inner_visit();
    let lanes = Lanes::new(level, slabs);
    let (entries, hit) = children(level, node, slabs, &lanes, limit);
    let _ = if F::ORDERED {
        level.push_ordered(node.fan(), slabs.octant.shift, entries, hit, stack)
    } else {
        level.push_unordered(node.fan(), hit, stack)
    };
    // Of the sentinel too.
    probe.stack_depth(stack.len() - 1);
}
