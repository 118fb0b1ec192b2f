//! The suite must fail when a walk is broken. Here one walk after the other is broken on purpose, through the real
//! nodes of real structures, and each must be caught by the case that is meant for it.

mod support;

use ropewalk::aabb::slab_test;
use ropewalk::bvh::walk::{AllHits, AnyHit, BvhWalk, Collect, HitCount, Ordered, Summary, Visitor};
use ropewalk::bvh::{Node, StackOrder};
use ropewalk::catalogue::Row;
use ropewalk::{
    Answer, Bvh, Counters, Hit, HitLists, PreparedRay, Query, Ray, Status, Structure, TraceOptions, Traced,
    Walk,
};
use ropewalk_testkit::conformance::{Accuracy, Device, Report};
use std::ops::ControlFlow;
use support::{Asked, answering, bvh, demand_caught, row};

/// What is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    Nothing,
    NoNearPad,
    DropsTheOldestEntry,
    StackOfEightEntries,
    OpenTestAtPop,
    SkipsALeaf,
    EntersLeavesTwice,
    FartherChildFirst,
    AnyIgnoresTMax,
    ClosestIgnoresTMin,
    IgnoresTheMask,
    OpenWindow,
    TieRuleReversed,
    TiesToTheFirstMet,
    SideOfMirroredNotFlipped,
    BarycentricsOfTheFirstVertex,
    RenormalisedDirection,
    StaleFieldsOnAMiss,
    UnsortedList,
    TracesInvalidRays,
    WrongStatus,
    AnswersDifferWithCounters,
    CountersStayZero,
}

/// The ordered walk with one of the faults that a walk can have by itself.
#[derive(Clone, Copy)]
struct Faulty<const FAULT: u8>;

impl<const FAULT: u8> Faulty<FAULT> {
    const fn is(fault: Fault) -> bool {
        FAULT == fault as u8
    }

    /// Entry and whether the box is hit.
    fn test(node: &Node, ray: &PreparedRay, t_max: f32) -> (f32, bool) {
        let [min, max] = node.corners();
        let interval = slab_test(ray, min, max, t_max);
        if Self::is(Fault::NoNearPad) {
            let entry = (interval.entry / ropewalk::aabb::PAD_ENTRY).max(ray.t_min);
            return (entry, entry <= interval.exit);
        }
        (interval.entry, interval.is_hit())
    }
}

impl<const FAULT: u8> BvhWalk for Faulty<FAULT> {
    fn walk<V: Visitor>(self, nodes: &[Node], ray: &PreparedRay, visitor: &mut V) {
        let mut stack: Vec<(u32, f32)> = Vec::new();
        let mut next = (!nodes.is_empty()).then_some(0u32);
        while let Some(current) = next {
            let node = &nodes[current as usize];
            let mut entered = None;
            if node.is_leaf() {
                if Self::is(Fault::SkipsALeaf) && node.link.is_multiple_of(64) {
                    // Not a word about it.
                } else if visitor.leaf(node.link, node.count).is_break() {
                    return;
                }
                if Self::is(Fault::EntersLeavesTwice) && visitor.leaf(node.link, node.count).is_break() {
                    return;
                }
            } else {
                visitor.inner_visit(current);
                let (first, second) = (current + 1, node.link);
                let (a, hit_a) = Self::test(&nodes[first as usize], ray, visitor.t_max());
                let (b, hit_b) = Self::test(&nodes[second as usize], ray, visitor.t_max());
                entered = match (hit_a, hit_b) {
                    (true, true) => {
                        let second_first = (b < a) != Self::is(Fault::FartherChildFirst);
                        let (near, far) =
                            if second_first { (second, (first, a)) } else { (first, (second, b)) };
                        stack.push(far);
                        if Self::is(Fault::DropsTheOldestEntry) && stack.len() > 3 {
                            stack.remove(0);
                        }
                        if Self::is(Fault::StackOfEightEntries) && stack.len() > 8 {
                            stack.pop();
                        }
                        visitor.stack_depth(stack.len());
                        Some(near)
                    }
                    (true, false) => Some(first),
                    (false, true) => Some(second),
                    (false, false) => None,
                };
            }
            next = entered.or_else(|| {
                loop {
                    let (node, entry) = stack.pop()?;
                    let limit = visitor.t_max();
                    if entry < limit || (entry == limit && !Self::is(Fault::OpenTestAtPop)) {
                        return Some(node);
                    }
                }
            });
        }
    }
}

/// Keeps the closest hit by a broken rule for ties.
struct WrongTies {
    t_max: f32,
    hit: Hit,
    fault: Fault,
}

impl Collect for WrongTies {
    fn t_max(&self) -> f32 {
        self.t_max
    }

