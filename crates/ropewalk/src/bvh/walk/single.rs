//! One ray at a time, with the best walk there is for it.

use super::{AllHits, AnyHit, BvhWalk, ClosestHit, Collect, HitCount, Ordered, Summary, TriangleVisitor};
use crate::bvh::Bvh;
use crate::{Hit, NoProbe, PreparedRay, Probe, Ray};

impl Bvh {
    /// The closest hit of a ray; [`Hit::MISS`] where there is none or the ray is not valid.
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Hit {
        self.summary::<Ordered, ClosestHit, NoProbe>(ray).0
    }

    /// Whether a ray hits anything in its window; false where the ray is not valid.
    #[must_use]
    pub fn any(&self, ray: &Ray) -> bool {
        self.summary::<Ordered, AnyHit, NoProbe>(ray).0
    }

    /// How many hits a ray has in its window; 0 where the ray is not valid.
    #[must_use]
    pub fn count(&self, ray: &Ray) -> u32 {
        self.summary::<Ordered, HitCount, NoProbe>(ray).0
    }

    /// Replaces `hits` by every hit of a ray in its window, sorted by `t`, ties by id. None is left out: there
    /// is no most.
    pub fn all(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        if let Some(ray) = PreparedRay::new(ray) {
            self.visit::<Ordered, _, _>(&ray, AllHits::new(&ray, hits), NoProbe);
            sort(hits);
        }
    }

    /// The answer of a query by the walk `W`, and what was counted on the way.
    #[inline(always)]
    pub(super) fn summary<W: BvhWalk, S: Summary, P: Probe + Default>(&self, ray: &Ray) -> (S::Answer, P) {
        match PreparedRay::new(ray) {
            None => Default::default(),
            Some(ray) => {
                let (summary, probe) = self.visit::<W, S, P>(&ray, S::new(&ray), P::default());
                (summary.answer(), probe)
            }
        }
    }

    /// Leads a ray through the structure by the walk `W`, and gives back what was collected and counted.
    #[inline(always)]
    pub fn visit<W: BvhWalk, C: Collect, P: Probe>(&self, ray: &PreparedRay, collect: C, probe: P) -> (C, P) {
        let mut visitor = TriangleVisitor { triangles: &self.triangles, ray, collect, probe };
        W::walk(&self.nodes, ray, &mut visitor);
        (visitor.collect, visitor.probe)
    }
}

/// Puts hits into the order of the tie rule.
pub(super) fn sort(hits: &mut [Hit]) {
    hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then_with(|| a.id().cmp(&b.id())));
}
