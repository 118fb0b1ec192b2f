// A ray as what goes through lists whose inner nodes are boxes on a grid, of which each layer has its own.
// Source: the same as shared/packed_box.
// Invariants: the same names as seek_spheres. A layer is entered before its first element is asked.

#import shared/aabb
#import shared/list_grid

#ifndef TWO_LEVEL
alias Seeker = PreparedRay;
#endif

var<private> layer_grid: Grid;

// Makes ready for the lists of a layer.
fn enter_layer(layer: u32) {
    layer_grid = load_grid(layer);
}

// Where the volume of an inner node begins and ends, up to `limit`.
fn approach(seeker: PreparedRay, payload: vec4<u32>, limit: f32) -> Interval {
    let corners = box_corners(layer_grid, payload);
    return slab_test(seeker, corners.low, corners.high, limit);
}
