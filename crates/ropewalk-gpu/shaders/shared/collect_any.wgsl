// Stops at the first hit of any kind: the twin of AnyHit in ropewalk's collect.rs.
// Source: the same.
// Invariants: those of collect_closest.

#import shared/hit

struct Collect {
    // Hits beyond this t need not be offered.
    t_max: f32,
    found: bool,
}

fn new_collect(infinity: f32) -> Collect {
    return Collect(0.0, false);
}

fn offer(collect: ptr<function, Collect>, hit: Hit) -> bool {
    (*collect).found = true;
    return true;
}
