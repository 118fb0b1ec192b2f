// Rows of heads that are triangles: rays that leave one by its front.
// Source: the twin of ropewalk's traversal_list/heads/polygon.rs, and of goes_with_all in cull.rs.
// Invariants: a row is a triangle's number and its three vertices' indices. Of the half-spaces of a list the normals count
//   alone: they begin at the triangle.

#import shared/list
#import shared/half_space

// Whether no direction of the list runs against a normal.
fn goes_with_all(lists: u32, along: vec3<f32>, normal: vec3<f32>) -> bool {
    let with_list = normal * along;
    switch lists {
        case 2u: {
            return with_list.x >= 0.0 && normal.y == 0.0 && normal.z == 0.0;
        }
        case 6u: {
            let beside = abs(normal * (vec3<f32>(1.0) - abs(along)));
            let others = beside.x + beside.y + beside.z;
            return with_list.x + with_list.y + with_list.z >= others;
        }
        case 8u: {
            return all(with_list >= vec3<f32>(0.0));
        }
        default: {
            return false;
        }
    }
}

// Gathers what a row's rays of a list stay within; false where no ray is of the list. `at` is where the list's words are,
// `rows_at` where the rows begin.
fn gather_half_spaces(row: u32, list: u32, at: u32, rows_at: u32) -> bool {
    let record = rows_at + 4u * row;
    let a = load_vertex(records[record + 1u]);
    let b = load_vertex(records[record + 2u]);
    let c = load_vertex(records[record + 3u]);
    let mirrored = (shared_word(list_word(2) + 3u * records[record] + 1u) & #{MIRROR}) != 0u;
    let normal = cross(b - a, c - a);
    let front = select(normal, -normal, mirrored);
    if goes_with_all(list_word(1), load_record_vector(at + 1u), -front) {
        return false;
    }
    let largest = bitcast<f32>(list_word(4));
    let size = max(abs(front.x), max(abs(front.y), abs(front.z)));
    let size_bits = bitcast<u32>(size);
    if size_bits > 0u && size_bits < 0x7f800000u {
        // The last of the list's words is the share by which the triangle's own is moved.
        let share = bitcast<f32>(records[at + #{HEAD_LIST_WORDS}u - 1u]);
        add_half_space(half_space_from(front / size, a, b, c, share, largest));
    }
    let facets = records[at];
    for (var facet = 0u; facet < facets; facet += 1u) {
        let normal = load_record_vector(at + 4u + 5u * facet);
        add_half_space(half_space_from(normal, a, b, c, #{HEAD_PAD}, largest));
    }
    return true;
}
