// The results of closest points: twelve words a query, or sixteen with counters.
// Source: read back by ropewalk-gpu's tracer/points/results.rs.
// Invariants: all words of a query are written.

#import shared/point_closest
#import shared/point_triangle
#import shared/probe

@group(#{BATCH_GROUP}) @binding(1) var<storage, read_write> results: array<vec4<u32>>;

fn store_result(index: u32, query: PreparedPoint, collect: ptr<function, Collect>, status: u32) {
    var closest = no_closest_point(batch.infinity);
    if (*collect).is_found {
        let found = (*collect).closest;
        closest = closest_point_of(load_triangle(found.triangle), query, found.distance);
    }
    let written = status | #{STATUS_WRITTEN};
#ifdef COUNTERS
    let at = 4u * index;
    results[at + 2u] = vec4<u32>(closest.instance, written, counters.inner_visits, counters.leaf_visits);
    results[at + 3u] = vec4<u32>(
        counters.primitive_tests,
        counters.restarts,
        counters.stack_depth,
        counters.objects_entered,
    );
#else
    let at = 3u * index;
    results[at + 2u] = vec4<u32>(closest.instance, written, 0u, 0u);
#endif
    results[at] = vec4<u32>(bitcast<u32>(closest.distance), bitcast<vec3<u32>>(closest.point));
    results[at + 1u] =
        vec4<u32>(bitcast<vec2<u32>>(closest.barycentrics), closest.primitive, closest.geometry);
}
