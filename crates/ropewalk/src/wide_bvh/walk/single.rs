//! One ray at a time, with the best walk there is for it.

use super::{Ordered, WideNodes, WideWalk};
use crate::batch::Traversal;
use crate::bvh::walk::{AnyHit, ClosestHit, Collect, TriangleVisitor, Visitor};
use crate::wide_bvh::{WideBvh, Width};
use crate::{Hit, NoProbe, PreparedRay, Probe, Ray};

impl WideBvh {
    /// The closest hit of a ray; [`Hit::MISS`] where there is none or the ray is not valid.
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Hit {
        self.by(Ordered).summary::<ClosestHit, NoProbe>(ray).0
    }

    /// Whether a ray hits anything in its window; false where the ray is not valid.
    #[must_use]
    pub fn any(&self, ray: &Ray) -> bool {
        self.by(Ordered).summary::<AnyHit, NoProbe>(ray).0
    }

    /// How many hits a ray has in its window; 0 where the ray is not valid.
    #[must_use]
    pub fn count(&self, ray: &Ray) -> u32 {
        self.by(Ordered).count(ray)
    }

    /// Replaces `hits` by every hit of a ray in its window, sorted by `t`, ties by id. None is left out: there
    /// is no most.
    pub fn all(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        self.by(Ordered).append_all(ray, hits, NoProbe);
    }

    /// Leads a ray through the structure by a walk, and gives back what was collected and counted.
    ///
    /// Where spatial splits put a triangle into several leaves, its hit may be offered once for each.
    #[inline(always)]
    pub fn visit<W: WideWalk, C: Collect, P: Probe>(
        &self,
        walk: W,
        ray: &PreparedRay,
        collect: C,
        probe: P,
    ) -> (C, P) {
        let mut visitor = TriangleVisitor { triangles: &self.triangles, ray, collect, probe };
        self.lead(walk, ray, &mut visitor);
        (visitor.collect, visitor.probe)
    }

    /// Leads a visitor of any kind through the structure by a walk.
    #[inline(always)]
    pub fn lead<W: WideWalk, V: Visitor>(&self, walk: W, ray: &PreparedRay, visitor: &mut V) {
        match self.width {
            Width::Four => walk.walk(self.nodes::<4>(), ray, visitor),
            Width::Eight => walk.walk(self.nodes::<8>(), ray, visitor),
        }
    }

    /// The wide nodes, where `WIDTH` is the width of the tree.
    #[inline(always)]
    fn nodes<const WIDTH: usize>(&self) -> WideNodes<'_, WIDTH> {
        WideNodes {
            nodes: self.children.as_chunks().0,
            levels: self.report.depth,
            stack_entries: self.stack_entries,
        }
    }

    #[inline(always)]
    pub(super) const fn by<W>(&self, walk: W) -> Walked<'_, W> {
        Walked { bvh: self, walk }
    }
}

/// A tree together with the way to walk it.
#[derive(Clone, Copy)]
pub(super) struct Walked<'a, W> {
    bvh: &'a WideBvh,
    walk: W,
}

impl<W: WideWalk> Traversal for Walked<'_, W> {
    #[inline(always)]
    fn visit<C: Collect, P: Probe>(&self, _: &Ray, ray: &PreparedRay, collect: C, probe: P) -> (C, P) {
        self.bvh.visit(self.walk, ray, collect, probe)
    }

    fn has_repeats(&self) -> bool {
        self.bvh.has_repeats()
    }
}
