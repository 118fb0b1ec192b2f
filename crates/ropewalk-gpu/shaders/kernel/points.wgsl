// The kernel of point queries.
// Source: as kernel/batch.
// Invariants: those of kernel/batch.

#import shared/bvh
#import shared/point_distance
#import shared/point_query
#import kernel/batch

// Five words a query.
fn load_query(index: u32) -> PointQuery {
    let at = 5u * index;
    return PointQuery(
        bitcast<vec3<f32>>(vec3<u32>(records[at], records[at + 1u], records[at + 2u])),
        bitcast<f32>(records[at + 3u]),
        records[at + 4u],
    );
}

fn answer(index: u32) {
    let query = load_query(index);
    let point = prepare_point(query);
    // Zero-filled: nothing found.
    var collect: Collect;
    var status = STATUS_INVALID_RAY;
    if is_valid_query(query) {
        var slack = 0.0;
        if batch.slack_share > 0.0 {
            let root = load_node(0u);
            slack = point_slack(point.point, root.low, root.high, batch.slack_share);
        }
        collect = new_collect(point.radius, slack, batch.k);
        status = lead(point, &collect);
    }
    store_result(index, point, &collect, status);
}
