//! Triangles of one side against the same triangles of two sides.
//!
//! To give triangles one side takes hits away, and changes none: what is hit of one side is hit of two, with the same words,
//! and lost are the hits of backs alone. So a ray whose first hit of two sides is a front has that very hit of one side; one
//! that misses both sides misses one; and no hit of one side comes before the first of two. Where f32 may not tell which side
//! is met, a front may be lost as well.

use super::{Mismatch, Summary, check_shape, is_same};
use crate::oracle::{Candidate, Expectation};
use ropewalk::{Answer, Hit, Ray, Traced};

/// Demands that `front`, the answers of triangles of one side, are those of `both`, the same triangles with two sides, less
/// the hits of backs. `expected` is what the oracle says of two sides.
///
/// # Errors
/// Names the first ray of which that is not true.
pub fn fronts(expected: &Expectation, both: &Traced, front: &Traced) -> Result<Summary, Mismatch> {
    let rays = &expected.rays;
    check_shape(rays, both)?;
    check_shape(rays, front)?;
    if both.answer.query() != front.answer.query() {
        let (expected, given) = (both.answer.query(), front.answer.query());
        return Err(Mismatch::of_batch("these are answers of different queries", expected, given));
    }
    let mut summary = Summary { rays: rays.len(), hits: front.answer.rays_that_hit(), ..Summary::default() };
    for (ray, candidates) in rays.iter().enumerate().zip(&expected.candidates) {
        // A ray that surely sees each side that it meets leaves no choice.
        summary.clear += usize::from(candidates.iter().all(|candidate| candidate.facing_margin.abs() > 1.0));
        compare(ray, candidates, &both.answer, &front.answer)?;
    }
    Ok(summary)
}

