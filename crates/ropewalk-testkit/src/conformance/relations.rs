//! What must hold between the walks of one tree, for each ray.
//!
//! **Stacks** (ALGORITHMS B1 to B6). Recursion does the work of the unordered stack; culling, sorting and ordering
//! never do more than the unordered stack; all hits and count do exactly its work, since nothing is culled; before the
//! first hit culling changes nothing, so any hit is the same with it. Summed over a class of rays sorting does no more
//! than culling alone, and ordering no more than sorting, up to the few rays that an order misleads. Skip pointers lead to
//! what the unordered stack visits, in another order. A wide tree is walked in one order only, and so is a list: the work of
//! all its hits takes the place of the unordered stack's. Of two levels, one loop does the work of two, one in the other.
//!
//! **Restart trails** (ALGORITHMS L2 to L6, C2), against the ordered stack and the same query. They enter the same
//! leaves and test the same triangles, whatever the short stack; their stack holds what the full one holds, up to its
//! size; without a restart, and so wherever the full stack never held more than the short one can, they visit the same
//! inner nodes, else at least those. Summed over a class of rays a longer short stack never visits more. Registers and
//! memories change nothing at all.

use super::work::Work;
use crate::cases::Case;
use ropewalk::bvh::StackOrder;
use ropewalk::catalogue::{Row, TrailOptions};
use ropewalk::{Counters, Query, StructureKind, Traced, Walk};

/// The rows of one structure that were traced, and what is wrong with them.
struct Runs<'a> {
    case: &'a Case,
    runs: &'a [(usize, Row, &'a Traced)],
    wrong: Vec<(usize, String)>,
}

/// A row and its counters.
type Counted<'a> = Option<(usize, &'a [Counters])>;

/// Checks what must hold between the walks of one tree. Each entry of `runs` is a row, its index, and its counted
/// answers; gives back the index and what is wrong.
#[must_use]
pub fn relations(kind: StructureKind, case: &Case, runs: &[(usize, Row, &Traced)]) -> Vec<(usize, String)> {
    let mut runs = Runs { case, runs, wrong: Vec::new() };
    match kind {
        StructureKind::Bvh => {
            runs.stacks();
            runs.in_one_order(Walk::List);
        }
        // Of a packed tree each query has an order of its own.
        StructureKind::Bvh8 => {}
        StructureKind::WideBvh | StructureKind::Instanced => runs.in_one_order(ORDERED),
        StructureKind::List => runs.in_one_order(Walk::List),
        StructureKind::KdTree => runs.in_one_order(ORDERED),
        StructureKind::TwoLevel => {
            runs.in_one_order(ORDERED);
            runs.smart_stacks();
        }
    }
    for query in Query::EVERY {
        runs.trails(query);
    }
    runs.wrong
}

const ORDERED: Walk = Walk::Stack(StackOrder::Ordered);

