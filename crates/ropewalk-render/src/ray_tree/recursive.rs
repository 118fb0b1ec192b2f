//! The tree by recursion, one ray after the other: what it is, written down. The reference of the other orders; slow.

use super::node::{Node, Sample};
use super::{Followed, Root, Tally, Tree, TreeRay};
use crate::error::RenderError;
use crate::tracing::{Asking, Tracing};
use glam::Vec3;
use rayon::prelude::*;
use ropewalk::Hit;

struct Recursion<'a> {
    tree: &'a Tree<'a>,
    tracing: &'a Tracing<'a>,
    sample: Sample,
    sum: Vec3,
    is_broken: bool,
    tally: Tally,
}

impl Recursion<'_> {
    /// Adds the light that comes along a ray.
    fn follow(&mut self, ray: &TreeRay) -> Result<(), RenderError> {
        self.tally.count(ray.kind);
        if ray.kind.is_occlusion() {
            let mut asking = Asking::default();
            asking.push(ray.ray, ray.left, ray.weight, ray.depth);
            for status in self.tracing.arriving_of(&mut asking)? {
                self.tally.incomplete.count(status);
                self.is_broken |= !status.is_complete();
            }
            asking.passed.iter().for_each(|_| self.tally.count(ray.kind));
            self.tally.cut_by_depth += asking.stopped;
            asking.light.iter().for_each(|light| self.sum += *light);
            return Ok(());
        }
        let (hit, status) = self.tracing.closest(&ray.ray, ray.left)?;
        self.tally.incomplete.count(status);
        self.is_broken |= !status.is_complete();
        if status.is_complete() { self.arrive(ray, &hit) } else { Ok(()) }
    }

    /// Adds the light that leaves the place a ray has found.
    fn arrive(&mut self, ray: &TreeRay, hit: &Hit) -> Result<(), RenderError> {
        if !hit.is_hit() {
            self.sum += self.tree.missed(&self.sample, ray);
            return Ok(());
        }
        let mut node = Node::default();
        if !self.tree.grow(&self.sample, ray, hit, &mut node) {
            self.tally.incomplete.count_lost(1);
            self.is_broken = true;
            return Ok(());
        }
        self.tally.cut_by_depth += u64::from(node.cut_by_depth);
        self.tally.cut_by_weight += u64::from(node.cut_by_weight);
        self.sum += node.own;
        node.rays.iter().try_for_each(|child| self.follow(child))
    }
}

pub(super) fn follow(
    tree: &Tree<'_>,
    tracing: &Tracing<'_>,
    roots: &[Root],
) -> Result<(Vec<Followed>, Tally), RenderError> {
    let all: Result<Vec<(Followed, Tally)>, RenderError> = roots
        .par_iter()
        .with_min_len(64)
        .map(|root| {
            let mut recursion = Recursion {
                tree,
                tracing,
                sample: root.sample,
                sum: Vec3::ZERO,
                is_broken: false,
                tally: Tally::default(),
            };
            recursion.arrive(&TreeRay::primary(root.ray), &root.hit)?;
            let followed = Followed { color: recursion.sum, is_broken: recursion.is_broken };
            Ok((followed, recursion.tally))
        })
        .collect();
    let mut tally = Tally::default();
    let followed = all?.into_iter().map(|(followed, own)| {
        tally.add(&own);
        followed
    });
    Ok((followed.collect(), tally))
}
