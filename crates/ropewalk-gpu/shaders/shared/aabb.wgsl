// The slab test that every hierarchy of boxes shares: the twin of slab_test in ropewalk's aabb.rs.
// Source: Ize 2013 for the padded far end; the near end is padded too, see there.
// Invariants: closed and monotone: a box that contains another is never missed where the inner one is hit.

#import shared/ray

// The box is hit when entry <= exit.
struct Interval {
    entry: f32,
    exit: f32,
}

// Where the ray's line enters and leaves the box, padded, whatever its window.
fn slab_span(ray: PreparedRay, low_corner: vec3<f32>, high_corner: vec3<f32>) -> Interval {
    let low = (low_corner - ray.origin_low) * ray.inverse;
    let high = (high_corner - ray.origin_high) * ray.inverse;
    let nearer = min(low, high);
    let farther = max(low, high);
    let near = max(nearer.x, max(nearer.y, nearer.z));
    let far = min(farther.x, min(farther.y, farther.z));
    return Interval(near * #{PAD_ENTRY}, far * #{PAD_EXIT});
}

fn slab_test(ray: PreparedRay, low_corner: vec3<f32>, high_corner: vec3<f32>, t_max: f32) -> Interval {
    let span = slab_span(ray, low_corner, high_corner);
    return Interval(max(span.entry, ray.t_min), min(span.exit, t_max));
}

fn is_hit(interval: Interval) -> bool {
    return interval.entry <= interval.exit;
}
