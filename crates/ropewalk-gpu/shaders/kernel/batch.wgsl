// The batch kernel: one invocation a ray, rays in, results out.
// Source: DESIGN, "Shaders": at most 4 storage buffers and nothing that is not portable. WALK is the file of the walk,
//   COLLECT and RESULT those of the query.
// Invariants: every ray below the count has all its words written, once, whatever becomes of it; the status word has
//   a bit that only a write sets, and the host zeroes the results before each run.

#import shared/ray
#import shared/probe
#import shared/status
#import shared/invocation
#import shared/loops
#import #{COLLECT}
#import #{WALK}
#import #{RESULT}

struct Batch {
    ray_count: u32,
    node_count: u32,
    step_budget: u32,
    // WGSL has no word for it.
    infinity: f32,
}

// RAY_WORDS a ray: nine, and with ALL the place of its first hit and how many it has room for.
@group(#{BATCH_GROUP}) @binding(0) var<storage, read> rays: array<u32>;
@group(#{BATCH_GROUP}) @binding(2) var<uniform> batch: Batch;

fn load_ray(index: u32) -> Ray {
    let at = #{RAY_WORDS}u * index;
    return Ray(
        bitcast<vec3<f32>>(vec3<u32>(rays[at], rays[at + 1u], rays[at + 2u])),
        bitcast<f32>(rays[at + 3u]),
        bitcast<vec3<f32>>(vec3<u32>(rays[at + 4u], rays[at + 5u], rays[at + 6u])),
        bitcast<f32>(rays[at + 7u]),
        rays[at + 8u],
    );
}

@compute @workgroup_size(#{WORKGROUP_SIZE})
fn trace(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    local_index = invocation;
    let index = id.x;
    if index >= batch.ray_count {
        return;
    }
    let ray = load_ray(index);
    var collect = new_collect(batch.infinity);
#ifdef ALL
    collect.first = rays[#{RAY_WORDS}u * index + 9u];
    collect.room = rays[#{RAY_WORDS}u * index + 10u];
#endif
    var status = STATUS_INVALID_RAY;
    if is_valid(ray) {
        let prepared = prepare_ray(ray);
        collect.t_max = prepared.t_max;
        status = walk_bvh(prepared, batch.node_count, batch.step_budget, &collect);
        // There is at least this ray.
        if loops_were_cut(min(batch.ray_count, 1u)) {
            status = STATUS_STEP_BUDGET;
        }
    }
    store_result(index, collect, status);
}
