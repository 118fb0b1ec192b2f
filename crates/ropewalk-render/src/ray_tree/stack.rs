//! The tree by one stack a sample: Reichl et al. 2010, listing 1. Rays of every kind are one record, come from one stack
//! and take one path through the code; on a graphics device threads that run in step stay in step. Here is the kernel's
//! twin.
//!
//! **Bound.** A place pushes its rays in reverse, so the first comes off first, and all rays that follow from it before the
//! second: the recursion's order. Of a place's rays only the refracted one can wait while another one is followed to its
//! end, so [`Request::most_waiting`](super::Request::most_waiting) rays are the most that ever wait; a ray to a
//! light that passes a pane takes its own place again. A stack that were
//! fuller would be reported as a broken sample, never cut off silently.

use super::node::Node;
use super::{Followed, Root, Tally, Tree, TreeRay};
use crate::error::RenderError;
use crate::looks::MOST_PANES;
use crate::tracing::Tracing;
use glam::Vec3;
use rayon::prelude::*;
use ropewalk::Status;

/// What a sample needs while its rays are followed; kept from one sample to the next.
struct Desk {
    stack: Vec<TreeRay>,
    node: Node,
    most_waiting: usize,
    tally: Tally,
}

fn follow_one(
    tree: &Tree<'_>,
    tracing: &Tracing<'_>,
    root: &Root,
    desk: &mut Desk,
) -> Result<Followed, RenderError> {
    let mut sum = Vec3::ZERO;
    let mut is_broken = false;
    desk.stack.clear();
    desk.stack.push(TreeRay::primary(root.ray));
    let mut known = Some(root.hit);
    while let Some(ray) = desk.stack.pop() {
        desk.tally.count(ray.kind);
        let (hit, status) = match known.take() {
            Some(hit) => (hit, Status::COMPLETE),
            None => tracing.closest(&ray.ray, ray.left)?,
        };
        desk.tally.incomplete.count(status);
        is_broken |= !status.is_complete();
        if ray.kind.is_occlusion() {
            if !hit.is_hit() {
                sum += ray.weight;
                continue;
            }
            let through = tree.looks.through(&hit);
            if through == Vec3::ZERO {
                continue;
            }
            if ray.depth >= MOST_PANES {
                desk.tally.cut_by_depth += 1;
                continue;
            }
            let ray_behind = ray.ray.window(hit.t.next_up(), ray.ray.t_max);
            desk.stack.push(TreeRay {
                ray: ray_behind,
                weight: ray.weight * through,
                depth: ray.depth + 1,
                ..ray
            });
            continue;
        }
        if !status.is_complete() {
            continue;
        }
        if !hit.is_hit() {
            sum += tree.missed(&root.sample, &ray);
            continue;
        }
        if !tree.grow(&root.sample, &ray, &hit, &mut desk.node) {
            desk.tally.incomplete.count_lost(1);
            is_broken = true;
            continue;
        }
        desk.tally.cut_by_depth += u64::from(desk.node.cut_by_depth);
        desk.tally.cut_by_weight += u64::from(desk.node.cut_by_weight);
        sum += desk.node.own;
        if desk.stack.len() + desk.node.rays.len() > desk.most_waiting {
            desk.tally.incomplete.count(Status::STACK_OVERFLOW);
            is_broken = true;
            continue;
        }
        desk.stack.extend(desk.node.rays.iter().rev());
    }
    Ok(Followed { color: sum, is_broken })
}

pub(super) fn follow(
    tree: &Tree<'_>,
    tracing: &Tracing<'_>,
    roots: &[Root],
) -> Result<(Vec<Followed>, Tally), RenderError> {
    follow_within(tree, tracing, roots, tree.request.most_waiting(tree.lights.sources.len()))
}

/// Follows trees with stacks of so many rays.
pub(super) fn follow_within(
    tree: &Tree<'_>,
    tracing: &Tracing<'_>,
    roots: &[Root],
    most_waiting: usize,
) -> Result<(Vec<Followed>, Tally), RenderError> {
    let runs: Result<Vec<(Vec<Followed>, Tally)>, RenderError> = roots
        .par_chunks(64)
        .map(|run| {
            let mut desk = Desk {
                stack: Vec::with_capacity(most_waiting),
                node: Node::default(),
                most_waiting,
                tally: Tally::default(),
            };
            let followed: Result<Vec<Followed>, RenderError> =
                run.iter().map(|root| follow_one(tree, tracing, root, &mut desk)).collect();
            Ok((followed?, desk.tally))
        })
        .collect();
    let mut tally = Tally::default();
    let mut all = Vec::with_capacity(roots.len());
    for (followed, own) in runs? {
        all.extend(followed);
        tally.add(&own);
    }
    Ok((all, tally))
}
