// What happens in a leaf, and between the children of a node: the twin of PointVisitor in ropewalk's point/visitor.rs
// and of `children` in point/walk/mod.rs.
// Source: the same.
// Invariants: the triangles are asked in their order. The first child comes first at equal distance, so that the order
//   is one for all devices.

#import shared/point_triangle
#import #{POINT_COLLECT}
#import shared/probe

// Asks `count` triangles from `first` on.
fn visit_point_leaf(query: PreparedPoint, first: u32, count: u32, collect: ptr<function, PointCollect>) {
    probe_leaf_visit();
    for (var i = 0u; i < count; i += 1u) {
        probe_primitive_test();
        var square: f32;
        if measure_triangle(load_triangle(first + i), query, (*collect).reach, &square) {
            offer_point(collect, Found(sqrt(square), first + i));
        }
    }
}

// The children of an inner node, with the squared distances to their boxes.
struct PointChildren {
    near: u32,
    near_link: u32,
    near_count: u32,
    near_square: f32,
    far: u32,
    far_link: u32,
    far_count: u32,
    far_square: f32,
}

fn measure_children(point: vec3<f32>, first: u32, second: u32) -> PointChildren {
    let a = load_node(first);
    let b = load_node(second);
    let square_a = box_distance_squared(point, a.low, a.high);
    let square_b = box_distance_squared(point, b.low, b.high);
    let go_second = square_b < square_a;
    return PointChildren(
        select(first, second, go_second),
        select(a.link, b.link, go_second),
        select(a.count, b.count, go_second),
        select(square_a, square_b, go_second),
        select(second, first, go_second),
        select(b.link, a.link, go_second),
        select(b.count, a.count, go_second),
        select(square_b, square_a, go_second),
    );
}
