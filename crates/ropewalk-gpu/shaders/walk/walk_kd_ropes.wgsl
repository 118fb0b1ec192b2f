// Ropes: out of each leaf through a face, by the rope that leads beyond it, and down to the next leaf.
// Source: Popov et al. 2007; the twin of ropewalk's kd_tree/walk/ropes.rs and of what certain.rs has for it, visit for visit.
// Invariants: those of shared/kd_certain. A step enters one node. Each way down ends with a leaf that the ray has not been in, so
//   a valid tree never uses up a budget of its leaves times the nodes on its longest path, and the trail's.

#import #{SEEKER}
#import shared/kd_certain
#import shared/kd_places

// The child in which the ray goes on when it comes out of a leaf at `at`; `whole` is its interval in the whole tree. NONE where
// that is not certain.
fn side_at(crossing: Crossing, at: f32, whole: Interval) -> u32 {
    // Where the ray is parallel to the plane, the plane must be out of reach.
    if is_behind(crossing.far_entry, at) && (crossing.is_point || crossing.far_entry > whole.exit) {
        return crossing.near;
    }
    if is_behind(at, crossing.near_exit) && (crossing.is_point || crossing.near_exit < whole.entry) {
        return crossing.far;
    }
    return #{NONE};
}

// How a ray goes through a leaf's box.
struct Faces {
    entry: f32,
    exit: f32,
    // The face through which it goes out, as load_rope counts them; NONE where it ends before.
    face: u32,
    // Whether all of this is beyond doubt.
    is_certain: bool,
}

fn faces_of(place: KdPlace, ray: PreparedRay, limit: f32) -> Faces {
    let low = (place.low - ray.origin_low) * ray.inverse;
    let high = (place.high - ray.origin_high) * ray.inverse;
    let nears = min(low, high) * #{PAD_ENTRY};
    let fars = max(low, high) * #{PAD_EXIT};
    let parallel = ray.origin_low != ray.origin_high;
    var entry = ray.t_min;
    var exit = limit;
    // The second largest entry and the second smallest exit. The first axis comes again below and changes nothing.
    var earlier = min(nears.x, entry);
    var later = max(fars.x, exit);
    var in_by_parallel = false;
    var out_by_parallel = false;
    var face = #{NONE};
#repeat AXIS 3
    if nears[#{AXIS}] > entry {
        in_by_parallel = parallel[#{AXIS}];
    }
    earlier = max(earlier, min(nears[#{AXIS}], entry));
    entry = max(nears[#{AXIS}], entry);
    if fars[#{AXIS}] < exit {
        out_by_parallel = parallel[#{AXIS}];
        face = 2u * #{AXIS}u + u32(ray.inverse[#{AXIS}] >= 0.0);
    }
    later = min(later, max(fars[#{AXIS}], exit));
    exit = min(fars[#{AXIS}], exit);
#endrepeat
    let is_certain = is_behind(entry, earlier)
        && is_behind(exit, entry)
        && is_behind(later, exit)
        && !in_by_parallel
        && !out_by_parallel;
    return Faces(entry, exit, face, is_certain);
}

// Leads the ray through the tree; the status of the walk.
fn walk(seeker: Seeker, node_count: u32, step_budget: u32, collect: ptr<function, Collect>) -> u32 {
    if node_count == 0u {
        return STATUS_COMPLETE;
    }
    let limit = (*collect).t_max;
    let whole = whole_tree(seeker, limit);
    if !is_hit(whole) {
        return STATUS_COMPLETE;
    }
    // Where the ray comes into the cell of the current node.
    var at = whole.entry;
    var steps_left = step_budget;
    var current = 0u;
    loop {
        if steps_left == 0u {
            return STATUS_STEP_BUDGET;
        }
        steps_left -= 1u;
        let node = load_kd_node(current);
        if node.axis != LEAF_AXIS {
            probe_inner_visit();
            current = side_at(cross_plane(seeker, current, node), at, whole);
            if current == #{NONE} {
                return give_over(seeker, steps_left, collect);
            }
            continue;
        }
        let place = load_kd_place(current);
        let faces = faces_of(place, seeker, limit);
        // A leaf that does not lead on would lead round in circles.
        if !faces.is_certain || faces.exit <= at {
            return give_over(seeker, steps_left, collect);
        }
        // All that comes after begins later still.
        if faces.entry > (*collect).t_max || visit_leaf(seeker, node.word, node.link, collect) {
            return STATUS_COMPLETE;
        }
        at = faces.exit;
        // The next leaf begins no further before the end of this one than the pads.
        if faces.face == #{NONE} || is_behind(at, (*collect).t_max) {
            return STATUS_COMPLETE;
        }
        current = load_rope(place.leaf, faces.face);
        if current == #{NONE} {
            return STATUS_COMPLETE;
        }
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
