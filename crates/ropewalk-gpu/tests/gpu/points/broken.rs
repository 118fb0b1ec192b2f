//! Shaders that are broken on purpose: the twin tests must notice each of them, or they prove nothing.

use super::compare::{Agreement, compare_closest, compare_nearest};
use super::{COUNTED, asked, bvh};
use crate::damage::{Damage, notice_each};
use crate::machine::Machine;
use crate::{scenes, trees};
use ropewalk::bvh::Node;
use ropewalk::{Bvh, FlatTriangle, Structure, Walk};
use ropewalk_gpu::GpuStructure;

const SHARED: &[Damage] = &[
    ("shared/point_query", "all(size <= vec3<u32>(", "all(size < vec3<u32>("),
    ("shared/point_query", "all(size <= vec3<u32>(#{LARGEST_POINT_BITS}))", "true"),
    ("shared/point_query", "radius <= 0x7f800000u", "radius < 0x7f800000u"),
    ("shared/point_query", "radius <= 0x7f800000u", "radius <= 0x7fffffffu"),
    ("shared/point_query", " || radius == 0x80000000u", ""),
    ("shared/point_query", "query.mask << 24u", "0xff000000u"),
    ("shared/point_distance", "max(low - point, point - high)", "low - point"),
    ("shared/point_distance", "max(low - point, point - high)", "point - high"),
    ("shared/point_distance", " * #{PAD_EXIT}", ""),
    ("shared/point_distance", "min(distance, 1e19)", "min(distance, 1e3)"),
    ("shared/point_distance", "farthest.z)) * share", "farthest.z)) * 0.0"),
    ("shared/point_distance", "farthest.z)) * share", "farthest.z)) * share * 2.0"),
    ("shared/point_foot", "other.square < one.square", "other.square > one.square"),
    ("shared/point_foot", "weight > 0.0 && weight < 1.0", "weight > 0.0"),
    ("shared/point_foot", "weight > 0.0 && weight < 1.0", "weight < 1.0"),
    ("shared/point_foot", "(0.0, weight), backwards)", "(weight, 0.0), backwards)"),
    (
        "shared/point_foot",
        "square_0 <= square_1 && square_0 <= square_2",
        "square_0 < square_1 && square_0 <= square_2",
    ),
    ("shared/point_foot", "else if square_1 <= square_2", "else if square_1 < square_2"),
    ("shared/point_foot", "length_0 >= length_1 && length_0 >= length_2", "true"),
    ("shared/point_foot", "else if length_1 >= length_2", "else if length_1 < length_2"),
    ("shared/point_foot", "let along = first + more", "let along = first"),
    ("shared/point_foot", "corner * -scale", "corner * scale"),
    ("shared/point_foot", "bitcast<f32>(0x7f000000u - (bitcast<u32>(extent) & 0x7f800000u))", "1.0"),
    ("shared/point_foot", "along.y > 0.0 && along.x + along.y < 1.0", "along.y > 0.0"),
    ("shared/point_foot", "1.0 - (foot.along.x + foot.along.y)", "1.0 - foot.along.y - foot.along.x"),
    ("shared/point_foot", "vec2<f32>(rest, foot.along.x)", "vec2<f32>(foot.along.x, rest)"),
    ("shared/point_triangle", "box_square > limit", "box_square >= limit"),
    ("shared/point_triangle", "return *square <= limit", "return *square < limit"),
    ("shared/point_triangle", "without_negative_zero(position.x)", "position.x"),
    ("shared/point_triangle", "(triangle.instance_and_mask & query.mask) == 0u", "false"),
    ("shared/point_triangle", " & ~#{MIRROR}", ""),
    ("shared/point_triangle", " & 0x00ffffffu", ""),
    ("shared/point_order", "id_a.x < id_b.x", "id_a.x > id_b.x"),
    ("shared/point_order", "id_a.y < id_b.y", "id_a.y > id_b.y"),
    ("shared/point_order", "id_a.z < id_b.z", "id_a.z > id_b.z"),
    ("shared/point_order", " & 0x00ffffffu", ""),
    ("shared/point_closest", "found.distance > (*collect).radius", "found.distance >= (*collect).radius"),
    ("shared/point_closest", "found.distance > (*collect).radius", "false"),
    ("shared/point_closest", "!is_preferred(found, (*collect).closest)", "false"),
    ("shared/point_closest", "found.distance + (*collect).slack", "found.distance"),
    ("shared/point_nearest", "found.distance > (*collect).limit", "found.distance >= (*collect).limit"),
    ("shared/point_nearest", "place > 0u && !is_preferred(", "false && !is_preferred("),
    ("shared/point_nearest", "(*collect).held < (*collect).room", "(*collect).held + 1u < (*collect).room"),
    ("shared/point_nearest", "(*collect).limit + (*collect).slack", "(*collect).limit"),
    ("shared/point_nearest", "(*collect).room - 1u].distance", "0u].distance"),
    ("shared/point_nearest", "[moved] = (*collect).nearest[moved - 1u]", "[moved] = found"),
    ("shared/point_leaf", "first + i), query", "first), query"),
    ("shared/point_leaf", "sqrt(square), first + i", "sqrt(square), first"),
    ("shared/point_leaf", "probe_leaf_visit();", ""),
    ("shared/point_leaf", "probe_primitive_test();", ""),
    ("shared/seek_point", "high), limit)", "high), 0.0)"),
    ("shared/seek_point", "return (*collect).reach", "return #{LARGEST_FLOAT}"),
    ("kernel/points", "var status = STATUS_INVALID_RAY", "var status = STATUS_COMPLETE"),
    ("kernel/points", "batch.slack_share > 0.0", "false"),
];

