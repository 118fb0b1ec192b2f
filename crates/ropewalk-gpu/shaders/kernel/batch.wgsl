// The batch kernel: one invocation a ray, rays in, results out.
// Source: DESIGN, "Shaders": at most 4 storage buffers and nothing that is not portable.
// Invariants: every ray below the count has all its words written, once, whatever becomes of it; the status word has
//   a bit that only a write sets, and the host zeroes the results before each run.

#import shared/ray
#import shared/collect
#import shared/probe
#import shared/status
#import #{WALK}

struct Batch {
    ray_count: u32,
    node_count: u32,
    step_budget: u32,
    // WGSL has no word for it.
    infinity: f32,
}

// Nine words a ray.
@group(#{BATCH_GROUP}) @binding(0) var<storage, read> rays: array<u32>;
#ifdef ANY
@group(#{BATCH_GROUP}) @binding(1) var<storage, read_write> results: array<vec2<u32>>;
#else
@group(#{BATCH_GROUP}) @binding(1) var<storage, read_write> results: array<vec4<u32>>;
#endif
@group(#{BATCH_GROUP}) @binding(2) var<uniform> batch: Batch;

fn load_ray(index: u32) -> Ray {
    let at = 9u * index;
    return Ray(
        bitcast<vec3<f32>>(vec3<u32>(rays[at], rays[at + 1u], rays[at + 2u])),
        bitcast<f32>(rays[at + 3u]),
        bitcast<vec3<f32>>(vec3<u32>(rays[at + 4u], rays[at + 5u], rays[at + 6u])),
        bitcast<f32>(rays[at + 7u]),
        rays[at + 8u],
    );
}

fn store_result(index: u32, collect: Collect, status: u32) {
    let written = status | #{STATUS_WRITTEN};
#ifdef ANY
#ifdef COUNTERS
    let at = 4u * index;
    results[at + 1u] = vec2<u32>(counters.inner_visits, counters.leaf_visits);
    results[at + 2u] = vec2<u32>(counters.primitive_tests, counters.restarts);
    results[at + 3u] = vec2<u32>(counters.stack_depth, counters.objects_entered);
#else
    let at = index;
#endif
    results[at] = vec2<u32>(u32(collect.found), written);
#else
#ifdef COUNTERS
    let at = 4u * index;
    results[at + 2u] =
        vec4<u32>(counters.inner_visits, counters.leaf_visits, counters.primitive_tests, counters.restarts);
    results[at + 3u] = vec4<u32>(counters.stack_depth, counters.objects_entered, 0u, 0u);
#else
    let at = 2u * index;
#endif
    let hit = collect.hit;
    results[at] = vec4<u32>(bitcast<u32>(hit.t), bitcast<u32>(hit.u), bitcast<u32>(hit.v), hit.primitive);
    results[at + 1u] = vec4<u32>(hit.geometry, hit.instance, u32(hit.front_face), written);
#endif
}

@compute @workgroup_size(#{WORKGROUP_SIZE})
fn trace(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    if index >= batch.ray_count {
        return;
    }
    let ray = load_ray(index);
    var collect = new_collect(batch.infinity);
    var status = STATUS_INVALID_RAY;
    if is_valid(ray) {
        let prepared = prepare_ray(ray);
        collect.t_max = prepared.t_max;
        status = walk_bvh(prepared, batch.node_count, batch.step_budget, &collect);
    }
    store_result(index, collect, status);
}
