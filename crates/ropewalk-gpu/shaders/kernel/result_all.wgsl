// The results of all hits: a header a ray, then eight words a hit, at the places that the rays' records give out.
// Source: read back by ropewalk-gpu's tracer/all_hits.rs. The kernel runs twice: without room for any hit, to count
//   them, and with room for as many as it counted. It is one kernel, so that a device cannot round differently.
// Invariants: all words of a ray are written. No ray stores more hits than it has room for; the host sees to it that the
//   places do not overlap and lie within the buffer.

#import shared/collect_all
#import kernel/result_header

fn store_hit(place: u32, hit: Hit) {
    let at = HEADER * batch.count + 2u * place;
    results[at] = vec4<u32>(bitcast<u32>(hit.t), bitcast<u32>(hit.u), bitcast<u32>(hit.v), hit.primitive);
    results[at + 1u] = vec4<u32>(hit.geometry, hit.instance, u32(hit.front_face), #{STATUS_WRITTEN});
}

fn store_result(index: u32, collect: Collect, status: u32) {
    store_header(HEADER * index, collect.found, status);
}