fn compare(
    ray: (usize, &Ray),
    candidates: &[Candidate],
    both: &Answer,
    front: &Answer,
) -> Result<(), Mismatch> {
    let index = ray.0;
    let sure = |hit: &Hit| {
        let of_hit = candidates.iter().find(|candidate| candidate.id == hit.id());
        hit.front_face && of_hit.is_some_and(|candidate| candidate.facing_margin > 1.0)
    };
    match (both, front) {
        (Answer::Closest(both), Answer::Closest(front)) => {
            let (both, front) = (both[index], front[index]);
            let wrong = |why: &str| Err(Mismatch::of_ray(ray, why, both, front));
            if front.is_hit() && !front.front_face {
                wrong("a back is the closest hit of triangles of one side")
            } else if sure(&both) && !is_same(&both, &front) {
                wrong("a ray that sees a front first has another hit of one side")
            } else if !both.is_hit() && !is_same(&both, &front) {
                wrong("a ray that misses both sides hits one")
            } else if front.precedes(&both) || front.id() == both.id() && !is_same(&both, &front) {
                wrong("the closest hit of one side comes before that of two")
            } else {
                Ok(())
            }
        }
        (Answer::Any(both), Answer::Any(front)) if front[index] && !both[index] => {
            Err(Mismatch::of_ray(ray, "a ray that misses both sides hits one", both[index], front[index]))
        }
        (Answer::Count(both), Answer::Count(front)) if front[index] > both[index] => {
            Err(Mismatch::of_ray(ray, "one side has more hits than two", both[index], front[index]))
        }
        (Answer::All(both), Answer::All(front)) => {
            let (both, front) = (both.of(index), front.of(index));
            let is_in = |hit: &Hit, list: &[Hit]| list.iter().any(|other| is_same(hit, other));
            if let Some(extra) = front.iter().find(|hit| !hit.front_face || !is_in(hit, both)) {
                return Err(Mismatch::of_ray(ray, "this hit is not of a front of both sides", both, extra));
            }
            match both.iter().find(|hit| sure(hit) && !is_in(hit, front)) {
                Some(lost) => {
                    Err(Mismatch::of_ray(ray, "one side lacks the hit of a front that two have", lost, front))
                }
                None => Ok(()),
            }
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::Case;
    use crate::oracle::Oracle;
    use ropewalk::{HitLists, PreparedRay, Query, Status};

    /// By testing every triangle, of one side or of two.
    fn by_force(case: &Case, query: Query, one_sided: bool) -> Traced {
        let triangles = case.scene.flatten().unwrap().triangles;
        let (mut lists, mut status) = (HitLists { offsets: vec![0], hits: vec![] }, vec![]);
        for ray in &case.rays {
            let prepared = PreparedRay::new(ray);
            status.push(if prepared.is_some() { Status::COMPLETE } else { Status::INVALID_RAY });
            let hit = |triangle: &ropewalk::FlatTriangle| {
                let ray = prepared.as_ref()?;
                if one_sided {
                    triangle.intersect_front(ray, ray.t_max)
                } else {
                    triangle.intersect(ray, ray.t_max)
                }
            };
            let first = lists.hits.len();
            lists.hits.extend(triangles.iter().filter_map(hit));
            lists.hits[first..].sort_by(|a, b| a.t.total_cmp(&b.t).then(a.id().cmp(&b.id())));
            lists.offsets.push(lists.hits.len() as u64);
        }
        let each = || (0..case.rays.len()).map(|ray| lists.of(ray));
        let answer = match query {
            Query::Closest => {
                Answer::Closest(each().map(|hits| hits.first().copied().unwrap_or(Hit::MISS)).collect())
            }
            Query::Any => Answer::Any(each().map(|hits| !hits.is_empty()).collect()),
            Query::Count => Answer::Count(each().map(|hits| hits.len() as u32).collect()),
            Query::All => Answer::All(lists),
        };
        Traced { answer, status, counters: None }
    }

    fn expectation(case: &Case) -> Expectation {
        Oracle::of_scene(&case.scene).unwrap().expect(case.rays.clone())
    }

    /// One side against two, and against the oracle of one side.
    fn judge(expected: &Expectation, both: &Traced, front: &Traced) -> [bool; 2] {
        let truth = super::super::against_oracle(&expected.one_sided(), front);
        [fronts(expected, both, front).is_ok(), truth.is_ok()]
    }

    #[test]
    fn one_side_passes_and_is_clear_but_for_grazes() {
        for name in ["soup", "sphere", "placed", "boxes", "duplicates", "needles"] {
            let case = Case::named(name).unwrap();
            let expected = expectation(&case);
            for query in Query::EVERY {
                let (both, front) = (by_force(&case, query, false), by_force(&case, query, true));
                let summary = fronts(&expected, &both, &front).unwrap_or_else(|it| panic!("{name}: {it}"));
                assert!(summary.clear * 3 > summary.rays, "{name}: {summary:?}");
                let truth = super::super::against_oracle(&expected.one_sided(), &front);
                let truth = truth.unwrap_or_else(|it| panic!("{name}: {it}"));
                assert!(truth.hits < both.answer.rays_that_hit() && truth.hits > 200, "{name}: {truth:?}");
            }
        }
    }

    /// What has two sides is no answer of one.
    #[test]
    fn backs_are_objected_to() {
        let case = Case::named("soup").unwrap();
        let expected = expectation(&case);
        for query in Query::EVERY {
            let both = by_force(&case, query, false);
            let [against_two, against_the_oracle] = judge(&expected, &both, &both);
            assert!(!against_the_oracle, "{query}");
            let shows_its_sides = matches!(query, Query::Closest | Query::All);
            assert_eq!(against_two, !shows_its_sides, "{query}");
        }
        // One back alone, in place of the right answer.
        let (Answer::Closest(both), mut front) =
            (by_force(&case, Query::Closest, false).answer, by_force(&case, Query::Closest, true))
        else {
            panic!()
        };
        let Answer::Closest(hits) = &mut front.answer else { panic!() };
        let back = both.iter().position(|hit| hit.is_hit() && !hit.front_face).unwrap();
        hits[back] = both[back];
        let both = by_force(&case, Query::Closest, false);
        assert_eq!(judge(&expected, &both, &front), [false, false]);
    }

    #[test]
    fn fronts_that_are_missing_are_objected_to() {
        let case = Case::named("soup").unwrap();
        let expected = expectation(&case);
        for query in Query::EVERY {
            let (both, mut front) = (by_force(&case, query, false), by_force(&case, query, true));
            assert_eq!(judge(&expected, &both, &front), [true, true]);
            let first_front = |hits: &[Hit]| hits.iter().position(Hit::is_hit).unwrap();
            match &mut front.answer {
                Answer::Closest(hits) => {
                    let Answer::Closest(both) = &both.answer else { panic!() };
                    let seen = both.iter().position(|hit| hit.front_face).unwrap();
                    hits[seen] = Hit::MISS;
                }
                Answer::Any(hits) => *hits.iter_mut().find(|hit| **hit).unwrap() = false,
                Answer::Count(counts) => *counts.iter_mut().find(|count| **count > 0).unwrap() -= 1,
                Answer::All(lists) => {
                    let place = first_front(&lists.hits);
                    lists.hits.remove(place);
                    lists.offsets.iter_mut().filter(|end| **end > place as u64).for_each(|end| *end -= 1);
                }
            }
            let [against_two, against_the_oracle] = judge(&expected, &both, &front);
            assert!(!against_the_oracle, "{query}");
            assert_eq!(against_two, matches!(query, Query::Any | Query::Count), "{query}");
        }
    }

    /// Too much of one side, and another word of the same hit.
    #[test]
    fn one_side_is_a_part_of_two_to_the_bit() {
        let case = Case::named("soup").unwrap();
        let expected = expectation(&case);
        for query in Query::EVERY {
            let (both, mut front) = (by_force(&case, query, false), by_force(&case, query, true));
            match &mut front.answer {
                Answer::Closest(hits) => {
                    let place = hits.iter().position(Hit::is_hit).unwrap();
                    hits[place].t = hits[place].t.next_up();
                }
                Answer::Any(hits) => hits.iter_mut().for_each(|hit| *hit = true),
                Answer::Count(counts) => counts.iter_mut().for_each(|count| *count += 40),
                Answer::All(lists) => lists.hits[0].t = lists.hits[0].t.next_up(),
            }
            assert!(fronts(&expected, &both, &front).is_err(), "{query}");
        }
        let (closest, any) = (by_force(&case, Query::Closest, true), by_force(&case, Query::Any, true));
        assert!(fronts(&expected, &closest, &any).is_err());
    }
}
