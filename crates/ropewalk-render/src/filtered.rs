//! Holes on devices that have no filter of their own: hits are looked at after they are found.
//!
//! A ray is traced as usual first. Only where its first hit lies in a hole are all its hits asked for, and the first
//! that counts is taken: most rays of most pictures pay nothing.

use crate::begin::Begin;
use crate::trace::Trace;
use ropewalk::{Answer, Hit, HitLists, Keep, Query, Ray, Status, TraceOptions, Traced, Walk};
use std::error::Error;

type Failure = Box<dyn Error + Send + Sync>;

/// Traces a batch as if the hits that `keep` does not keep were not there. Counters are those of the first pass.
pub(crate) fn trace<T: Trace + ?Sized>(
    tracer: &T,
    walk: Walk,
    query: Query,
    rays: &[Ray],
    begin: &Begin<'_>,
    keep: Keep<'_>,
    options: TraceOptions,
) -> Result<Traced, Failure> {
    if query == Query::All || query == Query::Count {
        return all(tracer, walk, query, rays, begin, keep, options);
    }
    let mut traced = tracer.trace_begun(walk, query, rays, begin, options)?;
    let again: Vec<usize> = match &traced.answer {
        Answer::Closest(hits) => {
            (0..hits.len()).filter(|&ray| hits[ray].is_hit() && !keep(&hits[ray])).collect()
        }
        Answer::Any(blocked) => (0..blocked.len()).filter(|&ray| blocked[ray]).collect(),
        _ => Vec::new(),
    };
    if again.is_empty() {
        return Ok(traced);
    }
    let some: Vec<Ray> = again.iter().filter_map(|&ray| rays.get(ray).copied()).collect();
    if query == Query::Any {
        // What is in the way may be known by the closest hit already.
        let left = vec![None; some.len()];
        let plain = TraceOptions::default();
        let closest = trace(tracer, walk, Query::Closest, &some, &Begin::OnTriangles(&left), keep, plain)?;
        if let (Answer::Any(blocked), Answer::Closest(hits)) = (&mut traced.answer, &closest.answer) {
            for (&ray, hit) in again.iter().zip(hits) {
                blocked[ray] = hit.is_hit();
            }
        }
        merge(&mut traced.status, &again, &closest.status);
        return Ok(traced);
    }
    let found = tracer.trace_batch(walk, Query::All, &some, TraceOptions::default())?;
    if let (Answer::Closest(hits), Answer::All(lists)) = (&mut traced.answer, &found.answer) {
        for (number, &ray) in again.iter().enumerate() {
            hits[ray] = lists.of(number).iter().find(|hit| keep(hit)).copied().unwrap_or(Hit::MISS);
        }
    }
    merge(&mut traced.status, &again, &found.status);
    Ok(traced)
}

/// All hits, or their number, without those that do not count.
fn all<T: Trace + ?Sized>(
    tracer: &T,
    walk: Walk,
    query: Query,
    rays: &[Ray],
    begin: &Begin<'_>,
    keep: Keep<'_>,
    options: TraceOptions,
) -> Result<Traced, Failure> {
    let mut traced = tracer.trace_begun(walk, Query::All, rays, begin, options)?;
    if let Answer::All(lists) = &traced.answer {
        let mut kept = HitLists { offsets: vec![0], hits: Vec::new() };
        for ray in 0..rays.len() {
            kept.hits.extend(lists.of(ray).iter().filter(|hit| keep(hit)));
            kept.offsets.push(kept.hits.len() as u64);
        }
        traced.answer = if query == Query::All {
            Answer::All(kept)
        } else {
            Answer::Count(kept.offsets.windows(2).map(|pair| (pair[1] - pair[0]) as u32).collect())
        };
    }
    Ok(traced)
}

fn merge(status: &mut [Status], rays: &[usize], of_rays: &[Status]) {
    for (&ray, &own) in rays.iter().zip(of_rays) {
        if let Some(status) = status.get_mut(ray) {
            *status = *status | own;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use ropewalk::{Mesh, NoMonitor, Scene, Structure, StructureSpec};

    /// A pile of squares, each of two triangles that share an edge.
    fn pile() -> Structure {
        let mut positions = Vec::new();
        let mut triangles = Vec::new();
        for level in 0..6_u32 {
            let z = level as f32;
            positions.extend([
                Vec3::new(-1.0, -1.0, z),
                Vec3::new(1.0, -1.0, z),
                Vec3::new(1.0, 1.0, z),
                Vec3::new(-1.0, 1.0, z),
            ]);
            let first = 4 * level;
            triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        let scene = Scene::from_mesh(Mesh::new(positions, triangles));
        StructureSpec::default().build(&scene, &NoMonitor).unwrap()
    }

    /// Traces by looking at hits afterwards, and by the structure's own filter.
    fn both(query: Query, keep: Keep<'_>) -> (Answer, Answer) {
        let structure = pile();
        let rays: Vec<Ray> = (0..200)
            .map(|index| {
                let (x, y) = ((index % 20) as f32 / 8.0 - 1.2, (index / 20) as f32 / 4.0 - 1.2);
                Ray::new(Vec3::new(x, y, 9.0), Vec3::new(0.01, 0.02, -1.0))
                    .window(0.0, 4.0 + (index % 7) as f32)
            })
            .collect();
        let left = vec![None; rays.len()];
        let begin = Begin::OnTriangles(&left);
        let options = TraceOptions::default();
        let after = trace(&structure, Walk::default(), query, &rays, &begin, keep, options).unwrap();
        let within = structure.trace_filtered(Walk::default(), query, &rays, options, keep).unwrap();
        assert_eq!(after.status, within.status);
        (after.answer, within.answer)
    }

    #[test]
    fn hits_looked_at_afterwards_are_those_of_a_filter_within_the_walk() {
        let every_other = |hit: &Hit| (hit.primitive_index / 2).is_multiple_of(2);
        let by_place = |hit: &Hit| hit.barycentrics.x > 0.3;
        let none = |_: &Hit| false;
        for keep in [&every_other as Keep<'_>, &by_place, &none] {
            for query in Query::EVERY {
                let (after, within) = both(query, keep);
                assert_eq!(after, within, "{query}");
            }
        }
        let (without, with) = (both(Query::Any, &none).0, both(Query::Any, &|_: &Hit| true).0);
        assert_ne!(without, with, "the filter is asked");
    }
}
