// Boxes of six planes on a grid, 21 bits each: the twin of PackedBox::corners in ropewalk's packed_box.rs.
// Source: the same.
// Invariants: a step is a power of two, so a plane's distance from the grid's corner is exact, and its place is rounded
//   once on every device, fused or not.

struct Grid {
    origin: vec3<f32>,
    step: vec3<f32>,
}

struct Corners {
    low: vec3<f32>,
    high: vec3<f32>,
}

fn grid_point(grid: Grid, x: u32, y: u32, z: u32) -> vec3<f32> {
    let steps = vec3<f32>(vec3<u32>(x, y, z) & vec3<u32>(0x1fffffu));
    return grid.origin + steps * grid.step;
}

// The three lower planes and then the three upper ones, from the lowest bit on.
fn box_corners(grid: Grid, words: vec4<u32>) -> Corners {
    let low = grid_point(
        grid,
        words.x,
        (words.x >> 21u) | (words.y << 11u),
        words.y >> 10u,
    );
    let high = grid_point(
        grid,
        (words.y >> 31u) | (words.z << 1u),
        (words.z >> 20u) | (words.w << 12u),
        words.w >> 9u,
    );
    return Corners(low, high);
}
