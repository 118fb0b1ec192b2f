//! What walks may count. Where a mistake does not show in the hits (a leaf entered twice, nothing culled), it
//! shows here.
//!
//! Of one walk ([`check`]): nothing for a ray that is not valid; no triangle, leaf or node more often than there
//! are of them; no stack deeper than the tree; brute force tests every triangle exactly once.
//!
//! Between walks of one binary tree ([`relations`]), for each ray, from ALGORITHMS B1 to B6: recursion does the
//! work of the unordered stack; culling, sorting and ordering never do more than the unordered stack; all hits
//! and count do exactly its work, since nothing is culled; before the first hit culling changes nothing, so any
//! hit is the same with it. Summed over a class of rays sorting does no more than culling alone, and ordering no
//! more than sorting, up to the few rays that an order misleads.

use crate::cases::Case;
use ropewalk::bvh::StackOrder;
use ropewalk::catalogue::Row;
use ropewalk::{Answer, Counters, Query, Ray, Structure, Traced, Walk};

/// Checks the counters of one row by themselves.
///
/// # Errors
/// Says what cannot be.
pub fn check(structure: &Structure, row: Row, rays: &[Ray], traced: &Traced) -> Result<(), String> {
    let Some(counters) = &traced.counters else {
        return Err("counters were asked for and are not there".into());
    };
    if counters.len() != rays.len() || traced.answer.len() != rays.len() {
        return Err(format!("{} rays have {} counters", rays.len(), counters.len()));
    }
    let report = structure.report();
    let inner_nodes = report.nodes - report.leaves;
    for (index, (ray, counted)) in rays.iter().zip(counters).enumerate() {
        let fail = |what: &str| Err(format!("ray {index}: {what}: {counted:?}"));
        if !ray.is_valid() {
            if *counted != Counters::default() {
                return fail("work was done for a ray that is not valid");
            }
            continue;
        }
        let hit = is_hit(&traced.answer, index);
        if counted.primitive_tests as usize > report.triangles {
            return fail("more triangles were tested than there are");
        }
        if counted.leaf_visits as usize > report.leaves {
            return fail("more leaves were entered than there are");
        }
        if counted.inner_visits as usize > inner_nodes {
            return fail("more inner nodes were visited than there are");
        }
        if counted.stack_depth > report.depth {
            return fail("the stack was deeper than the tree");
        }
        if counted.leaf_visits > counted.primitive_tests || (hit && counted.primitive_tests == 0) {
            return fail("a leaf was entered or a hit found without a test");
        }
        if counted.restarts > 0 || counted.objects_entered > 0 {
            return fail("a walk with a full stack over one structure restarts nowhere and enters no object");
        }
        if row.walk == Walk::BruteForce {
            let everything = counted.primitive_tests as usize == report.triangles
                && counted.leaf_visits as usize == report.leaves;
            let may_stop = row.query == Query::Any && hit;
            if counted.inner_visits > 0 || !(everything || may_stop) {
                return fail("brute force tests every triangle once and no box");
            }
        } else if (counted.inner_visits == 0) != (inner_nodes == 0) {
            return fail("a walk begins at the root's children, if it has any");
        }
    }
    Ok(())
}

/// Checks what must hold between the walks of one binary tree. Each entry of `runs` is a row, its index, and its
/// counted answers; gives back the index and what is wrong.
#[must_use]
pub fn relations(case: &Case, runs: &[(usize, Row, &Traced)]) -> Vec<(usize, String)> {
    let stack = |order: StackOrder| Walk::Stack(order);
    let of = |walk: Walk, query: Query| {
        let run = runs.iter().find(|(_, row, _)| row.walk == walk && row.query == query)?;
        Some((run.0, run.2.counters.as_ref()?.as_slice()))
    };
    let mut wrong = Vec::new();
    let mut demand = |given: Option<(usize, &[Counters])>,
                      than: Option<(usize, &[Counters])>,
                      holds: fn(Work, Work) -> bool,
                      what: &str| {
        let (Some((row, given)), Some((_, than))) = (given, than) else { return };
        let broken = given.iter().zip(than).position(|(given, than)| !holds(work(given), work(than)));
        if let Some(index) = broken {
            let (given, than) = (given[index], than[index]);
            wrong.push((row, format!("ray {index}: {what}: {given:?}, the other {than:?}")));
        }
    };
    let equal: fn(Work, Work) -> bool = |a, b| a == b;
    let no_more: fn(Work, Work) -> bool = |a, b| (0..3).all(|i| a[i] <= b[i]);
    let plain = of(stack(StackOrder::Unordered), Query::Closest);
    demand(
        of(Walk::Recursive, Query::Closest),
        plain,
        equal,
        "recursion does the work of the unordered stack",
    );
    for order in [StackOrder::Culled, StackOrder::Sorted, StackOrder::Ordered] {
        demand(
            of(stack(order), Query::Closest),
            plain,
            no_more,
            "culling does more than the unordered stack",
        );
    }
    for walk in Walk::EVERY.into_iter().filter(|&walk| walk != Walk::BruteForce) {
        demand(of(walk, Query::Any), plain, no_more, "any hit does more than the whole unordered walk");
        demand(of(walk, Query::All), plain, equal, "all hits does other work than the unordered walk");
        demand(of(walk, Query::Count), plain, equal, "count does other work than the unordered walk");
    }
    let any = of(stack(StackOrder::Unordered), Query::Any);
    demand(of(stack(StackOrder::Culled), Query::Any), any, equal, "culling changed a search for any hit");

    for (better, worse) in
        [(StackOrder::Sorted, StackOrder::Culled), (StackOrder::Ordered, StackOrder::Sorted)]
    {
        let (better, worse) = (of(stack(better), Query::Closest), of(stack(worse), Query::Closest));
        let (Some((row, better)), Some((_, worse))) = (better, worse) else { continue };
        for (class, range) in &case.classes {
            let sum = |counters: &[Counters]| counters[range.clone()].iter().map(work).fold([0u64; 3], add);
            let (better, worse) = (sum(better), sum(worse));
            // An order can mislead single rays: a tenth, and four visits a ray on trees of few nodes.
            let allowed = |worse: u64| worse + worse / 10 + 4 * range.len() as u64;
            if (0..3).any(|i| better[i] > allowed(worse[i])) {
                wrong.push((row, format!("rays of class {class}: {better:?} visits, leaves and tests against {worse:?} with less order")));
            }
        }
    }
    wrong
}

/// Inner visits, leaf visits, primitive tests.
type Work = [u64; 3];

fn work(counters: &Counters) -> Work {
    [counters.inner_visits, counters.leaf_visits, counters.primitive_tests].map(u64::from)
}

fn add(a: Work, b: Work) -> Work {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Whether two walks did the same work for every ray, the depth of their stacks aside.
pub(super) fn is_same_work(a: &[Counters], b: &[Counters]) -> bool {
    a.iter().map(work).eq(b.iter().map(work))
}

fn is_hit(answer: &Answer, index: usize) -> bool {
    match answer {
        Answer::Closest(hits) => hits[index].is_hit(),
        Answer::Any(hits) => hits[index],
        Answer::Count(counts) => counts[index] > 0,
        Answer::All(lists) => !lists.of(index).is_empty(),
    }
}
