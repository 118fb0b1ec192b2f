// Whether the driver has ended loops before they were done.
// Source: Mesa's llvmpipe and lavapipe count the iterations of all loops together, for the 4 to 8 invocations that run
//   in one vector; after 65,535 each loop ends after one iteration, and nobody is told. Measured with lavapipe 22.3.6.
// Invariants: costs two iterations, and nothing where a driver has no such habit.

// Whether loops end early by now, so that what they should have done before is in doubt. `one` must be 1 in a way that a
// compiler cannot see, or it would put two additions in the loop's place.
fn loops_were_cut(one: u32) -> bool {
    var turns = 0u;
    while turns <= one {
        turns += 1u;
    }
    return turns <= one;
}
