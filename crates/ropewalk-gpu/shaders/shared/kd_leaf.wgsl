// What happens in a leaf of a kd-tree: the twin of ReferenceVisitor in ropewalk's kd_tree/walk/visitor.rs.
// Source: the same.
// Invariants: the triangles are tested in the order of the references, and none after an offer that says enough.

#import shared/kd_tree
#import #{COLLECT}
#import shared/probe

// Tests the triangles of `count` references from `first` on. Whether the walk is over.
fn visit_leaf(ray: PreparedRay, first: u32, count: u32, collect: ptr<function, Collect>) -> bool {
    probe_leaf_visit();
    for (var i = 0u; i < count; i += 1u) {
        probe_primitive_test();
        var hit: Hit;
        if intersect_triangle(load_referenced_triangle(first + i), ray, (*collect).t_max, &hit) {
            if offer(collect, hit) {
                return true;
            }
        }
    }
    return false;
}
