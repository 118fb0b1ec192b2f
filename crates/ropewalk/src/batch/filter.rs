//! Filters: hits that are looked at before they count, such as those in the holes of a leaf's picture.
//!
//! A filter stands between a walk and what the query does with hits: a hit that it does not keep is as if the triangle were
//! not there, so the walk goes on behind it. All queries, counting or not, share one instance of each walk, which calls the
//! filter and the query's end through pointers: a call a hit, none a node unless it is counted, and little to compile.

use super::trace::{Question, Traversal};
use crate::bvh::walk::Collect;
use crate::{Hit, PreparedRay, Probe, Ray};
use std::ops::ControlFlow;

/// Says whether a hit counts.
///
/// It must answer the same whenever it is asked of the same hit of the same ray: where a triangle stands in several leaves, and
/// by walks that come to a leaf again, it is asked several times; and hits are offered in no order, also such as lie behind a
/// closer one that is found later. It is called from several threads at once.
pub type Keep<'a> = &'a (dyn Fn(&Hit) -> bool + Sync);

/// A structure together with the way to walk it, and a filter.
#[derive(Clone, Copy)]
pub(super) struct Filtered<'a, Q = Ray> {
    pub(super) walk: &'a dyn FilteredWalk<Q>,
    pub(super) keep: Keep<'a>,
    /// Whether the walk's work is counted.
    pub(super) counts: bool,
}

impl<Q: Question> Traversal<Q> for Filtered<'_, Q> {
    #[inline(always)]
    fn visit<C: Collect, P: Probe>(
        &self,
        question: &Q,
        ray: &PreparedRay,
        mut collect: C,
        mut probe: P,
    ) -> (C, P) {
        let sieve = Sieve { t_max: collect.t_max(), collect: &mut collect, keep: self.keep };
        let told = Told(if self.counts { Some(&mut probe) } else { None });
        self.walk.visit_filtered(question, ray, sieve, told);
        (collect, probe)
    }

    fn has_repeats(&self) -> bool {
        self.walk.is_repeating()
    }
}

/// The one instance of a walk that serves all filters.
pub(super) trait FilteredWalk<Q>: Sync {
    fn visit_filtered(&self, question: &Q, ray: &PreparedRay, sieve: Sieve<'_>, told: Told<'_>);

    /// [`Traversal::has_repeats`].
    fn is_repeating(&self) -> bool;
}

impl<Q: Question, T: Traversal<Q>> FilteredWalk<Q> for T {
    #[inline(never)]
    fn visit_filtered(&self, question: &Q, ray: &PreparedRay, sieve: Sieve<'_>, told: Told<'_>) {
        self.visit(question, ray, sieve, told);
    }

    fn is_repeating(&self) -> bool {
        self.has_repeats()
    }
}

/// Offers on what is kept.
pub(super) struct Sieve<'a> {
    /// That of `collect`.
    t_max: f32,
    collect: &'a mut dyn Collect,
    keep: Keep<'a>,
}

impl Collect for Sieve<'_> {
    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn offer(&mut self, hit: Hit) -> ControlFlow<()> {
        if !(self.keep)(&hit) {
            return ControlFlow::Continue(());
        }
        let going_on = self.collect.offer(hit);
        self.t_max = self.collect.t_max();
        going_on
    }
}

/// Tells another probe, or none.
pub(super) struct Told<'a>(Option<&'a mut dyn Probe>);

impl Told<'_> {
    #[inline(always)]
    fn tell(&mut self, event: impl FnOnce(&mut dyn Probe)) {
        if let Some(probe) = &mut self.0 {
            event(&mut **probe);
        }
    }
}

impl Probe for Told<'_> {
    #[inline(always)]
    fn inner_visit(&mut self) {
        self.tell(|probe| probe.inner_visit());
    }
    #[inline(always)]
    fn leaf_visit(&mut self) {
        self.tell(|probe| probe.leaf_visit());
    }
    #[inline(always)]
    fn primitive_test(&mut self) {
        self.tell(|probe| probe.primitive_test());
    }
    #[inline(always)]
    fn restart(&mut self) {
        self.tell(|probe| probe.restart());
    }
    #[inline(always)]
    fn stack_depth(&mut self, entries: usize) {
        self.tell(|probe| probe.stack_depth(entries));
    }
    #[inline(always)]
    fn object_tested(&mut self) {
        self.tell(|probe| probe.object_tested());
    }
    #[inline(always)]
    fn object_entered(&mut self) {
        self.tell(|probe| probe.object_entered());
    }
    #[inline(always)]
    fn object_left(&mut self) {
        self.tell(|probe| probe.object_left());
    }
    #[inline(always)]
    fn stack_bytes(&mut self, most: u32, swaps: u32) {
        self.tell(|probe| probe.stack_bytes(most, swaps));
    }
}
