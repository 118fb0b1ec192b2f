// The results of all hits: four words a ray, or eight with counters; then eight words a hit, at the places that the
// rays' records give out.
// Source: read back by ropewalk-gpu's tracer/results.rs. The kernel runs twice: without room for any hit, to count
//   them, and with room for as many as it counted. It is one kernel, so that a device cannot round differently.
// Invariants: all words of a ray are written. No ray stores more hits than it has room for; the host sees to it that the
//   places do not overlap and lie within the buffer.

#import shared/collect_all
#import shared/probe

@group(#{BATCH_GROUP}) @binding(1) var<storage, read_write> results: array<vec4<u32>>;

#ifdef COUNTERS
const HEADER: u32 = 2u;
#else
const HEADER: u32 = 1u;
#endif

fn store_hit(place: u32, hit: Hit) {
    let at = HEADER * batch.ray_count + 2u * place;
    results[at] = vec4<u32>(bitcast<u32>(hit.t), bitcast<u32>(hit.u), bitcast<u32>(hit.v), hit.primitive);
    results[at + 1u] = vec4<u32>(hit.geometry, hit.instance, u32(hit.front_face), #{STATUS_WRITTEN});
}

fn store_result(index: u32, collect: Collect, status: u32) {
    let written = status | #{STATUS_WRITTEN};
#ifdef COUNTERS
    results[2u * index] = vec4<u32>(collect.found, written, counters.inner_visits, counters.leaf_visits);
    results[2u * index + 1u] = vec4<u32>(
        counters.primitive_tests,
        counters.restarts,
        counters.stack_depth,
        counters.objects_entered,
    );
#else
    results[index] = vec4<u32>(collect.found, written, 0u, 0u);
#endif
}
