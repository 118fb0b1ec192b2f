// A BVH in two buffers: the twin of ropewalk's bvh/node.rs and of FlatTriangle.
// Source: the same. A binary tree is in depth-first order, the first child beside its parent, the second child at the
//   link; for a wide one see shared/wide_bvh.
// Invariants: each node is two loads of 16 bytes, each triangle three. They are loaded as integers: the words of
//   identity may look like a NaN, which a driver may alter when it passes for a float.

#import shared/triangle

@group(#{STRUCTURE_GROUP}) @binding(0) var<storage, read> bvh_nodes: array<vec4<u32>>;
@group(#{STRUCTURE_GROUP}) @binding(1) var<storage, read> bvh_triangles: array<vec4<u32>>;

struct BvhNode {
    low: vec3<f32>,
    high: vec3<f32>,
    // Inner: the index of the second child, or of the wide node. Leaf: the index of the first triangle.
    link: u32,
    // Inner: 0. Leaf: the number of triangles.
    count: u32,
}

fn load_node(index: u32) -> BvhNode {
    let low = bvh_nodes[2u * index];
    let high = bvh_nodes[2u * index + 1u];
    return BvhNode(bitcast<vec3<f32>>(low.xyz), bitcast<vec3<f32>>(high.xyz), low.w, high.w);
}

// The part of a node that says where it leads.
fn load_link_and_count(index: u32) -> vec2<u32> {
    return vec2<u32>(bvh_nodes[2u * index].w, bvh_nodes[2u * index + 1u].w);
}

fn load_triangle(index: u32) -> Triangle {
    let first = bvh_triangles[3u * index];
    let second = bvh_triangles[3u * index + 1u];
    let third = bvh_triangles[3u * index + 2u];
    return Triangle(
        bitcast<vec3<f32>>(first.xyz),
        first.w,
        bitcast<vec3<f32>>(second.xyz),
        second.w,
        bitcast<vec3<f32>>(third.xyz),
        third.w,
    );
}
