// The frame of every kernel: one invocation a record; records in, results out.
// Source: DESIGN, "Shaders": at most 4 storage buffers and nothing that is not portable. The kernel itself is a function
//   answer(index); it declares the results, the second binding of the group.
// Invariants: every record below the count has all its words written, once, whatever becomes of it; the status word has
//   a bit that only a write sets, and the host zeroes the results before each run.

#import shared/invocation

struct Batch {
    // Records.
    count: u32,
    // Nodes, or elements.
    node_count: u32,
    step_budget: u32,
    // WGSL has no word for it.
    infinity: f32,
    // Of point queries: how many triangles are wanted, where several are. Of heads: how many there are a row, never 0.
    k: u32,
    // Of point queries: how far a search reaches beyond its limit; zero without spatial splits: see point_slack.
    slack_share: f32,
}

@group(#{BATCH_GROUP}) @binding(0) var<storage, read> records: array<u32>;
@group(#{BATCH_GROUP}) @binding(2) var<uniform> batch: Batch;

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
