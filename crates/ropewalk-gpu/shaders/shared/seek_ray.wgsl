// A ray as what goes through a tree, in search of hits: the twin of Seeker for PreparedRay in ropewalk's
// bvh/walk/seeker.rs.
// Source: the same.
// Invariants: entries and limits are in t. The entry does not depend on the limit, and a box that holds another begins no
//   later than that one. The same names as seek_point.

#import shared/aabb
#import shared/leaf
#import #{COLLECT}

alias Seeker = PreparedRay;

// Where a box begins; it is to be entered where the interval is hit.
fn approach(seeker: Seeker, low: vec3<f32>, high: vec3<f32>, limit: f32) -> Interval {
    return slab_test(seeker, low, high, limit);
}

// How far boxes are of interest.
fn limit_of(collect: ptr<function, Collect>) -> f32 {
    return (*collect).t_max;
}
