//! Where a ray meets the plane of a node.
//!
//! These are the floats of the padded slab test of the children's boxes: the far face of the near child and the near face of
//! the far one. Where the ray is parallel to the plane the two are computed from different origins and lie far apart, so that
//! a ray in the plane meets both children in the whole interval (ALGORITHMS: C6).

use crate::PreparedRay;
use crate::aabb::{Interval, PAD_ENTRY, PAD_EXIT, larger, smaller};
use crate::kd_tree::{KdNode, KdTree};

/// What the planes need of a ray, by axis. The fourth lane is never asked for: it makes every two-bit axis an index.
#[derive(Clone, Copy)]
pub(crate) struct RayPlanes {
    low: [f32; 4],
    high: [f32; 4],
    inverse: [f32; 4],
}

/// The two children of an inner node, as a ray meets them.
#[derive(Clone, Copy)]
pub(crate) struct Crossing {
    pub(crate) near: u32,
    pub(crate) far: u32,
    /// Where the near child ends, padded.
    pub(crate) near_exit: f32,
    /// Where the far child begins, padded.
    pub(crate) far_entry: f32,
    /// Whether the ray meets the plane at one point: it is not parallel to it.
    pub(crate) is_point: bool,
}

impl RayPlanes {
    #[inline(always)]
    pub(crate) fn of(ray: &PreparedRay) -> Self {
        Self {
            low: ray.origin_low.to_array(),
            high: ray.origin_high.to_array(),
            inverse: ray.inverse.to_array(),
        }
    }

    /// Which child is near depends on the ray's direction alone.
    #[inline(always)]
    pub(crate) fn crossing(&self, index: u32, node: &KdNode) -> Crossing {
        let (axis, split) = (node.axis(), node.split());
        let inverse = self.inverse[axis];
        // The lower face of the upper child, and the upper face of the lower one.
        let at_low = (split - self.low[axis]) * inverse;
        let at_high = (split - self.high[axis]) * inverse;
        let (lower, upper) = (index + 1, node.upper());
        let (near, far, ends, begins) =
            if inverse < 0.0 { (upper, lower, at_low, at_high) } else { (lower, upper, at_high, at_low) };
        Crossing {
            near,
            far,
            near_exit: ends * PAD_EXIT,
            far_entry: begins * PAD_ENTRY,
            is_point: at_low == at_high,
        }
    }
}

impl Crossing {
    /// The near child's part of the node's interval.
    #[inline(always)]
    pub(crate) fn near_part(&self, cell: Interval) -> Interval {
        Interval { entry: cell.entry, exit: smaller(cell.exit, self.near_exit) }
    }

    /// The far child's part of the node's interval.
    #[inline(always)]
    pub(crate) fn far_part(&self, cell: Interval) -> Interval {
        Interval { entry: larger(cell.entry, self.far_entry), exit: cell.exit }
    }
}

/// Where the ray is in the cell of the whole tree, from its `t_min` up to `limit`. The tree must not be empty.
#[inline(always)]
pub(crate) fn whole_tree(tree: &KdTree, ray: &PreparedRay, limit: f32) -> Interval {
    let bounds = tree.bounds();
    crate::aabb::slab_test(ray, bounds.min.extend(1.0), bounds.max.extend(1.0), limit)
}

/// Where the ray is in the cell of a node, from its `t_min` up to `limit`.
#[inline(always)]
pub(crate) fn cell_of(tree: &KdTree, node: u32, ray: &PreparedRay, limit: f32) -> Interval {
    if node == 0 {
        return whole_tree(tree, ray, limit);
    }
    let [min, max] = tree.places()[node as usize].corners();
    crate::aabb::slab_test(ray, min, max, limit)
}
