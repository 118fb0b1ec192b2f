//! Shaders of lists that are broken on purpose.

use crate::broken::{few, notice};
use crate::damage::Damage;
use crate::lists;
use ropewalk::Query;
use ropewalk::traversal_list::Bounds;

const LIST: &[Damage] = &[
    ("walk/walk_list", "probe_inner_visit();", ""),
    ("walk/walk_list", "probe_primitive_test();", ""),
    ("walk/walk_list", "next = 1;", ""),
    ("walk/walk_list", "place + u32(next)", "place + 1u"),
    // The last triangle has the index 0, and a missed node with nothing behind it -1.
    ("walk/walk_list", "next > 0", "next >= 0"),
    ("walk/walk_list", "next > 0", "next != 0"),
    (
        "walk/walk_list",
        "                if offer(collect, hit) {",
        "                if !offer(collect, hit) {",
    ),
    ("shared/list", "bitcast<u32>(element.escape) <= 1u", "element.escape == 1"),
    ("shared/list", "bitcast<u32>(element.escape) <= 1u", "element.escape <= 1"),
    ("shared/list", "list_word(2) + 3u * payload.w", "list_word(2)"),
    ("shared/list", "load_vertex(payload.y)", "load_vertex(payload.z)"),
    ("shared/list", "shared_word(identity + 2u)", "shared_word(identity + 1u)"),
];
/// The choice of a list, which changes what is visited, and where something is culled what is hit.
const LIST_OF_TWO: &[Damage] = &[("shared/list", "return negative.x;", "return 0u;")];
const LIST_OF_SIX: &[Damage] =
    &[("shared/list", "2u * ray.kz", "ray.kz"), ("shared/list", "u32(!ray.forward)", "u32(ray.forward)")];
const LIST_OF_EIGHT: &[Damage] = &[
    ("shared/list", "negative.x | (negative.y << 1u)", "negative.y | (negative.x << 1u)"),
    ("shared/list", "negative.z << 2u", "0u"),
    ("shared/list", "ray.inverse < vec3", "ray.inverse > vec3"),
];
const SPHERE: &[Damage] = &[
    ("shared/sphere", "#{SPHERE_PAD} *", "0.0 *"),
    ("shared/sphere", "let radius = sphere.w + pad;", "let radius = sphere.w;"),
    ("shared/sphere", "/ sqrt(square) + pad", "/ sqrt(square)"),
    ("shared/sphere", " / sqrt(square)", ""),
    ("shared/sphere", "dot(offset, along) / square", "dot(offset, along)"),
    ("shared/sphere", "select(b, a, ray.forward)", "a"),
    ("shared/sphere", "select(a, b, ray.forward)", "b"),
    ("shared/sphere", "select(limit, exit, exit < limit)", "exit"),
    // The smallest positive root, which of a sphere that the ray starts in is the exit.
    (
        "shared/sphere",
        "select(ray.t_min, entry, entry > ray.t_min)",
        "select(exit, entry, entry > ray.t_min)",
    ),
    ("shared/sphere", "permute(sphere.xyz - ray.origin, ray.kz)", "sphere.xyz - ray.origin"),
    ("shared/sphere", "distance > radius", "distance > sphere.w"),
];
const PACKED_BOX: &[Damage] = &[
    ("shared/packed_box", "0x1fffffu", "0xfffffu"),
    ("shared/packed_box", "(words.x >> 21u) | (words.y << 11u)", "words.y << 11u"),
    ("shared/packed_box", "words.y >> 10u", "words.y >> 11u"),
    ("shared/packed_box", "(words.y >> 31u) |", ""),
    ("shared/packed_box", "(words.z >> 20u) |", ""),
    ("shared/packed_box", "words.w >> 9u", "words.w >> 8u"),
    ("shared/packed_box", "steps * grid.step", "steps * grid.step.x"),
    ("shared/seek_boxes", "layer_grid = load_grid(layer);", ""),
];
const ONE_SIDED: &[Damage] = &[
    ("shared/triangle", "front_face && runs_against(ray, mirrored, plane.normal)", "true"),
    ("shared/triangle", "!(front_face && runs_against(ray, mirrored, plane.normal))", "front_face"),
    ("shared/triangle", "select(slope > 0.0, slope < 0.0, ray.forward != mirrored)", "slope < 0.0"),
    ("shared/triangle", "ray.forward != mirrored)", "ray.forward)"),
];
const LAYERS: &[Damage] = &[
    ("walk/walk_list", "if layer == layers {", "if layer == 1u {"),
    ("walk/walk_list", "first_element(layer, list)", "first_element(0u, list)"),
    ("shared/list", "#{LIST_LAYER_WORDS}u * layer + list", "#{LIST_LAYER_WORDS}u * layer"),
];
const GRIDS: &[Damage] = &[("walk/walk_list", "enter_layer(layer);", "enter_layer(0u);")];

#[test]
fn broken_lists_are_noticed() {
    use Bounds::{Aabb, Sphere};
    let some = |bounds, names: &[&str]| few(lists::every(bounds), names);
    let eight = &["soup by an octree", "soup far away", "coplanar duplicates"];
    notice("list", Query::Closest, &some(Sphere, eight), &[LIST, LIST_OF_EIGHT, SPHERE].concat());
    notice("list", Query::Closest, &some(Aabb, &["stretched soup", "instances"]), PACKED_BOX);
    notice("list", Query::Closest, &some(Sphere, &["soup with spatial splits"]), LIST_OF_TWO);
    notice("list", Query::Closest, &some(Sphere, &["lattice"]), LIST_OF_SIX);
    let one_sided = few(lists::one_sided(Aabb), &["one-sided soup", "one-sided instances"]);
    notice("list", Query::Closest, &one_sided, ONE_SIDED);
}

#[test]
fn broken_layers_are_noticed() {
    notice("list", Query::Closest, &few(lists::layered(Bounds::Sphere), &["two layers"]), LAYERS);
    notice("list", Query::Closest, &few(lists::layered(Bounds::Aabb), &["two layers"]), GRIDS);
}
