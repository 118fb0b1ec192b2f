//! The two-level walk in one loop: both levels share a [`SmartStack`] (Reichl 2010, sections 4.2.4 and 4.3).
//!
//! While an object is walked its entries lie above those of the top level, and are used up before these are wanted again: so
//! one stack serves both, and a node is of the object exactly while one is entered. A BVH's entry is two words, a kd-tree's
//! three. Wide trees and lists, which have their own kind of stack or none, are walked as [`super::walk`] does.
//!
//! It does the same work in the same order as [`super::walk`], which a test demands of every counter. On a CPU it is the twin
//! of `walk_two_level.wgsl`, no faster way to trace.

use super::enter::{Approach, Moved, Told};
use super::{Bottom, Entry, SmartStack, TwoLevel};
use crate::aabb::{Interval, slab_test, smaller};
use crate::bvh::Node;
use crate::bvh::walk::{Collect, TriangleVisitor, Visitor};
use crate::kd_tree::KdTree;
use crate::kd_tree::walk::ReferenceVisitor;
use crate::kd_tree::walk::crossing::{RayPlanes, cell_of};
use crate::{PreparedRay, Probe, Ray};
use std::ops::ControlFlow;

impl TwoLevel {
    /// Leads a ray through both levels in one loop with a ring of so many bytes, and gives back what was collected and counted.
    /// The ray must be that of which the prepared one was made. [`TwoLevel::visit`] does the same work, with two stacks.
    pub fn visit_merged<C: Collect, P: Probe>(
        &self,
        bytes: u32,
        question: &Ray,
        ray: &PreparedRay,
        collect: C,
        probe: P,
    ) -> (C, P) {
        let stack = SmartStack::new(bytes);
        let wide_ray = self.widened(ray);
        let mut walk = Merged { scene: self, question, ray, wide_ray, stack, collect, probe };
        // Whether it was led to the end or had enough is the same to the caller.
        let _ended = walk.top_level();
        walk.probe.stack_bytes(walk.stack.deepest_bytes(), walk.stack.swaps());
        (walk.collect, walk.probe)
    }
}

/// A ray on its way.
struct Merged<'a, C, P> {
    scene: &'a TwoLevel,
    question: &'a Ray,
    ray: &'a PreparedRay,
    /// The ray as the top level's boxes are asked for it.
    wide_ray: PreparedRay,
    stack: SmartStack,
    collect: C,
    probe: P,
}

