//! The walk as the paper prints it, without culling at pop: an entry is visited whatever has been hit since it was
//! pushed. The same answers with more visits, and the comparison that the reference measurements made.
//!
//! The catalogue has no such walk, since nobody should want it; counts alone are taken, on the CPU.

use crate::comparison::ShortStack;
use rayon::prelude::*;
use ropewalk::bvh::walk::{AnyHit, ArrayTrail, ClosestHit, RestartTrail, Summary};
use ropewalk::{Answer, Bvh, Counters, PreparedRay, Query, Ray, Status, Structure, Traced};

/// Entries that no walk of a binary tree fills: one a level waits.
const FULL: u32 = 64;

/// Traces a batch of [`Query::Closest`] or [`Query::Any`] through a binary tree; nothing for any other.
pub(super) fn trace(
    structure: &Structure,
    short_stack: ShortStack,
    query: Query,
    rays: &[Ray],
) -> Option<Traced> {
    let Structure::Bvh(bvh) = structure else { return None };
    let walk = RestartTrail::new(short_stack.entries().unwrap_or(FULL));
    let (answer, counters) = match query {
        Query::Closest => {
            let (hits, counters) = each::<ClosestHit>(bvh, walk, rays);
            (Answer::Closest(hits), counters)
        }
        Query::Any => {
            let (hits, counters) = each::<AnyHit>(bvh, walk, rays);
            (Answer::Any(hits), counters)
        }
        _ => return None,
    };
    let status = |ray: &Ray| if ray.is_valid() { Status::COMPLETE } else { Status::INVALID_RAY };
    Some(Traced { answer, status: rays.iter().map(status).collect(), counters: Some(counters) })
}

fn each<S: Summary>(
    bvh: &Bvh,
    walk: RestartTrail<ArrayTrail, { FULL as usize }, false>,
    rays: &[Ray],
) -> (Vec<S::Answer>, Vec<Counters>) {
    let one = |ray: &Ray| match PreparedRay::new(ray) {
        None => Default::default(),
        Some(ray) => {
            let (summary, counters) = bvh.visit(walk, &ray, S::new(&ray), Counters::default());
            (summary.answer(), counters)
        }
    };
    rays.par_iter().map(one).unzip()
}
