//! One ray from the root to the end.

use super::Stack;
use super::boxes::{Boxes, Lanes, children};
use super::ray::WalkRay;
use super::sink::{Any, Closest, Named, Sink, is_blind, tell};
use super::triangles::cross;
use crate::batch::Traversal;
use crate::bvh::walk::Collect;
use crate::bvh8::arena::{CompactView, Reader, View};
use crate::bvh8::leaf::Triangles;
use crate::bvh8::names::Names;
use crate::bvh8::node::{DONE, Word};
use crate::bvh8::simd::{Level, Task, dispatch};
use crate::bvh8::{Bvh8, Form, ROOT};
use crate::{Counters, Hit, NoProbe, PreparedRay, Probe, Ray};
use std::ops::ControlFlow;

/// What a walk goes through.
#[derive(Clone, Copy)]
pub(in super::super) struct Place<'a, R> {
    pub(in super::super) view: R,
    pub(in super::super) names: &'a Names,
}

/// Something of a tree in full, or the same of a compact one.
pub(in super::super) enum ByForm<F, C> {
    Full(F),
    Compact(C),
}

/// Leads a ray through the tree. The tree must not be empty.
#[inline(always)]
pub(super) fn walk<'a, L: Level, R: Reader<'a>, S: Sink, P: Probe>(
    level: L,
    place: Place<'a, R>,
    ray: &PreparedRay,
    sink: &mut S,
    probe: &mut P,
) {
    let ray = WalkRay::new(ray);
    let lanes = Lanes::new(level, &ray.slabs);
    let mut stack = Stack::new();
    let mut word = ROOT;
    loop {
        if !word.is_leaf() {
            probe.inner_visit();
            // SAFETY: the word is the root's, or was read from a node of this arena.
            let node = unsafe { place.view.node(word) };
            let (entries, mask) = children(level, node, &ray.slabs, &lanes, sink.t_max());
            let hit = level.bits(mask);
            if hit == 0 {
                word = stack.pop();
            } else if hit & (hit - 1) == 0 {
                word = Word(node.fan().children[hit.trailing_zeros() as usize % 8]);
            } else {
                word = if S::ORDERED {
                    level.push_ordered(node.fan(), ray.slabs.octant.shift, entries, mask, &mut stack)
                } else {
                    level.push_unordered(node.fan(), mask, &mut stack)
                };
                // Of the sentinel too.
                probe.stack_depth(stack.len() - 1);
                stack.shrink_to(stack.len() - 1);
                place.view.prefetch(stack.peek());
            }
            continue;
        }
        if word.0 == DONE {
            return;
        }
        let before = sink.t_max();
        // SAFETY: the word was read from a node of this arena and is not the sentinel.
        if unsafe { visit_leaf(level, place, word, &ray.prepared, sink, probe) }.is_break() {
            return;
        }
        if S::ORDERED && sink.t_max() < before {
            level.cull(&mut stack, sink.t_max());
        }
        word = stack.pop();
    }
}

/// Tests the triangles of a leaf.
///
/// # Safety
/// The word was read from a node of the place's arena, and is a leaf's.
#[inline(always)]
pub(super) unsafe fn visit_leaf<'a, L: Level, R: Reader<'a>, S: Sink, P: Probe>(
    level: L,
    place: Place<'a, R>,
    word: Word,
    ray: &PreparedRay,
    sink: &mut S,
    probe: &mut P,
) -> ControlFlow<()> {
    probe.leaf_visit();
    // SAFETY: the caller's.
    let leaf = unsafe { place.view.leaf(word) };
    for _ in 0..leaf.len() {
        probe.primitive_test();
    }
    // SAFETY: the leaf is one of an arena.
    let Some(crossings) = (unsafe { cross(level, leaf, ray, sink.t_max()) }) else {
        return ControlFlow::Continue(());
    };
    let mut lanes = crossings.lanes;
    while lanes != 0 {
        let triangle = lanes.trailing_zeros() as usize;
        lanes &= lanes - 1;
        let number = leaf.name(triangle);
        if place.names.sees(ray.mask, number) {
            sink.offer(crossings.get(triangle), number)?;
        }
    }
    ControlFlow::Continue(())
}

