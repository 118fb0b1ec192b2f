// Floats by their bits, where WGSL leaves the value open: NaN, infinity, neighbours.
// Source: IEEE 754; f32::next_up and f32::next_down of Rust's standard library.
// Invariants: a driver may assume that NaN and infinity never happen (x != x is false on lavapipe), so nothing here
//   compares floats. A device that flushes denormals (SwiftShader) takes the neighbours of zero for zero, which is
//   why shared/ray moves a parallel slab's origins by more than one float there.

// The bits of |x|. They order magnitudes as the floats themselves are ordered, NaN above infinity.
fn magnitude_bits(x: f32) -> u32 {
    return bitcast<u32>(x) & 0x7fffffffu;
}

fn is_nan(x: f32) -> bool {
    return magnitude_bits(x) > 0x7f800000u;
}

fn is_finite(v: vec3<f32>) -> bool {
    let bits = bitcast<vec3<u32>>(v) & vec3<u32>(0x7fffffffu);
    return all(bits < vec3<u32>(0x7f800000u));
}

// The next float above a finite x; above both zeros stands the smallest denormal.
fn next_up(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    let magnitude = bits & 0x7fffffffu;
    let away = select(bits - 1u, bits + 1u, bits == magnitude);
    return bitcast<f32>(select(away, 0x00000001u, magnitude == 0u));
}

// The next float below a finite x; below both zeros stands the smallest negative denormal.
fn next_down(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    let magnitude = bits & 0x7fffffffu;
    let away = select(bits + 1u, bits - 1u, bits == magnitude);
    return bitcast<f32>(select(away, 0x80000001u, magnitude == 0u));
}

// Zero for negative zero: x + 0.0, which a driver may take for x.
fn without_negative_zero(x: f32) -> f32 {
    return bitcast<f32>(select(bitcast<u32>(x), 0u, magnitude_bits(x) == 0u));
}
