// The results of the k nearest triangles: a header a query, and behind each twelve words for each of k triangles.
// Source: read back by ropewalk-gpu's tracer/points/results.rs.
// Invariants: the header of a query is written, and the words of as many triangles as it says; the rest stays zero.

#import shared/point_nearest
#import shared/point_triangle
#import kernel/result_header

fn store_result(index: u32, query: PreparedPoint, collect: ptr<function, Collect>, status: u32) {
    let at = (HEADER + 3u * batch.k) * index;
    let held = (*collect).held;
    store_header(at, held, status);
    for (var i = 0u; i < held; i += 1u) {
        let found = (*collect).nearest[i];
        let near = closest_point_of(load_triangle(found.triangle), query, found.distance);
        let place = at + HEADER + 3u * i;
        results[place] = vec4<u32>(bitcast<u32>(near.distance), bitcast<vec3<u32>>(near.point));
        results[place + 1u] = vec4<u32>(bitcast<vec2<u32>>(near.barycentrics), near.primitive, near.geometry);
        results[place + 2u] = vec4<u32>(near.instance, #{STATUS_WRITTEN}, 0u, 0u);
    }
}
