//! What a render did: rays by class, time by stage, work of the walk, and what did not come back whole.

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
    /// Time in which primary rays were traced.
    pub primary_time: Duration,
    /// Time in which shadow and ambient rays were traced.
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
        self.primary_rays + self.shadow_rays + self.ambient_rays
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
