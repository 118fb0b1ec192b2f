// Whether the box of an inner node lies outside of a half-space.
// Source: as shared/half_space.
// Invariants: the same names as outside_spheres.

#import shared/half_space
#import shared/list_grid

fn excludes_volume(space: HalfSpace, layer: u32, payload: vec4<u32>) -> bool {
    let corners = box_corners(load_grid(layer), payload);
    return excludes_box(space, corners.low, corners.high);
}
