// Half-spaces, and what lies outside of them for certain: the twin of Plane in ropewalk's traversal_list/heads/plane.rs.
// Source: the same.
// Invariants: same operations in the same order as in Rust. Sums of products are dot(), for the reason that
//   shared/triangle gives.

// The points x with dot(normal, x) >= offset.
struct HalfSpace {
    normal: vec3<f32>,
    // Moved outwards, or inwards.
    offset: f32,
    // Of the normal.
    length: f32,
}

// The one that begins at the first of three points, when the largest coordinate of all is `largest`, moved outwards by a
// share of that.
fn half_space_from(
    normal: vec3<f32>,
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
    share: f32,
    largest: f32,
) -> HalfSpace {
    let size = abs(normal);
    let pad = (size.x + size.y + size.z) * (share * largest);
    let first = min(min(dot(normal, a), dot(normal, b)), dot(normal, c));
    return HalfSpace(normal, first - pad, sqrt(dot(normal, normal)));
}

// Whether all of a sphere is outside. The radius is the fourth component.
fn excludes_sphere(space: HalfSpace, sphere: vec4<f32>) -> bool {
    return dot(space.normal, sphere.xyz) + sphere.w * space.length < space.offset;
}

fn excludes_box(space: HalfSpace, low: vec3<f32>, high: vec3<f32>) -> bool {
    let farthest = select(low, high, space.normal >= vec3<f32>(0.0));
    return dot(space.normal, farthest) < space.offset;
}

fn excludes_triangle(space: HalfSpace, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> bool {
    return dot(space.normal, a) < space.offset
        && dot(space.normal, b) < space.offset
        && dot(space.normal, c) < space.offset;
}
