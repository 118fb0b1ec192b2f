//! The suite must fail when a restart trail is broken. Most of its mistakes leave every hit right and only do work
//! twice, so it is the counters that must tell. Each fault here is one that a port from the paper makes easily: the
//! formulas as they are printed, the level of the last pop left out, a ring that drops the wrong end.

mod support;

use ropewalk::aabb::slab_test;
use ropewalk::bvh::walk::{AnyHit, BvhWalk, ClosestHit, Summary, Visitor};
use ropewalk::bvh::{Node, StackOrder};
use ropewalk::catalogue::{Row, StackMemory, TrailOptions, TrailRegister};
use ropewalk::{
    Answer, Bvh, Counters, Hit, PreparedRay, Query, Ray, Status, Structure, StructureSpec, TraceOptions,
    Traced, Walk,
};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::conformance::{Accuracy, Device, Report};
use std::collections::VecDeque;
use support::{Asked, answering, bvh, demand_caught, row};

/// What is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    Nothing,
    /// The one child of a node is entered, although it is the near one and finished.
    PopLevelIgnored,
    /// `trail &= !level; trail += level`, as the paper prints it.
    PrintedFormula,
    /// `trail >> 1` where the lowest bit is asked, as the paper prints it: wrong for odd trails.
    PrintedLowestBit,
    /// A full ring takes nothing more.
    DropsTheNewest,
    /// An entry that is culled when it is popped leaves no mark in the trail.
    CulledEntriesLeaveNoMark,
    /// Boxes and entries at exactly the closest hit are culled.
    HalfOpenCulling,
    /// A node with one child to visit leaves no mark.
    SingleChildrenLeaveNoMark,
    /// The far child is taken before the near one is finished.
    FarChildFirstAfterARestart,
    /// A restart is not told.
    RestartsAreNotCounted,
}

/// The restart trail in 64 bits with a short stack, written anew so that it can be broken.
#[derive(Clone, Copy)]
struct Faulty {
    fault: Fault,
    capacity: usize,
}

/// More than any sound walk of these cases takes: a broken one may have no end of its own.
const STEPS: usize = 20_000;

const SENTINEL: u64 = 1 << 63;

/// The bits of the trail and the two levels, each one bit.
#[derive(Clone, Copy)]
struct Bits {
    trail: u64,
    level: u64,
    pop_level: u64,
}

impl Faulty {
    fn is_within(self, entry: f32, t_max: f32) -> bool {
        if self.fault == Fault::HalfOpenCulling { entry < t_max } else { entry <= t_max }
    }

    /// Notes that the current node is finished; whether there is another one.
    fn finish(self, bits: &mut Bits) -> bool {
        bits.trail = match self.fault {
            Fault::PrintedFormula => (bits.trail & !bits.level).wrapping_add(bits.level),
            _ => (bits.trail & bits.level.wrapping_neg()).wrapping_add(bits.level),
        };
        bits.level = if self.fault == Fault::PrintedLowestBit {
            let shifted = bits.trail >> 1;
            (shifted.wrapping_sub(1) ^ shifted).wrapping_add(1)
        } else {
            bits.trail & bits.trail.wrapping_neg()
        };
        bits.pop_level = if self.fault == Fault::PopLevelIgnored { 0 } else { bits.level };
        bits.trail & SENTINEL == 0
    }
}

