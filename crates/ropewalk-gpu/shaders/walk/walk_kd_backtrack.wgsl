// kd-backtrack: after each leaf up to the first ancestor that the ray has not left yet, and down again.
// Source: Foley and Sugerman 2005; the twin of ropewalk's kd_tree/walk/backtrack.rs, visit for visit.
// Invariants: those of shared/kd_certain. A step enters one node, on the way down or up. Between two leaves there is one way up
//   and one down, so a valid tree never uses up a budget of twice its leaves times the nodes on its longest path, and the
//   trail's.

#import #{SEEKER}
#import shared/kd_certain
#import shared/kd_places

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
    // Where the last leaf ended.
    var done = NOTHING_DONE;
    var steps_left = step_budget;
    var current = 0u;
    var cell = whole;
    // Whether the way leads up.
    var up = false;
    loop {
        if steps_left == 0u {
            return STATUS_STEP_BUDGET;
        }
        steps_left -= 1u;
        if up {
            probe_inner_visit();
            let place = load_kd_place(current);
            cell = slab_test(seeker, place.low, place.high, limit);
            // The same floats as on the way down.
            up = cell.exit <= done;
            if up {
                current = place.parent;
                if current == #{NONE} {
                    return STATUS_COMPLETE;
                }
            }
            continue;
        }
        let node = load_kd_node(current);
        if node.axis != LEAF_AXIS {
            probe_inner_visit();
            let crossing = cross_plane(seeker, current, node);
            let fork = fork_of(crossing, cell);
            if fork == FORK_UNDECIDED {
                return give_over(seeker, steps_left, collect);
            }
            let both = fork == FORK_BOTH;
            let go_far = fork == FORK_FAR || (both && crossing.near_exit <= done);
            current = select(crossing.near, crossing.far, go_far);
            cell.entry = select(cell.entry, max(cell.entry, crossing.far_entry), both && go_far);
            cell.exit = select(cell.exit, min(cell.exit, crossing.near_exit), both && !go_far);
            continue;
        }
        // All that comes after begins later still.
        if cell.entry > (*collect).t_max || visit_leaf(seeker, node.word, node.link, collect) {
            return STATUS_COMPLETE;
        }
        done = cell.exit;
        // The next leaf begins no further before the end of this one than the pads.
        if done >= whole.exit || is_behind(done, (*collect).t_max) {
            return STATUS_COMPLETE;
        }
        current = load_kd_place(current).parent;
        if current == #{NONE} {
            return STATUS_COMPLETE;
        }
        up = true;
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
