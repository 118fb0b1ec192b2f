//! How many leaves a number of references makes: what a split is weighed by.
//!
//! A leaf is one test however full it is, so a side of a split costs its area times the leaves that it will make, and
//! splits that fill them win. It also says when the depth cap would be broken.

/// Counts leaves of at most `max_leaf` references.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaves {
    max_leaf: u32,
    /// 2^32 / `max_leaf`, rounded up.
    reciprocal: u64,
}

impl Leaves {
    pub(super) fn of_at_most(max_leaf: u32) -> Self {
        let max_leaf = max_leaf.max(1);
        Self { max_leaf, reciprocal: (1_u64 << 32).div_ceil(u64::from(max_leaf)) }
    }

    /// The leaves that `count` references fill, the last one perhaps not quite. Exact below 2^28.
    #[inline(always)]
    pub(super) fn of(&self, count: u32) -> f32 {
        (((u64::from(count) + u64::from(self.max_leaf) - 1) * self.reciprocal) >> 32) as u32 as f32
    }

    /// Whether so many references make a leaf.
    #[inline(always)]
    pub(super) fn is_one(&self, count: usize) -> bool {
        count <= self.max_leaf as usize
    }

    /// Whether two sides each fit under a node with `levels` levels below it.
    #[inline(always)]
    pub(super) fn fit(&self, counts: [u32; 2], levels: u32) -> bool {
        let room = u64::from(self.max_leaf) << levels.saturating_sub(1).min(32);
        counts.iter().all(|&count| u64::from(count) <= room)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_are_counted_as_by_a_division() {
        for max_leaf in 1..=8 {
            let leaves = Leaves::of_at_most(max_leaf);
            for count in (0..5000).chain((1 << 28) - 20..1 << 28) {
                assert_eq!(leaves.of(count), count.div_ceil(max_leaf) as f32, "{count} {max_leaf}");
            }
            assert!(leaves.is_one(max_leaf as usize) && !leaves.is_one(max_leaf as usize + 1));
        }
    }

    #[test]
    fn what_fits_under_the_cap_is_known() {
        let leaves = Leaves::of_at_most(4);
        assert!(leaves.fit([4, 4], 1) && !leaves.fit([4, 5], 1));
        assert!(leaves.fit([8, 8], 2) && !leaves.fit([9, 1], 2));
        assert!(leaves.fit([u32::MAX, u32::MAX], 64));
        assert!(!leaves.fit([5, 1], 0));
    }
}
