// The ordered stack walk of a wide tree: the nearest child first, leaves too, and a last look before a postponed child
// is entered.
// Source: the twin of the stack walk in ropewalk's wide_bvh/walk, visit for visit.
// Invariants: the children but one of each node on the way down are postponed, so a stack of the largest such sum is
//   never full. A step enters one node or leaf, and each is entered once, so a budget of the number of records, and one
//   for the root, is never used up by a valid tree.

#import shared/leaf
#import shared/wide_bvh
#import shared/status

// Leads the ray through the tree; the status of the walk.
fn walk(ray: PreparedRay, node_count: u32, step_budget: u32, collect: ptr<function, Collect>) -> u32 {
    if node_count == 0u {
        return STATUS_COMPLETE;
    }
    var stack: array<Postponed, #{STACK_ENTRIES}>;
    var entries = 0u;
    // Not in the loop, where WGSL would have it zeroed at each visit.
    var sorted: array<Postponed, #{WIDTH}>;
    var steps_left = step_budget;
    // Of what is entered: the link and the count of its record. The root has none; these would be its.
    var current = vec2<u32>(0u);
    loop {
        if steps_left == 0u {
            return STATUS_STEP_BUDGET;
        }
        steps_left -= 1u;
        if current.y != 0u {
            if visit_leaf(ray, current.x, current.y, collect) {
                return STATUS_COMPLETE;
            }
        } else {
            probe_inner_visit();
            let hits = hit_children(ray, current.x, (*collect).t_max, &sorted);
            if hits > 0u {
                for (var i = hits - 1u; i > 0u; i -= 1u) {
                    if entries == #{STACK_ENTRIES}u {
                        return STATUS_STACK_OVERFLOW;
                    }
                    stack[entries] = sorted[i];
                    entries += 1u;
                    probe_stack_depth(entries);
                }
                current = load_link_and_count(sorted[0].node);
                continue;
            }
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
        current = load_link_and_count(stack[entries].node);
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
