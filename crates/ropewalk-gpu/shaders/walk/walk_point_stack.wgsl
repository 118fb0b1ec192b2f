// The stack walk of point queries: nearer child first, leaves too, and a last look before a postponed child is entered.
// Source: the twin of ropewalk's point/walk/stack.rs, visit for visit.
// Invariants: one child a level is postponed, so a stack of the tree's depth is never full. A step enters one node,
//   and each node is entered once, so a budget of the number of nodes is never used up by a valid tree. A postponed
//   child's entry is the squared distance to its box.

#import shared/point_leaf
#import shared/postponed
#import shared/status

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
    var stack: array<Postponed, #{STACK_ENTRIES}>;
    var entries = 0u;
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
                if children.far_square <= (*collect).reach {
                    if entries == #{STACK_ENTRIES}u {
                        return STATUS_STACK_OVERFLOW;
                    }
                    stack[entries] = Postponed(children.far, children.far_square);
                    entries += 1u;
                    probe_stack_depth(entries);
                }
                current = children.near;
                link = children.near_link;
                count = children.near_count;
                continue;
            }
        }
        loop {
            if entries == 0u {
                return STATUS_COMPLETE;
            }
            entries -= 1u;
            // Closed: at equal distance a smaller id may still win.
            if stack[entries].entry <= (*collect).reach {
                break;
            }
        }
        current = stack[entries].node;
        let node = load_link_and_count(current);
        link = node.x;
        count = node.y;
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
