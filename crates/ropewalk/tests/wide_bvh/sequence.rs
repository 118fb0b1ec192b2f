//! The restart trail does what the full stack does, in its order: equal hits alone would not show that.

use crate::recorder::{Shorten, record};
use crate::scenes::{builds, collapsed, rays, scenes};
use ropewalk::wide_bvh::walk::{ArrayTrail, Ordered, RestartTrail, Trail, TrailU64};
use ropewalk::{PreparedRay, WideBvh};
use ropewalk_testkit::recorder::{Event, Events, Fault};

/// Entries that no tree of these tests asks for: nothing is ever dropped.
pub(crate) const UNLIMITED: usize = 512;

/// What is wrong with the walk of a trail with a stack of `short_stack` entries.
pub(crate) fn faults<T: Trail>(
    bvh: &WideBvh,
    short_stack: usize,
    ray: &PreparedRay,
    shorten: Shorten,
) -> Vec<Fault> {
    let full = record(bvh, Ordered, ray, shorten);
    let walk = RestartTrail::<T, UNLIMITED>::new(short_stack as u32);
    Events::faults(&full, &record(bvh, walk, ray, shorten), short_stack == UNLIMITED)
}

const SHORTEN: [Shorten; 3] = [Shorten::Hits, Shorten::EachLeaf(0.9), Shorten::EachLeaf(0.6)];

fn each_tree(mut check: impl FnMut(&str, &WideBvh, &[PreparedRay])) {
    for (name, scene) in scenes() {
        let rays: Vec<PreparedRay> = rays(&scene, 12).iter().filter_map(PreparedRay::new).collect();
        for options in builds() {
            for bvh in collapsed(&scene, &options).1 {
                check(&format!("{name} {options:?} {:?}", bvh.width()), &bvh, &rays);
            }
        }
    }
}

#[test]
fn an_unlimited_short_stack_makes_the_visits_of_the_full_stack() {
    let mut pushes = 0;
    each_tree(|name, bvh, rays| {
        for (index, ray) in rays.iter().enumerate() {
            for shorten in SHORTEN {
                let full = record(bvh, Ordered, ray, shorten);
                assert_eq!(full.1.restarts(), 0);
                let trail = record(bvh, RestartTrail::<ArrayTrail, UNLIMITED>::new(512), ray, shorten);
                assert_eq!(trail, full, "{name}, ray {index}, {shorten:?}");
                if bvh.report().depth <= TrailU64::LEVELS {
                    let trail = record(bvh, RestartTrail::<TrailU64, UNLIMITED>::new(512), ray, shorten);
                    assert_eq!(trail, full, "{name}, ray {index}, {shorten:?}");
                }
                pushes += full.1.0.iter().filter(|event| matches!(event, Event::Depth(_))).count();
            }
        }
    });
    assert!(pushes > 100_000, "the rays are too simple to tell: {pushes} pushes");
}

/// For every size of the stack: the same leaves in the same order, none twice, the same nodes, and less work the larger
/// the stack.
#[test]
fn every_short_stack_enters_the_leaves_of_the_full_stack() {
    let mut restarts = [0; 17];
    each_tree(|name, bvh, rays| {
        // One ray in five: each is asked 3 times 34 times.
        for ray in rays.iter().step_by(5) {
            for shorten in SHORTEN {
                for short_stack in 0..=16 {
                    let found = faults::<ArrayTrail>(bvh, short_stack, ray, shorten);
                    assert_eq!(found, [], "{name}, {short_stack}, {shorten:?}");
                    if bvh.report().depth <= TrailU64::LEVELS {
                        let found = faults::<TrailU64>(bvh, short_stack, ray, shorten);
                        assert_eq!(found, [], "{name}, {short_stack}, {shorten:?}, u64");
                    }
                }
            }
        }
        let mut before = usize::MAX;
        for (short_stack, restarts) in restarts.iter_mut().enumerate() {
            let walk = RestartTrail::<ArrayTrail>::new(short_stack as u32);
            let events = rays.iter().map(|ray| record(bvh, walk, ray, Shorten::Hits).1);
            let (visits, again) = events.fold((0, 0), |(visits, again), events| {
                (visits + events.inner_visits(), again + events.restarts())
            });
            assert!(visits <= before, "{name}: {visits} visits with {short_stack} entries, {before} before");
            before = visits;
            *restarts += again;
        }
    });
    assert!(restarts.is_sorted_by(|a, b| a >= b), "{restarts:?}");
    assert!(restarts[0] > 10 * restarts[8] && restarts[4] > 0, "{restarts:?}");
}
