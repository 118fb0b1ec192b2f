// Keeps the closest triangle, ties by id: the twin of KeepClosest in ropewalk's point/collect.rs.
// Source: the same.
// Invariants: the limit never grows. The same functions as point_nearest.

#import shared/point_distance
#import shared/point_order

struct PointCollect {
    // What a squared distance must not exceed; follows the limit.
    reach: f32,
    // How far the search reaches beyond the limit.
    slack: f32,
    // Nothing farther need be offered.
    limit: f32,
    is_found: bool,
    closest: Found,
}

// Nothing found yet. One triangle is kept, whatever `k` says.
fn new_point_collect(radius: f32, slack: f32, k: u32) -> PointCollect {
    return PointCollect(reach(radius + slack), slack, radius, false, Found(0.0, 0u));
}

// A triangle's distance, perhaps beyond the limit, and perhaps not for the first time.
fn offer_point(collect: ptr<function, PointCollect>, found: Found) {
    if found.distance > (*collect).limit {
        return;
    }
    if (*collect).is_found && !is_preferred(found, (*collect).closest) {
        return;
    }
    (*collect).is_found = true;
    (*collect).closest = found;
    (*collect).limit = found.distance;
    (*collect).reach = reach(found.distance + (*collect).slack);
}
