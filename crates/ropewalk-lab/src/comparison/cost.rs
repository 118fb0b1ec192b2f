//! What a walk costs, by itself and over the full stack's.

use super::ComparisonError;
use crate::Spread;
use crate::bench::{Progress, Watch};
use ropewalk::{CounterTotals, Walk};
use ropewalk_gpu::GpuError;
use std::time::Instant;

/// Counts of a walk, each a mean over what was asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Means {
    pub(crate) inner_visits: f64,
    pub(crate) leaf_visits: f64,
    pub(crate) primitive_tests: f64,
    pub(crate) restarts: f64,
    /// Inner visits, over those of the full stack.
    pub(crate) ratio_inner: f64,
}

impl Means {
    /// Of a batch of `asked` rays or points.
    pub(crate) fn new(asked: usize, totals: &CounterTotals, full: &CounterTotals) -> Self {
        let mean = |sum: u64| sum as f64 / asked as f64;
        // A tree of one leaf has no inner visit, with any stack.
        let ratio_inner =
            if full.inner_visits == 0 { 1.0 } else { totals.inner_visits as f64 / full.inner_visits as f64 };
        Self {
            inner_visits: mean(totals.inner_visits),
            leaf_visits: mean(totals.leaf_visits),
            primitive_tests: mean(totals.primitive_tests),
            restarts: mean(totals.restarts),
            ratio_inner,
        }
    }
}

/// How fast a walk is; nothing where no round was timed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rates {
    /// Answers a second: the median of the rounds.
    pub(crate) per_second: Option<f64>,
    /// The time, over that of the full stack in the same round.
    pub(crate) ratio_time: Option<Spread>,
}

impl Rates {
    /// From the seconds of each round for `asked` rays or points.
    pub(crate) fn new(asked: usize, times: &[f64], full_times: &[f64]) -> Self {
        let ratios: Vec<f64> = times.iter().zip(full_times).map(|(time, full)| time / full).collect();
        Self {
            per_second: Spread::of(times).map(|seconds| asked as f64 / seconds.median),
            ratio_time: Spread::of(&ratios),
        }
    }
}

/// The seconds of each walk in each round. Each round has every walk once, so that a machine that slows down slows all
/// of them alike.
pub(crate) fn time(
    walks: &[Walk],
    rounds: usize,
    what: &str,
    watch: &Watch<'_>,
    run: impl Fn(Walk) -> Result<(), GpuError>,
) -> Result<Vec<Vec<f64>>, ComparisonError> {
    let mut times = vec![Vec::with_capacity(rounds); walks.len()];
    for round in 0..rounds {
        if watch(Progress { what, done: round, total: rounds }).is_break() {
            return Err(ComparisonError::Stopped);
        }
        for (&walk, times) in walks.iter().zip(&mut times) {
            let start = Instant::now();
            run(walk)?;
            times.push(start.elapsed().as_secs_f64());
        }
    }
    Ok(times)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;
    use std::ops::ControlFlow;

    #[test]
    fn means_are_over_what_was_asked_and_ratios_over_the_full_stack() {
        let full = CounterTotals { rays: 4, inner_visits: 20, ..CounterTotals::default() };
        let totals = CounterTotals { inner_visits: 30, leaf_visits: 8, restarts: 2, ..full };
        let means = Means::new(4, &totals, &full);
        assert_eq!((means.inner_visits, means.leaf_visits, means.restarts), (7.5, 2.0, 0.5));
        assert_eq!(means.ratio_inner, 1.5);
        let leaf = CounterTotals::default();
        assert_eq!(Means::new(4, &leaf, &leaf).ratio_inner, 1.0);
    }

    #[test]
    fn rates_are_medians_and_their_ratios_are_of_the_same_round() {
        let rates = Rates::new(10, &[2.0, 8.0, 5.0], &[1.0, 8.0, 2.0]);
        assert_eq!(rates.per_second, Some(2.0));
        assert_eq!(rates.ratio_time, Some(Spread { median: 2.0, min: 1.0, max: 2.5 }));
        assert_eq!(Rates::new(10, &[], &[]), Rates { per_second: None, ratio_time: None });
    }

    #[test]
    fn a_round_has_every_walk_once() {
        let walks = [Walk::BruteForce, Walk::Recursive];
        let seen = RefCell::new(Vec::new());
        let run = |walk| {
            seen.borrow_mut().push(walk);
            Ok(())
        };
        let times = time(&walks, 3, "", &|_| ControlFlow::Continue(()), run).unwrap();
        assert_eq!(times.iter().map(Vec::len).collect::<Vec<_>>(), [3, 3]);
        assert_eq!(seen.borrow().as_slice(), walks.repeat(3));
        let stopped = time(&walks, 3, "", &|_| ControlFlow::Break(()), run);
        assert!(matches!(stopped, Err(ComparisonError::Stopped)));
    }
}
