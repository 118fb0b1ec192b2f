// The nearest point of a triangle, its foot: the twin of Foot in ropewalk's point/foot.rs.
// Source: the same, which explains the seven candidates, the scaling and the second look at the weights.
// Invariants: a quotient is formed only where its divisor is positive; where Rust divides by zero all the same, it
//   refuses what comes of it. Vertices and edges are picked by comparisons, since an array with a variable index would
//   lie in memory. Sums of more than one product are dot(): see shared/triangle. What lavapipe does to other sums was
//   found by comparing: it takes out a factor that both terms have, and adds three terms in the order that it likes.

struct Foot {
    // The vertex from which the foot is measured.
    vertex: u32,
    // The weights of the vertex after it and of the one after that.
    along: vec2<f32>,
    // The squared distance.
    square: f32,
}

// One of three, by its number.
fn pick(index: u32, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> vec3<f32> {
    return select(select(c, b, index == 1u), a, index == 0u);
}

// From a place along parts of two ways: start + (one * along.x + other * along.y), in this order.
fn along_two(start: vec3<f32>, one: vec3<f32>, other: vec3<f32>, along: vec2<f32>) -> vec3<f32> {
    let parts = vec3<f32>(along, 1.0);
    return vec3<f32>(
        dot(vec3<f32>(one.x, other.x, start.x), parts),
        dot(vec3<f32>(one.y, other.y, start.y), parts),
        dot(vec3<f32>(one.z, other.z, start.z), parts),
    );
}

// An end of an edge: a vertex, the way to it from the point, and that way's square.
struct EdgeEnd {
    vertex: u32,
    corner: vec3<f32>,
    square: f32,
}

// Keeps the foot inside of an edge, measured from its nearer end, where it is nearer than what there is.
fn keep_foot_on_edge(best: ptr<function, Foot>, one: EdgeEnd, other: EdgeEnd, edge: vec3<f32>, length: f32) {
    if !(length > 0.0) {
        return;
    }
    let backwards = other.square < one.square;
    let corner = select(one.corner, other.corner, backwards);
    let way = select(edge, -edge, backwards);
    let weight = -dot(corner, way) / length;
    if !(weight > 0.0 && weight < 1.0) {
        return;
    }
    let offset = corner + way * weight;
    let square = dot(offset, offset);
    if square < (*best).square {
        let along = select(vec2<f32>(weight, 0.0), vec2<f32>(0.0, weight), backwards);
        *best = Foot(select(one.vertex, other.vertex, backwards), along, square);
    }
}

// The weights of a way in the face: of the edge `one` and of the edge `other`.
fn face_weights(normal: vec3<f32>, one: vec3<f32>, other: vec3<f32>, way: vec3<f32>, area: f32) -> vec2<f32> {
    return vec2<f32>(dot(normal, cross(way, other)) / area, dot(normal, cross(one, way)) / area);
}

fn find_foot(point: vec3<f32>, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> Foot {
    let corner_0 = v0 - point;
    let corner_1 = v1 - point;
    let corner_2 = v2 - point;
    let edge_0 = v1 - v0;
    let edge_1 = v2 - v1;
    let edge_2 = v0 - v2;
    let square_0 = dot(corner_0, corner_0);
    let square_1 = dot(corner_1, corner_1);
    let square_2 = dot(corner_2, corner_2);
    let length_0 = dot(edge_0, edge_0);
    let length_1 = dot(edge_1, edge_1);
    let length_2 = dot(edge_2, edge_2);

    var nearest = 2u;
    var nearest_square = square_2;
    if square_0 <= square_1 && square_0 <= square_2 {
        nearest = 0u;
        nearest_square = square_0;
    } else if square_1 <= square_2 {
        nearest = 1u;
        nearest_square = square_1;
    }
    // Of two equally near, the one with fewer weights.
    var best = Foot(nearest, vec2<f32>(0.0), nearest_square);

    let end_0 = EdgeEnd(0u, corner_0, square_0);
    let end_1 = EdgeEnd(1u, corner_1, square_1);
    let end_2 = EdgeEnd(2u, corner_2, square_2);
    keep_foot_on_edge(&best, end_0, end_1, edge_0, length_0);
    keep_foot_on_edge(&best, end_1, end_2, edge_1, length_1);
    keep_foot_on_edge(&best, end_2, end_0, edge_2, length_2);

    let extents = max(abs(edge_0), max(abs(edge_1), abs(edge_2)));
    let extent = max(extents.x, max(extents.y, extents.z));
    // One over the largest power of two that is no larger than the extent, by the bits of the exponent.
    let scale = bitcast<f32>(0x7f000000u - (bitcast<u32>(extent) & 0x7f800000u));
    let ab = edge_0 * scale;
    let bc = edge_1 * scale;
    let ca = edge_2 * scale;
    var normal_one = ab;
    var normal_other = bc;
    if length_0 >= length_1 && length_0 >= length_2 {
        normal_one = bc;
        normal_other = ca;
    } else if length_1 >= length_2 {
        normal_one = ca;
        normal_other = ab;
    }
    let normal = cross(normal_one, normal_other);
    let area = dot(normal, normal);
    if area > 0.0 {
        let corner = pick(nearest, corner_0, corner_1, corner_2);
        let one = pick(nearest, edge_0, edge_1, edge_2);
        let other = -pick(nearest, edge_2, edge_0, edge_1);
        let one_scaled = one * scale;
        let other_scaled = other * scale;
        let way = corner * -scale;
        let first = face_weights(normal, one_scaled, other_scaled, way, area);
        let left_over = way - (one_scaled * first.x + other_scaled * first.y);
        let more = face_weights(normal, one_scaled, other_scaled, left_over, area);
        let along = first + more;
        if along.x > 0.0 && along.y > 0.0 && along.x + along.y < 1.0 {
            let offset = along_two(corner, one, other, along);
            let square = dot(offset, offset);
            if square < best.square {
                best = Foot(nearest, along, square);
            }
        }
    }
    return best;
}

// The weights of the second and of the third vertex.
fn foot_barycentrics(foot: Foot) -> vec2<f32> {
    let rest = 1.0 - (foot.along.x + foot.along.y);
    if foot.vertex == 0u {
        return foot.along;
    }
    if foot.vertex == 1u {
        return vec2<f32>(rest, foot.along.x);
    }
    return vec2<f32>(foot.along.y, rest);
}

// The foot itself.
fn foot_position(foot: Foot, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> vec3<f32> {
    let start = pick(foot.vertex, v0, v1, v2);
    let one = pick(foot.vertex, v1, v2, v0) - start;
    let other = pick(foot.vertex, v2, v0, v1) - start;
    return along_two(start, one, other, foot.along);
}
