// What a query does with the hits it is offered: the twin of ClosestHit and AnyHit in ropewalk's collect.rs.
// Source: the same.
// Invariants: t_max never grows. offer() answers whether no further hit matters.

#import shared/ray
#import shared/hit

struct Collect {
    // Hits beyond this t need not be offered.
    t_max: f32,
#ifdef ANY
    found: bool,
#else
    hit: Hit,
#endif
}

// Nothing found yet; t_max is the ray's, which the caller fills in when the ray is prepared.
fn new_collect(infinity: f32) -> Collect {
#ifdef ANY
    return Collect(0.0, false);
#else
    return Collect(0.0, miss(infinity));
#endif
}

fn offer(collect: ptr<function, Collect>, hit: Hit) -> bool {
#ifdef ANY
    (*collect).found = true;
    return true;
#else
    if precedes(hit, (*collect).hit) {
        (*collect).hit = hit;
        (*collect).t_max = hit.t;
    }
    return false;
#endif
}
