//! One ray or many through a kd-tree.

use super::KdTree;
use super::walk::{Backtrack, KdWalk, ReferenceVisitor, Restart, RestartTrail, Ropes, ShortStack, Stack};
use crate::batch::{Batch, TraceOptions, Traced, Traversal, answer_each, trace_entries};
use crate::bvh::StackOrder;
use crate::bvh::walk::{AnyHit, ClosestHit, Collect, TrailU64};
use crate::{CatalogueError, Hit, NoProbe, PreparedRay, Probe, Query, Ray, TraceError, Walk};

trace_entries!(KdTree, KdTree);

impl KdTree {
    /// The closest hit of a ray; [`Hit::MISS`] where there is none or the ray is not valid.
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Hit {
        self.by(Stack).summary::<ClosestHit, NoProbe>(ray).0
    }

    /// Whether a ray hits anything in its window; false where the ray is not valid.
    #[must_use]
    pub fn any(&self, ray: &Ray) -> bool {
        self.by(Stack).summary::<AnyHit, NoProbe>(ray).0
    }

    /// How many hits a ray has in its window; 0 where the ray is not valid.
    #[must_use]
    pub fn count(&self, ray: &Ray) -> u32 {
        self.by(Stack).count(ray)
    }

    /// Replaces `hits` by every hit of a ray in its window, sorted by `t`, ties by id. None is left out: there
    /// is no most.
    pub fn all(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        self.by(Stack).append_all(ray, hits, NoProbe);
    }

    /// The closest hits of many rays, into `hits`. Only the first `min(rays.len(), hits.len())` are traced.
    pub fn closest_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        answer_each(rays, hits, |ray| self.closest(ray));
    }

    /// Whether each of many rays hits anything, into `hits`. Only the first `min(rays.len(), hits.len())` are traced.
    pub fn any_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        answer_each(rays, hits, |ray| self.any(ray));
    }

    /// Leads a ray through the tree by a walk, and gives back what was collected and counted.
    ///
    /// A triangle may stand in several leaves, and some walks [show a leaf again](KdWalk::SHOWS_AGAIN): its hit may be
    /// offered once for each.
    #[inline(always)]
    pub fn visit<W: KdWalk, C: Collect, P: Probe>(
        &self,
        walk: W,
        ray: &PreparedRay,
        collect: C,
        probe: P,
    ) -> (C, P) {
        let mut visitor = ReferenceVisitor { tree: self, ray, collect, probe };
        walk.walk(self, ray, &mut visitor);
        (visitor.collect, visitor.probe)
    }

    fn trace_batch(&self, walk: Walk, batch: Batch<'_>) -> Result<Traced, TraceError> {
        Ok(match walk {
            Walk::BruteForce => Unordered(self).trace(batch),
            Walk::Stack(StackOrder::Ordered) => self.by(Stack).trace(batch),
            Walk::RestartTrail(trail) => {
                let walk = RestartTrail::<TrailU64>::new(trail.short_stack);
                self.by(walk).trace(batch)
            }
            Walk::KdRestart => self.by(Restart).trace(batch),
            Walk::KdBacktrack => self.by(Backtrack).trace(batch),
            Walk::ShortStack { entries } => self.by(ShortStack { entries }).trace(batch),
            Walk::Ropes => self.by(Ropes).trace(batch),
            // The catalogue has refused them.
            Walk::Recursive | Walk::Stack(_) | Walk::List | Walk::SmartStack { .. } => {
                let text = format!("the walk '{walk}' does not go through kd-trees");
                return Err(CatalogueError(text).into());
            }
        })
    }

    /// Traces a batch by a walk.
    #[must_use]
    pub fn trace_by<W: KdWalk>(&self, walk: W, query: Query, rays: &[Ray], options: TraceOptions) -> Traced {
        self.by(walk).trace(Batch { query, rays, options, keep: None })
    }

    /// Traces a batch by testing every triangle, each once: no cell takes part.
    #[must_use]
    pub fn trace_by_force(&self, query: Query, rays: &[Ray], options: TraceOptions) -> Traced {
        Unordered(self).trace(Batch { query, rays, options, keep: None })
    }

    #[inline(always)]
    const fn by<W>(&self, walk: W) -> Walked<'_, W> {
        Walked { tree: self, walk }
    }
}

/// A tree together with the way to walk it.
#[derive(Clone, Copy)]
struct Walked<'a, W> {
    tree: &'a KdTree,
    walk: W,
}

impl<W: KdWalk> Traversal for Walked<'_, W> {
    #[inline(always)]
    fn visit<C: Collect, P: Probe>(&self, _: &Ray, ray: &PreparedRay, collect: C, probe: P) -> (C, P) {
        self.tree.visit(self.walk, ray, collect, probe)
    }

    fn has_repeats(&self) -> bool {
        W::SHOWS_AGAIN || self.tree.has_repeats()
    }
}

/// Every triangle, and no cell.
#[derive(Clone, Copy)]
struct Unordered<'a>(&'a KdTree);

impl Traversal for Unordered<'_> {
    #[inline(always)]
    fn visit<C: Collect, P: Probe>(
        &self,
        _: &Ray,
        ray: &PreparedRay,
        mut collect: C,
        mut probe: P,
    ) -> (C, P) {
        for triangle in self.0.triangles() {
            probe.primitive_test();
            if let Some(hit) = triangle.intersect(ray, collect.t_max())
                && collect.offer(hit).is_break()
            {
                break;
            }
        }
        (collect, probe)
    }

    /// Each triangle is tested once.
    fn has_repeats(&self) -> bool {
        false
    }
}
