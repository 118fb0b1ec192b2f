//! The walk: on by one element, or by as many as the escape index says.
//!
//! The loop of Toczek 2010, section 2.1, with what its pseudocode gets wrong put right (ALGORITHMS: C1): the last triangle's
//! index is 0, not 1, and it is a triangle all the same; an empty list has no element to begin with; a volume is compared by
//! its entry, closed, and not by its smallest positive root, which is the exit of one that the ray starts in.
//! It runs on the CPU alone.

use super::{Bounds, Element, TraversalList, list_of};
use crate::aabb::{Interval, slab_test};
use crate::batch::{TraceOptions, Traced, Traversal, answer_each};
use crate::bvh::walk::{AnyHit, ClosestHit, Collect};
use crate::catalogue::{self, StructureKind};
use crate::{CatalogueError, DeviceKind, Hit, NoProbe, PreparedRay, Probe, Query, Ray, TraceError, Walk};

impl TraversalList {
    /// The closest hit of a ray; [`Hit::MISS`] where there is none or the ray is not valid.
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Hit {
        Listed(self).summary::<ClosestHit, NoProbe>(ray).0
    }

    /// Whether a ray hits anything in its window; false where the ray is not valid.
    #[must_use]
    pub fn any(&self, ray: &Ray) -> bool {
        Listed(self).summary::<AnyHit, NoProbe>(ray).0
    }

    /// How many hits a ray has in its window; 0 where the ray is not valid.
    #[must_use]
    pub fn count(&self, ray: &Ray) -> u32 {
        Listed(self).count(ray)
    }

    /// Replaces `hits` by every hit of a ray in its window, sorted by `t`, ties by id. None is left out: there
    /// is no most.
    pub fn all(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        Listed(self).append_all(ray, hits, NoProbe);
    }

    /// The closest hits of many rays, into `hits`. Only the first `min(rays.len(), hits.len())` are traced.
    pub fn closest_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        answer_each(rays, hits, |ray| self.closest(ray));
    }

    /// Whether each of many rays hits anything, into `hits`. Only the first `min(rays.len(), hits.len())` are traced.
    pub fn any_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        answer_each(rays, hits, |ray| self.any(ray));
    }

    /// Traces a batch by any walk of the catalogue.
    ///
    /// # Errors
    /// When the walk does not answer the query.
    pub fn trace(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, TraceError> {
        catalogue::check(StructureKind::List, walk, query, DeviceKind::Cpu)?;
        match walk {
            Walk::List => Ok(Listed(self).trace(query, rays, options)),
            Walk::BruteForce => Ok(Unordered(self).trace(query, rays, options)),
            // The catalogue has refused them.
            Walk::Recursive | Walk::Stack(_) | Walk::RestartTrail(_) => {
                Err(CatalogueError(format!("the walk '{walk}' goes through trees only")).into())
            }
        }
    }

    /// Leads a ray through its list, and gives back what was collected and counted.
    ///
    /// Where spatial splits put a triangle into the list several times, its hit may be offered once for each.
    #[inline(always)]
    pub fn visit<C: Collect, P: Probe>(&self, ray: &PreparedRay, mut collect: C, mut probe: P) -> (C, P) {
        let list = self.list(list_of(self.options.directions, ray));
        match self.options.bounds {
            Bounds::Sphere => {
                let approach = |element: &Element, limit| element.sphere().interval(ray, limit);
                self.walk(list, ray, approach, &mut collect, &mut probe);
            }
            Bounds::Aabb => {
                let approach = |element: &Element, limit| {
                    let [min, max] = element.packed_box().corners(&self.grid);
                    slab_test(ray, min, max, limit)
                };
                self.walk(list, ray, approach, &mut collect, &mut probe);
            }
        }
        (collect, probe)
    }

    /// The loop, with a test of an inner node's volume.
    #[inline(always)]
    fn walk<C: Collect, P: Probe>(
        &self,
        list: &[Element],
        ray: &PreparedRay,
        approach: impl Fn(&Element, f32) -> Interval,
        collect: &mut C,
        probe: &mut P,
    ) {
        let mut rest = list;
        while let Some(element) = rest.first() {
            let mut next = element.escape;
            if element.is_triangle() {
                probe.primitive_test();
                if let Some(hit) = self.triangle(element).intersect(ray, collect.t_max())
                    && collect.offer(hit).is_break()
                {
                    return;
                }
            } else {
                probe.inner_visit();
                if approach(element, collect.t_max()).is_hit() {
                    next = 1;
                }
            }
            // 0, behind the last triangle, and -1, where nothing follows.
            if next <= 0 {
                return;
            }
            rest = &rest[next as usize..];
        }
    }
}

/// Lists, with the way to walk them.
#[derive(Clone, Copy)]
struct Listed<'a>(&'a TraversalList);

impl Traversal for Listed<'_> {
    #[inline(always)]
    fn visit<C: Collect, P: Probe>(&self, ray: &PreparedRay, collect: C, probe: P) -> (C, P) {
        self.0.visit(ray, collect, probe)
    }

    fn has_repeats(&self) -> bool {
        self.0.has_repeats()
    }
}

/// Every triangle of the first list, and no volume.
#[derive(Clone, Copy)]
struct Unordered<'a>(&'a TraversalList);

impl Traversal for Unordered<'_> {
    #[inline(always)]
    fn visit<C: Collect, P: Probe>(&self, ray: &PreparedRay, mut collect: C, mut probe: P) -> (C, P) {
        for element in self.0.list(0).iter().filter(|element| element.is_triangle()) {
            probe.primitive_test();
            if let Some(hit) = self.0.triangle(element).intersect(ray, collect.t_max())
                && collect.offer(hit).is_break()
            {
                break;
            }
        }
        (collect, probe)
    }

    fn has_repeats(&self) -> bool {
        self.0.has_repeats()
    }
}
