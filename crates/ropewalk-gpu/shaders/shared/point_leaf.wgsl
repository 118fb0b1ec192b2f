// What happens in a leaf in search of what is near a point: the twin of PointVisitor in ropewalk's point/visitor.rs.
// Source: the same.
// Invariants: the triangles are asked in their order, and all of them. The same function as shared/leaf.

#import shared/point_triangle
#import #{COLLECT}
#import shared/probe

// Asks `count` triangles from `first` on. No answer ends the walk.
fn visit_leaf(query: PreparedPoint, first: u32, count: u32, collect: ptr<function, Collect>) -> bool {
    probe_leaf_visit();
    for (var i = 0u; i < count; i += 1u) {
        probe_primitive_test();
        var square: f32;
        if measure_triangle(load_triangle(first + i), query, (*collect).reach, &square) {
            offer_point(collect, Found(sqrt(square), first + i));
        }
    }
    return false;
}
