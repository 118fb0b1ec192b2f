//! The restart trail (Laine 2010) for point queries: a short stack of any size or none, and one bit a level that leads
//! back after a restart. The trails and the ring are those of the rays: [`crate::bvh::walk::Trail`].

use super::{Entry, PointWalk, children};
use crate::bvh::Node;
use crate::bvh::walk::short_stack::ShortStack;
use crate::bvh::walk::{Trail, Visitor};
use crate::point::PreparedPoint;

/// The walk, with a trail of type `T` and a short stack in a ring of `ROOM` places.
#[derive(Clone, Copy, Debug)]
pub struct PointRestartTrail<T, const ROOM: usize = 16> {
    capacity: usize,
    trail: std::marker::PhantomData<fn() -> T>,
}

impl<T: Trail, const ROOM: usize> PointRestartTrail<T, ROOM> {
    /// A walk whose stack holds the last `min(short_stack, ROOM)` entries. The tree must be no deeper than the
    /// trail's [`Trail::LEVELS`].
    #[must_use]
    pub const fn new(short_stack: u32) -> Self {
        Self { capacity: short_stack as usize, trail: std::marker::PhantomData }
    }
}

impl<T: Trail + Sync, const ROOM: usize> PointWalk for PointRestartTrail<T, ROOM> {
    #[inline(always)]
    fn walk<V: Visitor>(self, nodes: &[Node], point: &PreparedPoint, visitor: &mut V) {
        if nodes.is_empty() {
            return;
        }
        let mut trail = T::new();
        let mut stack = ShortStack::<Entry, ROOM>::new(self.capacity);
        let mut current = 0;
        loop {
            let node = &nodes[current as usize];
            if node.is_leaf() {
                if visitor.leaf(node.link, node.count).is_break() {
                    return;
                }
            } else {
                visitor.inner_visit(current);
                let (near, far) = children(nodes, current, point);
                if far.square <= visitor.t_max() {
                    trail.descend();
                    if trail.is_near_done() {
                        current = far.node;
                    } else {
                        current = near.node;
                        if self.capacity > 0 {
                            visitor.stack_depth(stack.push(far));
                        }
                    }
                    continue;
                }
                if near.square <= visitor.t_max() {
                    trail.descend();
                    if !trail.is_pop_level() {
                        trail.set_single();
                        current = near.node;
                        continue;
                    }
                    // Both were within reach when the walk came by first, and the near one is finished: what was found
                    // since then culls the far one.
                }
            }
            loop {
                if !trail.finish() {
                    return;
                }
                match stack.pop() {
                    None => {
                        trail.restart();
                        visitor.restart();
                        current = 0;
                        break;
                    }
                    // Closed: at equal distance a smaller id may still win.
                    Some(far) if far.square <= visitor.t_max() => {
                        current = far.node;
                        break;
                    }
                    // Culled. It has its own bit of the trail, which the next round sets.
                    Some(_) => {}
                }
            }
        }
    }
}
