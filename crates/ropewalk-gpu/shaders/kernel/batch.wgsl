// The frame of every kernel: one invocation a record, a ray or a point query; records in, results out.
// Source: DESIGN, "Shaders": at most 4 storage buffers and nothing that is not portable. The kernel itself is a function
//   answer(index). SEEKER is the file of what goes through the tree, WALK that of the walk, COLLECT and RESULT those of
//   what is asked.
// Invariants: every record below the count has all its words written, once, whatever becomes of it; the status word has
//   a bit that only a write sets, and the host zeroes the results before each run.

#import shared/probe
#import shared/status
#import shared/invocation
#import shared/loops
#import #{SEEKER}
#import #{COLLECT}
#import #{WALK}
#import #{RESULT}

struct Batch {
    // Records.
    count: u32,
    node_count: u32,
    step_budget: u32,
    // WGSL has no word for it.
    infinity: f32,
    // Of point queries: how many triangles are wanted, where several are.
    k: u32,
    // Of point queries: how far a search reaches beyond its limit; zero without spatial splits: see point_slack.
    slack_share: f32,
}

@group(#{BATCH_GROUP}) @binding(0) var<storage, read> records: array<u32>;
@group(#{BATCH_GROUP}) @binding(2) var<uniform> batch: Batch;

// Leads the seeker through the tree; the status of the walk.
fn lead(seeker: Seeker, collect: ptr<function, Collect>) -> u32 {
    let status = walk_bvh(seeker, batch.node_count, batch.step_budget, collect);
    // There is at least this record.
    return select(status, STATUS_STEP_BUDGET, loops_were_cut(min(batch.count, 1u)));
}

@compute @workgroup_size(#{WORKGROUP_SIZE})
fn trace(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    local_index = invocation;
    if id.x < batch.count {
        answer(id.x);
    }
}