impl<'a> Runs<'a> {
    fn of(&self, walk: Walk, query: Query) -> Counted<'a> {
        let run = self.runs.iter().find(|(_, row, _)| row.walk == walk && row.query == query)?;
        Some((run.0, run.2.counters.as_ref()?.as_slice()))
    }

    /// Demands something of the counters of each ray; nothing where one of both is not there.
    fn demand(
        &mut self,
        given: Counted<'_>,
        than: Counted<'_>,
        holds: impl Fn(&Counters, &Counters) -> bool,
        what: &str,
    ) {
        let (Some((row, given)), Some((_, than))) = (given, than) else { return };
        if let Some(index) = given.iter().zip(than).position(|(given, than)| !holds(given, than)) {
            let (given, than) = (given[index], than[index]);
            self.wrong.push((row, format!("ray {index}: {what}: {given:?}, the other {than:?}")));
        }
    }

    fn stacks(&mut self) {
        let stack = Walk::Stack;
        let plain = self.of(stack(StackOrder::Unordered), Query::Closest);
        let recursive = self.of(Walk::Recursive, Query::Closest);
        self.demand(recursive, plain, is_equal, "recursion does the work of the unordered stack");
        for order in [StackOrder::Culled, StackOrder::Sorted, StackOrder::Ordered] {
            let given = self.of(stack(order), Query::Closest);
            self.demand(given, plain, is_no_more, "culling does more than the unordered stack");
        }
        let skipping = self.of(Walk::List, Query::Closest);
        self.demand(skipping, plain, is_no_more, "skip pointers do more than the unordered stack");
        for walk in [StackOrder::Unordered, StackOrder::Culled, StackOrder::Sorted, StackOrder::Ordered]
            .map(stack)
            .into_iter()
            .chain([Walk::Recursive, Walk::List])
        {
            self.against_whole(walk, plain);
        }
        let any = self.of(stack(StackOrder::Unordered), Query::Any);
        let culled = self.of(stack(StackOrder::Culled), Query::Any);
        self.demand(culled, any, is_equal, "culling changed a search for any hit");
        for (better, worse) in
            [(StackOrder::Sorted, StackOrder::Culled), (StackOrder::Ordered, StackOrder::Sorted)]
        {
            let (better, worse) =
                (self.of(stack(better), Query::Closest), self.of(stack(worse), Query::Closest));
            // An order can mislead single rays: a tenth, and four visits a ray on trees of few nodes.
            let allowed = |worse: u64, rays: usize| worse + worse / 10 + 4 * rays as u64;
            self.demand_of_classes(better, worse, "less order", allowed);
        }
    }

    /// What the queries of a walk do of which there is one order only.
    fn in_one_order(&mut self, walk: Walk) {
        let whole = self.of(walk, Query::All);
        let closest = self.of(walk, Query::Closest);
        self.demand(closest, whole, is_no_more, "culling does more than the search for all hits");
        self.against_whole(walk, whole);
    }

    /// What the other queries do, compared with a walk that culls nothing.
    fn against_whole(&mut self, walk: Walk, whole: Counted<'_>) {
        for (query, holds, what) in [
            (Query::Any, is_no_more as Rule, "any hit does more than the whole unordered walk"),
            (Query::All, is_equal, "all hits does other work than the unordered walk"),
            (Query::Count, is_equal, "count does other work than the unordered walk"),
        ] {
            let given = self.of(walk, query);
            self.demand(given, whole, holds, what);
        }
    }

    /// One loop with one ring for both levels does what two loops with two stacks do, whatever the ring holds.
    fn smart_stacks(&mut self) {
        let smart: Vec<(Walk, Query)> = self.runs.iter().map(|(_, row, _)| (row.walk, row.query)).collect();
        for (walk, query) in smart.into_iter().filter(|(walk, _)| matches!(walk, Walk::SmartStack { .. })) {
            let (given, full) = (self.of(walk, query), self.of(ORDERED, query));
            self.demand(given, full, |a, b| a == b, "one loop does other work than one loop in the other");
        }
    }

    fn trails(&mut self, query: Query) {
        let mut trails: Vec<(TrailOptions, Counted<'a>)> = self
            .runs
            .iter()
            .filter_map(|(_, row, _)| match row.walk {
                Walk::RestartTrail(options) if row.query == query => {
                    Some((options, self.of(row.walk, query)))
                }
                _ => None,
            })
            .collect();
        let full = self.of(ORDERED, query);
        for &(TrailOptions { short_stack, .. }, given) in &trails {
            self.demand(given, full, has_same_leaves, "the trail enters other leaves than the ordered stack");
            self.demand(
                given,
                full,
                |given, full| given.stack_depth == full.stack_depth.min(short_stack),
                "the short stack holds other than the youngest entries of the full one",
            );
            self.demand(
                given,
                full,
                |given, full| given.restarts == 0 || full.stack_depth > short_stack,
                "there is a restart although no entry was dropped",
            );
            self.demand(
                given,
                full,
                |given, full| match given.restarts {
                    0 => given.inner_visits == full.inner_visits,
                    _ => given.inner_visits > full.inner_visits,
                },
                "the trail visits other inner nodes than the ordered stack, restarts aside",
            );
        }
        trails.sort_by_key(|(options, _)| options.short_stack);
        for pair in trails.windows(2) {
            let [(shorter, less), (longer, more)] = pair else { continue };
            if shorter.short_stack == longer.short_stack {
                self.demand(*more, *less, |a, b| a == b, "another register or memory changed the work");
            } else {
                self.demand_of_classes(*more, *less, "a shorter stack", |less, _| less);
            }
        }
    }

    /// Demands of the sums over each class of rays that `given` is no more than `allowed` of `than` and the number of
    /// rays.
    fn demand_of_classes(
        &mut self,
        given: Counted<'_>,
        than: Counted<'_>,
        with: &str,
        allowed: impl Fn(u64, usize) -> u64,
    ) {
        let (Some((row, given)), Some((_, than))) = (given, than) else { return };
        for (class, range) in &self.case.classes {
            let sum = |counters: &[Counters]| {
                counters[range.clone()].iter().map(Work::of).fold(Work::default(), Work::plus)
            };
            let (given, than) = (sum(given), sum(than));
            if !given.0.iter().zip(than.0).all(|(&given, than)| given <= allowed(than, range.len())) {
                let what = format!("{given:?} visits, leaves and tests against {than:?} with {with}");
                self.wrong.push((row, format!("rays of class {class}: {what}")));
            }
        }
    }
}

type Rule = fn(&Counters, &Counters) -> bool;

fn is_equal(a: &Counters, b: &Counters) -> bool {
    Work::of(a) == Work::of(b)
}

fn is_no_more(a: &Counters, b: &Counters) -> bool {
    Work::of(a).0.iter().zip(Work::of(b).0).all(|(&a, b)| a <= b)
}

fn has_same_leaves(a: &Counters, b: &Counters) -> bool {
    (a.leaf_visits, a.primitive_tests) == (b.leaf_visits, b.primitive_tests)
}
