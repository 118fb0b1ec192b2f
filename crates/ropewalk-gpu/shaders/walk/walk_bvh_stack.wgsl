// The ordered stack walk: nearer child first, leaves too, and a last look before a postponed child is entered.
// Source: the twin of ropewalk's bvh/walk/ordered.rs, visit for visit. SEEKER is the file of what goes through the tree.
// Invariants: one child a level is postponed, so a stack of the tree's depth is never full. A step enters one node,
//   and each node is entered once, so a budget of the number of nodes is never used up by a valid tree.

#import #{SEEKER}
#import shared/postponed
#import shared/status

// Leads the seeker through the tree; the status of the walk.
fn walk(seeker: Seeker, node_count: u32, step_budget: u32, collect: ptr<function, Collect>) -> u32 {
    if node_count == 0u {
        return STATUS_COMPLETE;
    }
    var stack: array<Postponed, #{STACK_ENTRIES}>;
    var entries = 0u;
    var steps_left = step_budget;
    var current = 0u;
    let root = load_node(0u);
    // Of the current node; a child's are at hand when its box has been asked.
    var link = root.link;
    var count = root.count;
    loop {
        if steps_left == 0u {
            return STATUS_STEP_BUDGET;
        }
        steps_left -= 1u;
        if count != 0u {
            if visit_leaf(seeker, link, count, collect) {
                return STATUS_COMPLETE;
            }
        } else {
            probe_inner_visit();
            let first = current + 1u;
            let second = link;
            let first_node = load_node(first);
            let second_node = load_node(second);
            let limit = limit_of(collect);
            let a = approach(seeker, first_node.low, first_node.high, limit);
            let b = approach(seeker, second_node.low, second_node.high, limit);
            let hit_a = is_hit(a);
            let hit_b = is_hit(b);
            if hit_a || hit_b {
                // The first child at equal distance, so that the order is one for all devices.
                let go_second = hit_b && (!hit_a || b.entry < a.entry);
                if hit_a && hit_b {
                    if entries == #{STACK_ENTRIES}u {
                        return STATUS_STACK_OVERFLOW;
                    }
                    stack[entries] =
                        Postponed(select(second, first, go_second), select(b.entry, a.entry, go_second));
                    entries += 1u;
                    probe_stack_depth(entries);
                }
                current = select(first, second, go_second);
                link = select(first_node.link, second_node.link, go_second);
                count = select(first_node.count, second_node.count, go_second);
                continue;
            }
        }
        loop {
            if entries == 0u {
                return STATUS_COMPLETE;
            }
            entries -= 1u;
            // Closed: at equal distance a smaller id may still win.
            if stack[entries].entry <= limit_of(collect) {
                break;
            }
        }
        current = stack[entries].node;
        let node = load_node(current);
        link = node.link;
        count = node.count;
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
