// The grid of the boxes of a layer's lists.
// Source: as shared/list.
// Invariants: the layer is there.

#import shared/list
#import shared/packed_box

fn load_grid(layer: u32) -> Grid {
    let at = #{LIST_LAYERS_AT}u + #{LIST_LAYER_WORDS}u * layer + #{LIST_GRID_AT}u;
    return Grid(
        bitcast<vec3<f32>>(vec3<u32>(list_word(at), list_word(at + 1u), list_word(at + 2u))),
        bitcast<vec3<f32>>(vec3<u32>(list_word(at + 3u), list_word(at + 4u), list_word(at + 5u))),
    );
}
