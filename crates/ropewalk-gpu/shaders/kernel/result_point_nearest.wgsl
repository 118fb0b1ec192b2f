// The results of the k nearest triangles: four words a query, or eight with counters, and behind them twelve words for
// each of k triangles.
// Source: read back by ropewalk-gpu's tracer/points/results.rs.
// Invariants: the first words of a query are written, and those of as many triangles as they say; the rest stays zero.

#import shared/point_nearest
#import shared/point_triangle
#import shared/probe

@group(#{BATCH_GROUP}) @binding(1) var<storage, read_write> results: array<vec4<u32>>;

#ifdef COUNTERS
const HEADER: u32 = 2u;
#else
const HEADER: u32 = 1u;
#endif

fn store_result(index: u32, query: PreparedPoint, collect: ptr<function, PointCollect>, status: u32) {
    let at = (HEADER + 3u * batch.k) * index;
    let held = (*collect).held;
    let written = status | #{STATUS_WRITTEN};
#ifdef COUNTERS
    results[at] = vec4<u32>(held, written, counters.inner_visits, counters.leaf_visits);
    results[at + 1u] = vec4<u32>(
        counters.primitive_tests,
        counters.restarts,
        counters.stack_depth,
        counters.objects_entered,
    );
#else
    results[at] = vec4<u32>(held, written, 0u, 0u);
#endif
    for (var i = 0u; i < held; i += 1u) {
        let found = (*collect).nearest[i];
        let near = closest_point_of(load_triangle(found.triangle), query, found.distance);
        let place = at + HEADER + 3u * i;
        results[place] = vec4<u32>(bitcast<u32>(near.distance), bitcast<vec3<u32>>(near.point));
        results[place + 1u] = vec4<u32>(bitcast<vec2<u32>>(near.barycentrics), near.primitive, near.geometry);
        results[place + 2u] = vec4<u32>(near.instance, #{STATUS_WRITTEN}, 0u, 0u);
    }
}
