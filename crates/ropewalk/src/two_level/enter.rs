//! Entering an object: what a hit of a two-level scene is.
//!
//! The ray is taken to the object's frame and led through the object's own structure there. That computes other floats than the
//! boxes of the top level do. So, as a triangle's own box decides where its hit is ([`crate::triangle`]), an instance's box does:
//! a ray enters an instance where it is in the instance's box, and the `t` of every hit is moved into the interval in which it
//! is. Every box above holds that box and the slab test is monotone, so the answer depends neither on the top level nor on
//! the order in which instances are entered. And since moving is monotone, it depends on no bottom structure either: while
//! nothing is known that lies before the end of the interval, the bottom is searched as far as the ray reaches, because every `t`
//! beyond that end is moved to it; and after that up to the limit itself.

use super::instance::LocalRay;
use super::{Entry, ObjectStructure, Placed};
use crate::aabb::{Interval, larger, slab_test, smaller};
use crate::bvh::walk::Collect;
use crate::{Hit, PreparedRay, Probe, Ray};
use std::ops::ControlFlow;

/// The instances of a scene, for walks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instances<'a> {
    pub(super) objects: &'a [Option<std::sync::Arc<ObjectStructure>>],
    pub(super) placed: &'a [Placed],
}

impl<'a> Instances<'a> {
    /// Makes ready to enter an instance: the ray in its frame and what is done with hits; `None` where the ray passes by, or
    /// nothing of it can be of interest any more.
    #[inline(always)]
    pub(super) fn approach<C: Collect>(
        &self,
        place: u32,
        question: &Ray,
        ray: &PreparedRay,
        collect: &C,
    ) -> Option<Approach<'a>> {
        let placed = &self.placed[place as usize];
        let structure = self.objects.get(placed.object as usize)?.as_deref()?;
        let span = placed.span(ray)?;
        let local = placed.local(question)?;
        let moving = Moving::new(placed, span, &local);
        let local = local.ray;
        let bounds = structure.bounds();
        let limit = moving.limit(collect.t_max());
        slab_test(&local, bounds.min.extend(1.0), bounds.max.extend(1.0), limit)
            .is_hit()
            .then_some(Approach { structure, ray: local, moving })
    }

    /// Enters an instance and walks its object's structure by the best walk that it has, or with `EVERY` tests all of its
    /// triangles.
    #[inline(always)]
    pub(super) fn enter<const EVERY: bool, C: Collect, P: Probe>(
        &self,
        entry: Entry,
        (question, ray): (&Ray, &PreparedRay),
        collect: &mut C,
        probe: &mut P,
    ) -> ControlFlow<()> {
        probe.object_tested();
        let Some(approach) = self.approach(entry.place, question, ray, collect) else {
            return ControlFlow::Continue(());
        };
        probe.object_entered();
        let moved = Moved { collect, moving: approach.moving, ended: false };
        let told = Told(probe);
        let bottom = approach.structure.bottom();
        let (moved, told) = if EVERY {
            bottom.visit_all(&approach.ray, moved, told)
        } else {
            bottom.visit(entry.node, &approach.ray, moved, told)
        };
        let ended = moved.ended;
        told.0.object_left();
        if ended { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// An instance that is about to be entered.
pub(super) struct Approach<'a> {
    pub(super) structure: &'a ObjectStructure,
    /// The ray in the object's frame.
    pub(super) ray: PreparedRay,
    pub(super) moving: Moving,
}

/// How `t` moves between an object's frame and the scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moving {
    /// Where the ray is in the instance's box.
    span: Interval,
    /// See [`LocalRay::scale`].
    scale: f32,
    /// The end of the ray's window, in the frame.
    t_max: f32,
    instance: u32,
}

impl Moving {
    /// Of a ray that is in an instance's box at `span`, and in the object's frame.
    #[inline(always)]
    pub(crate) fn new(placed: &Placed, span: Interval, local: &LocalRay) -> Self {
        Self { span, scale: local.scale, t_max: local.ray.t_max, instance: placed.instance() }
    }

    /// How far the frame is searched where the scene is of interest up to a limit.
    #[inline(always)]
    pub(crate) fn limit(&self, limit: f32) -> f32 {
        if limit >= self.span.exit { self.t_max } else { limit / self.scale }
    }

    /// The hit in the scene.
    #[inline(always)]
    pub(crate) fn hit(&self, hit: Hit) -> Hit {
        Hit { t: self.t(hit.t), instance_index: self.instance, ..hit }
    }

    /// A `t` of the frame in the scene.
    #[inline(always)]
    pub(crate) fn t(&self, t: f32) -> f32 {
        // Plus zero, as of a triangle: no bit may depend on which of -0 and 0 came.
        smaller(larger(t * self.scale, self.span.entry), self.span.exit) + 0.0
    }
}

/// Offers an object's hits to the collector of the scene.
pub(crate) struct Moved<'a, C> {
    pub(crate) collect: &'a mut C,
    pub(crate) moving: Moving,
    /// Whether the collector has enough.
    pub(crate) ended: bool,
}

impl<C: Collect> Collect for Moved<'_, C> {
    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.moving.limit(self.collect.t_max())
    }

    #[inline(always)]
    fn offer(&mut self, hit: Hit) -> ControlFlow<()> {
        let hit = self.moving.hit(hit);
        // The end of the box's interval may lie a little behind the end of the ray's window, or behind what was found since.
        if hit.t > self.collect.t_max() {
            return ControlFlow::Continue(());
        }
        let going_on = self.collect.offer(hit);
        self.ended = going_on.is_break();
        going_on
    }
}

/// Tells another probe.
pub(super) struct Told<'a, P>(pub(super) &'a mut P);

impl<P: Probe> Probe for Told<'_, P> {
    #[inline(always)]
    fn inner_visit(&mut self) {
        self.0.inner_visit();
    }
    #[inline(always)]
    fn leaf_visit(&mut self) {
        self.0.leaf_visit();
    }
    #[inline(always)]
    fn primitive_test(&mut self) {
        self.0.primitive_test();
    }
    #[inline(always)]
    fn restart(&mut self) {
        self.0.restart();
    }
    #[inline(always)]
    fn stack_depth(&mut self, entries: usize) {
        self.0.stack_depth(entries);
    }
}
