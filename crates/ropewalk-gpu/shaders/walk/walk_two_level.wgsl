// Both levels in one loop, with one stack: what waits of an object lies above what waits of the top level.
// Source: Reichl et al. 2010, sections 4.2.4 and 4.3; the twin of ropewalk's two_level/merged.rs, and of two_level/walk.rs with
//   the walks of the objects' structures that bottom.rs names, visit for visit. LEVEL_STACK is the file of the stack;
//   BOTTOM_KD_TREE, BOTTOM_WIDE and BOTTOM_LIST say what there is beside binary BVHs, VOLUMES is the file of the lists' volumes.
// Invariants: a stack of the top level's depth and that of the deepest object is never full. A step enters one node. Every node
//   of the top level is entered once, and every node of an object once for each of its instances.

#import #{SEEKER}
#import shared/enter
#import shared/levels
#import shared/postponed
#import #{LEVEL_STACK}
#import shared/probe
#import shared/status
#ifdef BOTTOM_KD_TREE
#import shared/level_cells
#endif
#ifdef BOTTOM_WIDE
#import shared/wide_bvh
#endif
#ifdef BOTTOM_LIST
#import shared/list
#import #{VOLUMES}
#endif

// Tests a triangle of an object. Whether the walk is over.
fn test_triangle(inside: Inside, triangle: Triangle, collect: ptr<function, Collect>) -> bool {
    probe_primitive_test();
    var hit: Hit;
    let limit = limit_inside(inside, (*collect).t_max);
    if intersect_triangle(triangle, inside.ray, limit, &hit) {
        return offer_moved(inside, hit, collect);
    }
    return false;
}

