// The traversal lists of an object, in the buffers of both levels.
// Source: as shared/list.
// Invariants: as shared/levels. Lists are begun before anything of them is loaded. The same names as list_buffers.

#import shared/levels

// The first word of the header and of the elements, and that of the vertices, of the lists that the ray is in.
var<private> list_base: u32;
var<private> shared_base: u32;

fn begin_lists(object: LevelObject) {
    list_base = 4u * object.nodes;
    shared_base = 12u * object.triangles;
}

fn list_word(place: u32) -> u32 {
    let word = list_base + place;
    return bvh_nodes[word / 4u][word % 4u];
}

fn shared_word(place: u32) -> u32 {
    let word = shared_base + place;
    return bvh_triangles[word / 4u][word % 4u];
}
