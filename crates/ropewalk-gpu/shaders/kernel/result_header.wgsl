// The header of a record whose answer is a list: how long it is and the status in four words, and in four more the
// counters.
// Source: read back by ropewalk-gpu's tracer.
// Invariants: all words of a header are written.

#import shared/probe

@group(#{BATCH_GROUP}) @binding(1) var<storage, read_write> results: array<vec4<u32>>;

// Its length in the buffer.
#ifdef COUNTERS
const HEADER: u32 = 2u;
#else
const HEADER: u32 = 1u;
#endif

fn store_header(at: u32, listed: u32, status: u32) {
    let written = status | #{STATUS_WRITTEN};
#ifdef COUNTERS
    results[at] = vec4<u32>(listed, written, counters.inner_visits, counters.leaf_visits);
    results[at + 1u] = vec4<u32>(
        counters.primitive_tests,
        counters.restarts,
        counters.stack_depth,
        counters.objects_entered,
    );
#else
    results[at] = vec4<u32>(listed, written, 0u, 0u);
#endif
}
