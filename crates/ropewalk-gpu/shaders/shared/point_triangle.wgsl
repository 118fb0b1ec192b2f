// A flattened triangle's answer to a point query: the twin of FlatTriangle::closest_point in ropewalk's
// point/triangle.rs.
// Source: the same; why the distance is at least that of the triangle's box is explained in point/mod.rs.
// Invariants: the walk asks for the distance alone and keeps that and the triangle's place, two words; the whole answer
//   is worked out when the walk is over, from the same foot.

#import shared/bvh
#import shared/point_query
#import shared/point_distance
#import shared/point_foot

struct ClosestPoint {
    distance: f32,
    point: vec3<f32>,
    // The weights of the second and third vertex.
    barycentrics: vec2<f32>,
    primitive: u32,
    geometry: u32,
    instance: u32,
}

// Where nothing was found.
fn no_closest_point(infinity: f32) -> ClosestPoint {
    return ClosestPoint(infinity, vec3<f32>(0.0), vec2<f32>(0.0), #{NONE}, #{NONE}, #{NONE});
}

// Whether the query sees the triangle within `limit`, a squared distance; then `square` is filled in.
fn measure_triangle(triangle: Triangle, query: PreparedPoint, limit: f32, square: ptr<function, f32>) -> bool {
    if (triangle.instance_and_mask & query.mask) == 0u {
        return false;
    }
    let low = min(triangle.v0, min(triangle.v1, triangle.v2));
    let high = max(triangle.v0, max(triangle.v1, triangle.v2));
    let box_square = box_distance_squared(query.point, low, high);
    // Most triangles of a leaf that is entered late end here.
    if box_square > limit {
        return false;
    }
    let foot = find_foot(query.point, triangle.v0, triangle.v1, triangle.v2);
    *square = max(foot.square, box_square);
    return *square <= limit;
}

// The answer of a triangle that was found at this distance.
fn closest_point_of(triangle: Triangle, query: PreparedPoint, distance: f32) -> ClosestPoint {
    let foot = find_foot(query.point, triangle.v0, triangle.v1, triangle.v2);
    let position = foot_position(foot, triangle.v0, triangle.v1, triangle.v2);
    return ClosestPoint(
        distance,
        vec3<f32>(
            without_negative_zero(position.x),
            without_negative_zero(position.y),
            without_negative_zero(position.z),
        ),
        foot_barycentrics(foot),
        triangle.primitive,
        triangle.geometry_and_mirror & ~#{MIRROR},
        triangle.instance_and_mask & 0x00ffffffu,
    );
}
