// The kernel of heads: where a ray may begin that stays within half-spaces. One invocation a head.
// Source: the twin of ropewalk's traversal_list/heads. ROWS is the file of what the rows are about, OUTSIDE that of the
//   inner nodes' volumes.
// Invariants: those of kernel/frame. The records begin with so many words for each list of a layer: how many half-spaces
//   all rows have there, the list's direction, and those half-spaces; then come the rows. A search asks each element of a
//   list at most once. An element is passed by only where it lies outside of one half-space as a whole.

#import shared/list
#import shared/loops
#import shared/status
#import kernel/frame
#import #{OUTSIDE}
#import #{ROWS}

@group(#{BATCH_GROUP}) @binding(1) var<storage, read_write> results: array<vec2<u32>>;

// Of a search: all half-spaces, of which some are the row's own and the others those of all rows.
var<private> half_spaces: array<HalfSpace, #{MOST_HALF_SPACES}>;
var<private> half_space_count: u32;

fn add_half_space(space: HalfSpace) {
    half_spaces[half_space_count] = space;
    half_space_count += 1u;
}

fn load_record_vector(at: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(vec3<u32>(records[at], records[at + 1u], records[at + 2u]));
}

fn load_half_space(at: u32) -> HalfSpace {
    return HalfSpace(
        load_record_vector(at),
        bitcast<f32>(records[at + 3u]),
        bitcast<f32>(records[at + 4u]),
    );
}

// Whether an element lies outside of one of the half-spaces.
fn is_outside(layer: u32, element: Element) -> bool {
    if is_triangle(element) {
        let a = load_vertex(element.payload.x);
        let b = load_vertex(element.payload.y);
        let c = load_vertex(element.payload.z);
#repeat INDEX #{MOST_HALF_SPACES}
        if #{INDEX}u < half_space_count && excludes_triangle(half_spaces[#{INDEX}], a, b, c) {
            return true;
        }
#endrepeat
        return false;
    }
#repeat INDEX #{MOST_HALF_SPACES}
    if #{INDEX}u < half_space_count && excludes_volume(half_spaces[#{INDEX}], layer, element.payload) {
        return true;
    }
#endrepeat
    return false;
}

// The head of a list, counted from its first element, and the status of the search.
fn find_head(layer: u32, list: u32, step_budget: u32) -> vec2<u32> {
    let first = first_element(layer, list);
    if first == NO_ELEMENT {
        return vec2<u32>(#{NO_HEAD}, STATUS_COMPLETE);
    }
    var place = first;
    var head = first;
    for (var steps_left = step_budget; steps_left > 0u; steps_left -= 1u) {
        let element = load_element(place);
        if is_outside(layer, element) {
            if element.escape <= 0 {
                return vec2<u32>(#{NO_HEAD}, STATUS_COMPLETE);
            }
            place += u32(element.escape);
            // Not the triangle that the search ends with: what it passed on the way down must be asked again.
            head = place;
        } else if is_triangle(element) {
            return vec2<u32>(head - first, STATUS_COMPLETE);
        } else {
            place += 1u;
        }
    }
    return vec2<u32>(#{NO_HEAD}, STATUS_STEP_BUDGET);
}

fn answer(index: u32) {
    let row = index / batch.k;
    let lists = list_word(1);
    // Of all lists of all layers.
    let own = index - row * batch.k;
    var layer = 0u;
    var list = own;
    while list >= lists {
        list -= lists;
        layer += 1u;
    }
    half_space_count = 0u;
    var found = vec2<u32>(#{NO_HEAD}, STATUS_COMPLETE);
    if gather_half_spaces(row, list, #{HEAD_LIST_WORDS}u * list, #{HEAD_LIST_WORDS}u * lists) {
        found = find_head(layer, list, batch.step_budget);
    }
    if loops_were_cut(min(batch.count, 1u)) {
        found.y = STATUS_STEP_BUDGET;
    }
    results[index] = vec2<u32>(found.x, found.y | #{STATUS_WRITTEN});
}
