// The restart trail: a bit a level leads back after a restart at the root, so that the stack may be of any size, or none.
// Source: Laine 2010; the twin of ropewalk's bvh/walk/restart_trail.rs, visit for visit; its corrections are named there.
//   SEEKER is the file of what goes through the tree, TRAIL that of the trail's bits, SHORT_STACK that of the stack.
// Invariants: the tree is no deeper than the trail. A step enters one node. Each way down begins at the root or at an
//   entry of the stack, is no longer than the tree is deep, and ends where a subtree is finished; these subtrees do not
//   overlap. So a valid tree never uses up a budget of its leaves times the nodes on its longest path.

#import #{SEEKER}
#import shared/status
#import #{TRAIL}
#import #{SHORT_STACK}

// Leads the seeker through the tree; the status of the walk.
fn walk(seeker: Seeker, node_count: u32, step_budget: u32, collect: ptr<function, Collect>) -> u32 {
    if node_count == 0u {
        return STATUS_COMPLETE;
    }
    var trail = new_trail();
    // Zero-filled: empty.
    var stack: ShortStack;
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
                descend(&trail);
                var go_second = hit_b;
                var go = true;
                if hit_a && hit_b {
                    // The first child at equal distance, so that the order is one for all devices.
                    let second_is_near = b.entry < a.entry;
                    let near_done = is_near_done(&trail);
                    go_second = second_is_near != near_done;
                    if !near_done {
                        let far = Postponed(
                            select(second, first, second_is_near),
                            select(b.entry, a.entry, second_is_near),
                        );
                        probe_stack_depth(push_short(&stack, far));
                    }
                } else if is_far_level(&trail) {
                    // Both were hit when the walk came by first, and the near one is finished: the hits since then
                    // cull the far one.
                    go = false;
                } else {
                    set_single(&trail);
                }
                if go {
                    current = select(first, second, go_second);
                    link = select(first_node.link, second_node.link, go_second);
                    count = select(first_node.count, second_node.count, go_second);
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
            if far.entry <= limit_of(collect) {
                current = far.node;
                break;
            }
        }
        let node = load_node(current);
        link = node.link;
        count = node.count;
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
