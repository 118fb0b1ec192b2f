//! Shaders that are broken on purpose: the twin test must notice each of them, or it proves nothing.

use crate::compare::compare;
use crate::damage::{Damage, notice_each};
use crate::machine::Machine;
use crate::scenes::{self, Case};
use crate::trails::cpu_twin;
use crate::{rays, trees};
use ropewalk::wide_bvh::Width;
use ropewalk::{Query, TraceOptions, Walk};
use ropewalk_gpu::{GpuError, GpuStructure};

const SHARED: &[Damage] = &[
    ("shared/hit", "return a.instance < b.instance", "return a.instance > b.instance"),
    ("shared/hit", "return a.geometry < b.geometry", "return a.geometry > b.geometry"),
    ("shared/hit", "return a.primitive < b.primitive", "return a.primitive > b.primitive"),
    ("shared/aabb", "near * #{PAD_ENTRY}", "near"),
    ("shared/aabb", "far * #{PAD_EXIT}", "far"),
    ("shared/aabb", "entry <= interval.exit", "entry < interval.exit"),
    ("shared/aabb", "max(span.entry, ray.t_min)", "span.entry"),
    ("shared/ray", "select(ray.origin, above, parallel)", "ray.origin"),
    ("shared/ray", "select(ray.origin, below, parallel)", "ray.origin"),
    ("shared/ray", "size.x >= size.y", "size.x > size.y"),
    ("shared/ray", "else if size.y >= size.z", "else if size.y > size.z"),
    ("shared/ray", "size <= vec3", "size < 0.0 * vec3"),
    ("shared/ray", "largest >= #{SMALLEST_DIRECTION_BITS}", "largest > 0u"),
    ("shared/ray", "largest <= #{LARGEST_DIRECTION_BITS}", "largest < 0x7f800000u"),
    ("shared/ray", "is_finite(ray.origin)", "true"),
    ("shared/ray", "|| t_min == 0x80000000u", "|| t_min == 1u"),
    ("shared/ray", "&& !is_nan(ray.t_max)", ""),
    ("shared/ray", "ray.mask << 24u", "0xff000000u"),
    ("shared/ray", "max(ray.origin + outwards, next_above)", "next_above"),
    ("shared/ray", "max(ray.origin + outwards, next_above)", "ray.origin + outwards"),
    ("shared/ray", "min(ray.origin - outwards, next_below)", "next_below"),
    ("shared/ray", "min(ray.origin - outwards, next_below)", "ray.origin - outwards"),
    ("shared/ray", "min(ray.t_max, #{LARGEST_FLOAT})", "min(ray.t_max, 1e12)"),
    ("shared/triangle", "0.0 - cross", "cross"),
    ("shared/triangle", "t < ray.t_min ||", "t <= ray.t_min ||"),
    ("shared/triangle", "|| t > t_max", "|| t >= t_max"),
    ("shared/triangle", "max(depth * ray.shear.z, span.entry)", "(depth * ray.shear.z)"),
    ("shared/triangle", "span.entry), span.exit)", "span.entry), t_max)"),
    ("shared/triangle", "ab_length >= bc_length && ab_length >= ca_length", "true"),
    ("shared/triangle", "slope == 0.0 || magnitude_bits(depth) >= 0x7f800000u", "true"),
    ("shared/triangle", "depth = (u * a.z", "depth = (v * a.z"),
    ("shared/triangle", "== ray.forward", "== true"),
    ("shared/triangle", "!= mirrored", "!= false"),
    ("shared/triangle", "& ~#{MIRROR}", ""),
    ("shared/triangle", "& 0x00ffffffu", ""),
    ("shared/leaf", "first + i", "first"),
    ("shared/leaf", "probe_leaf_visit();", ""),
    ("shared/leaf", "probe_primitive_test();", ""),
    ("shared/seek_ray", "return (*collect).t_max", "return #{LARGEST_FLOAT}"),
    ("kernel/rays", "var status = STATUS_INVALID_RAY", "var status = STATUS_COMPLETE"),
];

const ORDERED: &[Damage] = &[
    ("walk/walk_bvh_stack", "b.entry < a.entry", "b.entry <= a.entry"),
    ("walk/walk_bvh_stack", "stack[entries].entry <=", "stack[entries].entry <"),
    ("walk/walk_bvh_stack", "select(b.entry, a.entry, go_second)", "a.entry"),
    ("walk/walk_bvh_stack", "probe_inner_visit();", ""),
    ("walk/walk_bvh_stack", "probe_stack_depth(entries);", "probe_stack_depth(entries + 1u);"),
    ("walk/walk_bvh_stack", "select(first, second, go_second)", "first"),
];