const STACK: &[Damage] = &[
    ("walk/walk_bvh_stack", "stack[entries].entry <=", "stack[entries].entry <"),
    ("walk/walk_bvh_stack", "b.entry < a.entry", "b.entry <= a.entry"),
    ("walk/walk_bvh_stack", "b.entry < a.entry", "b.entry > a.entry"),
    ("walk/walk_bvh_stack", "let hit_a = is_hit(a);", "let hit_a = a.entry < a.exit;"),
    ("walk/walk_bvh_stack", "let hit_b = is_hit(b);", "let hit_b = b.entry < b.exit;"),
    ("walk/walk_bvh_stack", "select(b.entry, a.entry, go_second)", "select(a.entry, b.entry, go_second)"),
    ("walk/walk_bvh_stack", "probe_inner_visit();", ""),
    ("walk/walk_bvh_stack", "probe_stack_depth(entries);", "probe_stack_depth(entries + 1u);"),
];

const TRAIL: &[Damage] = &[
    ("walk/walk_bvh_restart_trail", "far.entry <= limit_of(collect)", "far.entry < limit_of(collect)"),
    ("walk/walk_bvh_restart_trail", "far.entry <= limit_of(collect)", "true"),
    ("walk/walk_bvh_restart_trail", "let hit_a = is_hit(a);", "let hit_a = a.entry < a.exit;"),
    ("walk/walk_bvh_restart_trail", "let hit_b = is_hit(b);", "let hit_b = b.entry < b.exit;"),
    ("walk/walk_bvh_restart_trail", "else if is_far_level(&trail)", "else if false"),
    ("walk/walk_bvh_restart_trail", "set_single(&trail);", ""),
    ("walk/walk_bvh_restart_trail", "if !near_done {", "if true {"),
    ("walk/walk_bvh_restart_trail", "second_is_near != near_done", "second_is_near"),
    ("walk/walk_bvh_restart_trail", "select(first, second, go_second)", "first"),
    ("walk/walk_bvh_restart_trail", "probe_restart();", ""),
    ("walk/walk_bvh_restart_trail", "probe_inner_visit();", ""),
];

#[test]
fn broken_parts_are_noticed() {
    notice("stack", &[SHARED, STACK].concat());
}

#[test]
fn broken_trails_are_noticed() {
    notice("restart-trail:short-stack=2,register=array", TRAIL);
}

/// A triangle with a corner of negative zeros, which no builder leaves as they are.
fn zeros() -> scenes::Case {
    let triangle = FlatTriangle {
        v0: [-0.0; 3],
        primitive: 0,
        v1: [-1.0, -0.5, -0.25],
        geometry_and_mirror: 0,
        v2: [-0.25, -1.0, -0.5],
        instance_and_mask: 0xff00_0000,
    };
    let nodes = vec![Node::leaf(&triangle.triangle().bounds(), 0, 1)];
    let bvh = Bvh::from_parts(nodes, vec![triangle]).unwrap();
    scenes::Case { name: "negative zeros", structure: Structure::Bvh(bvh) }
}

/// Asks the cases with the sound shaders and with each damage.
fn notice(walk: &str, damages: &[Damage]) {
    let what = walk;
    let walk: Walk = walk.parse().unwrap();
    let cases: Vec<_> = trees::split()
        .into_iter()
        .chain(trees::chains())
        .chain(scenes::every())
        .chain([zeros()])
        .map(asked)
        .map(|(case, queries)| {
            let bvh = bvh(&case.structure);
            let closest = bvh.closest_points(walk, &queries, COUNTED).unwrap();
            let nearest = bvh.nearest_points(walk, 5, &queries, COUNTED).unwrap();
            (case, queries, closest, nearest)
        })
        .collect();
    let upload = |machine: &Machine| -> Vec<GpuStructure> {
        cases.iter().map(|(case, ..)| machine.trusted.upload(&case.structure).unwrap()).collect()
    };
    notice_each(what, 64, damages, upload, |tracer, uploaded| {
        cases.iter().zip(uploaded).find_map(|((case, queries, closest, nearest), uploaded)| {
            let gpu = tracer.closest_points(uploaded, walk, queries, COUNTED).unwrap().answers;
            let same = compare_closest(queries, closest, &gpu, Agreement::Exact).and_then(|()| {
                let gpu = tracer.nearest_points(uploaded, walk, 5, queries, COUNTED).unwrap().answers;
                compare_nearest(queries, nearest, &gpu, Agreement::Exact)
            });
            same.err().map(|what| format!("{}: {what}", case.name))
        })
    });
}
