// The results of closest hits: eight words a ray, and eight more with counters.
// Source: read back by ropewalk-gpu's tracer/results.rs.
// Invariants: all words of a ray are written.

#import shared/collect_closest
#import shared/probe

@group(#{BATCH_GROUP}) @binding(1) var<storage, read_write> results: array<vec4<u32>>;

fn store_result(index: u32, collect: Collect, status: u32) {
#ifdef COUNTERS
    let at = 4u * index;
    results[at + 2u] =
        vec4<u32>(counters.inner_visits, counters.leaf_visits, counters.primitive_tests, counters.restarts);
    results[at + 3u] = vec4<u32>(counters.stack_depth, counters.objects_entered, 0u, 0u);
#else
    let at = 2u * index;
#endif
    let hit = collect.hit;
    results[at] = vec4<u32>(bitcast<u32>(hit.t), bitcast<u32>(hit.u), bitcast<u32>(hit.v), hit.primitive);
    results[at + 1u] =
        vec4<u32>(hit.geometry, hit.instance, u32(hit.front_face), status | #{STATUS_WRITTEN});
}
