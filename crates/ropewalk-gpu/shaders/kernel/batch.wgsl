// What kernels of rays and of point queries have in common: something is led through a structure.
// Source: as kernel/frame. SEEKER is the file of what goes through the structure, WALK that of the walk, COLLECT and RESULT
//   those of what is asked.
// Invariants: those of kernel/frame.

#import shared/probe
#import shared/status
#import shared/loops
#import kernel/frame
#import #{SEEKER}
#import #{COLLECT}
#import #{WALK}
#import #{RESULT}

// Leads the seeker through the structure; the status of the walk.
fn lead(seeker: Seeker, collect: ptr<function, Collect>) -> u32 {
    let status = walk(seeker, batch.node_count, batch.step_budget, collect);
    // There is at least this record.
    return select(status, STATUS_STEP_BUDGET, loops_were_cut(min(batch.count, 1u)));
}
