// The restart trail of a wide tree: of each level the number of finished children leads back after a restart at the root.
// Source: Laine 2010, section 4, as future work; the twin of the trail's walk in ropewalk's wide_bvh/walk, visit for
//   visit. TRAIL is the file of the trail's bits, SHORT_STACK that of the stack.
// Invariants: those of walk_bvh_restart_trail. Children in progress are never culled, and are sorted alike at every
//   visit, so the finished ones are always the first of the sorted.

#import shared/leaf
#import shared/wide_bvh
#import shared/status
#import #{TRAIL}
#import #{SHORT_STACK}

// On an entry of the stack, beside the record's place: no sibling comes after it. No buffer has so many records.
const LAST_SIBLING: u32 = 0x80000000u;

// Leads the ray through the tree; the status of the walk.
fn walk(ray: PreparedRay, node_count: u32, step_budget: u32, collect: ptr<function, Collect>) -> u32 {
    if node_count == 0u {
        return STATUS_COMPLETE;
    }
    var trail = new_trail();
    // Zero-filled: empty.
    var stack: ShortStack;
    // Not in the loop, where WGSL would have it zeroed at each visit.
    var sorted: array<Postponed, #{WIDTH}>;
    var steps_left = step_budget;
    // Of what is entered: the link and the count of its record. The root has none; these would be its.
    var current = vec2<u32>(0u);
    var level = 0u;
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
            let finished = finished_children(&trail, level);
            if finished < hits {
                let last = hits - 1u;
                if finished == last {
                    set_last(&trail, level);
                } else {
                    sorted[last].node |= LAST_SIBLING;
                    for (var i = last; i > finished; i -= 1u) {
                        probe_stack_depth(push_short(&stack, sorted[i]));
                    }
                }
                current = load_link_and_count(sorted[finished].node);
                level += 1u;
                continue;
            }
        }
        loop {
            // Each entry that is culled is finished by itself, like one that is visited.
            level = finish_trail(&trail, level);
            if level == 0u {
                return STATUS_COMPLETE;
            }
            var next: Postponed;
            if !pop_short(&stack, &next) {
                probe_restart();
                current = vec2<u32>(0u);
                level = 0u;
                break;
            }
            if (next.node & LAST_SIBLING) != 0u {
                set_last(&trail, level - 1u);
            }
            // Closed: at equal t a smaller id may still win.
            if next.entry <= (*collect).t_max {
                current = load_link_and_count(next.node & ~LAST_SIBLING);
                break;
            }
        }
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
