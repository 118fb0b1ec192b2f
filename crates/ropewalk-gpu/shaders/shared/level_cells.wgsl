// The kd-trees of objects, in the buffers of both levels.
// Source: as shared/kd_tree.
// Invariants: as shared/levels. Two nodes share a four of words.

#import shared/cells
#import shared/levels

// By the place of the tree's first node and the node's index.
fn load_level_kd_node(nodes: u32, index: u32) -> KdNode {
    let four = bvh_nodes[nodes + index / 2u];
    return kd_node(select(four.xy, four.zw, (index & 1u) != 0u));
}

// The index of a triangle within the object, by the reference's place.
fn load_level_reference(object: LevelObject, reference: u32) -> u32 {
    return bvh_triangles[object.references + reference / 4u][reference % 4u];
}
