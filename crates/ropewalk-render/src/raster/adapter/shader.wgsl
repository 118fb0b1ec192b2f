// Draws the triangles of one instance after another: for each pixel, which instance and which triangle is nearest.
// Source: Reichl et al. 2010, section 4.2.2.
// Invariants: corners come as the structure has them; the rows lead from a place relative to the eye to clip space, made in f64
//   for each instance. The depth is reversed and reaches to infinity: NEAR over the distance, of which a f32 keeps as many
//   digits far away as near by, and nothing in front of the eye is cut off. Corners behind the eye are the clipper's business.

// 2^-60. A depth of 2^60 still has a normal number.
const NEAR: f32 = 8.6736174e-19;

struct Corner {
    @builtin(position) @invariant position: vec4<f32>,
    // The instance's number, and the triangle's.
    @location(0) @interpolate(flat, either) name: vec2<u32>,
}

@vertex
fn place(
    @builtin(vertex_index) vertex: u32,
    @location(0) corner: vec3<f32>,
    @location(1) eye: vec3<f32>,
    @location(2) instance: u32,
    @location(3) across: vec3<f32>,
    @location(4) upwards: vec3<f32>,
    @location(5) depth: vec3<f32>,
) -> Corner {
    let from_eye = corner - eye;
    let position = vec4<f32>(dot(across, from_eye), dot(upwards, from_eye), NEAR, dot(depth, from_eye));
    return Corner(position, vec2<u32>(instance, vertex / 3u));
}

@fragment
fn name(@location(0) @interpolate(flat, either) name: vec2<u32>) -> @location(0) vec2<u32> {
    return name;
}
