// The stack walk of the blog of 2022 in its three stages: plain; CULL: boxes behind the closest hit are ignored; SORT,
// only with CULL: of two inner children the nearer one first. A leaf is handled at its parent.
// Source: the twin of ropewalk's bvh/walk/postponed.rs, visit for visit; its corrections are named there.
// Invariants: as in walk_bvh_stack. A step tests the children of one inner node.

#import shared/leaf
#import shared/status

// How far boxes are of interest.
fn box_limit(ray: PreparedRay, t_max: f32) -> f32 {
#ifdef CULL
    return t_max;
#else
    return ray.t_max;
#endif
}

// Whether a box that was hit before a leaf shortened the ray still counts.
fn still_hit(entry: f32, t_max: f32) -> bool {
#ifdef CULL
    return entry <= t_max;
#else
    return true;
#endif
}

// Whether the second of two inner children is entered first.
fn second_goes_first(first_entry: f32, second_entry: f32) -> bool {
#ifdef SORT
    return second_entry < first_entry;
#else
    return false;
#endif
}

// Leads the ray through the tree; the status of the walk.
fn walk(ray: PreparedRay, node_count: u32, step_budget: u32, collect: ptr<function, Collect>) -> u32 {
    if node_count == 0u {
        return STATUS_COMPLETE;
    }
    let root = load_node(0u);
    if root.count != 0u {
        if step_budget == 0u {
            return STATUS_STEP_BUDGET;
        }
        visit_leaf(ray, root.link, root.count, collect);
        return STATUS_COMPLETE;
    }
    var stack: array<u32, #{STACK_ENTRIES}>;
    var entries = 0u;
    var steps_left = step_budget;
    var current = 0u;
    // Of the current node, which is an inner one.
    var link = root.link;
    loop {
        if steps_left == 0u {
            return STATUS_STEP_BUDGET;
        }
        steps_left -= 1u;
        probe_inner_visit();
        let limit = box_limit(ray, (*collect).t_max);
        let first = current + 1u;
        let second = link;
        let first_node = load_node(first);
        let second_node = load_node(second);
        let a = slab_test(ray, first_node.low, first_node.high, limit);
        let b = slab_test(ray, second_node.low, second_node.high, limit);
        var enter_first = is_hit(a);
        if enter_first && first_node.count != 0u {
            if visit_leaf(ray, first_node.link, first_node.count, collect) {
                return STATUS_COMPLETE;
            }
            enter_first = false;
        }
        var enter_second = is_hit(b) && still_hit(b.entry, (*collect).t_max);
        if enter_second && second_node.count != 0u {
            if visit_leaf(ray, second_node.link, second_node.count, collect) {
                return STATUS_COMPLETE;
            }
            enter_second = false;
        }
        // The second one's leaf may have shortened the ray for the first child.
        enter_first = enter_first && still_hit(a.entry, (*collect).t_max);
        if enter_first || enter_second {
            let go_second = enter_second && (!enter_first || second_goes_first(a.entry, b.entry));
            if enter_first && enter_second {
                if entries == #{STACK_ENTRIES}u {
                    return STATUS_STACK_OVERFLOW;
                }
                stack[entries] = select(second, first, go_second);
                entries += 1u;
                probe_stack_depth(entries);
            }
            current = select(first, second, go_second);
            link = select(first_node.link, second_node.link, go_second);
        } else {
            if entries == 0u {
                return STATUS_COMPLETE;
            }
            entries -= 1u;
            current = stack[entries];
            link = load_node(current).link;
        }
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