    fn offer(&mut self, hit: Hit) -> ControlFlow<()> {
        let wins_tie = match self.fault {
            Fault::TieRuleReversed => hit.id() > self.hit.id(),
            _ => false,
        };
        if hit.t < self.hit.t || (hit.t == self.hit.t && wins_tie) {
            self.hit = hit;
            self.t_max = hit.t;
        }
        ControlFlow::Continue(())
    }
}

/// What a device says whose ordered walk is broken; the other walks are the CPU's.
fn answer(fault: Fault, structure: &Structure, asked: &Asked<'_>) -> Result<Traced, String> {
    if asked.walk != Walk::Stack(StackOrder::Ordered) {
        return asked.soundly(structure);
    }
    let Asked { query, rays, options, .. } = *asked;
    let bvh = bvh(structure)?;
    macro_rules! by_walk {
        ($($fault:ident),*) => {
            match fault {
                $(Fault::$fault => trace(Faulty::<{ Fault::$fault as u8 }>, bvh, fault, query, rays, options),)*
                _ => trace(Ordered, bvh, fault, query, rays, options),
            }
        };
    }
    Ok(by_walk!(
        Nothing,
        NoNearPad,
        DropsTheOldestEntry,
        StackOfEightEntries,
        OpenTestAtPop,
        SkipsALeaf,
        EntersLeavesTwice,
        FartherChildFirst
    ))
}

/// A device whose ordered walk is broken.
fn broken(fault: Fault) -> impl Device {
    answering(move |structure, asked| answer(fault, structure, asked))
}

fn trace<W: BvhWalk>(
    walk: W,
    bvh: &Bvh,
    fault: Fault,
    query: Query,
    rays: &[Ray],
    options: TraceOptions,
) -> Traced {
    let mut status = Vec::new();
    let mut counters = Vec::new();
    let (mut closest, mut any, mut counts) = (Vec::new(), Vec::new(), Vec::new());
    let mut lists = HitLists { offsets: vec![0], hits: Vec::new() };
    for ray in rays {
        let mut asked = *ray;
        match fault {
            Fault::AnyIgnoresTMax if query == Query::Any => asked.t_max = f32::INFINITY,
            Fault::ClosestIgnoresTMin if query == Query::Closest => asked.t_min = 0.0,
            Fault::IgnoresTheMask => asked.mask = 0xff,
            Fault::OpenWindow => asked.t_max = asked.t_max.next_down(),
            Fault::RenormalisedDirection if ray.is_valid() => {
                asked.dir = ray.dir.as_dvec3().normalize().as_vec3();
            }
            Fault::TracesInvalidRays if !ray.is_valid() => {
                asked = Ray::new(glam::Vec3::ZERO, glam::Vec3::ONE);
            }
            _ => {}
        }
        let prepared = PreparedRay::new(&asked);
        let mut good = ray.is_valid();
        good |= fault == Fault::TracesInvalidRays;
        good &= !(fault == Fault::WrongStatus && any.len() + closest.len() == 7);
        status.push(if good { Status::COMPLETE } else { Status::INVALID_RAY });
        let mut counted = Counters::default();
        match query {
            Query::Any => any.push(prepared.is_some_and(|ray| {
                let (found, probe) = bvh.visit(walk, &ray, AnyHit::new(&ray), counted);
                counted = probe;
                found.answer()
            })),
            Query::Count => counts.push(prepared.map_or(0, |ray| {
                let (found, probe) = bvh.visit(walk, &ray, HitCount::new(&ray), counted);
                counted = probe;
                found.answer()
            })),
            Query::All => {
                let first = lists.hits.len();
                if let Some(ray) = prepared {
                    counted = bvh.visit(walk, &ray, AllHits::new(&ray, &mut lists.hits), counted).1;
                }
                let hits = &mut lists.hits[first..];
                hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.id().cmp(&b.id())));
                hits.iter_mut().for_each(|hit| spoil(hit, fault, bvh));
                if fault == Fault::UnsortedList {
                    hits.reverse();
                }
                lists.offsets.push(lists.hits.len() as u64);
            }
            Query::Closest => {
                let mut hit = prepared.map_or(Hit::MISS, |ray| {
                    let (hit, probe) = nearest(walk, bvh, &ray, fault, counted);
                    counted = probe;
                    hit
                });
                spoil(&mut hit, fault, bvh);
                if let (Fault::StaleFieldsOnAMiss, false, Some(last)) = (fault, hit.is_hit(), closest.last())
                {
                    let last: &Hit = last;
                    hit = Hit { t: hit.t, primitive_index: hit.primitive_index, ..*last };
                }
                if fault == Fault::AnswersDifferWithCounters && options.counters && hit.is_hit() {
                    hit.t = hit.t.next_up();
                }
                closest.push(hit);
            }
        }
        counters.push(if fault == Fault::CountersStayZero { Counters::default() } else { counted });
    }
    let answer = match query {
        Query::Closest => Answer::Closest(closest),
        Query::Any => Answer::Any(any),
        Query::All => Answer::All(lists),
        Query::Count => Answer::Count(counts),
    };
    Traced { answer, status, counters: options.counters.then_some(counters) }
}

