//! What is kept of many rounds: the median, and how far the others lie.

use serde::Serialize;

/// The median, the smallest and the largest of some numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// The middle one; of an even count the mean of the two middle ones.
    pub median: f64,
    /// The smallest.
    pub min: f64,
    /// The largest.
    pub max: f64,
}

impl Spread {
    /// The spread of some numbers; `None` when there are none.
    ///
    /// ```
    /// use ropewalk_lab::Spread;
    /// let spread = Spread::of(&[3.0, 1.0, 9.0]);
    /// assert_eq!(spread, Some(Spread { median: 3.0, min: 1.0, max: 9.0 }));
    /// ```
    #[must_use]
    pub fn of(numbers: &[f64]) -> Option<Self> {
        let mut sorted = numbers.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (min, max) = (*sorted.first()?, *sorted.last()?);
        let (low, high) = (sorted[(sorted.len() - 1) / 2], sorted[sorted.len() / 2]);
        Some(Self { median: low + (high - low) / 2.0, min, max })
    }

    /// The same in another unit; the smallest and the largest change places where `convert` falls.
    #[must_use]
    pub fn map(self, convert: impl Fn(f64) -> f64) -> Self {
        let (a, b) = (convert(self.min), convert(self.max));
        Self { median: convert(self.median), min: a.min(b), max: a.max(b) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(Spread::of(&[]), None);
        assert_eq!(Spread::of(&[4.0]), Some(Spread { median: 4.0, min: 4.0, max: 4.0 }));
        assert_eq!(Spread::of(&[4.0, 1.0]).unwrap().median, 2.5);
        assert_eq!(Spread::of(&[9.0, 1.0, 2.0, 3.0, 100.0]).unwrap().median, 3.0);
    }

    #[test]
    fn a_rate_is_fast_where_the_time_is_short() {
        let rate = Spread { median: 2.0, min: 1.0, max: 4.0 }.map(|seconds| 8.0 / seconds);
        assert_eq!(rate, Spread { median: 4.0, min: 2.0, max: 8.0 });
    }
}
