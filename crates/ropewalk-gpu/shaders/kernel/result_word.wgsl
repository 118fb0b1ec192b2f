// The results of any hit and of the count: a word and the status for each ray, and six words more with counters.
// Source: read back by ropewalk-gpu's tracer/results.rs.
// Invariants: all words of a ray are written.

#import #{COLLECT}
#import shared/probe

@group(#{BATCH_GROUP}) @binding(1) var<storage, read_write> results: array<vec2<u32>>;

fn store_result(index: u32, collect: Collect, status: u32) {
#ifdef COUNTERS
    let at = 4u * index;
    results[at + 1u] = vec2<u32>(counters.inner_visits, counters.leaf_visits);
    results[at + 2u] = vec2<u32>(counters.primitive_tests, counters.restarts);
    results[at + 3u] = vec2<u32>(counters.stack_depth, counters.objects_entered);
#else
    let at = index;
#endif
    results[at] = vec2<u32>(u32(collect.found), status | #{STATUS_WRITTEN});
}
