// The places of a kd-tree's nodes and the ropes of its leaves, for walks that go up, or from leaf to leaf.
// Source: Foley and Sugerman 2005 for parents and boxes, Popov et al. 2007 for ropes; the twins of ropewalk's
//   kd_tree/places.rs and ropes.rs.
// Invariants: as in shared/kd_tree.

#import shared/kd_tree

struct KdPlace {
    // The cell.
    low: vec3<f32>,
    high: vec3<f32>,
    // Of the root NONE.
    parent: u32,
    // The leaf's number, of an inner node NONE.
    leaf: u32,
}

fn load_kd_place(node: u32) -> KdPlace {
    let at = kd_words[3].x + 4u * node;
    let first = kd_words[at];
    let second = kd_words[at + 1u];
    let third = kd_words[at + 2u];
    let fourth = kd_words[at + 3u];
    return KdPlace(
        bitcast<vec3<f32>>(vec3<u32>(first, second.x)),
        bitcast<vec3<f32>>(vec3<u32>(third, fourth.x)),
        second.y,
        fourth.y,
    );
}

// The node beyond a face of a leaf, by the leaf's number: 2 * axis, and one more for the upper face. NONE outside of the tree.
fn load_rope(leaf: u32, face: u32) -> u32 {
    return kd_words[kd_words[3].y + 3u * leaf + face / 2u][face % 2u];
}
