// The restart trail of a kd-tree from the root on: a walk of its own, and what the walks that go by t alone give a ray over to.
// Source: as walk/walk_kd_restart_trail. With TRAIL_STACK it has a short stack, of the file SHORT_STACK.
// Invariants: the same. Hits that were found before stay, and shorten the ray.

#import #{SEEKER}
#import shared/kd_leaf
#import shared/status
#import #{TRAIL}
#ifdef TRAIL_STACK
#import #{SHORT_STACK}
#endif

fn walk_by_trail(seeker: Seeker, step_budget: u32, collect: ptr<function, Collect>) -> u32 {
    var cell = whole_tree(seeker, (*collect).t_max);
    if !is_hit(cell) {
        return STATUS_COMPLETE;
    }
    var trail = new_trail();
#ifdef TRAIL_STACK
    // Zero-filled: empty.
    var stack: ShortStack;
#endif
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
            let near_is_open = is_hit(near);
            let far_is_open = is_hit(far);
            if near_is_open || far_is_open {
                descend(&trail);
                var go_far = far_is_open;
                var go = true;
                if near_is_open && far_is_open {
                    go_far = is_near_done(&trail);
#ifdef TRAIL_STACK
                    if !go_far {
                        probe_stack_depth(push_short(&stack, Postponed(crossing.far, far.entry, far.exit)));
                    }
#endif
                } else if is_far_level(&trail) {
                    // Both were open when the walk came by first, and the near one is finished: the hits since then
                    // cull the far one.
                    go = false;
                } else {
                    set_single(&trail);
                }
                if go {
                    current = select(crossing.near, crossing.far, go_far);
                    cell.entry = select(near.entry, far.entry, go_far);
                    cell.exit = select(near.exit, far.exit, go_far);
                    continue;
                }
            }
        }
        loop {
            // Each entry that is culled has its own bit of the trail, like one that is visited.
            if !finish_trail(&trail) {
                return STATUS_COMPLETE;
            }
#ifdef TRAIL_STACK
            var far: Postponed;
            if pop_short(&stack, &far) {
                // Closed: at equal t a smaller id may still win.
                if far.entry <= (*collect).t_max {
                    current = far.node;
                    cell = Interval(far.entry, min(far.exit, (*collect).t_max));
                    break;
                }
                continue;
            }
#endif
            restart_trail(&trail);
            probe_restart();
            current = 0u;
            cell = whole_tree(seeker, (*collect).t_max);
            break;
        }
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
