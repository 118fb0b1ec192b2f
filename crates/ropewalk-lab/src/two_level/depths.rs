//! What is kept of a number that every ray has: average, maximum, variance.

use serde::Serialize;

/// The average, the largest and the variance of some numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Depths {
    /// The mean.
    pub avg: f64,
    /// The largest.
    pub max: u32,
    /// The mean square of the differences from the mean: of all rays, not of a sample of them.
    pub var: f64,
}

impl Depths {
    /// Of some numbers; zeros when there are none.
    #[must_use]
    pub fn of(numbers: impl Iterator<Item = u32>) -> Self {
        // Sums of integers are exact: 2^32 rays of squares up to 2^32 would be needed to overflow.
        let (mut count, mut sum, mut squares, mut max) = (0_u64, 0_u64, 0_u128, 0);
        for number in numbers {
            count += 1;
            sum += u64::from(number);
            squares += u128::from(number) * u128::from(number);
            max = max.max(number);
        }
        if count == 0 {
            return Self::default();
        }
        let avg = sum as f64 / count as f64;
        let var = (squares as f64 / count as f64 - avg * avg).max(0.0);
        Self { avg, max, var }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_row_has_its_statistics() {
        let depths = Depths::of([2, 4, 4, 4, 5, 5, 7, 9].into_iter());
        assert_eq!(depths, Depths { avg: 5.0, max: 9, var: 4.0 });
        assert_eq!(Depths::of([3; 10].into_iter()), Depths { avg: 3.0, max: 3, var: 0.0 });
        assert_eq!(Depths::of(std::iter::empty()), Depths::default());
    }
}
