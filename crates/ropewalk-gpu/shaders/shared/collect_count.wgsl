// Counts the hits: the twin of HitCount in ropewalk's collect.rs.
// Source: the same.
// Invariants: those of collect_closest. A triangle that stands in several leaves is counted in each.

#import shared/hit

struct Collect {
    // Hits beyond this t need not be offered.
    t_max: f32,
    found: u32,
}

fn new_collect(infinity: f32) -> Collect {
    return Collect(0.0, 0u);
}

fn offer(collect: ptr<function, Collect>, hit: Hit) -> bool {
    (*collect).found += 1u;
    return false;
}
