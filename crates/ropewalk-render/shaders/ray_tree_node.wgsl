// One node of a tree of rays: the twin of ropewalk-render's ray_tree/node.rs.
// Source: Whitted 1980; the order of all sums is explained there.
// Invariants: same operations in the same order as in Rust, but for the rays, which are pushed with the last one first, so that
//   the first one is taken first.

#import bsdf_shading
#import light_source
#import looks_place
#import ray_tree_ray
#import ray_tree_request
#import sampling

// A sample: who asks.
struct Sample {
    pixel: vec2<u32>,
    // The number of the sample in its pixel.
    index: u32,
    // What the eye sees here when its ray leaves the scene.
    behind: vec3<f32>,
}

// A place with what its rays have in common.
struct Site {
    sample: Sample,
    ray: TreeRay,
    place: Place,
    bsdf: Bsdf,
    // What light from here is multiplied by on its way to the picture.
    weight: vec3<f32>,
}

// What a place gives, beside its rays.
struct TreeNode {
    // Its own light, weighted.
    own: vec3<f32>,
    cut_by_depth: u32,
    cut_by_weight: u32,
}

fn is_black(color: vec3<f32>) -> bool {
    return all(color == vec3<f32>(0.0));
}

// What is seen along a ray that leaves the scene.
fn behind_of(sample: Sample, ray: TreeRay) -> vec3<f32> {
    if ray.depth == 0u {
        return sample.behind;
    }
    return environment_radiance(ray.ray.dir);
}

// The direction, mirrored to the side of the plane that `normal` points to where it is not there already.
fn above_plane(direction: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let below = min(dot(direction, normal), 0.0);
    return direction - normal * (below + below);
}

// The light that arrives at a place from a light, and the way to it.
struct SiteLight {
    is_there: bool,
    light: vec3<f32>,
    to_light: vec3<f32>,
    distance: f32,
}

fn site_light(site: Site, number: u32) -> SiteLight {
    let samples = request_word(3u);
    let part = (site.sample.index + 7u * number + 3u * site.ray.depth) % samples;
    let square = light_point(site.sample.pixel, part, samples);
    let incoming = light_towards(number, site.place.origin_outside, square);
    var answer: SiteLight;
    if !incoming.is_there {
        return answer;
    }
    answer.is_there = true;
    answer.light = direct(site.bsdf, site.place.normal, site.place.to_eye, incoming.to_light) * incoming.light;
    answer.to_light = incoming.to_light;
    answer.distance = incoming.distance * 0.999;
    return answer;
}

// Pushes a ray from a site.
fn push_from(
    index: u32,
    site: Site,
    kind: u32,
    origin: vec3<f32>,
    dir: vec3<f32>,
    t_max: f32,
    mask: u32,
    weight: vec3<f32>,
) {
    let ray = Ray(origin, 0.0, dir, t_max, mask);
    push_ray(index, TreeRay(ray, weight, kind, site.ray.depth + 1u));
}

// Pushes a mirrored or a refracted ray, unless it carries too little.
fn push_followed(
    index: u32,
    site: Site,
    kind: u32,
    origin: vec3<f32>,
    dir: vec3<f32>,
    weight: vec3<f32>,
    node: ptr<function, TreeNode>,
) {
    if max(max(weight.x, weight.y), weight.z) < request_float(2u) {
        (*node).cut_by_weight += 1u;
        return;
    }
    push_from(index, site, kind, origin, dir, batch.infinity, site.ray.ray.mask, weight);
}

// The refracted ray: its own light where it is not followed.
fn grow_glass(index: u32, site: Site, node: ptr<function, TreeNode>) -> vec3<f32> {
    let weight = site.weight * through_weight(site.bsdf, dot(site.place.normal, site.place.to_eye));
    if is_black(weight) {
        return vec3<f32>(0.0);
    }
    let bent = refract_ray(-site.place.to_eye, site.place.normal, site.bsdf.eta);
    if is_black(bent) {
        return vec3<f32>(0.0);
    }
    let direction = above_plane(bent, -site.place.geometric_normal);
    let follows = request_has(REQUEST_REFRACTIONS);
    if !follows || site.ray.depth >= request_bounces() {
        (*node).cut_by_depth += u32(follows);
        return weight * environment_radiance(direction);
    }
    push_followed(index, site, KIND_REFRACTED, site.place.origin_inside, direction, weight, node);
    return vec3<f32>(0.0);
}

