//! What is done with the hits that a leaf has.

use crate::bvh::walk::Collect;
use crate::bvh8::names::Names;
use crate::triangle::Crossing;
use crate::{Counters, Hit, PreparedRay, Probe};
use glam::Vec2;
use std::ops::ControlFlow;

/// Takes hits, in any order.
pub(in super::super) trait Sink {
    /// Whether children are visited nearest first. What ends at the first hit, or never ends early, needs no order.
    const ORDERED: bool;
    /// Hits beyond this `t` need not be offered.
    fn t_max(&self) -> f32;
    /// A hit, and the number of its triangle. `Break` when no further hit matters.
    fn offer(&mut self, hit: Crossing, number: u32) -> ControlFlow<()>;
}

/// No triangle's number.
const NOBODY: u32 = u32::MAX;

/// The closest hit so far, ties to the smaller number.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Closest {
    t_max: f32,
    hit: Crossing,
    number: u32,
}

impl Closest {
    #[inline(always)]
    pub(in super::super) fn new(t_max: f32) -> Self {
        Self { t_max, hit: Crossing::NONE, number: NOBODY }
    }

    #[inline(always)]
    pub(in super::super) fn answer(&self, names: &Names) -> Hit {
        if self.number == NOBODY { Hit::MISS } else { full(self.hit, self.number, names) }
    }
}

impl Sink for Closest {
    const ORDERED: bool = true;

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn offer(&mut self, hit: Crossing, number: u32) -> ControlFlow<()> {
        if hit.t < self.t_max || (hit.t == self.t_max && number < self.number) {
            *self = Self { t_max: hit.t, hit, number };
        }
        ControlFlow::Continue(())
    }
}

/// Whether there is a hit.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Any {
    t_max: f32,
    pub(in super::super) hit: bool,
}

impl Any {
    #[inline(always)]
    pub(in super::super) fn new(t_max: f32) -> Self {
        Self { t_max, hit: false }
    }
}

impl Sink for Any {
    const ORDERED: bool = false;

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn offer(&mut self, _: Crossing, _: u32) -> ControlFlow<()> {
        self.hit = true;
        ControlFlow::Break(())
    }
}

/// Hands hits with their names to a collector of any structure's. The collector is called through a pointer, so that there
/// is one such walk and not one for each kind of query, filter and counter; those who are in a hurry have sinks of their own.
pub(in super::super) struct Named<'a, const ORDERED: bool> {
    collect: &'a mut dyn Collect,
    names: &'a Names,
    /// The collector's, kept here because every visit asks.
    t_max: f32,
}

impl<'a, const ORDERED: bool> Named<'a, ORDERED> {
    pub(in super::super) fn new(collect: &'a mut dyn Collect, names: &'a Names) -> Self {
        let t_max = collect.t_max();
        Self { collect, names, t_max }
    }
}

impl<const ORDERED: bool> Sink for Named<'_, ORDERED> {
    const ORDERED: bool = ORDERED;

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn offer(&mut self, hit: Crossing, number: u32) -> ControlFlow<()> {
        let flow = self.collect.offer(full(hit, number, self.names));
        self.t_max = self.collect.t_max();
        flow
    }
}

/// Tells a probe what was counted: so the walk itself is compiled once, whatever counts.
pub(in super::super) fn tell<P: Probe>(counted: &Counters, probe: &mut P) {
    let Counters { inner_visits, leaf_visits, primitive_tests, stack_depth, .. } = *counted;
    (0..inner_visits).for_each(|_| probe.inner_visit());
    (0..leaf_visits).for_each(|_| probe.leaf_visit());
    (0..primitive_tests).for_each(|_| probe.primitive_test());
    if stack_depth > 0 {
        probe.stack_depth(stack_depth as usize);
    }
}

/// A hit with its names.
#[inline(always)]
fn full(hit: Crossing, number: u32, names: &Names) -> Hit {
    let name = names.name(number);
    Hit {
        t: hit.t,
        barycentrics: Vec2::new(hit.v, hit.w),
        primitive_index: name.primitive,
        geometry_index: name.geometry,
        instance_index: name.instance,
        front_face: hit.seen_from_front != name.mirrored,
    }
}

/// Whether a ray can see anything at all of a structure.
#[inline(always)]
pub(in super::super) fn is_blind(ray: &PreparedRay, names: &Names) -> bool {
    is_blind_to(ray.mask, names)
}

/// The same of a ray's mask, in the top 8 bits.
#[inline(always)]
pub(in super::super) fn is_blind_to(mask: u32, names: &Names) -> bool {
    names.common_mask().is_some_and(|common| common & mask == 0)
}
