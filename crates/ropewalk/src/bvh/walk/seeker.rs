//! Who goes through a tree: a ray in search of hits, or a point in search of what is near.
//!
//! The walks that order and cull ask only where a box begins, so they serve both. What they build on, the restart trail
//! (Laine 2010) more than all others, is in the contract of [`Seeker::approach`]: an order of the children that nothing
//! found on the way can change, and no near child culled that has a far child which is not.

use crate::PreparedRay;
use crate::aabb::{Interval, slab_test};
use crate::bvh::Node;
use crate::point::{PreparedPoint, box_distance_squared};

/// Goes through a tree in search of something.
pub trait Seeker {
    /// Where a node's box begins, in the unit of [`super::Visitor::t_max`], which is the `limit`. The box is to be
    /// entered where the interval [is hit](Interval::is_hit), closed: a box that begins at the limit is.
    ///
    /// The entry does not depend on the limit, and a box that holds another begins no later than that one.
    fn approach(&self, node: &Node, limit: f32) -> Interval;
}

/// In `t`: the padded slab test.
impl Seeker for PreparedRay {
    #[inline(always)]
    fn approach(&self, node: &Node, limit: f32) -> Interval {
        let [min, max] = node.corners();
        slab_test(self, min, max, limit)
    }
}

/// In squared distances. A ball has no far side, so a box ends at the limit.
impl Seeker for PreparedPoint {
    #[inline(always)]
    fn approach(&self, node: &Node, limit: f32) -> Interval {
        let [min, max] = node.corners();
        Interval { entry: box_distance_squared(self, min, max), exit: limit }
    }
}
