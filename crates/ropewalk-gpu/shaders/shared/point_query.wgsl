// Point queries, and what the tests of boxes and triangles need ready of them: the twin of ropewalk's point/query.rs.
// Source: the same.
// Invariants: a prepared point holds neither NaN nor infinity. Validity is asked of bits: see shared/float.

#import shared/float

struct PointQuery {
    point: vec3<f32>,
    // The largest distance that counts as found, included.
    radius: f32,
    mask: u32,
}

struct PreparedPoint {
    point: vec3<f32>,
    // The largest distance, included; finite.
    radius: f32,
    // The mask in the top 8 bits.
    mask: u32,
}

fn is_valid_query(query: PointQuery) -> bool {
    // NaN and infinity have larger bits than any number.
    let size = bitcast<vec3<u32>>(query.point) & vec3<u32>(0x7fffffffu);
    let radius = bitcast<u32>(query.radius);
    return all(size <= vec3<u32>(#{LARGEST_POINT_BITS}))
        // Not negative, not NaN; -0 counts as 0.
        && (radius <= 0x7f800000u || radius == 0x80000000u);
}

// The query must be valid.
fn prepare_point(query: PointQuery) -> PreparedPoint {
    // Infinity is the distance where nothing was found, so no triangle has it.
    return PreparedPoint(query.point, min(query.radius, #{LARGEST_FLOAT}), query.mask << 24u);
}