fn grow_mirror(index: u32, site: Site, node: ptr<function, TreeNode>) {
    let weight = site.weight * mirror_weight(site.bsdf, dot(site.place.normal, site.place.to_eye));
    if !request_has(REQUEST_REFLECTIONS) || is_black(weight) {
        return;
    }
    if site.ray.depth >= request_bounces() {
        (*node).cut_by_depth += 1u;
        return;
    }
    let direction = above_plane(mirrored(site.place.normal, site.place.to_eye), site.place.geometric_normal);
    push_followed(index, site, KIND_MIRRORED, site.place.origin_outside, direction, weight, node);
}

// The rays into the sky, the last one first.
fn push_sky(index: u32, site: Site, carried: vec3<f32>) {
    if is_black(carried) {
        return;
    }
    let samples = request_word(3u);
    let rounds = request_word(4u);
    for (var left = rounds; left > 0u; left -= 1u) {
        let part = site.sample.index * rounds + left - 1u;
        let square = sky_point(site.sample.pixel, part, rounds * samples);
        let dir = above_plane(cosine_direction(site.place.normal, square), site.place.geometric_normal);
        let length = pixel_fraction(site.sample.pixel, part);
        let reach = (length * length) * request_float(5u);
        push_from(index, site, KIND_SKY, site.place.origin_outside, dir, reach, 0xffu, carried);
    }
}

// Works out a node and pushes its rays, with what is seen behind the place. The site has the weight of the ray.
fn tree_node(index: u32, arrived: Site, behind: vec3<f32>) -> TreeNode {
    var site = arrived;
    let has_shadows = request_has(REQUEST_SHADOWS);
    let follows_mirrors = request_has(REQUEST_REFLECTIONS) && site.ray.depth < request_bounces();
    let surrounding = surroundings(site.bsdf, site.place.normal, site.place.to_eye, follows_mirrors);
    let is_catcher = site.place.is_catcher;
    let strength = catcher_strength(site.place.position);
    var node: TreeNode;
    node.own = site.weight * site.place.material.emissive;
    if is_catcher {
        node.own = behind * (1.0 - strength);
    }
    var of_surroundings: vec3<f32>;
    var of_glass: vec3<f32>;
    // All light that would arrive at a place that catches shadows, if nothing were in the way.
    var open: vec3<f32>;
    // In a loop that no compiler unrolls, so that there is one copy of what asks for light: once for all light that would
    // arrive, where that is wanted; and once for the lights, the last one first where their rays are pushed.
    let passes = 2u | looks_word(#{LOOKS_ZERO}u);
    for (var pass_number = select(1u, 0u, is_catcher); pass_number < passes; pass_number += 1u) {
        let is_open = pass_number == 0u;
        if !is_open {
            let weight = site.weight * surrounding;
            let asks_the_sky = site.ray.depth == 0u && is_studio() && request_word(4u) > 0u;
            of_surroundings = select(weight, weight * request_float(6u), asks_the_sky);
            if !is_catcher {
                of_glass = grow_glass(index, site, &node);
                grow_mirror(index, site, &node);
            }
            if asks_the_sky {
                push_sky(index, site, weight * request_float(7u));
            }
        }
        for (var i = 0u; i < light_count(); i += 1u) {
            let number = select(i, light_count() - 1u - i, has_shadows && !is_open);
            let light = site_light(site, number);
            if !light.is_there {
                continue;
            }
            let weight = site.weight * light.light;
            if is_open {
                open += light.light;
            } else if !has_shadows {
                node.own += weight;
            } else if !is_black(weight) {
                let origin = site.place.origin_outside;
                push_from(index, site, KIND_LIGHT, origin, light.to_light, light.distance, 0xffu, weight);
            }
        }
        if is_open {
            site.weight = behind * strength / max(open + surrounding, vec3<f32>(1e-30));
        }
    }
    node.own += of_surroundings;
    node.own += of_glass;
    return node;
}
