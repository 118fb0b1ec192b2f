//! The part of the counters that walks are compared by.

use ropewalk::Counters;

/// Inner visits, leaf visits, primitive tests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Work(pub(super) [u64; 3]);

impl Work {
    pub(super) fn of(counters: &Counters) -> Self {
        Self([counters.inner_visits, counters.leaf_visits, counters.primitive_tests].map(u64::from))
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self([0, 1, 2].map(|place| self.0[place] + other.0[place]))
    }
}

/// Whether two walks did the same work for every ray, the depth of their stacks aside.
pub(super) fn is_same_work(a: &[Counters], b: &[Counters]) -> bool {
    a.iter().map(Work::of).eq(b.iter().map(Work::of))
}
