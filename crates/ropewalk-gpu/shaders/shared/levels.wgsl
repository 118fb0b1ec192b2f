// Both levels in the two buffers of shared/bvh: one has a header, the objects, the nodes of their structures, and behind them
// what changes from frame to frame: the nodes of the top level, what each of its leaves leads to, and the instances; the
// other has the triangles of all objects, and behind those of a kd-tree its references.
// Source: Reichl et al. 2010, section 4.2.4; the twin of ropewalk's two_level. The places come from ropewalk-gpu's
//   shader/level_layout.rs.
// Invariants: places are counted in fours of words from the beginning of their buffer, those of nodes in pairs of them, those
//   of triangles in threes, so that the functions of shared/bvh load them.

#import shared/aabb
#import shared/bvh

// An object: its structure, and the box around it in its frame.
struct LevelObject {
    low: vec3<f32>,
    // One of the kinds below.
    kind: u32,
    high: vec3<f32>,
    // The place of its first node: of a BVH in pairs of fours, of a wide one in wide nodes, else in fours.
    nodes: u32,
    // The place of its first triangle, or of its lists' first vertex, in threes of fours.
    triangles: u32,
    // Of a kd-tree's references, in fours.
    references: u32,
}

// What a ray is in: the top level, or an object with this structure.
const IN_TOP_LEVEL: u32 = 0u;
const IN_BVH: u32 = #{LEVEL_BVH};
const IN_KD_TREE: u32 = #{LEVEL_KD_TREE};
const IN_WIDE_BVH: u32 = #{LEVEL_WIDE_BVH};
const IN_LIST: u32 = #{LEVEL_LIST};

// An instance: the map from the scene to the object's frame, and the box in the scene.
struct Placed {
    axis_x: vec3<f32>,
    object: u32,
    axis_y: vec3<f32>,
    // The instance in the low 24 bits, its mask in the top 8.
    instance_and_mask: u32,
    axis_z: vec3<f32>,
    origin: vec3<f32>,
    low: vec3<f32>,
    high: vec3<f32>,
}

// The place of the top level's first node, in pairs.
fn top_level_nodes() -> u32 {
    return bvh_nodes[0].x;
}

// What a leaf of the top level leads to.
struct LevelEntry {
    // The box of the part of the object, in its frame.
    low: vec3<f32>,
    // The place of the instance.
    place: u32,
    high: vec3<f32>,
    // The node of the object's structure at which rays begin.
    node: u32,
}

fn load_level_entry(leaf: u32) -> LevelEntry {
    let at = bvh_nodes[0].y + 2u * leaf;
    let first = bvh_nodes[at];
    let second = bvh_nodes[at + 1u];
    return LevelEntry(bitcast<vec3<f32>>(first.xyz), first.w, bitcast<vec3<f32>>(second.xyz), second.w);
}

// The ray as the boxes of the top level are asked for it: a little wider where objects were opened, as ropewalk's
// two_level/opening.rs explains.
fn widened(ray: PreparedRay) -> PreparedRay {
    let width = bitcast<f32>(bvh_nodes[0].w);
    let largest = bitcast<f32>(bvh_nodes[1].x);
    if width == 0.0 {
        return ray;
    }
    let away = abs(ray.origin);
    let step = vec3<f32>(width * (max(away.x, max(away.y, away.z)) + largest));
    var wide = ray;
    wide.origin_low = ray.origin_low + step;
    wide.origin_high = ray.origin_high - step;
    return wide;
}

fn load_placed(place: u32) -> Placed {
    let at = bvh_nodes[0].z + 6u * place;
    let first = bvh_nodes[at];
    let second = bvh_nodes[at + 1u];
    return Placed(
        bitcast<vec3<f32>>(first.xyz),
        first.w,
        bitcast<vec3<f32>>(second.xyz),
        second.w,
        bitcast<vec3<f32>>(bvh_nodes[at + 2u].xyz),
        bitcast<vec3<f32>>(bvh_nodes[at + 3u].xyz),
        bitcast<vec3<f32>>(bvh_nodes[at + 4u].xyz),
        bitcast<vec3<f32>>(bvh_nodes[at + 5u].xyz),
    );
}

fn load_level_object(object: u32) -> LevelObject {
    let at = #{LEVEL_HEADER_FOURS}u + #{LEVEL_OBJECT_FOURS}u * object;
    let first = bvh_nodes[at];
    let second = bvh_nodes[at + 1u];
    let third = bvh_nodes[at + 2u];
    return LevelObject(
        bitcast<vec3<f32>>(first.xyz),
        first.w,
        bitcast<vec3<f32>>(second.xyz),
        second.w,
        third.x,
        third.y,
    );
}
