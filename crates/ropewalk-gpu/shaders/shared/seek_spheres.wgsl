// A ray as what goes through lists whose inner nodes are spheres.
// Source: the same as shared/sphere.
// Invariants: the same names as seek_boxes.

#import shared/sphere

#ifndef TWO_LEVEL
alias Seeker = PreparedRay;
#endif

// Makes ready for the lists of a layer. Spheres need nothing.
fn enter_layer(layer: u32) {}

// Where the volume of an inner node begins and ends, up to `limit`.
fn approach(seeker: PreparedRay, payload: vec4<u32>, limit: f32) -> Interval {
    return sphere_interval(seeker, bitcast<vec4<f32>>(payload), limit);
}
