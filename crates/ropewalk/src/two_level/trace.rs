//! One ray or many through both levels.

use super::{SmartStack, TwoLevel};
use crate::batch::{Batch, Traced, Traversal, answer_each, trace_entries};
use crate::bvh::StackOrder;
use crate::bvh::walk::{AnyHit, ClosestHit, Collect};
use crate::{CatalogueError, Hit, NoProbe, PreparedRay, Probe, Ray, TraceError, Walk};

trace_entries!(TwoLevel, TwoLevel);

impl TwoLevel {
    /// The closest hit of a ray; [`Hit::MISS`] where there is none or the ray is not valid.
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Hit {
        Nested(self).summary::<ClosestHit, NoProbe>(ray).0
    }

    /// Whether a ray hits anything in its window; false where the ray is not valid.
    #[must_use]
    pub fn any(&self, ray: &Ray) -> bool {
        Nested(self).summary::<AnyHit, NoProbe>(ray).0
    }

    /// How many hits a ray has in its window; 0 where the ray is not valid.
    #[must_use]
    pub fn count(&self, ray: &Ray) -> u32 {
        Nested(self).count(ray)
    }

    /// Replaces `hits` by every hit of a ray in its window, sorted by `t`, ties by id. None is left out: there
    /// is no most.
    pub fn all(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        Nested(self).append_all(ray, hits, NoProbe);
    }

    /// The closest hits of many rays, into `hits`. Only the first `min(rays.len(), hits.len())` are traced.
    pub fn closest_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        answer_each(rays, hits, |ray| self.closest(ray));
    }

    /// Whether each of many rays hits anything, into `hits`. Only the first `min(rays.len(), hits.len())` are traced.
    pub fn any_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        answer_each(rays, hits, |ray| self.any(ray));
    }

    fn trace_batch(&self, walk: Walk, batch: Batch<'_>) -> Result<Traced, TraceError> {
        match walk {
            Walk::Stack(StackOrder::Ordered) => Ok(Nested(self).trace(batch)),
            Walk::BruteForce => Ok(Everything(self).trace(batch)),
            Walk::SmartStack { bytes } => {
                Ok(Merged { scene: self, bytes: SmartStack::round(bytes) }.trace(batch))
            }
            // The catalogue has refused them.
            _ => Err(CatalogueError(format!("the walk '{walk}' goes through one level only")).into()),
        }
    }
}

/// The walk that enters one structure from inside the other.
#[derive(Clone, Copy)]
struct Nested<'a>(&'a TwoLevel);

impl Traversal for Nested<'_> {
    #[inline(always)]
    fn visit<C: Collect, P: Probe>(&self, question: &Ray, ray: &PreparedRay, collect: C, probe: P) -> (C, P) {
        self.0.visit(question, ray, collect, probe)
    }

    fn has_repeats(&self) -> bool {
        self.0.has_repeats()
    }
}

/// Every triangle of every instance.
#[derive(Clone, Copy)]
struct Everything<'a>(&'a TwoLevel);

impl Traversal for Everything<'_> {
    #[inline(always)]
    fn visit<C: Collect, P: Probe>(&self, question: &Ray, ray: &PreparedRay, collect: C, probe: P) -> (C, P) {
        self.0.visit_all(question, ray, collect, probe)
    }

    fn has_repeats(&self) -> bool {
        self.0.has_repeats()
    }
}

/// One loop and one smart stack for both levels.
#[derive(Clone, Copy)]
struct Merged<'a> {
    scene: &'a TwoLevel,
    bytes: u32,
}

impl Traversal for Merged<'_> {
    #[inline(always)]
    fn visit<C: Collect, P: Probe>(&self, question: &Ray, ray: &PreparedRay, collect: C, probe: P) -> (C, P) {
        self.scene.visit_merged(self.bytes, question, ray, collect, probe)
    }

    fn has_repeats(&self) -> bool {
        self.scene.has_repeats()
    }
}
