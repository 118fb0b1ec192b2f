// What walks that go by t alone may conclude, and what they do where they may not.
// Source: the twin of ropewalk's kd_tree/walk/certain.rs, where it is proved that nothing is lost.
// Invariants: same operations in the same order as in Rust. An undecided ray is led again from the root on by the trail, which
//   goes by decisions and not by t; what was found stays found.

#import #{SEEKER}
#import shared/kd_trail

// No leaf has ended yet: before every t.
const NOTHING_DONE: f32 = -1.0;

// Whether `b` lies behind `a`, beyond doubt.
fn is_behind(b: f32, a: f32) -> bool {
    return a * #{KD_BAND} < b;
}

// Which children of a node are open: the near one, the far one, or both, one after the other; or that is not certain.
const FORK_NEAR: u32 = 0u;
const FORK_FAR: u32 = 1u;
const FORK_BOTH: u32 = 2u;
const FORK_UNDECIDED: u32 = 3u;

fn fork_of(crossing: Crossing, cell: Interval) -> u32 {
    if crossing.far_entry > cell.exit {
        return FORK_NEAR;
    }
    if crossing.near_exit < cell.entry {
        return FORK_FAR;
    }
    if crossing.is_point && crossing.near_exit < cell.exit && is_behind(crossing.far_entry, cell.entry) {
        return FORK_BOTH;
    }
    return FORK_UNDECIDED;
}

// Gives a ray over to the trail, which counts as a restart; the status of the walk.
fn give_over(seeker: Seeker, steps_left: u32, collect: ptr<function, Collect>) -> u32 {
    probe_restart();
    return walk_by_trail(seeker, steps_left, collect);
}
