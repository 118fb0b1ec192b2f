// The distance to a box, and how far a search reaches: the twin of ropewalk's point/distance.rs.
// Source: the same; why a search over spatial splits reaches farther is explained in point/visitor.rs.
// Invariants: a box that contains another is never farther. The sum of the squares is dot(): see shared/triangle.

// The squared distance from the point to the box; zero inside.
fn box_distance_squared(point: vec3<f32>, low: vec3<f32>, high: vec3<f32>) -> f32 {
    let outside = max(max(low - point, point - high), vec3<f32>(0.0));
    return dot(outside, outside);
}

// The squared distance up to which a search must look in order to find everything within `distance`.
fn reach(distance: f32) -> f32 {
    // Farther than any two points of a query and a scene are apart, and so small that its square is a number: WGSL
    // leaves infinities open.
    let bounded = min(distance, 1e19);
    // In this order: lavapipe multiplies by a constant first.
    return bounded * (bounded * #{PAD_EXIT});
}

// How far a search must reach beyond its limit: `share` of the largest way along an axis to a side of the box of
// everything.
fn point_slack(point: vec3<f32>, low: vec3<f32>, high: vec3<f32>, share: f32) -> f32 {
    let farthest = max(abs(point - low), abs(high - point));
    return max(farthest.x, max(farthest.y, farthest.z)) * share;
}