// Leads the ray through both levels; the status of the walk.
fn walk(seeker: Seeker, node_count: u32, step_budget: u32, collect: ptr<function, Collect>) -> u32 {
    if node_count == 0u {
        return STATUS_COMPLETE;
    }
    // Zero-filled: empty.
    var stack: LevelStack;
    var steps_left = step_budget;
    var level = IN_TOP_LEVEL;
    var inside: Inside;
    // Of a kd-tree: level the ray is in the current cell.
    var cell: Interval;
#ifdef BOTTOM_WIDE
    // Of a wide BVH: the link and the count of what is entered.
    var record = vec2<u32>(0u);
    var sorted: array<Postponed, #{WIDTH}>;
#endif
#ifdef BOTTOM_LIST
    // Of lists: the ray's, the layer that comes next, and the element.
    var list = 0u;
    var layer = 0u;
    var place = NO_ELEMENT;
#endif
    // The ray in the space that it is in.
    let wide_ray = widened(seeker.ray);
    var ray = wide_ray;
    // The place of the first node of what is walked, and of the current one.
    let top = top_level_nodes();
    var nodes = top;
    var current = top;
    loop {
        if steps_left == 0u {
            return STATUS_STEP_BUDGET;
        }
        steps_left -= 1u;
        var limit = (*collect).t_max;
        if level != IN_TOP_LEVEL {
            limit = limit_inside(inside, limit);
        }
        var go = false;
#ifdef BOTTOM_KD_TREE
        if level == IN_KD_TREE {
            let node = load_level_kd_node(nodes, current);
            if node.axis == LEAF_AXIS {
                probe_leaf_visit();
                for (var i = 0u; i < node.link; i += 1u) {
                    let index = inside.object.triangles + load_level_reference(inside.object, node.word + i);
                    if test_triangle(inside, load_triangle(index), collect) {
                        return STATUS_COMPLETE;
                    }
                }
            } else {
                probe_inner_visit();
                let crossing = cross_plane(ray, current, node);
                let near = near_span(cell, crossing);
                let far = far_span(cell, crossing);
                // One of the two is always open.
                let near_is_open = is_hit(near);
                go = true;
                if near_is_open && is_hit(far) {
                    if !push_level(&stack, Postponed(crossing.far, far.entry, far.exit)) {
                        return STATUS_STACK_OVERFLOW;
                    }
                    probe_stack_depth(held_of_level(&stack));
                }
                current = select(crossing.far, crossing.near, near_is_open);
                cell.entry = select(far.entry, near.entry, near_is_open);
                cell.exit = select(far.exit, near.exit, near_is_open);
            }
        }
#endif
#ifdef BOTTOM_WIDE
        if level == IN_WIDE_BVH {
            if record.y != 0u {
                probe_leaf_visit();
                for (var i = 0u; i < record.y; i += 1u) {
                    if test_triangle(inside, load_triangle(inside.object.triangles + record.x + i), collect) {
                        return STATUS_COMPLETE;
                    }
                }
            } else {
                probe_inner_visit();
                let hits = hit_children(ray, nodes + record.x, limit, &sorted);
                if hits > 0u {
                    for (var i = hits - 1u; i > 0u; i -= 1u) {
                        if !push_level(&stack, sorted[i]) {
                            return STATUS_STACK_OVERFLOW;
                        }
                        probe_stack_depth(held_of_level(&stack));
                    }
                    record = load_link_and_count(sorted[0].node);
                    go = true;
                }
            }
        }
#endif
#ifdef BOTTOM_LIST
        if level == IN_LIST {
            if place == NO_ELEMENT {
                go = layer < layer_count();
                if go {
                    enter_layer(layer);
                    place = first_element(layer, list);
                    layer += 1u;
                }
            } else {
                let element = load_element(place);
                var next = element.escape;
                if is_triangle(element) {
                    if test_triangle(inside, load_listed_triangle(element.payload), collect) {
                        return STATUS_COMPLETE;
                    }
                } else {
                    probe_inner_visit();
                    if is_hit(approach(ray, element.payload, limit)) {
                        next = 1;
                    }
                }
                // 0, behind the last triangle, and -1, where nothing follows.
                place = select(NO_ELEMENT, place + u32(next), next > 0);
                go = true;
            }
        }
#endif
        if level == IN_TOP_LEVEL || level == IN_BVH {
            let here = load_link_and_count(current);
            if here.y == 0u {
                probe_inner_visit();
                let first = current + 1u;
                let second = nodes + here.x;
                let first_node = load_node(first);
                let second_node = load_node(second);
                let a = slab_test(ray, first_node.low, first_node.high, limit);
                let b = slab_test(ray, second_node.low, second_node.high, limit);
                let hit_a = is_hit(a);
                let hit_b = is_hit(b);
                go = hit_a || hit_b;
                if go {
                    // The first child at equal distance, so that the order is one for all devices.
                    let go_second = hit_b && (!hit_a || b.entry < a.entry);
                    if hit_a && hit_b {
                        var far: Postponed;
                        far.node = select(second, first, go_second);
                        far.entry = select(b.entry, a.entry, go_second);
                        if !push_level(&stack, far) {
                            return STATUS_STACK_OVERFLOW;
                        }
                        probe_stack_depth(held_of_level(&stack));
                    }
                    current = select(first, second, go_second);
                }
            } else if level == IN_TOP_LEVEL {
                let entry = load_level_entry(here.x);
                if approach_instance(load_placed(entry.place), seeker, limit, &inside) {
                    probe_object_entered();
                    level = inside.object.kind;
                    begin_object(&stack, level == IN_KD_TREE);
                    ray = inside.ray;
                    nodes = inside.object.nodes;
                    current = nodes + entry.node;
                    go = true;
#ifdef BOTTOM_WIDE
                    // Of the root there is no record; this would be its.
                    record = vec2<u32>(0u);
#endif
#ifdef BOTTOM_LIST
                    if level == IN_LIST {
                        begin_lists(inside.object);
                        list = list_of(ray);
                        layer = 0u;
                        place = NO_ELEMENT;
                    }
#endif
#ifdef BOTTOM_KD_TREE
                    if level == IN_KD_TREE {
                        current = entry.node;
                        cell = slab_test(ray, entry.low, entry.high, limit_inside(inside, limit));
                        go = is_hit(cell);
                    }
#endif
                }
            } else {
                probe_leaf_visit();
                for (var i = 0u; i < here.y; i += 1u) {
                    if test_triangle(inside, load_triangle(inside.object.triangles + here.x + i), collect) {
                        return STATUS_COMPLETE;
                    }
                }
            }
        }
        while !go {
            var waiting: Postponed;
            if !pop_level(&stack, &waiting) {
                if level == IN_TOP_LEVEL {
                    return STATUS_COMPLETE;
                }
                // On with the top level.
                level = IN_TOP_LEVEL;
                end_object(&stack);
                ray = wide_ray;
                nodes = top;
                continue;
            }
            var limit_now = (*collect).t_max;
            if level != IN_TOP_LEVEL {
                limit_now = limit_inside(inside, limit_now);
            }
            // Closed: at equal t a smaller id may still win.
            go = waiting.entry <= limit_now;
            if go {
                current = waiting.node;
#ifdef BOTTOM_WIDE
                if level == IN_WIDE_BVH {
                    record = load_link_and_count(waiting.node);
                }
#endif
#ifdef BOTTOM_KD_TREE
                cell = Interval(waiting.entry, min(waiting.exit, limit_now));
#endif
            }
        }
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
