// Keeps the closest triangle, ties by id: the twin of KeepClosest in ropewalk's point/collect.rs.
// Source: the same.
// Invariants: the reach never grows. The same functions as point_nearest.

#import shared/point_distance
#import shared/point_order

struct Collect {
    // What a squared distance must not exceed; follows what is found.
    reach: f32,
    // How far the search reaches beyond what is found, or the radius.
    slack: f32,
    // Nothing farther is an answer.
    radius: f32,
    is_found: bool,
    closest: Found,
}

// Nothing found yet. One triangle is kept, whatever `k` says.
fn new_collect(radius: f32, slack: f32, k: u32) -> Collect {
    return Collect(reach(radius + slack), slack, radius, false, Found(0.0, 0u));
}

// A triangle's distance, perhaps beyond the radius, and perhaps not for the first time.
fn offer_point(collect: ptr<function, Collect>, found: Found) {
    if found.distance > (*collect).radius {
        return;
    }
    if (*collect).is_found && !is_preferred(found, (*collect).closest) {
        return;
    }
    (*collect).is_found = true;
    (*collect).closest = found;
    (*collect).reach = reach(found.distance + (*collect).slack);
}
