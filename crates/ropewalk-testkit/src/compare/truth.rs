//! A tracer against the oracle.
//!
//! There is no tolerance of taste here. A triangle that is certain to be hit must be found; one that is no
//! candidate must not be; a reported `t` lies between the bounds of its own triangle, and no certain triangle
//! lies wholly nearer. So at a tie any of the near-equal triangles may be the answer, but only one of them; and
//! among triangles with exactly the same vertices, whose `t` is the same to the bit, it is the one of smallest id.

use super::{Mismatch, Summary, check_shape, check_status, is_same};
use crate::oracle::{Candidate, Expectation};
use ropewalk::{Answer, Hit, Ray, Traced};

/// Demands that every answer is one that a right tracer in f32 may give.
///
/// # Errors
/// Names the first ray with a wrong answer.
pub fn against_oracle(expected: &Expectation, given: &Traced) -> Result<Summary, Mismatch> {
    check_shape(&expected.rays, given)?;
    let mut summary = Summary { rays: expected.rays.len(), ..Summary::default() };
    summary.hits = given.answer.rays_that_hit();
    for (ray, candidates) in expected.rays.iter().enumerate().zip(&expected.candidates) {
        check_status(ray, given.status[ray.0])?;
        if let Some(why) = objection(ray.1, candidates, &given.answer, ray.0) {
            let named: Vec<_> = candidates
                .iter()
                .take(4)
                .map(|candidate| (candidate.id, candidate.t, candidate.is_certain()))
                .collect();
            let count = format!("{} candidates (id, t, certain) {named:?}", candidates.len());
            let answer = describe(&given.answer, ray.0);
            return Err(Mismatch {
                ray: Some(Box::new((ray.0, *ray.1))),
                expected: count,
                given: answer,
                why,
            });
        }
        summary.clear += usize::from(is_clear(candidates, &given.answer));
    }
    Ok(summary)
}

/// What is wrong with the answer of the ray `index`, given its candidates.
#[must_use]
pub fn objection(ray: &Ray, candidates: &[Candidate], answer: &Answer, index: usize) -> Option<String> {
    match answer {
        Answer::Closest(hits) => closest(ray, candidates, &hits[index]),
        Answer::Any(hits) => any(candidates, hits[index]),
        Answer::Count(counts) => count(candidates, counts[index] as usize),
        Answer::All(lists) => all(ray, candidates, lists.of(index)),
    }
}

/// Whether only one answer would have been accepted, bounds of `t` aside.
pub(super) fn is_clear(candidates: &[Candidate], answer: &Answer) -> bool {
    match answer {
        Answer::Any(_) => candidates.is_empty() || candidates.iter().any(Candidate::is_certain),
        Answer::All(_) | Answer::Count(_) => candidates.iter().all(Candidate::is_certain),
        Answer::Closest(_) => {
            let limit = nearest_certain(candidates);
            // Copies of one triangle are told apart by their ids.
            let mut shapes = candidates.iter().filter(|other| other.t_low <= limit).map(|other| other.shape);
            let first = shapes.next();
            limit.is_finite() && shapes.all(|shape| Some(shape) == first) || candidates.is_empty()
        }
    }
}

fn describe(answer: &Answer, index: usize) -> String {
    match answer {
        Answer::Closest(hits) => format!("{:?}", hits[index]),
        Answer::Any(hits) => format!("{}", hits[index]),
        Answer::Count(counts) => format!("{}", counts[index]),
        Answer::All(lists) => format!("{:?}", lists.of(index)),
    }
}

/// Beyond this no closest hit may lie.
fn nearest_certain(candidates: &[Candidate]) -> f64 {
    candidates
        .iter()
        .filter(|candidate| candidate.is_certain())
        .map(|candidate| candidate.t_high)
        .fold(f64::INFINITY, f64::min)
}

fn closest(ray: &Ray, candidates: &[Candidate], hit: &Hit) -> Option<String> {
    if !hit.is_hit() {
        if !is_same(hit, &Hit::MISS) {
            return Some("this is a miss with fields that are left over".into());
        }
        let lost = candidates.iter().find(|candidate| candidate.is_certain())?;
        return Some(format!("the hit of {:?} at {:e} is lost", lost.id, lost.t));
    }
    let candidate = match known(ray, candidates, hit) {
        Ok(candidate) => candidate,
        Err(why) => return Some(why),
    };
    let limit = nearest_certain(candidates);
    if f64::from(hit.t) > limit {
        return Some(format!("there is a certain hit nearer, at most at {limit:e}"));
    }
    let twin = candidates.iter().find(|other| other.shape == candidate.shape && other.id < candidate.id)?;
    Some(format!("the same triangle with the smaller id {:?} goes first", twin.id))
}

/// The candidate of a hit, or what is wrong with the hit by itself.
fn known<'a>(ray: &Ray, candidates: &'a [Candidate], hit: &Hit) -> Result<&'a Candidate, String> {
    let Some(candidate) = candidates.iter().find(|candidate| candidate.id == hit.id()) else {
        return Err(format!("the ray does not meet the triangle {:?} in its window", hit.id()));
    };
    if !(hit.t >= ray.t_min && hit.t <= ray.t_max) {
        return Err(format!("t = {:e} is outside of the ray's window", hit.t));
    }
    candidate.objection(hit).map_or(Ok(candidate), Err)
}

fn any(candidates: &[Candidate], hit: bool) -> Option<String> {
    if hit {
        return candidates.is_empty().then(|| "the ray meets nothing in its window".into());
    }
    let lost = candidates.iter().find(|candidate| candidate.is_certain())?;
    Some(format!("the hit of {:?} at {:e} is lost", lost.id, lost.t))
}

fn count(candidates: &[Candidate], count: usize) -> Option<String> {
    let certain = candidates.iter().filter(|candidate| candidate.is_certain()).count();
    let right = certain..=candidates.len();
    (!right.contains(&count)).then(|| format!("the count must be in {right:?}"))
}

fn all(ray: &Ray, candidates: &[Candidate], hits: &[Hit]) -> Option<String> {
    for hit in hits {
        if let Err(why) = known(ray, candidates, hit) {
            return Some(why);
        }
    }
    for pair in hits.windows(2) {
        if !pair[0].precedes(&pair[1]) {
            return Some(if pair[0].id() == pair[1].id() {
                format!("{:?} is listed twice", pair[0].id())
            } else {
                format!("{:?} stands before {:?}", pair[0].id(), pair[1].id())
            });
        }
    }
    let is_listed = |candidate: &Candidate| hits.iter().any(|hit| hit.id() == candidate.id);
    let lost = candidates.iter().find(|candidate| candidate.is_certain() && !is_listed(candidate))?;
    Some(format!("the hit of {:?} at {:e} is not listed", lost.id, lost.t))
}
