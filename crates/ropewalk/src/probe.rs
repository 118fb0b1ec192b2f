//! What a walk may count on its way, at no cost when nobody asks.
//!
//! One convention for all structures, without which no two counts compare (ALGORITHMS: C9):
//! an *inner visit* tests the boxes (or planes) of one node's children; a *leaf visit* enters one leaf; a
//! *primitive test* tests one triangle; a list element counts as one inner visit or one primitive test.

use std::ops::AddAssign;

/// Is told what a walk does. Every method has an empty default, so a probe that ignores an event costs nothing:
/// walks are generic over the probe and the compiler removes the calls.
pub trait Probe {
    /// The boxes of a node's children are tested.
    #[inline(always)]
    fn inner_visit(&mut self) {}
    /// A leaf is entered.
    #[inline(always)]
    fn leaf_visit(&mut self) {}
    /// A primitive is tested.
    #[inline(always)]
    fn primitive_test(&mut self) {}
    /// A walk with a short stack or none goes back to the root.
    #[inline(always)]
    fn restart(&mut self) {}
    /// The stack holds this many entries after a push.
    #[inline(always)]
    fn stack_depth(&mut self, _entries: usize) {}
    /// The boxes of an object in its place are tested.
    #[inline(always)]
    fn object_tested(&mut self) {}
    /// The structure of an object is entered.
    #[inline(always)]
    fn object_entered(&mut self) {}
    /// The structure of an object is left again.
    #[inline(always)]
    fn object_left(&mut self) {}
    /// A smart stack held so many bytes at most, and handed so many entries to its slower memory.
    #[inline(always)]
    fn stack_bytes(&mut self, _most: u32, _swaps: u32) {}
}

/// The probe that counts nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProbe;
impl Probe for NoProbe {}

/// The probe that counts everything: six words, the same as a GPU walk writes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Counters {
    /// Nodes whose children's boxes were tested.
    pub inner_visits: u32,
    /// Leaves entered.
    pub leaf_visits: u32,
    /// Triangles tested.
    pub primitive_tests: u32,
    /// Restarts from the root.
    pub restarts: u32,
    /// The most entries that the stack held.
    pub stack_depth: u32,
    /// Object structures entered.
    pub objects_entered: u32,
}

impl Probe for Counters {
    #[inline(always)]
    fn inner_visit(&mut self) {
        self.inner_visits += 1;
    }
    #[inline(always)]
    fn leaf_visit(&mut self) {
        self.leaf_visits += 1;
    }
    #[inline(always)]
    fn primitive_test(&mut self) {
        self.primitive_tests += 1;
    }
    #[inline(always)]
    fn restart(&mut self) {
        self.restarts += 1;
    }
    #[inline(always)]
    fn stack_depth(&mut self, entries: usize) {
        self.stack_depth = self.stack_depth.max(entries as u32);
    }
    #[inline(always)]
    fn object_entered(&mut self) {
        self.objects_entered += 1;
    }
}

/// Sums of [`Counters`] over rays, in 64 bits; the stack depth is the largest of any ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CounterTotals {
    /// Rays counted.
    pub rays: u64,
    /// Nodes whose children's boxes were tested.
    pub inner_visits: u64,
    /// Leaves entered.
    pub leaf_visits: u64,
    /// Triangles tested.
    pub primitive_tests: u64,
    /// Restarts from the root.
    pub restarts: u64,
    /// The most entries that any ray's stack held.
    pub stack_depth: u32,
    /// Object structures entered.
    pub objects_entered: u64,
}

impl AddAssign<&Counters> for CounterTotals {
    fn add_assign(&mut self, counters: &Counters) {
        self.rays += 1;
        self.inner_visits += u64::from(counters.inner_visits);
        self.leaf_visits += u64::from(counters.leaf_visits);
        self.primitive_tests += u64::from(counters.primitive_tests);
        self.restarts += u64::from(counters.restarts);
        self.stack_depth = self.stack_depth.max(counters.stack_depth);
        self.objects_entered += u64::from(counters.objects_entered);
    }
}

impl<'a> FromIterator<&'a Counters> for CounterTotals {
    fn from_iter<T: IntoIterator<Item = &'a Counters>>(counters: T) -> Self {
        counters.into_iter().fold(Self::default(), |mut totals, one| {
            totals += one;
            totals
        })
    }
}
