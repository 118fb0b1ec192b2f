// Keeps the k nearest triangles, each once, sorted: the twin of KeepNearest in ropewalk's point/collect.rs.
// Source: the same, where the list is a sorted tree.
// Invariants: the limit never grows. The list lies in the memory of the invocation, in NEAREST_ROOM places of two words,
//   of which the first `room` <= NEAREST_ROOM may be filled. A triangle that is offered again, which spatial splits do,
//   has the same distance and finds its place taken. The same functions as point_closest.

#import shared/point_distance
#import shared/point_order

struct Collect {
    // What a squared distance must not exceed; follows the limit.
    reach: f32,
    // How far the search reaches beyond the limit.
    slack: f32,
    // Nothing farther need be offered.
    limit: f32,
    room: u32,
    held: u32,
    nearest: array<Found, #{NEAREST_ROOM}>,
}

// Nothing found yet.
fn new_collect(radius: f32, slack: f32, k: u32) -> Collect {
    var collect: Collect;
    collect.reach = reach(radius + slack);
    collect.slack = slack;
    collect.limit = radius;
    collect.room = min(k, #{NEAREST_ROOM}u);
    return collect;
}

// A triangle's distance, perhaps beyond the limit, and perhaps not for the first time.
fn offer_point(collect: ptr<function, Collect>, found: Found) {
    if found.distance > (*collect).limit {
        return;
    }
    // From the farthest on: what is offered late is seldom the nearest.
    var place = (*collect).held;
    while place > 0u && is_preferred(found, (*collect).nearest[place - 1u]) {
        place -= 1u;
    }
    if place == (*collect).room {
        return;
    }
    if place > 0u && !is_preferred((*collect).nearest[place - 1u], found) {
        // It is in the list already.
        return;
    }
    if (*collect).held < (*collect).room {
        (*collect).held += 1u;
    }
    for (var moved = (*collect).held - 1u; moved > place; moved -= 1u) {
        (*collect).nearest[moved] = (*collect).nearest[moved - 1u];
    }
    (*collect).nearest[place] = found;
    if (*collect).held == (*collect).room {
        (*collect).limit = (*collect).nearest[(*collect).room - 1u].distance;
        (*collect).reach = reach((*collect).limit + (*collect).slack);
    }
}
