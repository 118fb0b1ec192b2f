// A point as what goes through a tree, in search of what is near: the twin of Seeker for PreparedPoint in ropewalk's
// bvh/walk/seeker.rs.
// Source: the same.
// Invariants: entries and limits are squared distances. A ball has no far side, so a box ends at the limit. For the rest
//   those of seek_ray.

#import shared/aabb
#import shared/point_distance
#import shared/point_leaf
#import #{COLLECT}

alias Seeker = PreparedPoint;

fn approach(seeker: Seeker, low: vec3<f32>, high: vec3<f32>, limit: f32) -> Interval {
    return Interval(box_distance_squared(seeker.point, low, high), limit);
}

fn limit_of(collect: ptr<function, Collect>) -> f32 {
    return (*collect).reach;
}
