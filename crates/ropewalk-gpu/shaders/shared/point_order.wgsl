// What is kept of a triangle that was found, and which of two is preferred: the twin of ClosestPoint::precedes in
// ropewalk's point/answer.rs.
// Source: the same: the smaller distance, at equal distance the smaller (instance, geometry, primitive).
// Invariants: two words. The identity is looked up at a tie alone.

#import shared/bvh

struct Found {
    distance: f32,
    // The triangle's place among the leaves.
    triangle: u32,
}

// Instance, geometry, primitive.
fn triangle_id(triangle: u32) -> vec3<u32> {
    return vec3<u32>(
        bvh_triangles[3u * triangle + 2u].w & 0x00ffffffu,
        bvh_triangles[3u * triangle + 1u].w & ~#{MIRROR},
        bvh_triangles[3u * triangle].w,
    );
}

// Whether `a` is preferred to `b`. Of a triangle that stands in two leaves, neither place is.
fn is_preferred(a: Found, b: Found) -> bool {
    if a.distance != b.distance {
        return a.distance < b.distance;
    }
    let id_a = triangle_id(a.triangle);
    let id_b = triangle_id(b.triangle);
    if id_a.x != id_b.x {
        return id_a.x < id_b.x;
    }
    if id_a.y != id_b.y {
        return id_a.y < id_b.y;
    }
    return id_a.z < id_b.z;
}
