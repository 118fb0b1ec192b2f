// The kernel of point queries: one invocation a query, queries in, results out.
// Source: as kernel/batch. WALK is the file of the walk, POINT_COLLECT and POINT_RESULT those of the search.
// Invariants: those of kernel/batch.

#import shared/point_query
#import shared/point_leaf
#import shared/probe
#import shared/status
#import shared/invocation
#import shared/loops
#import #{POINT_COLLECT}
#import #{WALK}
#import #{POINT_RESULT}

struct Batch {
    query_count: u32,
    node_count: u32,
    step_budget: u32,
    // WGSL has no word for it.
    infinity: f32,
    // How many triangles are wanted, where several are.
    k: u32,
    // How far a search reaches beyond its limit; zero without spatial splits: see point_slack.
    slack_share: f32,
}

// Five words a query.
@group(#{BATCH_GROUP}) @binding(0) var<storage, read> queries: array<u32>;
@group(#{BATCH_GROUP}) @binding(2) var<uniform> batch: Batch;

fn load_query(index: u32) -> PointQuery {
    let at = 5u * index;
    return PointQuery(
        bitcast<vec3<f32>>(vec3<u32>(queries[at], queries[at + 1u], queries[at + 2u])),
        bitcast<f32>(queries[at + 3u]),
        queries[at + 4u],
    );
}

@compute @workgroup_size(#{WORKGROUP_SIZE})
fn trace(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    local_index = invocation;
    let index = id.x;
    if index >= batch.query_count {
        return;
    }
    let query = load_query(index);
    let point = prepare_point(query);
    // Zero-filled: nothing found.
    var collect: PointCollect;
    var status = STATUS_INVALID_RAY;
    if is_valid_query(query) {
        var slack = 0.0;
        if batch.slack_share > 0.0 {
            let root = load_node(0u);
            slack = point_slack(point.point, root.low, root.high, batch.slack_share);
        }
        collect = new_point_collect(point.radius, slack, batch.k);
        status = walk_points(point, batch.node_count, batch.step_budget, &collect);
        // There is at least this query.
        if loops_were_cut(min(batch.query_count, 1u)) {
            status = STATUS_STEP_BUDGET;
        }
    }
    store_result(index, point, &collect, status);
}
