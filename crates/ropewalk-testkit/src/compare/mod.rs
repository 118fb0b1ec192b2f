//! Comparators of answers. Each says what it found, or names the first ray that is wrong and why.
//!
//! | function | compares | demands |
//! |---|---|---|
//! | [`same_bits`] | two tracers | every word equal: CPU walks with each other, CPU with software adapters |
//! | [`against_oracle`] | a tracer with f64 | a right answer within the bounds of [`crate::oracle`] |
//! | [`nearly`] | two tracers | equal ids, `t` within 1e-5; ties, edges and grazes aside: real GPUs |
//! | [`across_queries`] | one tracer with itself | closest, any, all and count say the same |
//! | [`fronts`] | triangles of one side with the same of two | what is left are the hits of fronts, to the bit |
//!
//! A comparator that never objects proves nothing, so each is fed every kind of wrong answer in its tests.

mod bits;
mod nearly;
mod queries;
mod sides;
mod truth;

#[cfg(test)]
mod tests;

pub use bits::same_bits;
pub use nearly::nearly;
pub use queries::across_queries;
pub use sides::fronts;
pub use truth::{against_oracle, objection};

use ropewalk::{Hit, Ray, Status, Traced};
use std::error::Error;
use std::fmt;

/// What a comparator that had nothing to object has seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Rays compared.
    pub rays: usize,
    /// Rays that hit something.
    pub hits: usize,
    /// Rays whose answer left no room: a wrong one could not have passed.
    pub clear: usize,
    /// Rays at ties, edges or grazes where the two answers differ and both are right.
    pub differing: usize,
}

/// The first wrong answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Mismatch {
    /// The ray's index and the ray; none when the batch as a whole is wrong.
    pub ray: Option<Box<(usize, Ray)>>,
    /// What was expected.
    pub expected: String,
    /// What was given.
    pub given: String,
    /// Why that is wrong.
    pub why: String,
}

impl fmt::Display for Mismatch {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((index, ray)) = self.ray.as_deref() {
            let Ray { origin, dir, t_min, t_max, mask } = ray;
            // Shortest texts that read back to the same bits.
            write!(formatter, "ray {index} (origin {:?}, dir {:?}, ", origin.to_array(), dir.to_array())?;
            write!(formatter, "t {t_min:?}..{t_max:?}, mask {mask:#x}): ")?;
        }
        write!(formatter, "{}; expected {}, given {}", self.why, self.expected, self.given)
    }
}

impl Error for Mismatch {}

impl Mismatch {
    fn of_batch(why: &str, expected: impl fmt::Debug, given: impl fmt::Debug) -> Self {
        let (expected, given) = (format!("{expected:?}"), format!("{given:?}"));
        Self { ray: None, expected, given, why: why.into() }
    }

    fn of_ray(
        (index, ray): (usize, &Ray),
        why: impl Into<String>,
        expected: impl fmt::Debug,
        given: impl fmt::Debug,
    ) -> Self {
        let (expected, given) = (format!("{expected:?}"), format!("{given:?}"));
        Self { ray: Some(Box::new((index, *ray))), expected, given, why: why.into() }
    }
}

/// Checks that a batch has an answer, a status and, where counted, counters for each ray, and that the lists of
/// an all-hits answer lie one after the other.
fn check_shape(rays: &[Ray], traced: &Traced) -> Result<(), Mismatch> {
    let expected = rays.len();
    let mut lens = vec![("answers", traced.answer.len()), ("status words", traced.status.len())];
    lens.extend(traced.counters.as_ref().map(|counters| ("counters", counters.len())));
    if let ropewalk::Answer::All(lists) = &traced.answer {
        lens.push(("offsets but one", lists.offsets.len().wrapping_sub(1)));
        let ordered = lists.offsets.windows(2).all(|pair| pair[0] <= pair[1]);
        let ends = (lists.offsets.first().copied(), lists.offsets.last().copied());
        if !ordered || ends != (Some(0), Some(lists.hits.len() as u64)) {
            return Err(Mismatch::of_batch(
                "the offsets do not cut the hits into one list a ray",
                (0, lists.hits.len()),
                ends,
            ));
        }
    }
    match lens.into_iter().find(|&(_, len)| len != expected) {
        None => Ok(()),
        Some((what, len)) => {
            Err(Mismatch::of_batch(&format!("the number of {what} is wrong"), expected, len))
        }
    }
}

/// Checks the status of one ray: complete, or not valid where the ray is not.
fn check_status(ray: (usize, &Ray), status: Status) -> Result<(), Mismatch> {
    let expected = if ray.1.is_valid() { Status::COMPLETE } else { Status::INVALID_RAY };
    if status == expected {
        return Ok(());
    }
    Err(Mismatch::of_ray(ray, "the status is wrong", expected, status))
}

/// Whether two hits are equal to the bit.
fn is_same(a: &Hit, b: &Hit) -> bool {
    a.to_words() == b.to_words()
}
