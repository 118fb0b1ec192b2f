//! One tracer against itself: what its answers to the four queries say of each other.

use super::{Mismatch, Summary, check_shape, is_same};
use ropewalk::{Answer, Hit, Query, Ray, Traced};

/// Demands that the answers to different queries agree to the bit: the closest hit is the first of all hits,
/// there is any hit when there is one, and the count is the length of the list. Each query is given at most once;
/// what is not given is not compared.
///
/// # Errors
/// Names the first ray whose answers contradict each other.
pub fn across_queries(rays: &[Ray], traced: &[&Traced]) -> Result<Summary, Mismatch> {
    let mut summary = Summary { rays: rays.len(), clear: rays.len(), ..Summary::default() };
    for one in traced {
        check_shape(rays, one)?;
        summary.hits = summary.hits.max(one.answer.rays_that_hit());
    }
    let of = |query: Query| traced.iter().map(|traced| &traced.answer).find(|answer| answer.query() == query);
    for ray in rays.iter().enumerate() {
        let index = ray.0;
        let closest = of(Query::Closest).and_then(|answer| match answer {
            Answer::Closest(hits) => Some(hits[index]),
            _ => None,
        });
        let all = of(Query::All).and_then(|answer| match answer {
            Answer::All(lists) => Some(lists.of(index)),
            _ => None,
        });
        let any = of(Query::Any).and_then(|answer| match answer {
            Answer::Any(hits) => Some(hits[index]),
            _ => None,
        });
        let count = of(Query::Count).and_then(|answer| match answer {
            Answer::Count(counts) => Some(counts[index] as usize),
            _ => None,
        });
        if let (Some(closest), Some(all)) = (closest, all) {
            let first = all.first().copied().unwrap_or(Hit::MISS);
            if !is_same(&closest, &first) {
                return Err(Mismatch::of_ray(ray, "the closest hit is not the first of all", first, closest));
            }
        }
        if let (Some(all), Some(count)) = (all, count)
            && all.len() != count
        {
            return Err(Mismatch::of_ray(ray, "the count is not the number of all hits", all.len(), count));
        }
        let hits = [closest.map(|hit| hit.is_hit()), all.map(|all| !all.is_empty()), count.map(|n| n > 0)];
        for hit in hits.into_iter().flatten() {
            if let Some(any) = any
                && any != hit
            {
                return Err(Mismatch::of_ray(ray, "any hit and the other queries disagree", hit, any));
            }
        }
        if let (Some(closest), Some(count)) = (closest, count)
            && closest.is_hit() != (count > 0)
        {
            return Err(Mismatch::of_ray(ray, "the closest hit and the count disagree", count, closest));
        }
    }
    Ok(summary)
}
