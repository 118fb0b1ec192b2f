// The restart trail on a kd-tree: a bit a level leads back after a restart at the root, so that the stack may be of any
// size, or none.
// Source: Laine 2010; the twin of ropewalk's kd_tree/walk/restart_trail.rs, visit for visit. TRAIL is the file of the trail's
//   bits, with TRAIL_STACK SHORT_STACK that of the stack.
// Invariants: those of walk_bvh_restart_trail.

#import #{SEEKER}
#import shared/kd_leaf
#import shared/status
#import shared/kd_trail

// Leads the ray through the tree; the status of the walk.
fn walk(seeker: Seeker, node_count: u32, step_budget: u32, collect: ptr<function, Collect>) -> u32 {
    if node_count == 0u {
        return STATUS_COMPLETE;
    }
    return walk_by_trail(seeker, step_budget, collect);
}
