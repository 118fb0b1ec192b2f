// The walk of traversal lists: on by one element, or by as many as the escape index says; layer after layer.
// Source: the twin of ropewalk's traversal_list/walk.rs, visit for visit; what the paper's pseudocode gets wrong is named
//   there. SEEKER is the file of the inner nodes' volumes. With STARTS a ray begins with heads, which a function
//   load_start(layer) of the kernel gives: counted from the first element of its list.
// Invariants: each layer has a list for the ray, or an empty one; the ray's limit goes on from one layer to the next. A
//   step asks one element, and each is asked once, so a budget of the elements of a ray's lists is never used up by
//   valid lists.

#import #{SEEKER}
#import #{COLLECT}
#import shared/list
#import shared/probe
#import shared/status

// Leads the ray through its lists; the status of the walk. The number of elements is of no use here: lists end by
// themselves.
fn walk(ray: Seeker, element_count: u32, step_budget: u32, collect: ptr<function, Collect>) -> u32 {
    let layers = layer_count();
    let list = list_of(ray);
    var steps_left = step_budget;
    var layer = 0u;
    var place = NO_ELEMENT;
    // One loop for all layers: neighbours that are at different ones need not wait for each other.
    loop {
        if place == NO_ELEMENT {
            if layer == layers {
                return STATUS_COMPLETE;
            }
            enter_layer(layer);
            place = first_element(layer, list);
#ifdef STARTS
            if place != NO_ELEMENT {
                let head = load_start(layer);
                place = select(place + head, NO_ELEMENT, head == #{NO_HEAD});
            }
#endif
            layer += 1u;
            continue;
        }
        if steps_left == 0u {
            return STATUS_STEP_BUDGET;
        }
        steps_left -= 1u;
        let element = load_element(place);
        var next = element.escape;
        if is_triangle(element) {
            probe_primitive_test();
            var hit: Hit;
            if intersect_triangle(load_listed_triangle(element.payload), ray, (*collect).t_max, &hit) {
                if offer(collect, hit) {
                    return STATUS_COMPLETE;
                }
            }
        } else {
            probe_inner_visit();
            if is_hit(approach(ray, element.payload, (*collect).t_max)) {
                next = 1;
            }
        }
        // 0, behind the last triangle, and -1, where nothing follows.
        place = select(NO_ELEMENT, place + u32(next), next > 0);
    }
    // Never reached; WGSL wants it.
    return STATUS_COMPLETE;
}
