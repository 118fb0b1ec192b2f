// The rays of a tree, and the stack on which they wait: the twin of TreeRay in ropewalk-render's ray_tree/node.rs.
// Source: Reichl et al. 2010, listing 1: one record for rays of all kinds.
// Invariants: the stack lies in the scratch, its height in the first word. A push that finds no room is noted in the item's
//   status and changes nothing. The primary ray, which is taken first, is read from the item.

#import shared/ray
#import shared/status

const KIND_PRIMARY: u32 = 0u;
const KIND_LIGHT: u32 = 1u;
const KIND_SKY: u32 = 2u;
const KIND_MIRRORED: u32 = 3u;
const KIND_REFRACTED: u32 = 4u;

struct TreeRay {
    ray: Ray,
    // The share of what it finds that reaches the picture; of a ray to a light, that light.
    weight: vec3<f32>,
    kind: u32,
    // How often it has been mirrored or refracted.
    depth: u32,
}

fn is_occlusion(kind: u32) -> bool {
    return kind == KIND_LIGHT || kind == KIND_SKY;
}

// Words of a ray on the stack.
const STACK_RAY_WORDS: u32 = 12u;

// The stack of this turn: how many rays wait.
var<private> rays_waiting: u32;

fn put_vector(index: u32, at: u32, v: vec3<f32>) {
    scratch[scratch_at(index, at)] = bitcast<u32>(v.x);
    scratch[scratch_at(index, at + 1u)] = bitcast<u32>(v.y);
    scratch[scratch_at(index, at + 2u)] = bitcast<u32>(v.z);
}

fn get_vector(index: u32, at: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(vec3<u32>(
        scratch[scratch_at(index, at)],
        scratch[scratch_at(index, at + 1u)],
        scratch[scratch_at(index, at + 2u)],
    ));
}

fn push_ray(index: u32, ray: TreeRay) {
    let at = 1u + STACK_RAY_WORDS * rays_waiting;
    if at + STACK_RAY_WORDS > #{SCRATCH_WORDS}u {
        item_status |= STATUS_STACK_OVERFLOW;
        return;
    }
    put_vector(index, at, ray.ray.origin);
    put_vector(index, at + 3u, ray.ray.dir);
    put_vector(index, at + 6u, ray.weight);
    scratch[scratch_at(index, at + 9u)] = bitcast<u32>(ray.ray.t_max);
    scratch[scratch_at(index, at + 10u)] = ray.kind | (ray.depth << 8u) | ((ray.ray.mask & 0xffu) << 16u);
    scratch[scratch_at(index, at + 11u)] = bitcast<u32>(ray.ray.t_min);
    rays_waiting += 1u;
}

// Takes the youngest ray. There must be one, and it must not be the primary ray.
fn pop_ray(index: u32) -> TreeRay {
    rays_waiting -= 1u;
    let at = 1u + STACK_RAY_WORDS * rays_waiting;
    let bits = scratch[scratch_at(index, at + 10u)];
    var ray: TreeRay;
    ray.ray.origin = get_vector(index, at);
    ray.ray.t_min = bitcast<f32>(scratch[scratch_at(index, at + 11u)]);
    ray.ray.dir = get_vector(index, at + 3u);
    ray.ray.t_max = bitcast<f32>(scratch[scratch_at(index, at + 9u)]);
    ray.ray.mask = bits >> 16u;
    ray.weight = get_vector(index, at + 6u);
    ray.kind = bits & 0xffu;
    ray.depth = (bits >> 8u) & 0xffu;
    return ray;
}
