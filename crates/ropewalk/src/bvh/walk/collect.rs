//! What a query does with the hits it is offered.

use crate::{Hit, PreparedRay};
use std::ops::ControlFlow;

/// Takes hits, in any order.
pub trait Collect {
    /// Hits beyond this `t` need not be offered.
    fn t_max(&self) -> f32;
    /// A hit with `t` in the window. `Break` when no further hit matters.
    fn offer(&mut self, hit: Hit) -> ControlFlow<()>;
}

/// A [`Collect`] that ends with one small answer; a ray that is not valid gets the default.
pub trait Summary: Collect {
    /// The answer.
    type Answer: Copy + Default + Send;
    /// Nothing found yet.
    fn new(ray: &PreparedRay) -> Self;
    /// What was found.
    fn answer(&self) -> Self::Answer;
}

/// Keeps the closest hit, ties by id.
#[derive(Clone, Copy, Debug)]
pub struct ClosestHit {
    t_max: f32,
    hit: Hit,
}

impl Summary for ClosestHit {
    type Answer = Hit;

    #[inline(always)]
    fn new(ray: &PreparedRay) -> Self {
        Self { t_max: ray.t_max, hit: Hit::MISS }
    }

    #[inline(always)]
    fn answer(&self) -> Hit {
        self.hit
    }
}

impl Collect for ClosestHit {
    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn offer(&mut self, hit: Hit) -> ControlFlow<()> {
        if hit.precedes(&self.hit) {
            self.hit = hit;
            self.t_max = hit.t;
        }
        ControlFlow::Continue(())
    }
}

/// Stops at the first hit of any kind.
#[derive(Clone, Copy, Debug)]
pub struct AnyHit {
    t_max: f32,
    hit: bool,
}

impl Summary for AnyHit {
    type Answer = bool;

    #[inline(always)]
    fn new(ray: &PreparedRay) -> Self {
        Self { t_max: ray.t_max, hit: false }
    }

    #[inline(always)]
    fn answer(&self) -> bool {
        self.hit
    }
}

impl Collect for AnyHit {
    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn offer(&mut self, _hit: Hit) -> ControlFlow<()> {
        self.hit = true;
        ControlFlow::Break(())
    }
}

/// Counts the hits.
#[derive(Clone, Copy, Debug)]
pub struct HitCount {
    t_max: f32,
    count: u32,
}

impl Summary for HitCount {
    type Answer = u32;

    #[inline(always)]
    fn new(ray: &PreparedRay) -> Self {
        Self { t_max: ray.t_max, count: 0 }
    }

    #[inline(always)]
    fn answer(&self) -> u32 {
        self.count
    }
}

impl Collect for HitCount {
    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn offer(&mut self, _hit: Hit) -> ControlFlow<()> {
        self.count += 1;
        ControlFlow::Continue(())
    }
}

/// Keeps every hit, unsorted.
#[derive(Debug)]
pub struct AllHits<'a> {
    t_max: f32,
    hits: &'a mut Vec<Hit>,
}

impl<'a> AllHits<'a> {
    /// Appends to `hits`.
    #[must_use]
    pub const fn new(ray: &PreparedRay, hits: &'a mut Vec<Hit>) -> Self {
        Self { t_max: ray.t_max, hits }
    }
}

impl Collect for AllHits<'_> {
    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn offer(&mut self, hit: Hit) -> ControlFlow<()> {
        self.hits.push(hit);
        ControlFlow::Continue(())
    }
}
