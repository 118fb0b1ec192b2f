// Keeps every hit, unsorted: the twin of AllHits in ropewalk's collect.rs.
// Source: the same.
// Invariants: those of collect_closest. At most `room` hits are stored, by a function store_hit(place, hit) of the
//   kernel, and all are counted. A triangle that stands in several leaves is kept in each.

#import shared/hit

struct Collect {
    // Hits beyond this t need not be offered.
    t_max: f32,
    found: u32,
    // The place of the ray's first hit among those of all rays, and how many places it has.
    first: u32,
    room: u32,
}

// The ray has no room yet.
fn new_collect(infinity: f32) -> Collect {
    return Collect(0.0, 0u, 0u, 0u);
}

fn offer(collect: ptr<function, Collect>, hit: Hit) -> bool {
    if (*collect).found < (*collect).room {
        store_hit((*collect).first + (*collect).found, hit);
    }
    (*collect).found += 1u;
    return false;
}