impl BvhWalk for Faulty {
    fn walk<V: Visitor>(self, nodes: &[Node], ray: &PreparedRay, visitor: &mut V) {
        let mut bits = Bits { trail: 0, level: SENTINEL, pop_level: 0 };
        let mut stack: VecDeque<(u32, f32)> = VecDeque::new();
        let mut current = 0u32;
        for _ in 0..STEPS {
            let Some(node) = nodes.get(current as usize) else { return };
            if node.is_leaf() {
                if visitor.leaf(node.link, node.count).is_break() {
                    return;
                }
            } else {
                visitor.inner_visit(current);
                let [(first, a), (second, b)] = [current + 1, node.link].map(|child| {
                    let [min, max] = nodes[child as usize].corners();
                    let interval = slab_test(ray, min, max, visitor.t_max());
                    let is_hit = interval.is_hit() && self.is_within(interval.entry, visitor.t_max());
                    (child, is_hit.then_some(interval.entry))
                });
                match (a, b) {
                    (Some(a), Some(b)) => {
                        let (near, far) = if b < a { (second, (first, a)) } else { (first, (second, b)) };
                        bits.level >>= 1;
                        let near_done = bits.trail & bits.level != 0;
                        if near_done
                            || (self.fault == Fault::FarChildFirstAfterARestart && bits.pop_level == 1 << 60)
                        {
                            current = far.0;
                        } else {
                            current = near;
                            if stack.len() < self.capacity || self.fault != Fault::DropsTheNewest {
                                stack.push_back(far);
                            }
                            if stack.len() > self.capacity {
                                stack.pop_front();
                            }
                            if self.capacity > 0 {
                                visitor.stack_depth(stack.len());
                            }
                        }
                        continue;
                    }
                    (Some(_), None) | (None, Some(_)) => {
                        bits.level >>= 1;
                        if bits.level != bits.pop_level {
                            if self.fault != Fault::SingleChildrenLeaveNoMark {
                                bits.trail |= bits.level;
                            }
                            current = if a.is_some() { first } else { second };
                            continue;
                        }
                    }
                    (None, None) => {}
                }
            }
            let mut must_finish = true;
            loop {
                if must_finish && !self.finish(&mut bits) {
                    return;
                }
                match stack.pop_back() {
                    None => {
                        bits.level = SENTINEL;
                        if self.fault != Fault::RestartsAreNotCounted {
                            visitor.restart();
                        }
                        current = 0;
                        break;
                    }
                    Some((far, entry)) if self.is_within(entry, visitor.t_max()) => {
                        current = far;
                        break;
                    }
                    Some(_) => must_finish = self.fault != Fault::CulledEntriesLeaveNoMark,
                }
            }
        }
    }
}

/// A device whose restart trails are broken; the other walks are the CPU's.
fn broken(fault: Fault) -> impl Device {
    answering(move |structure, asked| {
        // A tree that is too deep for the register is refused before anything is walked.
        let sound = asked.soundly(structure)?;
        let Walk::RestartTrail(trail) = asked.walk else { return Ok(sound) };
        let (bvh, walk) = (bvh(structure)?, Faulty { fault, capacity: trail.short_stack as usize });
        Ok(match sound.answer {
            Answer::Closest(_) => trace::<ClosestHit>(walk, bvh, asked.rays, asked.options, Answer::Closest),
            Answer::Any(_) => trace::<AnyHit>(walk, bvh, asked.rays, asked.options, Answer::Any),
            _ => sound,
        })
    })
}

fn trace<S: Summary>(
    walk: Faulty,
    bvh: &Bvh,
    rays: &[Ray],
    options: TraceOptions,
    answer: fn(Vec<S::Answer>) -> Answer,
) -> Traced {
    let walked = rays.iter().map(|ray| match PreparedRay::new(ray) {
        None => (S::Answer::default(), Counters::default()),
        Some(ray) => {
            let (found, counters) = bvh.visit(walk, &ray, S::new(&ray), Counters::default());
            (found.answer(), counters)
        }
    });
    let (answers, counters): (Vec<_>, Vec<_>) = walked.unzip();
    let status = |ray: &Ray| if ray.is_valid() { Status::COMPLETE } else { Status::INVALID_RAY };
    Traced {
        answer: answer(answers),
        status: rays.iter().map(status).collect(),
        counters: options.counters.then_some(counters),
    }
}

fn rows() -> Vec<Row> {
    let trail = |short_stack| {
        let register = TrailRegister::U64;
        Walk::RestartTrail(TrailOptions { short_stack, register, memory: StackMemory::Private })
    };
    let walks = [Walk::BruteForce, Walk::Stack(StackOrder::Ordered), trail(0), trail(2), trail(4)];
    walks.into_iter().flat_map(|walk| [Query::Closest, Query::Any].map(|query| row(walk, query))).collect()
}

fn run(case: &str, fault: Fault) -> Report {
    support::run(case, &rows(), Accuracy::Exact, broken(fault))
}

/// Runs the case with the fault: it must be caught by a check whose words contain `says`, and only the trails blamed.
fn must_be_caught(fault: Fault, case: &str, says: &str) {
    let report = run(case, fault);
    demand_caught(&report, fault, case, says);
    for (row, failure) in report.failures() {
        assert!(matches!(row.walk, Walk::RestartTrail(_)), "{fault:?}: {} is blamed: {failure}", row.walk);
    }
}