const SORTED: &[Damage] = &[
    ("walk/walk_bvh_postponed", "second_entry < first_entry", "second_entry <= first_entry"),
    ("walk/walk_bvh_postponed", "return entry <= t_max", "return true"),
    ("walk/walk_bvh_postponed", "return entry <= t_max", "return entry < t_max"),
    ("walk/walk_bvh_postponed", "    return t_max;", "    return ray.t_max;"),
    (
        "walk/walk_bvh_postponed",
        "stack[entries] = select(second, first, go_second)",
        "stack[entries] = second",
    ),
];

/// Of every query: what is collected, and where it is written.
const CLOSEST: &[Damage] = &[
    ("shared/collect_closest", "if precedes(hit, (*collect).hit)", "if true"),
    ("shared/collect_closest", "(*collect).t_max = hit.t;", ""),
    ("kernel/result_closest", "u32(hit.front_face)", "1u"),
    ("kernel/result_closest", "counters.primitive_tests, counters.restarts", "counters.primitive_tests, 7u"),
];
const ANY: &[Damage] = &[
    ("shared/collect_any", "(*collect).found = true;", ""),
    ("shared/collect_any", "return true;", "return false;"),
];
const COUNT: &[Damage] = &[
    ("shared/collect_count", "+= 1u", "= 1u"),
    ("shared/collect_count", "return false;", "return true;"),
    ("kernel/result_word", "counters.stack_depth", "counters.inner_visits"),
];
const ALL: &[Damage] = &[
    ("shared/collect_all", "(*collect).first + (*collect).found", "(*collect).first"),
    ("shared/collect_all", "(*collect).first + (*collect).found", "(*collect).found"),
    ("shared/collect_all", "(*collect).found < (*collect).room", "(*collect).found + 1u < (*collect).room"),
    ("kernel/result_all", "2u * place", "1u * place"),
    ("kernel/result_header", "const HEADER: u32 = 2u;", "const HEADER: u32 = 1u;"),
    ("kernel/result_all", "hit.geometry, hit.instance", "hit.instance, hit.geometry"),
    ("kernel/rays", "collect.first = records[#{RAY_WORDS}u * index + 9u]", "collect.first = 0u"),
];

/// The newest entry of a full stack is dropped instead of the oldest.
const DROP_NEWEST: Damage = (
    "shared/short_stack_ring",
    "keep_entry(stack, place, entry);",
    "if (*stack).held == #{SHORT_STACK_ENTRIES}u { return (*stack).held; } keep_entry(stack, place, entry);",
);

