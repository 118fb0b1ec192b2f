//! What a walk meets on its way.

use super::Collect;
use crate::{FlatTriangle, PreparedRay, Probe};
use std::ops::ControlFlow;

/// Is led through a structure by a walk.
pub trait Visitor {
    /// Nothing beyond is of interest any more: a ray's `t`, or a point's squared distance. It never grows.
    fn t_max(&self) -> f32;
    /// The boxes of the children of this inner node are about to be tested.
    fn inner_visit(&mut self, node: u32);
    /// The stack holds this many entries after a push.
    fn stack_depth(&mut self, entries: usize);
    /// The walk goes back to the root.
    fn restart(&mut self);
    /// A leaf over `count` primitives from `first` on. `Break` ends the walk.
    fn leaf(&mut self, first: u32, count: u32) -> ControlFlow<()>;
}

/// Tests the triangles of each leaf, offers hits to a [`Collect`], and tells a [`Probe`] what happens.
#[derive(Debug)]
pub struct TriangleVisitor<'a, C, P> {
    /// The triangles, in the order of the leaves.
    pub triangles: &'a [FlatTriangle],
    /// The ray.
    pub ray: &'a PreparedRay,
    /// What is done with hits.
    pub collect: C,
    /// What is counted.
    pub probe: P,
}

impl<C: Collect, P: Probe> Visitor for TriangleVisitor<'_, C, P> {
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
        for triangle in &self.triangles[first as usize..][..count as usize] {
            self.probe.primitive_test();
            if let Some(hit) = triangle.intersect(self.ray, self.collect.t_max()) {
                self.collect.offer(hit)?;
            }
        }
        ControlFlow::Continue(())
    }
}
