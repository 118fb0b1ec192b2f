// Keeps the closest of the hits that pass a filter, ties by id, or ends at the first of them: the twin of a filtered closest
// hit, and of a filtered any hit.
// Source: as collect_closest. The filter is a function accepts(hit: Hit) -> bool of the program.
// Invariants: those of collect_closest. The filter depends on the hit alone, so the order of the offers decides nothing; it is
//   asked only of hits that would be kept.

#import shared/ray
#import shared/hit

struct Collect {
    // Hits beyond this t need not be offered.
    t_max: f32,
    // Whether one hit is enough, whichever it is.
    ends_early: bool,
    hit: Hit,
}

// Nothing found yet, and the closest is wanted.
fn new_collect(infinity: f32) -> Collect {
    return Collect(0.0, false, miss(infinity));
}

fn offer(collect: ptr<function, Collect>, hit: Hit) -> bool {
    if precedes(hit, (*collect).hit) && accepts(hit) {
        (*collect).hit = hit;
        (*collect).t_max = hit.t;
        return (*collect).ends_early;
    }
    return false;
}