/// The restart trail, with a stack of 2 in 32 bits. The printed formula never ends: the budget does it.
const TRAIL: &[Damage] = &[
    ("shared/trail_u32", "& (0u - level)", "& ~level"),
    ("shared/trail_u32", "return ((*trail).far & (*trail).level) != 0u;", "return false;"),
    ("shared/trail_u32", "bits & (0u - bits)", "0x80000000u"),
    ("shared/trail_u32", "(*trail).bits |= (*trail).level;", ""),
    // The lowest bit as it is printed, which misses bit 0: only a tree of the full depth shows it.
    (
        "shared/trail_u32",
        "let next = bits & (0u - bits);",
        "let next = (((bits >> 1u) - 1u) ^ (bits >> 1u)) + 1u;",
    ),
    ("walk/walk_bvh_restart_trail", "b.entry < a.entry", "b.entry <= a.entry"),
    ("walk/walk_bvh_restart_trail", "far.entry <=", "far.entry <"),
    ("walk/walk_bvh_restart_trail", "second_is_near != near_done", "second_is_near"),
    ("walk/walk_bvh_restart_trail", "} else if is_far_level(&trail) {", "} else if false {"),
    ("walk/walk_bvh_restart_trail", "set_single(&trail);", ""),
    ("walk/walk_bvh_restart_trail", "probe_restart();", ""),
    ("walk/walk_bvh_restart_trail", "probe_stack_depth(push_short(&stack, far))", "push_short(&stack, far)"),
    ("walk/walk_bvh_restart_trail", "select(b.entry, a.entry, second_is_near)", "a.entry"),
    // The trail is not told of entries that are culled.
    (
        "walk/walk_bvh_restart_trail",
        "if far.entry <= limit_of(collect) {",
        "while far.entry > limit_of(collect) && pop_short(&stack, &far) {} if far.entry <= limit_of(collect) {",
    ),
    DROP_NEWEST,
    ("shared/short_stack_ring", "place == #{SHORT_STACK_ENTRIES}u - 1u", "place == 0u"),
    ("shared/short_stack_ring", "(*stack).held -= 1u;", "(*stack).held = 0u;"),
    ("shared/short_stack_ring", "(*stack).next = place;", ""),
];
const TRAIL_U64: &[Damage] = &[
    ("shared/trail_u64", "& negated(level)", "& ~level"),
    ("shared/trail_u64", "u32(number.y == 0u)", "0u"),
    ("shared/trail_u64", "u32(low < a.y)", "0u"),
    ("shared/trail_u64", "| (level.x << 31u)", ""),
    ("shared/trail_u64", "any(((*trail).far & (*trail).level) != vec2<u32>(0u))", "false"),
    ("shared/trail_u64", "vec2<u32>(level.x >> 1u,", "vec2<u32>(level.x,"),
];
const TRAIL_ARRAY: &[Damage] = &[
    ("shared/trail_array", "(*trail).bits[word] = 0u;", ""),
    ("shared/trail_array", "(*trail).bits[level / 32u] & (bit - 1u)", "(*trail).bits[level / 32u]"),
    ("shared/trail_array", "((*trail).far[level / 32u] & (bit - 1u)) | bit", "0u"),
    ("shared/trail_array", "level / 32u + 1u; word < 3u", "level / 32u + 2u; word < 3u"),
    ("shared/trail_array", "return level > 0u;", "return level > 1u;"),
];
const WORKGROUP: &[Damage] = &[
    (
        "shared/short_stack_workgroup",
        "place * #{WORKGROUP_SIZE}u + local_index] = entry",
        "local_index] = entry",
    ),
    ("kernel/frame", "local_index = invocation;", ""),
    DROP_NEWEST,
];

const WIDE: &[Damage] = &[
    ("shared/wide_bvh", "#{OTHER}u < #{SLOT}u)", "#{SLOT}u < #{OTHER}u)"),
    ("shared/wide_bvh", "entry_#{OTHER} <= entry_#{SLOT}, ", "entry_#{OTHER} < entry_#{SLOT}, "),
    ("shared/wide_bvh", "&& (child_#{SLOT}.count | child_#{SLOT}.link) != 0u", ""),
    ("shared/wide_bvh", "select(#{LARGEST_FLOAT}, span_#{SLOT}.entry, hit_#{SLOT})", "span_#{SLOT}.entry"),
    ("walk/walk_wide_bvh_stack", "stack[entries].entry <=", "stack[entries].entry <"),
    ("walk/walk_wide_bvh_stack", "stack[entries] = sorted[i];", "stack[entries] = sorted[1];"),
    ("walk/walk_wide_bvh_stack", "probe_inner_visit();", ""),
    ("walk/walk_wide_bvh_stack", "probe_stack_depth(entries);", ""),
];
const WIDE_TRAIL: &[Damage] = &[
    ("walk/walk_wide_bvh_restart_trail", "next.entry <=", "next.entry <"),
    ("walk/walk_wide_bvh_restart_trail", "sorted[last].node |= LAST_SIBLING;", ""),
    ("walk/walk_wide_bvh_restart_trail", "if finished == last {", "if false {"),
    ("walk/walk_wide_bvh_restart_trail", "set_last(&trail, level - 1u);", ""),
    ("walk/walk_wide_bvh_restart_trail", "probe_restart();", ""),
    ("walk/walk_wide_bvh_restart_trail", "i > finished", "i > finished + 1u"),
    (
        "walk/walk_wide_bvh_restart_trail",
        "if next.entry <= (*collect).t_max {",
        "while next.entry > (*collect).t_max && pop_short(&stack, &next) {} if next.entry <= (*collect).t_max {",
    ),
    // The register of the default: two words.
    ("shared/wide_trail_u64", "(bits.x & up_to(ancestor))", "bits.x"),
    ("shared/wide_trail_u64", "(bits.y & up_to(ancestor))", "bits.y"),
    ("shared/wide_trail_u64", "(1u << (4u * ancestor)), 0u)", "(1u << (4u * ancestor)), bits.y)"),
    ("shared/wide_trail_u64", "ancestor + 9u", "ancestor + 8u"),
    ("shared/wide_trail_u64", "& up_to(parent - 8u)", ""),
    ("shared/wide_trail_u64", "& up_to(min(parent, 7u))", ""),
    ("shared/wide_trail_u64", "& 7u", "& 3u"),
];
const WIDE_TRAIL_ARRAY: &[Damage] = &[
    ("shared/wide_trail_array", "(*trail).bits[below] = 0u;", ""),
    ("shared/wide_trail_array", "& up_to(ancestor))", ")"),
    ("shared/wide_trail_array", "& up_to(parent % 8u)", ""),
    ("shared/wide_trail_array", "level / 8u] >>", "0u] >>"),
    ("shared/wide_trail_array", "8u * word + ancestor + 1u", "8u * word + ancestor"),
];

