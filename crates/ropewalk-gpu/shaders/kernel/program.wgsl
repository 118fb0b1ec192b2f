// The frame of a caller's program: one invocation an item, which takes turns until it is done.
// Source: the loop of Reichl et al. 2010, listing 1, cut into turns: a turn traces a ray or a few, and what must outlast it lies
//   in the scratch. PROGRAM is the caller's file. It declares
//     fn begin(index: u32)         // writes what the first turn reads
//     fn turn(index: u32) -> bool  // whether there is another turn to take
//   and reads records, table_a and table_b, writes results (at result_at) and scratch (at scratch_at), and calls trace_ray as
//   often as it likes. COLLECT is the file of what becomes of a ray's hits: shared/collect_closest, shared/collect_filtered,
//   or the caller's own.
// Invariants: those of kernel/frame. The last word of an item's results is the frame's: its status. A dispatch takes so many
//   turns that no driver ends its loops or loses its patience; an item that is done takes none in the dispatches that follow.

#import shared/ray
#import shared/probe
#import shared/status
#import shared/loops
#import kernel/frame
#import #{SEEKER}
#import #{COLLECT}
#import #{WALK}
#import #{PROGRAM}

@group(#{BATCH_GROUP}) @binding(1) var<storage, read_write> results: array<u32>;
@group(#{PROGRAM_GROUP}) @binding(0) var<storage, read> table_a: array<u32>;
@group(#{PROGRAM_GROUP}) @binding(1) var<storage, read> table_b: array<u32>;
@group(#{PROGRAM_GROUP}) @binding(2) var<storage, read_write> scratch: array<u32>;

// What went wrong with the item, in this turn or in an earlier one.
var<private> item_status: u32;

// Where a word of an item's results lies.
fn result_at(index: u32, word: u32) -> u32 {
    return #{RESULT_WORDS}u * index + word;
}

// Where a word of an item's scratch lies: the same word of neighbouring items side by side, as invocations read them.
fn scratch_at(index: u32, word: u32) -> u32 {
    return word * batch.count + index;
}

// Leads a ray through the structure. The collector says on return what was found; it must be as new_collect gives it, but for
// what the caller adds. A ray that is not valid finds nothing.
fn trace_ray(ray: Ray, collect: ptr<function, Collect>) {
    if !is_valid(ray) {
        item_status |= STATUS_INVALID_RAY;
        return;
    }
    let prepared = prepare_ray(ray);
    (*collect).t_max = prepared.t_max;
#ifdef TWO_LEVEL
    item_status |= walk(Seeker(ray, prepared), batch.node_count, batch.step_budget, collect);
#else
    item_status |= walk(prepared, batch.node_count, batch.step_budget, collect);
#endif
}

#ifdef COUNTERS
// Adds what the turns of this dispatch counted to what those of the earlier ones did.
fn add_counters(at: u32) {
    results[at] += counters.inner_visits;
    results[at + 1u] += counters.leaf_visits;
    results[at + 2u] += counters.primitive_tests;
    results[at + 3u] += counters.restarts;
    results[at + 4u] = max(results[at + 4u], counters.stack_depth);
    results[at + 5u] += counters.objects_entered;
}
#endif

fn answer(index: u32) {
    let status_at = result_at(index, #{RESULT_WORDS}u - 1u);
    let before = results[status_at];
    if before != 0u && (before & #{STATUS_UNFINISHED}) == 0u {
        return;
    }
    item_status = before & ~(#{STATUS_WRITTEN} | #{STATUS_UNFINISHED});
    if before == 0u {
        begin(index);
    }
    var goes_on = true;
    for (var turns_left = batch.k; turns_left > 0u && goes_on; turns_left -= 1u) {
        goes_on = turn(index) && (item_status & ~STATUS_INVALID_RAY) == STATUS_COMPLETE;
    }
    // There is at least this record.
    if loops_were_cut(min(batch.count, 1u)) {
        item_status |= STATUS_STEP_BUDGET;
        goes_on = false;
    }
#ifdef COUNTERS
    add_counters(status_at - 6u);
#endif
    results[status_at] = item_status | #{STATUS_WRITTEN} | select(0u, #{STATUS_UNFINISHED}, goes_on);
}
