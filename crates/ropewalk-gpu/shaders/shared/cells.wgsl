// The cells of a kd-tree, by the planes that a ray crosses on its way down.
// Source: Wald 2004; that a cell's interval is the padded slab test of the cell's box, plane by plane, and why, is explained
//   in ropewalk's kd_tree/walk/crossing.rs.
// Invariants: same operations in the same order as in Rust. Which child is near depends on the ray's direction alone.

#import shared/aabb

// The axis of a leaf.
const LEAF_AXIS: u32 = 3u;

struct KdNode {
    // 0, 1 or 2, or LEAF_AXIS.
    axis: u32,
    // Inner: the bits of the split. Leaf: the index of its first reference.
    word: u32,
    // Inner: the index of the upper child. Leaf: the number of references.
    link: u32,
}

fn kd_node(words: vec2<u32>) -> KdNode {
    return KdNode(words.y & 3u, words.x, words.y >> 2u);
}

// The two children of an inner node, as the ray meets them.
struct Crossing {
    near: u32,
    far: u32,
    // Where the near child ends and the far one begins, padded: they overlap.
    near_exit: f32,
    far_entry: f32,
    // Whether the ray meets the plane at one point: it is not parallel to it.
    is_point: bool,
}

fn cross_plane(ray: PreparedRay, index: u32, node: KdNode) -> Crossing {
    let split = bitcast<f32>(node.word);
    let inverse = ray.inverse[node.axis];
    // The lower face of the upper child, and the upper face of the lower one: they differ where the ray is parallel to them.
    let at_low = (split - ray.origin_low[node.axis]) * inverse;
    let at_high = (split - ray.origin_high[node.axis]) * inverse;
    let upper_is_near = inverse < 0.0;
    return Crossing(
        select(index + 1u, node.link, upper_is_near),
        select(node.link, index + 1u, upper_is_near),
        select(at_high, at_low, upper_is_near) * #{PAD_EXIT},
        select(at_low, at_high, upper_is_near) * #{PAD_ENTRY},
        at_low == at_high,
    );
}

// Of a cell with this interval.
fn near_span(cell: Interval, crossing: Crossing) -> Interval {
    return Interval(cell.entry, min(cell.exit, crossing.near_exit));
}

fn far_span(cell: Interval, crossing: Crossing) -> Interval {
    return Interval(max(cell.entry, crossing.far_entry), cell.exit);
}
