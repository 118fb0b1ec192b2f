//! What a render did: rays by class, time by stage, work of the walk, and what did not come back whole.

use crate::path::Noise;
use ropewalk::{CounterTotals, Status};
use std::fmt;
use std::time::Duration;

/// What a render did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Rays from the eye.
    pub primary_rays: u64,
    /// Rays to lights.
    pub shadow_rays: u64,
    /// Short rays into the sky.
    pub ambient_rays: u64,
    /// Rays into mirrors.
    pub reflected_rays: u64,
    /// Rays through glass.
    pub refracted_rays: u64,
    /// Rays of paths into one direction of many.
    pub scattered_rays: u64,
    /// Paths that chance ended; the mean of all is right without what they would have brought.
    pub ended_by_chance: u64,
    /// Addends of paths that were cut down in brightness, so that one of them does not speckle the picture.
    pub clipped: u64,
    /// How noisy the samples of paths are.
    pub noise: Noise,
    /// Rays that were not followed since they would have gone deeper than the bounces that were asked for; the
    /// surroundings stand in their place.
    pub cut_by_depth: u64,
    /// Rays that were not followed since they would have carried too little light.
    pub cut_by_weight: u64,
    /// Primary rays that were traced although drawing was asked for, since drawing left open what they hit.
    pub primary_traced_instead: u64,
    /// Time in which primary rays were traced.
    pub primary_time: Duration,
    /// Time in which shadow and ambient rays were traced; for a tree of rays or for paths, in which everything behind the
    /// primary hits was traced and shaded.
    pub occlusion_time: Duration,
    /// Time for everything else: making rays, shading, film.
    pub shading_time: Duration,
    /// What the walk did for the primary rays, for [`View::Visits`](crate::View::Visits).
    pub counters: Option<CounterTotals>,
    /// Rays whose answers are not complete; their samples are magenta, never silently black.
    pub incomplete: Incomplete,
    /// Samples whose colour was no finite number, from materials or lights that are none. They are black.
    pub not_finite: u64,
}

impl Statistics {
    /// All rays.
    #[must_use]
    pub const fn rays(&self) -> u64 {
        self.primary_rays
            + self.shadow_rays
            + self.ambient_rays
            + self.reflected_rays
            + self.refracted_rays
            + self.scattered_rays
    }
}

/// Rays whose answers are not complete, by reason. A ray may have several.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Incomplete {
    /// All of them, each once.
    pub rays: u64,
    /// Of these, [`Status::INVALID_RAY`].
    pub invalid_ray: u64,
    /// Of these, [`Status::STEP_BUDGET`].
    pub step_budget: u64,
    /// Of these, [`Status::STACK_OVERFLOW`].
    pub stack_overflow: u64,
    /// Of these, hits whose indices lead nowhere in the scene.
    pub no_such_triangle: u64,
}

impl Incomplete {
    pub(crate) fn count(&mut self, status: Status) {
        if status.is_complete() {
            return;
        }
        self.rays += 1;
        self.invalid_ray += u64::from(status.contains(Status::INVALID_RAY));
        self.step_budget += u64::from(status.contains(Status::STEP_BUDGET));
        self.stack_overflow += u64::from(status.contains(Status::STACK_OVERFLOW));
    }

    pub(crate) fn count_lost(&mut self, rays: u64) {
        self.rays += rays;
        self.no_such_triangle += rays;
    }

    /// Adds what another count has counted.
    pub(crate) fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.invalid_ray += other.invalid_ray;
        self.step_budget += other.step_budget;
        self.stack_overflow += other.stack_overflow;
        self.no_such_triangle += other.no_such_triangle;
    }

    /// Whether every ray was answered.
    #[must_use]
    pub const fn is_none(&self) -> bool {
        self.rays == 0
    }
}

impl fmt::Display for Incomplete {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let reasons: Vec<String> = [
            (self.invalid_ray, "are not valid"),
            (self.step_budget, "ran out of steps"),
            (self.stack_overflow, "ran out of stack"),
            (self.no_such_triangle, "hit a triangle that is not in the scene"),
        ]
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| format!("{count} {what}"))
        .collect();
        write!(formatter, "{} rays have no complete answer: {}", self.rays, reasons.join(", "))
    }
}
