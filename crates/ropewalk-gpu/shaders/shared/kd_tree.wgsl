// A kd-tree in two buffers: the twin of ropewalk's kd_tree/node.rs. One buffer has a header, the nodes and, for the walks
// that go from leaf to leaf, the places of all nodes and the ropes of all leaves; the other has the triangles, each once,
// and behind them the references of the leaves.
// Source: Wald 2004, section 7.2.1, for the eight bytes of a node; Popov et al. 2007 for the ropes. The header's places come
//   from ropewalk-gpu's shader/kd_layout.rs.
// Invariants: a node is one load of 8 bytes, a place four, a triangle three of 16. Nodes are in depth-first order, the lower
//   child beside its parent. Words are loaded as integers, since those of identity may look like a NaN.

#import shared/cells
#import shared/triangle

@group(#{STRUCTURE_GROUP}) @binding(0) var<storage, read> kd_words: array<vec2<u32>>;
@group(#{STRUCTURE_GROUP}) @binding(1) var<storage, read> kd_triangles: array<vec4<u32>>;

fn load_kd_node(index: u32) -> KdNode {
    return kd_node(kd_words[#{KD_HEADER_PAIRS}u + index]);
}

// Where the ray is in the box of the whole tree, up to `limit`.
fn whole_tree(ray: PreparedRay, limit: f32) -> Interval {
    let first = kd_words[0];
    let second = kd_words[1];
    let third = kd_words[2];
    let low = bitcast<vec3<f32>>(vec3<u32>(first, second.x));
    let high = bitcast<vec3<f32>>(vec3<u32>(second.y, third));
    return slab_test(ray, low, high, limit);
}

// The triangle of a reference, by the reference's place.
fn load_referenced_triangle(reference: u32) -> Triangle {
    let at = 3u * kd_triangles[kd_words[4].x + reference / 4u][reference % 4u];
    let first = kd_triangles[at];
    let second = kd_triangles[at + 1u];
    let third = kd_triangles[at + 2u];
    return Triangle(
        bitcast<vec3<f32>>(first.xyz),
        first.w,
        bitcast<vec3<f32>>(second.xyz),
        second.w,
        bitcast<vec3<f32>>(third.xyz),
        third.w,
    );
}