const OTHER_LEAVES: &str = "the trail enters other leaves than the ordered stack";

/// The plumbing of this file is not what the suite objects to.
#[test]
fn an_unbroken_trail_passes() {
    for case in
        ["soup", "big-soup-triangles", "reversed-ids", "coplanar-axis", "chain", "one-triangle", "empty"]
    {
        let report = run(case, Fault::Nothing);
        assert!(report.is_passed(), "{case}: {report}");
    }
}

#[test]
fn a_trail_without_the_level_of_the_last_pop_is_caught() {
    must_be_caught(Fault::PopLevelIgnored, "soup", OTHER_LEAVES);
    must_be_caught(Fault::PopLevelIgnored, "room", OTHER_LEAVES);
    // All hits are right: nothing but the counters can tell.
    let report = run("soup", Fault::PopLevelIgnored);
    assert!(report.failures().all(|(_, failure)| !failure.what.contains("oracle")), "{report}");
}

#[test]
fn the_formulas_as_they_are_printed_are_caught() {
    must_be_caught(Fault::PrintedFormula, "soup", "is lost");
    must_be_caught(Fault::PrintedFormula, "soup", OTHER_LEAVES);
    // Only the deepest level has an odd trail: a tree that uses all bits is wanted.
    must_be_caught(Fault::PrintedLowestBit, "chain", OTHER_LEAVES);
}

#[test]
fn a_ring_that_drops_its_newest_entry_is_caught() {
    must_be_caught(Fault::DropsTheNewest, "soup", "is lost");
    must_be_caught(Fault::DropsTheNewest, "chain", OTHER_LEAVES);
}

#[test]
fn a_trail_out_of_step_with_culled_entries_is_caught() {
    must_be_caught(Fault::CulledEntriesLeaveNoMark, "soup", OTHER_LEAVES);
}

#[test]
fn culling_at_exactly_the_closest_hit_is_caught() {
    must_be_caught(Fault::HalfOpenCulling, "reversed-ids", "against brute-force");
}

#[test]
fn marks_that_are_not_made_or_not_cleared_are_caught() {
    must_be_caught(Fault::SingleChildrenLeaveNoMark, "soup", OTHER_LEAVES);
    must_be_caught(Fault::FarChildFirstAfterARestart, "soup", OTHER_LEAVES);
}

#[test]
fn restarts_that_are_not_told_are_caught() {
    must_be_caught(Fault::RestartsAreNotCounted, "soup", "visits other inner nodes than the ordered stack");
}

/// A walk that goes through a tree which is too deep for its register is as wrong as one that refuses another.
#[test]
fn a_register_that_is_too_small_must_be_said() {
    let bold = |answers: bool| {
        answering(move |structure, asked| match asked.walk {
            Walk::RestartTrail(_) if !answers => Err("the tree is too deep, or so".into()),
            Walk::RestartTrail(trail) => {
                let trail = TrailOptions { register: TrailRegister::Array, ..trail };
                Asked { walk: Walk::RestartTrail(trail), ..*asked }.soundly(structure)
            }
            _ => asked.soundly(structure),
        })
    };
    for (answers, says) in [(true, "it answers where it must refuse"), (false, "the tree is too deep, or so")]
    {
        let report = support::run("chain", &rows(), Accuracy::Exact, bold(answers));
        assert!(!report.is_passed());
        assert!(report.to_string().contains(says), "{report}");
    }
}

/// The suite must not take a miss for an answer just because the reference missed as well.
#[test]
fn a_hit_is_among_what_is_compared() {
    let bvh = StructureSpec::default().build(&Case::named("soup").unwrap().scene, &ropewalk::NoMonitor);
    let Ok(Structure::Bvh(bvh)) = bvh else { panic!("no BVH") };
    let rays = &Case::named("soup").unwrap().rays;
    let walk = Faulty { fault: Fault::Nothing, capacity: 2 };
    let traced = trace::<ClosestHit>(walk, &bvh, rays, TraceOptions { counters: true }, Answer::Closest);
    let Answer::Closest(hits) = &traced.answer else { panic!("another answer") };
    assert!(hits.iter().filter(|hit| **hit != Hit::MISS).count() > 300);
    assert!(traced.totals().unwrap().restarts > 100);
}