/// A walk of one ray, to be run at some level.
struct Walk<'a, 'r, R, S, P> {
    place: Place<'a, R>,
    ray: &'r PreparedRay,
    sink: S,
    probe: P,
}

impl<'a, R: Reader<'a>, S: Sink, P: Probe> Task for Walk<'a, '_, R, S, P> {
    type Output = (S, P);

    #[inline(always)]
    fn run<L: Level>(mut self, level: L) -> (S, P) {
        walk(level, self.place, self.ray, &mut self.sink, &mut self.probe);
        (self.sink, self.probe)
    }
}

impl Bvh8 {
    /// The closest hit of a ray; [`Hit::MISS`] where there is none or the ray is not valid.
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Hit {
        match PreparedRay::new(ray) {
            Some(ray) if !is_blind(&ray, &self.names) => {
                self.lead(&ray, Closest::new(ray.t_max), NoProbe).0.answer(&self.names)
            }
            _ => Hit::MISS,
        }
    }

    /// Whether a ray hits anything in its window; false where the ray is not valid.
    #[must_use]
    pub fn any(&self, ray: &Ray) -> bool {
        PreparedRay::new(ray).is_some_and(|ray| {
            !is_blind(&ray, &self.names) && self.lead(&ray, Any::new(ray.t_max), NoProbe).0.hit
        })
    }

    /// How many hits a ray has in its window; 0 where the ray is not valid.
    #[must_use]
    pub fn count(&self, ray: &Ray) -> u32 {
        self.walked::<false>().count(ray)
    }

    /// Replaces `hits` by every hit of a ray in its window, sorted by `t`, ties by id. None is left out: there
    /// is no most.
    pub fn all(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        self.walked::<false>().append_all(ray, hits, NoProbe);
    }

    /// What walks go through.
    #[inline(always)]
    pub(in super::super) fn place(&self) -> ByForm<Place<'_, View<'_>>, Place<'_, CompactView<'_>>> {
        match self.form {
            // SAFETY: the reader is that of the form.
            Form::Full => ByForm::Full(unsafe { self.place_of() }),
            // SAFETY: as above.
            Form::Compact { .. } => ByForm::Compact(unsafe { self.place_of() }),
        }
    }

    /// The same where the form is known.
    ///
    /// # Safety
    /// The reader is that of the tree's form.
    #[inline(always)]
    pub(super) unsafe fn place_of<'a, R: Reader<'a>>(&'a self) -> Place<'a, R> {
        // SAFETY: the caller's.
        Place { view: unsafe { R::new(&self.arena) }, names: &self.names }
    }

    #[inline(always)]
    fn lead<S: Sink, P: Probe>(&self, ray: &PreparedRay, sink: S, probe: P) -> (S, P) {
        if self.is_empty() {
            return (sink, probe);
        }
        match self.place() {
            ByForm::Full(place) => dispatch(self.level, Walk { place, ray, sink, probe }),
            ByForm::Compact(place) => dispatch(self.level, Walk { place, ray, sink, probe }),
        }
    }

    /// Leads a ray through the tree for a collector. Kept out of its callers, of which there is one for each kind of query,
    /// filter and counter: a copy in each took a fifth of the crate's code.
    #[inline(never)]
    fn lead_named<const ORDERED: bool>(&self, ray: &PreparedRay, sink: Named<'_, ORDERED>) -> Counters {
        self.lead(ray, sink, Counters::default()).1
    }

    pub(super) const fn walked<const ORDERED: bool>(&self) -> Walked<'_, ORDERED> {
        Walked { bvh: self }
    }
}

/// The tree and its walk, for what all structures share; children nearest first or in the order of their places.
#[derive(Clone, Copy)]
pub(super) struct Walked<'a, const ORDERED: bool> {
    bvh: &'a Bvh8,
}

impl<const ORDERED: bool> Traversal for Walked<'_, ORDERED> {
    fn visit<C: Collect, P: Probe>(
        &self,
        _: &Ray,
        ray: &PreparedRay,
        mut collect: C,
        mut probe: P,
    ) -> (C, P) {
        let sink = Named::<ORDERED>::new(&mut collect, &self.bvh.names);
        let counted = self.bvh.lead_named(ray, sink);
        tell(&counted, &mut probe);
        (collect, probe)
    }

    fn has_repeats(&self) -> bool {
        self.bvh.has_repeats()
    }
}
