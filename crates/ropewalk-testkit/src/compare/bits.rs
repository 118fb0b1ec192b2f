//! Equality to the bit.

use super::{Mismatch, Summary, check_shape, is_same};
use ropewalk::{Answer, Ray, Traced};

/// Demands that two tracers say the same to the bit: answers, status words, and the counters where both have them
/// and `counters` is set.
///
/// # Errors
/// Names the first ray whose words differ.
pub fn same_bits(
    rays: &[Ray],
    reference: &Traced,
    given: &Traced,
    counters: bool,
) -> Result<Summary, Mismatch> {
    check_shape(rays, reference)?;
    check_shape(rays, given)?;
    if reference.answer.query() != given.answer.query() {
        let (expected, given) = (reference.answer.query(), given.answer.query());
        return Err(Mismatch::of_batch("these are answers of different queries", expected, given));
    }
    for ray in rays.iter().enumerate() {
        let (expected, status) = (reference.status[ray.0], given.status[ray.0]);
        if expected != status {
            return Err(Mismatch::of_ray(ray, "the status words differ", expected, status));
        }
        same_answer(ray, &reference.answer, &given.answer)?;
        if let (true, Some(expected), Some(given)) = (counters, &reference.counters, &given.counters)
            && expected[ray.0] != given[ray.0]
        {
            return Err(Mismatch::of_ray(ray, "the counters differ", expected[ray.0], given[ray.0]));
        }
    }
    if counters && reference.counters.is_some() != given.counters.is_some() {
        let (expected, given) = (reference.counters.is_some(), given.counters.is_some());
        return Err(Mismatch::of_batch("only one of them has counters", expected, given));
    }
    let (rays, hits) = (rays.len(), given.answer.rays_that_hit());
    Ok(Summary { rays, hits, clear: rays, differing: 0 })
}

fn same_answer(ray: (usize, &Ray), reference: &Answer, given: &Answer) -> Result<(), Mismatch> {
    let index = ray.0;
    match (reference, given) {
        (Answer::Closest(a), Answer::Closest(b)) if !is_same(&a[index], &b[index]) => {
            Err(Mismatch::of_ray(ray, "the closest hits differ", a[index], b[index]))
        }
        (Answer::Any(a), Answer::Any(b)) if a[index] != b[index] => {
            Err(Mismatch::of_ray(ray, "only one of them hits anything", a[index], b[index]))
        }
        (Answer::Count(a), Answer::Count(b)) if a[index] != b[index] => {
            Err(Mismatch::of_ray(ray, "the counts differ", a[index], b[index]))
        }
        (Answer::All(a), Answer::All(b)) => {
            let (a, b) = (a.of(index), b.of(index));
            if a.len() != b.len() {
                return Err(Mismatch::of_ray(ray, "the lists differ in length", a, b));
            }
            match a.iter().zip(b).position(|(a, b)| !is_same(a, b)) {
                Some(place) => Err(Mismatch::of_ray(
                    ray,
                    format!("entry {place} of the lists differs"),
                    a[place],
                    b[place],
                )),
                None => Ok(()),
            }
        }
        _ => Ok(()),
    }
}