fn nearest<W: BvhWalk>(
    walk: W,
    bvh: &Bvh,
    ray: &PreparedRay,
    fault: Fault,
    probe: Counters,
) -> (Hit, Counters) {
    if matches!(fault, Fault::TieRuleReversed | Fault::TiesToTheFirstMet) {
        let collect = WrongTies { t_max: ray.t_max, hit: Hit::MISS, fault };
        let (collect, probe) = bvh.visit(walk, ray, collect, probe);
        return (collect.hit, probe);
    }
    let (found, probe) = bvh.visit(walk, ray, ropewalk::bvh::walk::ClosestHit::new(ray), probe);
    (found.answer(), probe)
}

fn spoil(hit: &mut Hit, fault: Fault, bvh: &Bvh) {
    if !hit.is_hit() {
        return;
    }
    match fault {
        Fault::SideOfMirroredNotFlipped => {
            let of_hit = bvh.triangles().iter().find(|triangle| triangle.instance() == hit.instance_index);
            if of_hit.is_some_and(ropewalk::FlatTriangle::is_mirrored) {
                hit.front_face = !hit.front_face;
            }
        }
        Fault::BarycentricsOfTheFirstVertex => hit.barycentrics.x = 1.0 - hit.barycentrics.element_sum(),
        _ => {}
    }
}

fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for query in Query::EVERY {
        rows.extend([row(Walk::BruteForce, query), row(Walk::Stack(StackOrder::Ordered), query)]);
    }
    for order in [StackOrder::Unordered, StackOrder::Culled, StackOrder::Sorted] {
        rows.extend([Query::Closest, Query::Any].map(|query| row(Walk::Stack(order), query)));
    }
    rows
}

fn run(case: &str, fault: Fault) -> Report {
    support::run(case, &rows(), Accuracy::Exact, broken(fault))
}

/// Runs the case with the fault: it must be caught, by a check whose words contain `says`, and nobody else blamed.
fn must_be_caught(fault: Fault, case: &str, says: &str) {
    let report = run(case, fault);
    demand_caught(&report, fault, case, says);
    assert!(
        report.failures().any(|(row, _)| row.walk == Walk::Stack(StackOrder::Ordered)),
        "{fault:?}: the broken walk is not blamed: {report}"
    );
}

/// The plumbing of this file is not what the suite objects to.
#[test]
fn an_unbroken_walk_passes() {
    for case in
        ["soup", "reversed-ids", "coplanar-axis", "duplicates", "placed", "masks", "chain", "one-triangle"]
    {
        let report = run(case, Fault::Nothing);
        assert!(report.is_passed(), "{case}: {report}");
    }
}

#[test]
fn boxes_without_padding_at_the_near_end_are_caught() {
    must_be_caught(Fault::NoNearPad, "coplanar-axis", "against brute-force");
}

#[test]
fn a_stack_that_loses_entries_is_caught() {
    must_be_caught(Fault::DropsTheOldestEntry, "soup", "is lost");
    must_be_caught(Fault::StackOfEightEntries, "chain", "there is a certain hit nearer");
}

#[test]
fn an_open_test_at_pop_is_caught() {
    must_be_caught(Fault::OpenTestAtPop, "reversed-ids", "against brute-force");
}

#[test]
fn a_leaf_that_is_skipped_or_entered_twice_is_caught() {
    must_be_caught(Fault::SkipsALeaf, "soup", "is lost");
    must_be_caught(Fault::SkipsALeaf, "one-triangle", "is lost");
    must_be_caught(Fault::EntersLeavesTwice, "soup", "listed twice");
    must_be_caught(Fault::EntersLeavesTwice, "one-triangle", "more triangles were tested than there are");
}

/// Every hit is right; only the counters show it.
#[test]
fn a_wrong_order_is_caught_by_its_counters() {
    must_be_caught(Fault::FartherChildFirst, "big-soup-triangles", "with less order");
    must_be_caught(Fault::CountersStayZero, "soup", "a walk begins at the root's children");
}

#[test]
fn a_window_that_is_not_kept_is_caught() {
    must_be_caught(Fault::AnyIgnoresTMax, "soup", "meets nothing in its window");
    must_be_caught(Fault::ClosestIgnoresTMin, "soup", "outside of the ray's window");
    must_be_caught(Fault::OpenWindow, "soup", "against brute-force");
}