#[test]
fn broken_shared_parts_are_noticed() {
    notice("stack", Query::Closest, &usual(), &[SHARED, CLOSEST].concat());
}

#[test]
fn broken_walks_are_noticed() {
    notice("stack", Query::Closest, &usual(), ORDERED);
    notice("stack:order=sorted", Query::Closest, &usual(), SORTED);
}

#[test]
fn broken_collectors_are_noticed() {
    let cases = || few(usual(), &["soup, leaves of 8", "instances", "coplanar duplicates"]);
    notice("stack", Query::Any, &cases(), ANY);
    notice("stack", Query::Count, &cases(), COUNT);
    notice("stack", Query::All, &cases(), ALL);
}

#[test]
fn broken_trails_are_noticed() {
    let cases = || {
        let cases = usual().into_iter().chain(trees::chains()).collect();
        few(cases, &["soup, leaves of 1", "lattice", "coplanar duplicates", "chain of depth 31"])
    };
    let deep = || few(trees::chains(), &["chain of depth 63", "two chains of depth 63"]);
    notice("restart-trail:short-stack=2,register=u32", Query::Closest, &cases(), TRAIL);
    notice("restart-trail:short-stack=2,register=u64", Query::Closest, &deep(), TRAIL_U64);
    notice("restart-trail:short-stack=2,register=array", Query::Closest, &deep(), TRAIL_ARRAY);
    notice("restart-trail:short-stack=2,memory=workgroup", Query::Closest, &cases(), WORKGROUP);
}

#[test]
fn broken_walks_of_wide_trees_are_noticed() {
    let cases = || {
        few(
            trees::wide(Width::Eight),
            &[
                "soup",
                "lattice",
                "wide chain of 16 levels, parted early",
                "wide chain of 16 levels, parted late",
            ],
        )
    };
    let deep =
        || few(trees::wide(Width::Eight), &["wide chain of 17 levels, parted", "wide chain of 64 levels"]);
    notice("stack", Query::Closest, &cases(), WIDE);
    notice("restart-trail:short-stack=2", Query::Closest, &cases(), WIDE_TRAIL);
    notice("restart-trail:short-stack=2", Query::Closest, &deep(), WIDE_TRAIL_ARRAY);
}

fn usual() -> Vec<Case> {
    scenes::every()
}

/// The cases of these names.
pub(crate) fn few(cases: Vec<Case>, names: &[&str]) -> Vec<Case> {
    let cases: Vec<Case> = cases.into_iter().filter(|case| names.contains(&case.name)).collect();
    assert_eq!(cases.len(), names.len());
    cases
}

/// Traces the cases with the sound shaders and with each damage.
pub(crate) fn notice(walk: &str, query: Query, cases: &[Case], damages: &[Damage]) {
    let what = format!("{walk} {query}");
    let walk: Walk = walk.parse().unwrap();
    let options = TraceOptions { counters: true };
    let asked: Vec<_> = cases
        .iter()
        .map(|case| {
            let rays = rays::against(&case.structure);
            let cpu = case.structure.trace(cpu_twin(walk), query, &rays, options).unwrap();
            (case, rays, cpu)
        })
        .collect();
    let upload = |machine: &Machine| -> Vec<GpuStructure> {
        cases.iter().map(|case| machine.trusted.upload(&case.structure).unwrap()).collect()
    };
    notice_each(&what, 128, damages, upload, |tracer, uploaded| {
        asked.iter().zip(uploaded).find_map(|((case, rays, cpu), uploaded)| {
            match tracer.trace(uploaded, walk, query, rays, options) {
                Ok(gpu) => compare(cpu, &gpu.traced, true).err().map(|what| format!("{}: {what}", case.name)),
                // Hits that are written to another's place leave places without a word.
                Err(GpuError::Unanswered { ray }) => Some(format!("{}: ray {ray} has no answer", case.name)),
                Err(error) => panic!("{error}"),
            }
        })
    });
}
