//! The two-level walk, one structure inside the other: a stack for the top level, and in each of its leaves the walk of the
//! object's own structure, with a stack of its own.
//!
//! The loop of Reichl 2010, section 4.2.4: of two children the nearer one first; in a leaf the ray is taken to the object's
//! space and asked for the object's box; then the rest of the top level that is nearer than what was found. The twin on
//! graphics adapters, and [`super::merged`] here, do the same in one loop.

use super::enter::Instances;
use super::{Entry, TwoLevel};
use crate::bvh::walk::{BvhWalk, Collect, Ordered, Visitor};
use crate::{PreparedRay, Probe, Ray};
use std::ops::ControlFlow;

/// Enters the objects in the leaves of the top level.
struct ObjectVisitor<'a, C, P> {
    instances: Instances<'a>,
    /// What each leaf leads to.
    entries: &'a [Entry],
    question: &'a Ray,
    ray: &'a PreparedRay,
    collect: C,
    probe: P,
}

impl<C: Collect, P: Probe> Visitor for ObjectVisitor<'_, C, P> {
    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.collect.t_max()
    }

    #[inline(always)]
    fn inner_visit(&mut self, _node: u32) {
        self.probe.inner_visit();
    }

    #[inline(always)]
    fn stack_depth(&mut self, entries: usize) {
        self.probe.stack_depth(entries);
    }

    #[inline(always)]
    fn restart(&mut self) {
        self.probe.restart();
    }

    #[inline(always)]
    fn leaf(&mut self, first: u32, count: u32) -> ControlFlow<()> {
        for &entry in &self.entries[first as usize..][..count as usize] {
            let rays = (self.question, self.ray);
            self.instances.enter::<false, C, P>(entry, rays, &mut self.collect, &mut self.probe)?;
        }
        ControlFlow::Continue(())
    }
}

impl TwoLevel {
    /// Leads a ray through both levels, and gives back what was collected and counted. The ray must be that of which the
    /// prepared one was made.
    ///
    /// Where a bottom structure holds a triangle several times, its hit may be offered once for each.
    #[inline(always)]
    pub fn visit<C: Collect, P: Probe>(
        &self,
        question: &Ray,
        ray: &PreparedRay,
        collect: C,
        probe: P,
    ) -> (C, P) {
        let instances = self.instances();
        let entries = &self.entries;
        let mut visitor = ObjectVisitor { instances, entries, question, ray, collect, probe };
        Ordered.walk(self.top.nodes(), &self.widened(ray), &mut visitor);
        (visitor.collect, visitor.probe)
    }

    /// Tests every triangle of every instance in whose box the ray is.
    pub(super) fn visit_all<C: Collect, P: Probe>(
        &self,
        question: &Ray,
        ray: &PreparedRay,
        mut collect: C,
        mut probe: P,
    ) -> (C, P) {
        for place in 0..self.placed.len() as u32 {
            let (entry, rays) = (Entry { place, node: 0 }, (question, ray));
            if self.instances().enter::<true, C, P>(entry, rays, &mut collect, &mut probe).is_break() {
                break;
            }
        }
        (collect, probe)
    }
}
