//! What a walk shows leaves to.

use crate::bvh::walk::{Collect, Visitor};
use crate::kd_tree::KdTree;
use crate::{PreparedRay, Probe};
use std::ops::ControlFlow;

/// Tests the triangles that each leaf names, offers hits to a [`Collect`], and tells a [`Probe`] what happens.
#[derive(Debug)]
pub struct ReferenceVisitor<'a, C, P> {
    /// The tree that is walked.
    pub tree: &'a KdTree,
    /// The ray.
    pub ray: &'a PreparedRay,
    /// What is done with hits.
    pub collect: C,
    /// What is counted.
    pub probe: P,
}

impl<C: Collect, P: Probe> Visitor for ReferenceVisitor<'_, C, P> {
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
        self.probe.leaf_visit();
        for &reference in &self.tree.references()[first as usize..][..count as usize] {
            self.probe.primitive_test();
            let triangle = &self.tree.triangles()[reference as usize];
            if let Some(hit) = triangle.intersect(self.ray, self.collect.t_max()) {
                self.collect.offer(hit)?;
            }
        }
        ControlFlow::Continue(())
    }
}
