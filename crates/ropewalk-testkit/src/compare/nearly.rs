//! Two tracers of which one runs on a real GPU, where a product and a sum may be fused and a division is not
//! rounded correctly.

use super::{Mismatch, Summary, check_shape, check_status, is_same, objection, truth};
use crate::oracle::Oracle;
use ropewalk::{Answer, Hit, Ray, Traced};

/// How far two values of `t` of the same triangle may lie apart, relative: what the project promises for GPUs.
const T_TOLERANCE: f32 = 1e-5;
/// How far two barycentrics of the same triangle may lie apart.
const BARYCENTRIC_TOLERANCE: f32 = 1e-4;

/// Demands equal ids, `t` within 1e-5 relative, barycentrics within 1e-4, and equal sides. Where two answers
/// differ by more, both must be right by the oracle, and the oracle must find the ray not clear-cut: a tie, an
/// edge or a graze; such rays are counted. The oracle is asked only there. Counters are not compared.
///
/// # Errors
/// Names the first ray with answers that differ for no such reason.
pub fn nearly(
    oracle: &Oracle,
    rays: &[Ray],
    reference: &Traced,
    given: &Traced,
) -> Result<Summary, Mismatch> {
    check_shape(rays, reference)?;
    check_shape(rays, given)?;
    if reference.answer.query() != given.answer.query() {
        let (expected, given) = (reference.answer.query(), given.answer.query());
        return Err(Mismatch::of_batch("these are answers of different queries", expected, given));
    }
    let mut summary =
        Summary { rays: rays.len(), hits: given.answer.rays_that_hit(), clear: rays.len(), differing: 0 };
    for ray in rays.iter().enumerate() {
        check_status(ray, given.status[ray.0])?;
        let Some((why, expected, answer)) = difference(ray.0, &reference.answer, &given.answer) else {
            continue;
        };
        let wrong = |why: String| Mismatch {
            ray: Some(Box::new((ray.0, *ray.1))),
            expected: expected.clone(),
            given: answer.clone(),
            why,
        };
        let candidates = oracle.candidates(ray.1);
        if let Some(objection) = objection(ray.1, &candidates, &given.answer, ray.0) {
            return Err(wrong(format!("{why}, and {objection}")));
        }
        if let Some(objection) = objection(ray.1, &candidates, &reference.answer, ray.0) {
            return Err(wrong(format!("{why}, and the reference is wrong: {objection}")));
        }
        let same_list = matches!(given.answer, Answer::Closest(_) | Answer::All(_));
        if !same_list && truth::is_clear(&candidates, &given.answer) {
            return Err(wrong(format!("{why}, although the case is clear")));
        }
        summary.differing += 1;
        summary.clear -= 1;
    }
    Ok(summary)
}

/// What differs between the answers of a ray by more than the tolerance, and both in words.
fn difference(index: usize, reference: &Answer, given: &Answer) -> Option<(String, String, String)> {
    let say = |why: &str, a: &dyn std::fmt::Debug, b: &dyn std::fmt::Debug| {
        Some((why.to_owned(), format!("{a:?}"), format!("{b:?}")))
    };
    match (reference, given) {
        (Answer::Closest(a), Answer::Closest(b)) => {
            let (a, b) = (a.get(index)?, b.get(index)?);
            hit_difference(a, b).and_then(|why| say(why, a, b))
        }
        (Answer::Any(a), Answer::Any(b)) if a[index] != b[index] => {
            say("only one of them hits anything", &a[index], &b[index])
        }
        (Answer::Count(a), Answer::Count(b)) if a[index] != b[index] => {
            say("the counts differ", &a[index], &b[index])
        }
        (Answer::All(a), Answer::All(b)) => {
            let (a, b) = (a.of(index), b.of(index));
            let why = match a.iter().zip(b).find_map(|(a, b)| hit_difference(a, b)) {
                Some(why) => why,
                None if a.len() != b.len() => "the lists differ in length",
                None => return None,
            };
            say(why, &a, &b)
        }
        _ => None,
    }
}

fn hit_difference(a: &Hit, b: &Hit) -> Option<&'static str> {
    if is_same(a, b) {
        return None;
    }
    if a.is_hit() != b.is_hit() {
        return Some("only one of them hits");
    }
    if a.id() != b.id() {
        return Some("the triangles differ");
    }
    if !a.is_hit() {
        return Some("these are misses with different fields");
    }
    // Written so that a NaN differs from everything, and infinity from every number.
    let near = a.t == b.t || (b.t.is_finite() && (a.t - b.t).abs() <= T_TOLERANCE * a.t.abs().max(b.t.abs()));
    let beside = (a.barycentrics - b.barycentrics).abs().max_element() <= BARYCENTRIC_TOLERANCE
        && b.barycentrics.is_finite();
    match (near, beside, a.front_face == b.front_face) {
        (false, _, _) => Some("t differs by more than 1e-5"),
        (_, false, _) => Some("the barycentrics differ by more than 1e-4"),
        (_, _, false) => Some("the sides differ"),
        _ => None,
    }
}
