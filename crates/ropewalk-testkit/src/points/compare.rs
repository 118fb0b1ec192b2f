//! Comparators of whole batches of point queries.

use super::PointOracle;
use rayon::prelude::*;
use ropewalk::{ClosestPoint, NearestLists, PointAnswers, PointQuery, Status};
use std::error::Error;
use std::fmt;

/// The first wrong answer.
#[derive(Clone, Debug, PartialEq)]
pub struct PointMismatch {
    /// The query's index and the query; none when the batch as a whole is wrong.
    pub query: Option<(usize, PointQuery)>,
    /// What is wrong.
    pub why: String,
}

impl fmt::Display for PointMismatch {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((index, PointQuery { point, radius, mask })) = self.query {
            // Shortest texts that read back to the same bits.
            write!(
                formatter,
                "query {index} (point {:?}, radius {radius:?}, mask {mask:#x}): ",
                point.to_array()
            )?;
        }
        formatter.write_str(&self.why)
    }
}

impl Error for PointMismatch {}

fn of_batch(why: impl Into<String>) -> PointMismatch {
    PointMismatch { query: None, why: why.into() }
}

/// Demands that the closest points of a batch are right in f64, and the status words too.
///
/// # Errors
/// Names the first query that is answered wrongly.
pub fn closest_against_oracle(
    oracle: &PointOracle,
    queries: &[PointQuery],
    given: &PointAnswers<Vec<ClosestPoint>>,
) -> Result<(), PointMismatch> {
    check_shape(queries, given, given.points.len())?;
    first_objection(queries, |index, query| oracle.closest_objection(query, &given.points[index]))
}

/// Demands that the `k` nearest triangles of a batch are right in f64, and the status words too.
///
/// # Errors
/// Names the first query that is answered wrongly.
pub fn nearest_against_oracle(
    oracle: &PointOracle,
    k: usize,
    queries: &[PointQuery],
    given: &PointAnswers<NearestLists>,
) -> Result<(), PointMismatch> {
    check_lists(queries, given)?;
    first_objection(queries, |index, query| oracle.nearest_objection(query, k, given.points.of(index)))
}

/// Demands that two batches of closest points are the same to the bit; the counters too where both have them and
/// `counters` is set.
///
/// # Errors
/// Names the first query whose words differ.
pub fn same_closest_points(
    queries: &[PointQuery],
    reference: &PointAnswers<Vec<ClosestPoint>>,
    given: &PointAnswers<Vec<ClosestPoint>>,
    counters: bool,
) -> Result<(), PointMismatch> {
    for answers in [reference, given] {
        check_shape(queries, answers, answers.points.len())?;
    }
    same(queries, reference, given, counters, |index| {
        (std::slice::from_ref(&reference.points[index]), std::slice::from_ref(&given.points[index]))
    })
}

/// Demands that two batches of nearest triangles are the same to the bit; the counters too where both have them and
/// `counters` is set.
///
/// # Errors
/// Names the first query whose words differ.
pub fn same_nearest_points(
    queries: &[PointQuery],
    reference: &PointAnswers<NearestLists>,
    given: &PointAnswers<NearestLists>,
    counters: bool,
) -> Result<(), PointMismatch> {
    for answers in [reference, given] {
        check_lists(queries, answers)?;
    }
    same(queries, reference, given, counters, |index| (reference.points.of(index), given.points.of(index)))
}

fn same<'a, A>(
    queries: &[PointQuery],
    reference: &PointAnswers<A>,
    given: &PointAnswers<A>,
    counters: bool,
    points: impl Fn(usize) -> (&'a [ClosestPoint], &'a [ClosestPoint]),
) -> Result<(), PointMismatch> {
    if counters && reference.counters.is_some() != given.counters.is_some() {
        return Err(of_batch("only one of them has counters"));
    }
    for (index, query) in queries.iter().enumerate() {
        let wrong = |why: String| Err(PointMismatch { query: Some((index, *query)), why });
        let (expected, found) = points(index);
        let words = |points: &[ClosestPoint]| points.iter().map(ClosestPoint::to_words).collect::<Vec<_>>();
        if words(expected) != words(found) {
            return wrong(format!("the answers differ: expected {expected:?}, given {found:?}"));
        }
        if reference.status[index] != given.status[index] {
            return wrong(format!(
                "the status is {:?}, not {:?}",
                given.status[index], reference.status[index]
            ));
        }
        if let (true, Some(expected), Some(found)) = (counters, &reference.counters, &given.counters)
            && expected[index] != found[index]
        {
            return wrong(format!("the counters are {:?}, not {:?}", found[index], expected[index]));
        }
    }
    Ok(())
}

fn first_objection(
    queries: &[PointQuery],
    objection: impl Fn(usize, &PointQuery) -> Option<String> + Sync,
) -> Result<(), PointMismatch> {
    let found = queries.par_iter().enumerate().with_min_len(16).find_map_first(|(index, query)| {
        objection(index, query).map(|why| PointMismatch { query: Some((index, *query)), why })
    });
    found.map_or(Ok(()), Err)
}

fn check_lists(queries: &[PointQuery], given: &PointAnswers<NearestLists>) -> Result<(), PointMismatch> {
    let NearestLists { offsets, points } = &given.points;
    check_shape(queries, given, offsets.len().wrapping_sub(1))?;
    let ends = (offsets.first().copied(), offsets.last().copied());
    let is_ordered = offsets.windows(2).all(|pair| pair[0] <= pair[1]);
    if is_ordered && ends == (Some(0), Some(points.len() as u64)) {
        return Ok(());
    }
    Err(of_batch("the offsets do not cut the answers into one list a query"))
}

fn check_shape<A>(
    queries: &[PointQuery],
    given: &PointAnswers<A>,
    answers: usize,
) -> Result<(), PointMismatch> {
    let counters = given.counters.as_ref().map_or(queries.len(), Vec::len);
    for (what, len) in [("answers", answers), ("status words", given.status.len()), ("counters", counters)] {
        if len != queries.len() {
            return Err(of_batch(format!("there are {len} {what} for {} queries", queries.len())));
        }
    }
    for (index, (query, &status)) in queries.iter().zip(&given.status).enumerate() {
        let expected = if query.is_valid() { Status::COMPLETE } else { Status::INVALID_RAY };
        if status != expected {
            let why = format!("the status is {status:?}, not {expected:?}");
            return Err(PointMismatch { query: Some((index, *query)), why });
        }
    }
    Ok(())
}
