// The restart trail of point queries: a bit a level leads back after a restart at the root, so that the stack may be of
// any size, or none.
// Source: Laine 2010; the twin of ropewalk's point/walk/restart_trail.rs, visit for visit. TRAIL is the file of the
//   trail's bits, SHORT_STACK that of the stack; both are those of the rays.
// Invariants: the tree is no deeper than the trail. Steps and their budget: see walk_bvh_restart_trail. A postponed
//   child's entry is the squared distance to its box.

#import shared/point_leaf
#import shared/status
#import #{TRAIL}
#import #{SHORT_STACK}

// Leads the query through the tree; the status of the walk.
fn walk_points(
    query: PreparedPoint,
    node_count: u32,
    step_budget: u32,
    collect: ptr<function, PointCollect>,
) -> u32 {
    if node_count == 0u {
        return STATUS_COMPLETE;
    }
    var trail = new_trail();
    // Zero-filled: empty.
    var stack: ShortStack;
    var steps_left = step_budget;
    var current = 0u;
    let root = load_link_and_count(0u);
    // Of the current node; a child's are at hand when its box has been measured.
    var link = root.x;
    var count = root.y;
    loop {
        if steps_left == 0u {
            return STATUS_STEP_BUDGET;
        }
        steps_left -= 1u;
        if count != 0u {
            visit_point_leaf(query, link, count, collect);
        } else {
            probe_inner_visit();
            let children = measure_children(query.point, current + 1u, link);
            // The far child is within reach only where the near one is.
            if children.near_square <= (*collect).reach {
                descend(&trail);
                var go_far = false;
                var go = true;
                if children.far_square <= (*collect).reach {
                    go_far = is_near_done(&trail);
                    if !go_far {
                        let far = Postponed(children.far, children.far_square);
                        probe_stack_depth(push_short(&stack, far));
                    }
                } else if is_pop_level(&trail) {
                    // Both were within reach when the walk came by first, and the near one is finished: what was found
                    // since then culls the far one.
                    go = false;
                } else {
                    set_single(&trail);
                }
                if go {
                    current = select(children.near, children.far, go_far);
                    link = select(children.near_link, children.far_link, go_far);
                    count = select(children.near_count, children.far_count, go_far);
                    continue;
                }
            }
        }
        loop {
            // Each entry that is culled has its own bit of the trail, like one that is visited.
            if !finish_trail(&trail) {
                return STATUS_COMPLETE;
            }
            var far: Postponed;
            if !pop_short(&stack, &far) {
                restart_trail(&trail);
                probe_restart();
                current = 0u;
                break;
            }
            // Closed: at equal distance a smaller id may still win.
            if far.entry <= (*collect).reach {
                current = far.node;
                break;
            }
        }
        let node = load_link_and_count(current);
        link = node.x;
        count = node.y;
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
