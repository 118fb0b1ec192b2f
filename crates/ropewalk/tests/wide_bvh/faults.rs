//! Trails with known faults: each must be found out, and by the comparison that is there for it.

use crate::recorder::Shorten;
use crate::scenes::{builds, collapsed, rays, scene};
use crate::sequence::{UNLIMITED, faults};
use ropewalk::PreparedRay;
use ropewalk::wide_bvh::walk::{ArrayTrail, Trail};
use ropewalk_testkit::recorder::Fault;

/// The trail as it should be.
const RIGHT: u8 = 0;
/// As ALGORITHMS: C9b prints it: of a level that is flagged "no more", the last child that is hit *now* is entered.
const AS_PRINTED: u8 = 1;
/// What lies below a finished child is remembered, as if the next child were as far as it.
const KEEPS_LEVELS_BELOW: u8 = 2;
/// No level is ever flagged: the next child is looked for where there is none.
const NEVER_FLAGS: u8 = 3;
/// Finished children are not counted: the same one is visited again and again.
const DOES_NOT_COUNT: u8 = 4;
/// Flags are not looked at, so that a level is left only where its node has no child to visit.
const SKIPS_ONE: u8 = 5;

/// A number and a flag a level, with a fault.
#[derive(Clone, Copy)]
struct Faulty<const FAULT: u8> {
    levels: [(usize, bool); 65],
    level: usize,
}

impl<const FAULT: u8> Trail for Faulty<FAULT> {
    const LEVELS: u32 = ArrayTrail::LEVELS;

    fn new() -> Self {
        Self { levels: [(0, false); 65], level: 0 }
    }

    fn next(&self, hit: usize) -> usize {
        let (finished, is_last) = self.levels[self.level];
        if FAULT == AS_PRINTED && is_last { hit.wrapping_sub(1) } else { finished }
    }

    fn set_last(&mut self) {
        self.levels[self.level].1 = FAULT != NEVER_FLAGS;
    }

    fn descend(&mut self) {
        // A trail that has lost its way must not end in a panic, which no comparison would have found.
        self.level = (self.level + 1).min(64);
    }

    fn finish(&mut self) -> bool {
        let Some(open) = (0..self.level).rev().find(|&level| !self.levels[level].1) else { return false };
        self.levels[open].0 += match FAULT {
            DOES_NOT_COUNT => 0,
            SKIPS_ONE => 2,
            _ => 1,
        };
        if FAULT != KEEPS_LEVELS_BELOW {
            self.levels[open + 1..].fill((0, false));
        }
        self.level = open;
        true
    }

    fn restart(&mut self) {
        self.level = 0;
    }
}

/// Every kind of fault that is found with a trail: with a stack that drops nothing, and with short ones.
fn found<const FAULT: u8>() -> [Vec<Fault>; 2] {
    let mut found = [Vec::new(), Vec::new()];
    for name in ["soup", "sticks"] {
        let scene = scene(name);
        let rays: Vec<PreparedRay> = rays(&scene, 4).iter().filter_map(PreparedRay::new).collect();
        for options in &builds()[1..4] {
            for bvh in collapsed(&scene, options).1 {
                for ray in &rays {
                    for shorten in [Shorten::Hits, Shorten::EachLeaf(0.6)] {
                        found[0].extend(faults::<Faulty<FAULT>>(&bvh, UNLIMITED, ray, shorten));
                        for short_stack in [0, 2] {
                            found[1].extend(faults::<Faulty<FAULT>>(&bvh, short_stack, ray, shorten));
                        }
                    }
                }
            }
        }
    }
    found.map(|mut kinds| {
        kinds.sort_unstable();
        kinds.dedup();
        kinds
    })
}

#[test]
fn nothing_is_found_where_nothing_is_wrong() {
    assert_eq!(found::<RIGHT>(), [vec![], vec![]]);
}

/// It shows only where the ray gets shorter than the way to a box that it is in.
#[test]
fn the_printed_rule_enters_finished_children_again() {
    let [unlimited, short] = found::<AS_PRINTED>();
    assert_eq!(unlimited, [], "without a restart the rule is never asked");
    assert!(short.contains(&Fault::LeafTwice) && short.contains(&Fault::AnotherOrder), "{short:?}");
}

#[test]
fn a_trail_that_keeps_the_levels_below_is_found_out() {
    let [unlimited, short] = found::<KEEPS_LEVELS_BELOW>();
    assert!(unlimited.contains(&Fault::NotTheFullStack) && unlimited.contains(&Fault::AnotherAnswer));
    assert!(short.contains(&Fault::AnotherOrder), "{short:?}");
}

#[test]
fn a_trail_that_never_flags_is_found_out() {
    let [unlimited, short] = found::<NEVER_FLAGS>();
    assert!(unlimited.contains(&Fault::NotTheFullStack), "{unlimited:?}");
    assert!(short.contains(&Fault::LeafTwice) && short.contains(&Fault::AnotherAnswer), "{short:?}");
}

#[test]
fn a_trail_that_does_not_count_is_found_out() {
    let [_, short] = found::<DOES_NOT_COUNT>();
    assert!(short.contains(&Fault::LeafTwice) && short.contains(&Fault::DoesNotEnd), "{short:?}");
}

#[test]
fn a_trail_that_skips_a_child_is_found_out() {
    let [_, short] = found::<SKIPS_ONE>();
    assert!(short.contains(&Fault::AnotherAnswer) && short.contains(&Fault::AnotherOrder), "{short:?}");
}
