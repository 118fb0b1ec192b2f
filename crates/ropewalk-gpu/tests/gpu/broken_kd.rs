//! Shaders of kd-trees that are broken on purpose.

use crate::broken::{few, notice};
use crate::damage::Damage;
use crate::kd_trees;
use crate::scenes::Case;
use ropewalk::Query;

const STACK: &[Damage] = &[
    ("shared/cells", "inverse < 0.0", "inverse < 0.0 || ray.kz == 0u"),
    (
        "shared/cells",
        "select(at_high, at_low, upper_is_near) * #{PAD_EXIT}",
        "select(at_high, at_low, upper_is_near)",
    ),
    (
        "shared/cells",
        "select(at_low, at_high, upper_is_near) * #{PAD_ENTRY}",
        "select(at_low, at_high, upper_is_near)",
    ),
    ("shared/cells", "(split - ray.origin_low[node.axis])", "(split - ray.origin_high[node.axis])"),
    ("shared/cells", "(split - ray.origin_high[node.axis])", "(split - ray.origin_low[node.axis])"),
    ("shared/cells", "min(cell.exit, crossing.near_exit)", "crossing.near_exit"),
    ("shared/cells", "max(cell.entry, crossing.far_entry)", "crossing.far_entry"),
    ("shared/kd_tree", "+ reference / 4u][reference % 4u]", "+ reference / 4u][reference % 2u]"),
    ("shared/kd_tree", "vec3<u32>(second.y, third)", "vec3<u32>(second.y, third.yx)"),
    ("shared/kd_leaf", "first + i", "first"),
    ("shared/kd_leaf", "probe_leaf_visit();", ""),
    ("shared/kd_leaf", "probe_primitive_test();", ""),
    ("walk/walk_kd_stack", "probe_inner_visit();", ""),
    ("walk/walk_kd_stack", "probe_stack_depth(entries);", ""),
    ("walk/walk_kd_stack", "stack[entries].entry <=", "stack[entries].entry <"),
    (
        "walk/walk_kd_stack",
        "Postponed(crossing.far, far.entry, far.exit)",
        "Postponed(crossing.far, near.entry, far.exit)",
    ),
    ("walk/walk_kd_stack", "min(stack[entries].exit, (*collect).t_max)", "stack[entries].exit"),
];
const TRAIL: &[Damage] = &[
    ("shared/kd_trail", "go_far = is_near_done(&trail);", "go_far = false;"),
    ("shared/kd_trail", "set_single(&trail);", ""),
    ("shared/kd_trail", "probe_restart();", ""),
    ("shared/kd_trail", "if far.entry <= (*collect).t_max {", "if far.entry < (*collect).t_max {"),
    (
        "shared/kd_trail",
        "Interval(far.entry, min(far.exit, (*collect).t_max))",
        "Interval(far.entry, far.exit)",
    ),
    (
        "shared/kd_trail",
        "probe_stack_depth(push_short(&stack, Postponed(crossing.far, far.entry, far.exit)));",
        "push_short(&stack, Postponed(crossing.far, far.entry, far.exit));",
    ),
];
/// What all walks that go by `t` alone build on.
const CERTAIN: &[Damage] = &[
    ("shared/kd_certain", "a * #{KD_BAND} < b", "a < b"),
    ("shared/kd_certain", "if crossing.near_exit < cell.entry {", "if false {"),
    ("shared/kd_certain", "if crossing.far_entry > cell.exit {", "if false {"),
    ("shared/kd_certain", "return FORK_UNDECIDED;", "return FORK_BOTH;"),
    ("shared/kd_certain", "probe_restart();", ""),
];
const RESTART: &[Damage] = &[
    ("walk/walk_kd_restart", "crossing.near_exit <= done", "crossing.near_exit < done"),
    ("walk/walk_kd_restart", "cell.entry > (*collect).t_max ||", ""),
    ("walk/walk_kd_restart", "done >= whole.exit || ", ""),
    ("walk/walk_kd_restart", "|| is_behind(done, (*collect).t_max)", ""),
    ("walk/walk_kd_restart", "both && !go_far", "false"),
    ("walk/walk_kd_restart", "        cell = whole;", ""),
];
const BACKTRACK: &[Damage] = &[
    ("walk/walk_kd_backtrack", "crossing.near_exit <= done", "crossing.near_exit < done"),
    ("walk/walk_kd_backtrack", "up = cell.exit <= done;", "up = cell.exit < done;"),
    ("walk/walk_kd_backtrack", "current = place.parent;", "current = 0u;"),
    ("walk/walk_kd_backtrack", "current = load_kd_place(current).parent;", "current = 0u;"),
    ("shared/kd_places", "+ 4u * node", "+ 2u * node"),
];
const SHORT: &[Damage] = &[
    ("walk/walk_kd_short_stack", "crossing.near_exit <= done", "crossing.near_exit < done"),
    ("walk/walk_kd_short_stack", "is_base = false;", ""),
    ("walk/walk_kd_short_stack", "        is_base = true;", ""),
    ("walk/walk_kd_short_stack", "cell = Interval(far.entry, far.exit);", "cell = whole;"),
    ("walk/walk_kd_short_stack", "if is_base {", "if false {"),
];
const ROPES: &[Damage] = &[
    ("walk/walk_kd_ropes", "var at = whole.entry;", "var at = seeker.t_min;"),
    ("walk/walk_kd_ropes", "is_behind(exit, entry)", "true"),
    ("walk/walk_kd_ropes", "is_behind(entry, earlier)", "true"),
    ("walk/walk_kd_ropes", "is_behind(later, exit)", "true"),
    ("walk/walk_kd_ropes", "u32(ray.inverse[#{AXIS}] >= 0.0)", "1u"),
    ("walk/walk_kd_ropes", "faces.entry > (*collect).t_max ||", ""),
    ("walk/walk_kd_ropes", "|| is_behind(at, (*collect).t_max)", ""),
    ("shared/kd_places", "+ 3u * leaf + face / 2u", "+ 3u * leaf"),
    ("shared/kd_places", "kd_words[kd_words[3].y", "kd_words[kd_words[3].x"),
];

fn cases() -> Vec<Case> {
    few(kd_trees::every(), &["shallow soup", "lattice", "instances", "deep chain", "comb of depth 31"])
}

#[test]
fn broken_walks_of_kd_trees_are_noticed() {
    notice("stack", Query::Closest, &cases(), STACK);
    notice("restart-trail:short-stack=2", Query::Closest, &cases(), TRAIL);
}

#[test]
fn broken_walks_by_t_alone_are_noticed() {
    notice("kd-restart", Query::Closest, &cases(), &[CERTAIN, RESTART].concat());
    notice("kd-backtrack", Query::Closest, &cases(), BACKTRACK);
    notice("short-stack:entries=2", Query::Closest, &cases(), SHORT);
    notice("ropes", Query::Closest, &cases(), ROPES);
}
