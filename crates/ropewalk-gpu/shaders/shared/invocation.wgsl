// Which invocation of its workgroup this one is.
// Source: WGSL, local_invocation_index, which only an entry point is told.
// Invariants: the entry point writes it before anything else is called.

var<private> local_index: u32;