impl<C: Collect, P: Probe> Merged<'_, C, P> {
    /// The loop of the top level; in its leaves that of the object.
    fn top_level(&mut self) -> ControlFlow<()> {
        let nodes = self.scene.top.nodes();
        let mut current = if nodes.is_empty() { None } else { Some(0) };
        while let Some(index) = current {
            let node = &nodes[index as usize];
            if node.is_leaf() {
                self.enter(self.scene.entries[node.link as usize])?;
                current = self.pop_top();
                continue;
            }
            self.probe.inner_visit();
            let children = Children::of(nodes, index, &self.wide_ray, self.collect.t_max());
            if let Some((far, entry)) = children.far {
                self.stack.push_top([far, entry.to_bits()]);
                self.probe.stack_depth(self.stack.top_entries());
            }
            current = children.near.or_else(|| self.pop_top());
        }
        ControlFlow::Continue(())
    }

    /// The next node of the top level that begins no later than what was found.
    fn pop_top(&mut self) -> Option<u32> {
        while let Some([node, entry]) = self.stack.pop_top() {
            if f32::from_bits(entry) <= self.collect.t_max() {
                return Some(node);
            }
        }
        None
    }

    /// Enters an instance.
    fn enter(&mut self, entry: Entry) -> ControlFlow<()> {
        self.probe.object_tested();
        let instances = self.scene.instances();
        let Some(approach) = instances.approach(entry.place, self.question, self.ray, &self.collect) else {
            return ControlFlow::Continue(());
        };
        let Approach { structure, ray, moving } = approach;
        self.probe.object_entered();
        let moved = Moved { collect: &mut self.collect, moving, ended: false };
        let told = Told(&mut self.probe);
        let (ended, told) = match structure.bottom() {
            Bottom::Bvh(bvh) => {
                let mut visitor =
                    TriangleVisitor { triangles: bvh.triangles(), ray: &ray, collect: moved, probe: told };
                through_boxes(bvh.nodes(), entry.node, &ray, &mut self.stack, &mut visitor);
                (visitor.collect.ended, visitor.probe)
            }
            Bottom::KdTree(tree) => {
                let mut visitor = ReferenceVisitor { tree, ray: &ray, collect: moved, probe: told };
                through_cells(tree, entry.node, &ray, &mut self.stack, &mut visitor);
                (visitor.collect.ended, visitor.probe)
            }
            bottom @ (Bottom::WideBvh(_) | Bottom::List(_)) => {
                let (moved, told) = bottom.visit(entry.node, &ray, moved, told);
                (moved.ended, told)
            }
        };
        told.0.object_left();
        if ended { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// What of a node's two children is entered, and what waits.
struct Children {
    near: Option<u32>,
    far: Option<(u32, f32)>,
}

impl Children {
    /// Of an inner node: the nearer child first, the first child at equal distance.
    fn of(nodes: &[Node], index: u32, ray: &PreparedRay, t_max: f32) -> Self {
        let [first, second] = [index + 1, nodes[index as usize].link];
        let [a, b] = [first, second].map(|child| {
            let [min, max] = nodes[child as usize].corners();
            slab_test(ray, min, max, t_max)
        });
        match (a.is_hit(), b.is_hit()) {
            (true, true) if b.entry < a.entry => Self { near: Some(second), far: Some((first, a.entry)) },
            (true, true) => Self { near: Some(first), far: Some((second, b.entry)) },
            (true, false) => Self { near: Some(first), far: None },
            (false, true) => Self { near: Some(second), far: None },
            (false, false) => Self { near: None, far: None },
        }
    }
}

/// Through an object's BVH, with entries of two words.
fn through_boxes<V: Visitor>(
    nodes: &[Node],
    from: u32,
    ray: &PreparedRay,
    stack: &mut SmartStack,
    visitor: &mut V,
) {
    let mut current = if nodes.is_empty() { None } else { Some(from) };
    while let Some(index) = current {
        let node = &nodes[index as usize];
        let mut near = None;
        if node.is_leaf() {
            if visitor.leaf(node.link, node.count).is_break() {
                return;
            }
        } else {
            visitor.inner_visit(index);
            let children = Children::of(nodes, index, ray, visitor.t_max());
            if let Some((far, entry)) = children.far {
                stack.push_bottom([far, entry.to_bits()]);
                visitor.stack_depth(stack.bottom_entries());
            }
            near = children.near;
        }
        current = near;
        while current.is_none() {
            let Some([node, entry]) = stack.pop_bottom::<2>() else { return };
            current = (f32::from_bits(entry) <= visitor.t_max()).then_some(node);
        }
    }
}

/// Through an object's kd-tree, with entries of three words.
fn through_cells<V: Visitor>(
    tree: &KdTree,
    from: u32,
    ray: &PreparedRay,
    stack: &mut SmartStack,
    visitor: &mut V,
) {
    let nodes = tree.nodes();
    if nodes.is_empty() {
        return;
    }
    let planes = RayPlanes::of(ray);
    let mut cell = cell_of(tree, from, ray, visitor.t_max());
    if !cell.is_hit() {
        return;
    }
    let mut current = from;
    loop {
        let node = &nodes[current as usize];
        if !node.is_leaf() {
            visitor.inner_visit(current);
            let crossing = planes.crossing(current, node);
            let (near, far) = (crossing.near_part(cell), crossing.far_part(cell));
            if !near.is_hit() {
                (current, cell) = (crossing.far, far);
                continue;
            }
            if far.is_hit() {
                stack.push_bottom([crossing.far, far.entry.to_bits(), far.exit.to_bits()]);
                visitor.stack_depth(stack.bottom_entries());
            }
            (current, cell) = (crossing.near, near);
            continue;
        }
        if visitor.leaf(node.first(), node.count()).is_break() {
            return;
        }
        loop {
            let Some([node, entry, exit]) = stack.pop_bottom::<3>() else { return };
            let (entry, exit) = (f32::from_bits(entry), f32::from_bits(exit));
            if entry <= visitor.t_max() {
                (current, cell) = (node, Interval { entry, exit: smaller(exit, visitor.t_max()) });
                break;
            }
        }
    }
}
