//! How the rays of a picture are traced, holes and panes being what they are: a hit in a hole is none, and light goes on
//! behind a pane. Trees and paths ask here, and so does the eye.

use crate::begin::Begin;
use crate::error::RenderError;
use crate::looks::{Looks, MOST_PANES};
use crate::trace::Trace;
use glam::Vec3;
use ropewalk::{Answer, Hit, Query, Ray, Status, TraceOptions, Traced, Walk};

/// How the rays of a picture are traced: by what, and with the holes of its materials left out.
#[derive(Clone, Copy)]
pub(crate) struct Tracing<'a> {
    pub(crate) tracer: &'a dyn Trace,
    pub(crate) walk: Walk,
    /// Where it is known which hits lie in holes.
    pub(crate) looks: Option<&'a Looks>,
}

impl Tracing<'_> {
    /// Traces a batch.
    pub(crate) fn trace(
        &self,
        query: Query,
        rays: &[Ray],
        begin: &Begin<'_>,
        options: TraceOptions,
    ) -> Result<Traced, RenderError> {
        let traced = match self.looks.filter(|looks| looks.has_cut_outs()) {
            Some(looks) => {
                let keep = |hit: &Hit| !looks.is_cut_out(hit);
                self.tracer.trace_filtered(self.walk, query, rays, begin, &keep, options)
            }
            None => self.tracer.trace_begun(self.walk, query, rays, begin, options),
        };
        let traced = traced.map_err(RenderError::Trace)?;
        let counted = traced.counters.as_ref().map_or(0, Vec::len);
        if traced.answer.query() != query
            || traced.answer.len() != rays.len()
            || traced.status.len() != rays.len()
            || (options.counters && counted != rays.len())
        {
            return Err(other_question());
        }
        Ok(traced)
    }

    /// The closest hits of a batch.
    pub(crate) fn closest_of(
        &self,
        rays: &[Ray],
        begin: &Begin<'_>,
    ) -> Result<(Vec<Hit>, Vec<Status>), RenderError> {
        let traced = self.trace(Query::Closest, rays, begin, TraceOptions::default())?;
        let Answer::Closest(hits) = traced.answer else { return Err(other_question()) };
        Ok((hits, traced.status))
    }

    /// Whether something is in the way of each ray of a batch.
    pub(crate) fn blocked_of(
        &self,
        rays: &[Ray],
        begin: &Begin<'_>,
    ) -> Result<(Vec<bool>, Vec<Status>), RenderError> {
        let traced = self.trace(Query::Any, rays, begin, TraceOptions::default())?;
        let Answer::Any(blocked) = traced.answer else { return Err(other_question()) };
        Ok((blocked, traced.status))
    }

    /// The closest hit of one ray, which has left a triangle.
    pub(crate) fn closest(
        &self,
        ray: &Ray,
        left: Option<(u32, u32, u32)>,
    ) -> Result<(Hit, Status), RenderError> {
        let (hits, status) = self.closest_of(std::slice::from_ref(ray), &Begin::OnTriangles(&[left]))?;
        hits.first().copied().zip(status.first().copied()).ok_or_else(other_question)
    }

    /// What of their light rays to lights bring, of which each leaves a triangle: `light` becomes zero where something is in
    /// the way, and less behind panes. `depth` is that of the ray that goes on; rays that would pass too many panes are
    /// stopped and counted. Returns the statuses.
    pub(crate) fn arriving_of(&self, asking: &mut Asking) -> Result<Vec<Status>, RenderError> {
        let begin = Begin::OnTriangles(&asking.left);
        let (blocked, mut status) = self.blocked_of(&asking.rays, &begin)?;
        let mut waiting: Vec<usize> = (0..blocked.len()).filter(|&ray| blocked[ray]).collect();
        let Some(looks) = self.looks.filter(|looks| looks.has_panes()) else {
            waiting.into_iter().for_each(|ray| asking.light[ray] = Vec3::ZERO);
            return Ok(status);
        };
        while !waiting.is_empty() {
            let rays: Vec<Ray> = waiting.iter().map(|&ray| asking.rays[ray]).collect();
            let left: Vec<_> = waiting.iter().map(|&ray| asking.left[ray]).collect();
            let (hits, of_hits) = self.closest_of(&rays, &Begin::OnTriangles(&left))?;
            let mut next = Vec::new();
            for ((&ray, hit), own) in waiting.iter().zip(&hits).zip(of_hits) {
                status[ray] = status[ray] | own;
                if !hit.is_hit() || !own.is_complete() {
                    continue;
                }
                if asking.pass(ray, hit, looks) {
                    next.push(ray);
                }
            }
            waiting = next;
        }
        Ok(status)
    }
}

/// Rays to lights, and their light if nothing is in the way.
#[derive(Debug, Default)]
pub(crate) struct Asking {
    pub(crate) rays: Vec<Ray>,
    /// The triangles that they leave, where they leave one exactly.
    pub(crate) left: Vec<Option<(u32, u32, u32)>>,
    pub(crate) light: Vec<Vec3>,
    /// How often each has been mirrored or refracted or has passed a pane.
    pub(crate) depth: Vec<u32>,
    /// Rays that went on behind a pane.
    pub(crate) passed: Vec<usize>,
    /// Rays that were stopped for having passed too many.
    pub(crate) stopped: u64,
}

impl Asking {
    pub(crate) fn push(&mut self, ray: Ray, left: Option<(u32, u32, u32)>, light: Vec3, depth: u32) {
        self.rays.push(ray);
        self.left.push(left);
        self.light.push(light);
        self.depth.push(depth);
    }

    /// Sends a ray on behind what it has hit. False when it ends there.
    fn pass(&mut self, ray: usize, hit: &Hit, looks: &Looks) -> bool {
        let through = looks.through(hit);
        let goes_on = through != Vec3::ZERO && self.depth[ray] < MOST_PANES;
        self.stopped += u64::from(through != Vec3::ZERO && !goes_on);
        if goes_on {
            self.light[ray] *= through;
            self.rays[ray].t_min = hit.t.next_up();
            self.depth[ray] += 1;
            self.passed.push(ray);
        } else {
            self.light[ray] = Vec3::ZERO;
        }
        goes_on
    }
}

fn other_question() -> RenderError {
    RenderError::Trace("the device answered another question than was asked".into())
}
