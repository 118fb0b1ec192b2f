//! What a point walk meets on its way.
//!
//! **The slack of spatial splits.** A leaf's box holds a part of its triangle, so a triangle may come out
//! nearer than the box in which its nearest point lies, by the rounding of the foot: its offset from the point is a
//! sum of a corner and two weighted edges, each with a relative error of a few 2^-24, of which none is longer than
//! twice the distance `m` from the point to the farthest corner of everything. All in all less than `48 m 2^-24`. The
//! slack is [`SLACK_SHARE`] of the largest way along an axis to a side of everything, of which `m` is no more than the
//! root of 3 times, so more than `64 m 2^-24`; it needs neither a root, nor f64, which a GPU has not. It widens what is
//! culled by, never what is answered. Without spatial splits it is zero. It is
//! caution: no tree is known that loses anything without it, because a box is as far as what it holds only where the
//! offset runs along an axis, and is exact there.

use super::distance::farthest_side;
use super::{CollectPoints, PreparedPoint, reach};
use crate::bvh::Bvh;
use crate::bvh::walk::Visitor;
use crate::{FlatTriangle, Probe};
use std::ops::ControlFlow;

/// How far a search reaches beyond its limit where there are spatial splits, as a share of the largest way along an axis
/// from the point to a side of the box of everything: `112 * 2^-24`.
pub const SLACK_SHARE: f32 = 112.0 / (1 << 24) as f32;

/// How far a search must reach beyond its limit so that it finds everything within: see the text of this file.
pub(super) fn slack(bvh: &Bvh, point: &PreparedPoint) -> f32 {
    if bvh.has_repeats() {
        let bounds = bvh.bounds();
        farthest_side(point.point, bounds.min, bounds.max) * SLACK_SHARE
    } else {
        0.0
    }
}

/// Asks the triangles of each leaf, offers what they answer to a [`CollectPoints`], and tells a [`Probe`] what happens.
#[derive(Debug)]
pub struct PointVisitor<'a, C, P> {
    triangles: &'a [FlatTriangle],
    point: PreparedPoint,
    slack: f32,
    /// What a squared distance must not exceed; follows the limit of `collect`.
    reach: f32,
    /// What is done with answers.
    pub collect: C,
    /// What is counted.
    pub probe: P,
}

impl<'a, C: CollectPoints, P: Probe> PointVisitor<'a, C, P> {
    /// A visitor that has seen nothing of the tree yet.
    #[inline(always)]
    #[must_use]
    pub fn new(bvh: &'a Bvh, point: &PreparedPoint, collect: C, probe: P) -> Self {
        let slack = slack(bvh, point);
        let reach = reach(collect.limit() + slack);
        Self { triangles: bvh.triangles(), point: *point, slack, reach, collect, probe }
    }
}

impl<C: CollectPoints, P: Probe> Visitor for PointVisitor<'_, C, P> {
    /// The largest *squared* distance of interest.
    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.reach
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
            if let Some(found) = triangle.closest_point(&self.point, self.reach) {
                self.collect.offer(found);
                self.reach = reach(self.collect.limit() + self.slack);
            }
        }
        ControlFlow::Continue(())
    }
}
