//! The walk: on by one element, or by as many as the escape index says.
//!
//! The loop of Toczek 2010, section 2.1, with what its pseudocode gets wrong put right (ALGORITHMS: C1): the last triangle's
//! index is 0, not 1, and it is a triangle all the same; an empty list has no element to begin with; a volume is compared by
//! its entry, closed, and not by its smallest positive root, which is the exit of one that the ray starts in; a pointer
//! behind the end of a list is not carried on to the next layer.

use super::{Bounds, Element, NO_HEAD, TraversalList, list_of};
use crate::aabb::{Interval, slab_test};
use crate::bvh::walk::Collect;
use crate::{FlatTriangle, Hit, PreparedRay, Probe};
use std::ops::ControlFlow;

impl TraversalList {
    /// Leads a ray through its lists, and gives back what was collected and counted. It begins with these heads, one for
    /// each list of each layer, or with the first elements.
    ///
    /// Where spatial splits put a triangle into the list several times, its hit may be offered once for each.
    #[inline(always)]
    pub fn visit<C: Collect, P: Probe>(
        &self,
        ray: &PreparedRay,
        heads: Option<&[u32]>,
        mut collect: C,
        mut probe: P,
    ) -> (C, P) {
        let lists = self.options.directions.lists();
        let list = list_of(self.options.directions, ray);
        for layer in 0..self.layers.len() {
            let head = heads.map_or(0, |heads| heads[layer * lists + list]);
            if head == NO_HEAD {
                continue;
            }
            let elements = &self.list_of_layer(layer, list)[head as usize..];
            let ended = match self.options.bounds {
                Bounds::Sphere => {
                    let approach = |element: &Element, limit| element.sphere().interval(ray, limit);
                    self.walk(elements, ray, approach, &mut collect, &mut probe)
                }
                Bounds::Aabb => {
                    let grid = &self.layers[layer].grid;
                    let approach = |element: &Element, limit| {
                        let [min, max] = element.packed_box().corners(grid);
                        slab_test(ray, min, max, limit)
                    };
                    self.walk(elements, ray, approach, &mut collect, &mut probe)
                }
            };
            if ended.is_break() {
                break;
            }
        }
        (collect, probe)
    }

    /// The loop, with a test of an inner node's volume. Whether the collector has enough.
    #[inline(always)]
    fn walk<C: Collect, P: Probe>(
        &self,
        elements: &[Element],
        ray: &PreparedRay,
        approach: impl Fn(&Element, f32) -> Interval,
        collect: &mut C,
        probe: &mut P,
    ) -> ControlFlow<()> {
        let mut rest = elements;
        while let Some(element) = rest.first() {
            let mut next = element.escape;
            if element.is_triangle() {
                probe.primitive_test();
                if let Some(hit) = self.hit(&self.triangle(element), ray, collect.t_max()) {
                    collect.offer(hit)?;
                }
            } else {
                probe.inner_visit();
                if approach(element, collect.t_max()).is_hit() {
                    next = 1;
                }
            }
            // 0, behind the last triangle, and -1, where nothing follows.
            if next <= 0 {
                break;
            }
            rest = &rest[next as usize..];
        }
        ControlFlow::Continue(())
    }

    /// What a ray hits of a triangle: of both sides, or of the front alone.
    #[inline(always)]
    pub(super) fn hit(&self, triangle: &FlatTriangle, ray: &PreparedRay, t_max: f32) -> Option<Hit> {
        if self.is_one_sided() {
            triangle.intersect_front(ray, t_max)
        } else {
            triangle.intersect(ray, t_max)
        }
    }
}
