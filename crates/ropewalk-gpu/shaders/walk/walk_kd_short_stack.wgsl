// The short stack: a ring of the youngest entries; where it is exhausted, a restart as in kd-restart, but from the deepest node
// that holds all that is left of the ray.
// Source: Horn et al. 2007, with their push-down; the twin of ropewalk's kd_tree/walk/short_stack.rs, visit for visit.
//   SHORT_STACK is the file of the ring.
// Invariants: those of shared/kd_certain. A step enters one node. Each way down ends with a leaf that is finished for good, so a
//   valid tree never uses up a budget of its leaves times the nodes on its longest path, and the trail's.

#import #{SEEKER}
#import shared/kd_certain
#import #{SHORT_STACK}

// Leads the ray through the tree; the status of the walk.
fn walk(seeker: Seeker, node_count: u32, step_budget: u32, collect: ptr<function, Collect>) -> u32 {
    if node_count == 0u {
        return STATUS_COMPLETE;
    }
    let whole = whole_tree(seeker, (*collect).t_max);
    if !is_hit(whole) {
        return STATUS_COMPLETE;
    }
    // Zero-filled: empty.
    var stack: ShortStack;
    // Where the last leaf ended.
    var done = NOTHING_DONE;
    var steps_left = step_budget;
    var current = 0u;
    var cell = whole;
    // The node that holds all that is left, and whether the walk has come straight down from it.
    var base = current;
    var base_cell = whole;
    var is_base = true;
    loop {
        if steps_left == 0u {
            return STATUS_STEP_BUDGET;
        }
        steps_left -= 1u;
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
            if both && !go_far {
                is_base = false;
                let far = far_span(cell, crossing);
                probe_stack_depth(push_short(&stack, Postponed(crossing.far, far.entry, far.exit)));
            }
            current = select(crossing.near, crossing.far, go_far);
            cell.entry = select(cell.entry, max(cell.entry, crossing.far_entry), both && go_far);
            cell.exit = select(cell.exit, min(cell.exit, crossing.near_exit), both && !go_far);
            if is_base {
                base = current;
                base_cell = cell;
            }
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
        var far: Postponed;
        if pop_short(&stack, &far) {
            current = far.node;
            cell = Interval(far.entry, far.exit);
            continue;
        }
        // Where the base itself is finished, nothing is left.
        if done >= base_cell.exit {
            return STATUS_COMPLETE;
        }
        probe_restart();
        current = base;
        cell = base_cell;
        is_base = true;
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
