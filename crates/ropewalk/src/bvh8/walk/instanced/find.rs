//! What is done with the hits of instances.

use crate::bvh::walk::Collect;
use crate::bvh8::names::Names;
use crate::bvh8::walk::sink::Sink;
use crate::triangle::Crossing;
use crate::two_level::Moving;
use crate::{Hit, PreparedRay};
use glam::Vec2;
use std::ops::ControlFlow;

/// A triangle of an instance.
#[derive(Clone, Copy)]
pub(super) struct Who<'a> {
    /// The instance's index.
    pub(super) instance: u32,
    pub(super) number: u32,
    /// The names in the instance's object.
    pub(super) names: &'a Names,
}

impl Who<'_> {
    /// The hit with all names, of a crossing in the scene.
    fn hit(&self, hit: Crossing) -> Hit {
        let name = self.names.name(self.number);
        Hit {
            t: hit.t,
            barycentrics: Vec2::new(hit.v, hit.w),
            primitive_index: name.primitive,
            geometry_index: name.geometry,
            instance_index: self.instance,
            front_face: hit.seen_from_front != name.mirrored,
        }
    }
}

/// Takes hits, in any order.
pub(super) trait Find<'a> {
    /// Whether children are visited nearest first.
    const ORDERED: bool;
    /// Hits beyond this `t` need not be offered.
    fn t_max(&self) -> f32;
    /// A hit, `t` in the scene and no larger than [`Self::t_max`]. `Break` when no further hit matters.
    fn offer(&mut self, hit: Crossing, who: Who<'a>) -> ControlFlow<()>;
}

/// What a summary query asks of a ray.
pub(super) trait Goal<'a>: Find<'a> + Copy {
    type Answer: Copy + Send;
    /// What a ray is answered that sees nothing.
    const NOTHING: Self::Answer;
    fn new(ray: &PreparedRay) -> Self;
    fn answer(&self) -> Self::Answer;
}

/// The closest hit so far, ties to the smaller instance, then to the smaller number.
#[derive(Clone, Copy)]
pub(super) struct FindClosest<'a> {
    t_max: f32,
    hit: Crossing,
    who: Option<Who<'a>>,
}

impl<'a> Find<'a> for FindClosest<'a> {
    const ORDERED: bool = true;

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn offer(&mut self, hit: Crossing, who: Who<'a>) -> ControlFlow<()> {
        let precedes = match self.who {
            None => true,
            Some(best) => {
                hit.t < self.t_max
                    || (hit.t == self.t_max && (who.instance, who.number) < (best.instance, best.number))
            }
        };
        if precedes {
            *self = Self { t_max: hit.t, hit, who: Some(who) };
        }
        ControlFlow::Continue(())
    }
}

impl<'a> Goal<'a> for FindClosest<'a> {
    type Answer = Hit;
    const NOTHING: Hit = Hit::MISS;

    #[inline(always)]
    fn new(ray: &PreparedRay) -> Self {
        Self { t_max: ray.t_max, hit: Crossing::NONE, who: None }
    }

    #[inline(always)]
    fn answer(&self) -> Hit {
        match &self.who {
            Some(who) => who.hit(self.hit),
            None => Hit::MISS,
        }
    }
}

/// Whether there is a hit.
#[derive(Clone, Copy)]
pub(super) struct FindAny {
    t_max: f32,
    hit: bool,
}

impl<'a> Find<'a> for FindAny {
    const ORDERED: bool = false;

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn offer(&mut self, _: Crossing, _: Who<'a>) -> ControlFlow<()> {
        self.hit = true;
        ControlFlow::Break(())
    }
}

impl<'a> Goal<'a> for FindAny {
    type Answer = bool;
    const NOTHING: bool = false;

    #[inline(always)]
    fn new(ray: &PreparedRay) -> Self {
        Self { t_max: ray.t_max, hit: false }
    }

    #[inline(always)]
    fn answer(&self) -> bool {
        self.hit
    }
}

/// Hands hits to a collector of any structure's, through a pointer, so that there is one such walk.
pub(super) struct FindFor<'c, const ORDERED: bool> {
    collect: &'c mut dyn Collect,
    /// The collector's, kept here because every visit asks.
    t_max: f32,
}

impl<'c, const ORDERED: bool> FindFor<'c, ORDERED> {
    pub(super) fn new(collect: &'c mut dyn Collect) -> Self {
        let t_max = collect.t_max();
        Self { collect, t_max }
    }
}

impl<'a, const ORDERED: bool> Find<'a> for FindFor<'_, ORDERED> {
    const ORDERED: bool = ORDERED;

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn offer(&mut self, hit: Crossing, who: Who<'a>) -> ControlFlow<()> {
        let flow = self.collect.offer(who.hit(hit));
        self.t_max = self.collect.t_max();
        flow
    }
}

/// Takes the hits of an object's tree, and offers them where they are in the scene.
pub(super) struct Inside<'s, 'a, F> {
    pub(super) find: &'s mut F,
    pub(super) moving: Moving,
    pub(super) instance: u32,
    pub(super) names: &'a Names,
    /// Whether no further hit matters.
    pub(super) ended: bool,
}

impl<'a, F: Find<'a>> Sink for Inside<'_, 'a, F> {
    const ORDERED: bool = F::ORDERED;

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.moving.limit(self.find.t_max())
    }

    #[inline(always)]
    fn offer(&mut self, hit: Crossing, number: u32) -> ControlFlow<()> {
        let hit = Crossing { t: self.moving.t(hit.t), ..hit };
        // The end of the box's interval may lie a little behind the end of the ray's window, or behind what was found since.
        if hit.t > self.find.t_max() {
            return ControlFlow::Continue(());
        }
        let flow = self.find.offer(hit, Who { instance: self.instance, number, names: self.names });
        self.ended = flow.is_break();
        flow
    }
}