#[test]
fn a_mask_that_is_ignored_is_caught() {
    must_be_caught(Fault::IgnoresTheMask, "masks", "does not meet the triangle");
}

#[test]
fn a_wrong_rule_for_ties_is_caught() {
    must_be_caught(Fault::TieRuleReversed, "duplicates", "the same triangle with the smaller id");
    must_be_caught(Fault::TieRuleReversed, "parts", "the same triangle with the smaller id");
    must_be_caught(Fault::TiesToTheFirstMet, "reversed-ids", "against brute-force");
    must_be_caught(Fault::TiesToTheFirstMet, "duplicate-soup", "the same triangle with the smaller id");
}

#[test]
fn wrong_fields_are_caught() {
    must_be_caught(Fault::SideOfMirroredNotFlipped, "placed", "front_face is");
    must_be_caught(Fault::BarycentricsOfTheFirstVertex, "soup", "the barycentrics are");
    must_be_caught(Fault::StaleFieldsOnAMiss, "soup", "left over");
    must_be_caught(Fault::UnsortedList, "soup", "stands before");
}

#[test]
fn a_direction_that_is_renormalised_is_caught() {
    must_be_caught(Fault::RenormalisedDirection, "soup", "t is");
}

#[test]
fn wrong_status_words_are_caught() {
    must_be_caught(Fault::TracesInvalidRays, "one-triangle", "the status is wrong");
    must_be_caught(Fault::WrongStatus, "one-triangle", "the status is wrong");
}

#[test]
fn answers_that_change_with_counting_are_caught() {
    must_be_caught(Fault::AnswersDifferWithCounters, "soup", "without counters");
}

/// A device like a real GPU: its `t` is a few floats off, differently for each triangle.
fn rough(fault: Fault) -> impl Device {
    // Ties are broken before the rounding here, so a case without them is wanted.
    answering(move |structure, asked| {
        let mut traced = answer(fault, structure, asked)?;
        if let Answer::Closest(hits) = &mut traced.answer {
            for (hit, ray) in hits.iter_mut().zip(asked.rays).filter(|(hit, _)| hit.is_hit()) {
                let off = 1.0 + ((hit.primitive_index % 5) as f32 - 2.0) * 6e-8;
                hit.t = (hit.t * off).clamp(ray.t_min, ray.t_max);
            }
        }
        Ok(traced)
    })
}

fn run_rough(case: &str, fault: Fault, accuracy: Accuracy) -> Report {
    support::run(case, &rows(), accuracy, rough(fault))
}

#[test]
fn the_rounding_of_a_real_gpu_passes_where_it_may_and_a_broken_walk_does_not() {
    for case in ["soup", "placed", "needles", "far-1e6"] {
        let report = run_rough(case, Fault::Nothing, Accuracy::Relaxed);
        assert!(report.is_passed(), "{case}: {report}");
        assert!(!run_rough(case, Fault::Nothing, Accuracy::Exact).is_passed(), "{case}: exact means exact");
    }
    for (fault, case) in [
        (Fault::DropsTheOldestEntry, "soup"),
        (Fault::SkipsALeaf, "sphere"),
        (Fault::IgnoresTheMask, "masks"),
        (Fault::AnyIgnoresTMax, "soup"),
        (Fault::SideOfMirroredNotFlipped, "placed"),
        (Fault::RenormalisedDirection, "soup"),
        (Fault::StaleFieldsOnAMiss, "soup"),
        (Fault::WrongStatus, "soup"),
    ] {
        let report = run_rough(case, fault, Accuracy::Relaxed);
        assert!(report.is_caught_by(case), "{fault:?} slips through {case} on a real GPU");
    }
}

/// A device that fails, lies about lengths, or counts unasked is reported, not believed.
#[test]
fn a_device_that_fails_is_reported() {
    struct Failing(u8);
    impl Device for Failing {
        fn prepare(&mut self, _: &Structure) -> Result<(), String> {
            if self.0 == 0 { Err("out of memory".into()) } else { Ok(()) }
        }
        fn trace(&mut self, _: Walk, query: Query, rays: &[Ray], _: TraceOptions) -> Result<Traced, String> {
            let answer = if query == Query::Any {
                Answer::Any(vec![false; rays.len() - 1])
            } else {
                Answer::Count(vec![])
            };
            match self.0 {
                1 => Err("the device is lost".into()),
                _ => Ok(Traced { answer, status: vec![], counters: Some(vec![]) }),
            }
        }
    }
    for (kind, says) in
        [(0, "out of memory"), (1, "the device is lost"), (2, "the number of answers is wrong")]
    {
        let report = support::run("one-triangle", &rows(), Accuracy::Relaxed, Failing(kind));
        assert!(report.rows.iter().all(|row| !row.is_passed()));
        assert!(report.to_string().contains(says), "{report}");
    }
}
