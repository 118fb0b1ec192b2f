//! The knobs of the builder.

use super::MAX_DEPTH;
use crate::BuildError;

/// How deep a tree may be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Depth {
    /// `8 + 1.3 log2(n)` for `n` triangles (Wald and Havran 2006), [`MAX_DEPTH`] at most.
    #[default]
    Auto,
    /// A number, 1 to [`MAX_DEPTH`]. Reichl et al. 2010 have 20.
    Cap(u32),
}

impl Depth {
    /// The depth that no leaf over so many triangles exceeds.
    #[must_use]
    pub fn of(self, triangles: usize) -> u32 {
        match self {
            Self::Cap(depth) => depth,
            Self::Auto => (8.0 + 1.3 * (triangles.max(1) as f64).log2()).min(f64::from(MAX_DEPTH)) as u32,
        }
    }
}

/// The options of the builder of kd-trees.
///
/// ```
/// use ropewalk::KdOptions;
/// use ropewalk::kd_tree::Depth;
/// let of_the_paper = KdOptions { max_depth: Depth::Cap(20), ..KdOptions::default() };
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct KdOptions {
    /// The depth that no leaf exceeds.
    pub max_depth: Depth,
    /// What the plane of one node costs, 1 to 10,000.
    pub traversal_cost: u32,
    /// What the test of one triangle costs, 1 to 10,000, in the same unit.
    pub intersection_cost: u32,
    /// What a split that leaves one side empty is spared of its cost, in percent, 0 to 90.
    pub empty_bonus: u32,
    /// The most references in all leaves together, per triangle, 1 to 1000: a promise about memory.
    pub duplication: u32,
}

impl Default for KdOptions {
    /// Chosen by counting visits in the bunny, the kitchen, and two Sponzas. An intersection of 100 to 300 changes visits and
    /// tests by 5 percent at most, against each other; a bonus of 20 percent costs up to 15 percent more tests than one of 10, and
    /// one of 50 percent 15 percent more visits.
    fn default() -> Self {
        Self {
            max_depth: Depth::Auto,
            traversal_cost: 100,
            intersection_cost: 150,
            empty_bonus: 10,
            duplication: 32,
        }
    }
}

impl KdOptions {
    /// The most that a node or a triangle may be said to cost.
    pub const MAX_COST: u32 = 10_000;
    /// The largest bonus, in percent: with 100 every empty cut would be free.
    pub const MAX_EMPTY_BONUS: u32 = 90;
    /// The most references per triangle that may be allowed.
    pub const MAX_DUPLICATION: u32 = 1000;

    /// Whether every option is in its range.
    ///
    /// # Errors
    /// Names the first that is not.
    pub fn check(&self) -> Result<(), BuildError> {
        let range = |option, value: u32, smallest: u32, largest: u32| {
            if (smallest..=largest).contains(&value) {
                return Ok(());
            }
            let [value, smallest, largest] = [value, smallest, largest].map(|number| number as usize);
            Err(BuildError::Option { option, value, smallest, largest })
        };
        if let Depth::Cap(depth) = self.max_depth {
            range("max-depth", depth, 1, MAX_DEPTH)?;
        }
        range("traversal-cost", self.traversal_cost, 1, Self::MAX_COST)?;
        range("intersection-cost", self.intersection_cost, 1, Self::MAX_COST)?;
        range("empty-bonus", self.empty_bonus, 0, Self::MAX_EMPTY_BONUS)?;
        range("duplication", self.duplication, 1, Self::MAX_DUPLICATION)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_depth_grows_with_the_logarithm() {
        assert_eq!([0, 1, 2, 1024, 1 << 20].map(|count| Depth::Auto.of(count)), [8, 8, 9, 21, 34]);
        assert_eq!(Depth::Auto.of(usize::MAX), MAX_DEPTH);
        assert_eq!(Depth::Cap(20).of(5), 20);
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let plain = KdOptions::default();
        assert_eq!(plain.check(), Ok(()));
        for (name, wrong) in [
            ("max-depth", KdOptions { max_depth: Depth::Cap(0), ..plain }),
            ("max-depth", KdOptions { max_depth: Depth::Cap(61), ..plain }),
            ("traversal-cost", KdOptions { traversal_cost: 0, ..plain }),
            ("intersection-cost", KdOptions { intersection_cost: 10_001, ..plain }),
            ("empty-bonus", KdOptions { empty_bonus: 91, ..plain }),
            ("duplication", KdOptions { duplication: 0, ..plain }),
        ] {
            assert!(wrong.check().unwrap_err().to_string().starts_with(name), "{wrong:?}");
        }
    }
}
