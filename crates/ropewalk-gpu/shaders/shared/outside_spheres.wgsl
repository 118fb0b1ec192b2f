// Whether the sphere of an inner node lies outside of a half-space.
// Source: as shared/half_space.
// Invariants: the same names as outside_boxes.

#import shared/half_space

fn excludes_volume(space: HalfSpace, layer: u32, payload: vec4<u32>) -> bool {
    return excludes_sphere(space, bitcast<vec4<f32>>(payload));
}
