// The trees of rays of samples, one ray a turn: the twin of ropewalk-render's ray_tree/stack.rs.
// Source: Reichl et al. 2010, listing 1: shadow, mirrored and refracted rays come from one stack and take one path.
// Invariants: an item is a sample's ray, its pixel, its number, what is behind it, and where it is known its hit; see
//   ropewalk-render's gpu/item.rs. Light is added depth first, as there.

#import looks_panes
#import ray_tree_node

// Where things lie in an item.
const ITEM_PIXEL: u32 = 9u;
const ITEM_BEHIND: u32 = 12u;
const ITEM_HIT: u32 = 15u;

// Where things lie in the results: the light, rays of each kind but the primary, rays cut off, hits that lead nowhere.
const RESULT_RAYS: u32 = 3u;
const RESULT_CUT_BY_DEPTH: u32 = 7u;
const RESULT_CUT_BY_WEIGHT: u32 = 8u;
const RESULT_LOST: u32 = 9u;

fn item_word(index: u32, word: u32) -> u32 {
    return records[#{ITEM_WORDS}u * index + word];
}

fn item_vector(index: u32, word: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(vec3<u32>(
        item_word(index, word),
        item_word(index, word + 1u),
        item_word(index, word + 2u),
    ));
}

// Whether a hit is one: alpha masks leave holes.
fn accepts(hit: Hit) -> bool {
    if (looks_word(#{LOOKS_FLAGS}u) & #{LOOKS_HAS_CUT_OUTS}u) == 0u {
        return true;
    }
    return !is_cut_out(hit);
}

// The height of the stack while the primary ray is to come.
const BEFORE_ALL: u32 = 0xffffffffu;

fn begin(index: u32) {
    scratch[scratch_at(index, 0u)] = BEFORE_ALL;
}

fn primary_ray(index: u32) -> TreeRay {
    let window_begin = bitcast<f32>(item_word(index, 3u));
    let window_end = bitcast<f32>(item_word(index, 7u));
    let ray = Ray(
        item_vector(index, 0u),
        window_begin,
        item_vector(index, 4u),
        window_end,
        item_word(index, 8u) & 0xffu,
    );
    return TreeRay(ray, vec3<f32>(1.0), KIND_PRIMARY, 0u);
}

// The hit that came with the item.
fn known_hit(index: u32) -> Hit {
    return Hit(
        bitcast<f32>(item_word(index, ITEM_HIT + 1u)),
        bitcast<f32>(item_word(index, ITEM_HIT + 2u)),
        bitcast<f32>(item_word(index, ITEM_HIT + 3u)),
        item_word(index, ITEM_HIT + 4u),
        item_word(index, ITEM_HIT + 5u),
        item_word(index, ITEM_HIT + 6u),
        item_word(index, ITEM_HIT + 7u) != 0u,
    );
}

fn add_result(index: u32, word: u32, count: u32) {
    results[result_at(index, word)] += count;
}

fn add_light(index: u32, light: vec3<f32>) {
    let at = result_at(index, 0u);
    results[at] = bitcast<u32>(bitcast<f32>(results[at]) + light.x);
    results[at + 1u] = bitcast<u32>(bitcast<f32>(results[at + 1u]) + light.y);
    results[at + 2u] = bitcast<u32>(bitcast<f32>(results[at + 2u]) + light.z);
}

// Takes a ray, finds what it finds, adds its light, pushes the rays that follow.
fn turn(index: u32) -> bool {
    rays_waiting = scratch[scratch_at(index, 0u)];
    let is_first = rays_waiting == BEFORE_ALL;
    if !is_first && rays_waiting == 0u {
        return false;
    }
    var ray: TreeRay;
    if is_first {
        rays_waiting = 0u;
        ray = primary_ray(index);
    } else {
        ray = pop_ray(index);
        add_result(index, RESULT_RAYS + ray.kind - 1u, 1u);
    }
    let earlier = item_status;
    item_status = STATUS_COMPLETE;
    var collect = new_collect(batch.infinity);
    collect.ends_early = is_occlusion(ray.kind) && !has_panes();
    if is_first && item_word(index, ITEM_HIT) != 0u {
        collect.hit = known_hit(index);
    } else {
        trace_ray(ray.ray, &collect);
    }
    let is_answered = item_status == STATUS_COMPLETE;
    item_status |= earlier;
    if is_answered || is_occlusion(ray.kind) {
        arrive(index, ray, collect.hit);
    }
    scratch[scratch_at(index, 0u)] = rays_waiting;
    return rays_waiting > 0u;
}

// Adds the light that a ray brings, and pushes the rays that follow.
fn arrive(index: u32, ray: TreeRay, hit: Hit) {
    let asks = is_occlusion(ray.kind);
    let is_hit_found = hit.primitive != #{NONE};
    if asks && (!is_hit_found || !has_panes()) {
        if !is_hit_found {
            add_light(index, ray.weight);
        }
        return;
    }
    let sample = Sample(
        vec2<u32>(item_word(index, ITEM_PIXEL), item_word(index, ITEM_PIXEL + 1u)),
        item_word(index, ITEM_PIXEL + 2u),
        item_vector(index, ITEM_BEHIND),
    );
    var behind: vec3<f32>;
    if !is_hit_found || hit.instance == looks_word(#{LOOKS_CATCHER}u) {
        behind = ray.weight * behind_of(sample, ray);
    }
    if !is_hit_found {
        add_light(index, behind);
        return;
    }
    let rows = rows_of(hit);
    if !rows.is_there {
        add_result(index, RESULT_LOST, select(1u, 0u, asks));
        return;
    }
    let uv = uv_of(rows.triangle, vec2<f32>(hit.u, hit.v));
    let material = shaded_material(looks_word(rows.triangle + 9u), uv);
    let bsdf = new_bsdf(material, hit.front_face);
    if asks {
        go_behind(index, ray, hit, through_pane(material, bsdf));
        return;
    }
    let site = Site(sample, ray, place_of(ray.ray, hit, rows, uv, material), bsdf, ray.weight);
    let node = tree_node(index, site, behind);
    add_light(index, node.own);
    add_result(index, RESULT_CUT_BY_DEPTH, node.cut_by_depth);
    add_result(index, RESULT_CUT_BY_WEIGHT, node.cut_by_weight);
}

// Lets a ray to a light go on behind what is hit, where that is a pane.
fn go_behind(index: u32, ray: TreeRay, hit: Hit, through: vec3<f32>) {
    if is_black(through) {
        return;
    }
    if ray.depth >= #{MOST_PANES}u {
        add_result(index, RESULT_CUT_BY_DEPTH, 1u);
        return;
    }
    var onwards = ray;
    onwards.ray.t_min = next_up(hit.t);
    onwards.weight = ray.weight * through;
    onwards.depth = ray.depth + 1u;
    push_ray(index, onwards);
}
