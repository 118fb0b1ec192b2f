// Keeps the closest hit, ties by id: the twin of ClosestHit in ropewalk's collect.rs.
// Source: the same.
// Invariants: t_max never grows. offer() answers whether no further hit matters. The same functions as the other
//   collect files.

#import shared/ray
#import shared/hit

struct Collect {
    // Hits beyond this t need not be offered.
    t_max: f32,
    hit: Hit,
}

// Nothing found yet; t_max is the ray's, which the caller fills in when the ray is prepared.
fn new_collect(infinity: f32) -> Collect {
    return Collect(0.0, miss(infinity));
}

fn offer(collect: ptr<function, Collect>, hit: Hit) -> bool {
    if precedes(hit, (*collect).hit) {
        (*collect).hit = hit;
        (*collect).t_max = hit.t;
    }
    return false;
}
