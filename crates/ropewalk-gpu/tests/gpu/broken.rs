//! Shaders that are broken on purpose: the twin test must notice each of them, or it proves nothing.

use crate::compare::compare;
use crate::machine::on_every_adapter;
use crate::{rays, scenes};
use ropewalk::bvh::StackOrder;
use ropewalk::{Query, TraceOptions, Walk};
use ropewalk_gpu::shader::ShaderLibrary;
use ropewalk_gpu::{Tracer, TracerOptions};

/// A file, what stands in it, and what is put there instead.
type Damage = (&'static str, &'static str, &'static str);

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
    ("shared/triangle", "plane.y == 0.0 || magnitude_bits(depth) >= 0x7f800000u", "true"),
    ("shared/triangle", "depth = (u * a.z", "depth = (v * a.z"),
    ("shared/triangle", "== ray.forward", "== true"),
    ("shared/triangle", "!= mirrored", "!= false"),
    ("shared/triangle", "& ~#{MIRROR}", ""),
    ("shared/triangle", "& 0x00ffffffu", ""),
    ("shared/leaf", "first + i", "first"),
    ("shared/leaf", "probe_leaf_visit();", ""),
    ("shared/leaf", "probe_primitive_test();", ""),
    ("kernel/batch", "var status = STATUS_INVALID_RAY", "var status = STATUS_COMPLETE"),
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

#[test]
fn broken_shared_parts_are_noticed() {
    notice(StackOrder::Ordered, SHARED);
}

#[test]
fn broken_walks_are_noticed() {
    notice(StackOrder::Ordered, ORDERED);
    notice(StackOrder::Sorted, SORTED);
}

fn notice(order: StackOrder, damages: &[Damage]) {
    let walk = Walk::Stack(order);
    let options = TraceOptions { counters: true };
    let cases: Vec<_> = scenes::every()
        .into_iter()
        .map(|case| {
            let rays = rays::against(&case.structure);
            let cpu = case.structure.trace(walk, Query::Closest, &rays, options).unwrap();
            (case, rays, cpu)
        })
        .collect();
    on_every_adapter(|machine| {
        // Elsewhere rounding hides small damage, and the comparison is a looser one.
        if !machine.is_exact() {
            return;
        }
        let uploaded: Vec<_> =
            cases.iter().map(|(case, ..)| machine.trusted.upload(&case.structure).unwrap()).collect();
        let mut unnoticed = Vec::new();
        for &(file, sound, broken) in damages {
            let library = ShaderLibrary::shipped();
            let text = library.text(file).unwrap();
            assert!(text.contains(sound), "'{sound}' stands no longer in {file}");
            let text = text.replace(sound, broken);
            // One stack size for all scenes, so that each damage is compiled once.
            let mut how = TracerOptions::default();
            how.stack_entries = Some(64);
            let tracer = Tracer::with_library(machine.gpu().clone(), how, library.with(file, text));
            let noticed = cases.iter().zip(&uploaded).any(|((_, rays, cpu), uploaded)| {
                match tracer.trace(uploaded, walk, Query::Closest, rays, options) {
                    Ok(gpu) => compare(cpu, &gpu.traced, true).is_err(),
                    Err(error) => panic!("{file}: '{broken}' does not run: {error}"),
                }
            });
            if !noticed {
                unnoticed.push(format!("{file}: '{broken}' for '{sound}'"));
            }
        }
        assert!(unnoticed.is_empty(), "not noticed:\n{}", unnoticed.join("\n"));
    });
}
