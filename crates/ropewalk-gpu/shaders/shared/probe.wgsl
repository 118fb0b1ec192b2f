// What a walk counts on its way: the twin of ropewalk's probe.rs.
// Source: DESIGN, "Counting".
// Invariants: without COUNTERS every function is empty and nothing is stored.

#ifdef COUNTERS
struct Counters {
    inner_visits: u32,
    leaf_visits: u32,
    primitive_tests: u32,
    restarts: u32,
    stack_depth: u32,
    objects_entered: u32,
}

var<private> counters: Counters;
#endif

// The boxes of a node's children are tested.
fn probe_inner_visit() {
#ifdef COUNTERS
    counters.inner_visits += 1u;
#endif
}

// A leaf is entered.
fn probe_leaf_visit() {
#ifdef COUNTERS
    counters.leaf_visits += 1u;
#endif
}

// A primitive is tested.
fn probe_primitive_test() {
#ifdef COUNTERS
    counters.primitive_tests += 1u;
#endif
}

// A walk with a short stack or none goes back to the root.
fn probe_restart() {
#ifdef COUNTERS
    counters.restarts += 1u;
#endif
}

// The structure of an object is entered.
fn probe_object_entered() {
#ifdef COUNTERS
    counters.objects_entered += 1u;
#endif
}

// The stack holds this many entries after a push.
fn probe_stack_depth(entries: u32) {
#ifdef COUNTERS
    counters.stack_depth = max(counters.stack_depth, entries);
#endif
}
