// What happens in a leaf: the twin of TriangleVisitor in ropewalk's visitor.rs.
// Source: the same.
// Invariants: the triangles are tested in their order, and none after an offer that says enough.

#import shared/bvh
#import #{COLLECT}
#import shared/probe

// Tests `count` triangles from `first` on. Whether the walk is over.
fn visit_leaf(ray: PreparedRay, first: u32, count: u32, collect: ptr<function, Collect>) -> bool {
    probe_leaf_visit();
    for (var i = 0u; i < count; i += 1u) {
        probe_primitive_test();
        var hit: Hit;
        if intersect_triangle(load_triangle(first + i), ray, (*collect).t_max, &hit) {
            if offer(collect, hit) {
                return true;
            }
        }
    }
    return false;
}
