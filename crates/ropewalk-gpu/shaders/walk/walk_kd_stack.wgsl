// The stack walk of a kd-tree: the near child first, the far one postponed with its interval.
// Source: Wald 2004, section 7.2; the twin of ropewalk's kd_tree/walk/stack.rs, visit for visit; what has to be added for hits
//   in split planes is named there.
// Invariants: one child a level is postponed, so a stack of the tree's depth is never full. A step enters one node, and
//   each node is entered once, so a budget of the number of nodes is never used up by a valid tree.

#import #{SEEKER}
#import shared/kd_leaf
#import shared/postponed
#import shared/status

// Leads the ray through the tree; the status of the walk.
fn walk(seeker: Seeker, node_count: u32, step_budget: u32, collect: ptr<function, Collect>) -> u32 {
    if node_count == 0u {
        return STATUS_COMPLETE;
    }
    var cell = whole_tree(seeker, (*collect).t_max);
    if !is_hit(cell) {
        return STATUS_COMPLETE;
    }
    var stack: array<Postponed, #{STACK_ENTRIES}>;
    var entries = 0u;
    var steps_left = step_budget;
    var current = 0u;
    loop {
        if steps_left == 0u {
            return STATUS_STEP_BUDGET;
        }
        steps_left -= 1u;
        let node = load_kd_node(current);
        if node.axis == LEAF_AXIS {
            if visit_leaf(seeker, node.word, node.link, collect) {
                return STATUS_COMPLETE;
            }
        } else {
            probe_inner_visit();
            let crossing = cross_plane(seeker, current, node);
            let near = near_span(cell, crossing);
            let far = far_span(cell, crossing);
            // One of the two is always open.
            let near_is_open = is_hit(near);
            if near_is_open && is_hit(far) {
                if entries == #{STACK_ENTRIES}u {
                    return STATUS_STACK_OVERFLOW;
                }
                stack[entries] = Postponed(crossing.far, far.entry, far.exit);
                entries += 1u;
                probe_stack_depth(entries);
            }
            current = select(crossing.far, crossing.near, near_is_open);
            cell.entry = select(far.entry, near.entry, near_is_open);
            cell.exit = select(far.exit, near.exit, near_is_open);
            continue;
        }
        loop {
            if entries == 0u {
                return STATUS_COMPLETE;
            }
            entries -= 1u;
            // Closed: at equal t a smaller id may still win.
            if stack[entries].entry <= (*collect).t_max {
                break;
            }
        }
        current = stack[entries].node;
        cell = Interval(stack[entries].entry, min(stack[entries].exit, (*collect).t_max));
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
