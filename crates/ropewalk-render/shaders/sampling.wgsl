// Where samples lie on lights and in the sky: the twin of ropewalk-render's sampling.rs.
// Source: the same; Roberts' R2 and R3 lattices, Hammersley's set, Duff et al. 2017 for the frame.
// Invariants: same operations in the same order as in Rust. Whole numbers wrap.

#import bsdf_arithmetic

// A whole number as a fraction of 2^32, below 1.
fn fraction_of(bits: u32) -> f32 {
    return f32(bits >> 8u) * (1.0f / 16777216.0f);
}

// The middle of part `index` of `count`, as a fraction of 2^32.
fn sample_along(index: u32, count_of_all: u32) -> u32 {
    let count = min(max(count_of_all, 1u), 1u << 16u);
    let first = ((index % count) << 16u) + (1u << 15u);
    let second = (first % count) << 16u;
    return ((first / count) << 16u) + second / count;
}

fn lattice_point(pixel: vec2<u32>, index: u32, count: u32, x: vec2<u32>, y: vec2<u32>) -> vec2<f32> {
    let shift_x = pixel.x * x.x + pixel.y * x.y;
    let shift_y = pixel.x * y.x + pixel.y * y.y;
    return vec2<f32>(
        fraction_of(sample_along(index, count) + shift_x),
        fraction_of(reverseBits(index) + shift_y),
    );
}

// A point of the unit square for the disc of a light: number `index` of `count`, for one pixel.
fn light_point(pixel: vec2<u32>, index: u32, count: u32) -> vec2<f32> {
    return lattice_point(
        pixel,
        index,
        count,
        vec2<u32>(0x91e10da5u, 0xc13fa9a9u),
        vec2<u32>(0x8cb92ba7u, 0xd1b54a32u),
    );
}

// The same for the sky.
fn sky_point(pixel: vec2<u32>, index: u32, count: u32) -> vec2<f32> {
    return lattice_point(
        pixel,
        index,
        count,
        vec2<u32>(0xc13fa9a9u, 0x91e10da5u),
        vec2<u32>(0xd1b54a32u, 0xabc98388u),
    );
}

// The point on the unit circle a given turn along.
fn circle(turn: f32) -> vec2<f32> {
    let quarters = turn * 4.0;
    let quarter = floor(quarters);
    let angle = (quarters - quarter - 0.5) * 1.57079637050628662109375f;
    let square = angle * angle;
    let cosine = 1.0 - square * (0.5 - square * (1.0f / 24.0f));
    let sine = angle * (1.0 - square * (1.0f / 6.0f - square * (1.0f / 120.0f)));
    let x = (cosine - sine) * 0.707106769084930419921875f;
    let y = (cosine + sine) * 0.707106769084930419921875f;
    let which = u32(i32(quarter)) & 3u;
    if which == 0u {
        return vec2<f32>(x, y);
    }
    if which == 1u {
        return vec2<f32>(-y, x);
    }
    if which == 2u {
        return vec2<f32>(-x, -y);
    }
    return vec2<f32>(y, -x);
}

// Spreads the unit square evenly over the unit disc.
fn disc(square: vec2<f32>) -> vec2<f32> {
    return circle(square.y) * sqrt(square.x);
}

struct Frame {
    tangent: vec3<f32>,
    bitangent: vec3<f32>,
}

// Two unit vectors that make a right-handed frame with a unit vector.
fn frame_of(normal: vec3<f32>) -> Frame {
    let sign_of_z = select(1.0, -1.0, (bitcast<u32>(normal.z) >> 31u) != 0u);
    let a = -1.0 / (sign_of_z + normal.z);
    let b = normal.x * normal.y * a;
    return Frame(
        vec3<f32>(1.0 + sign_of_z * normal.x * normal.x * a, sign_of_z * b, -sign_of_z * normal.x),
        vec3<f32>(b, sign_of_z + normal.y * normal.y * a, -normal.y),
    );
}

// A direction of the hemisphere around a normal, more often near the normal, as the cosine weighs.
fn cosine_direction(normal: vec3<f32>, square: vec2<f32>) -> vec3<f32> {
    let place = disc(square);
    let frame = frame_of(normal);
    let height = sqrt(max(1.0 - dot(place, place), 0.0));
    return sum_of_three(frame.tangent, frame.bitangent, normal, vec3<f32>(place, height));
}

// A number from 0 to 1, below 1: number `index` for one pixel, evenly spread over both.
fn pixel_fraction(pixel: vec2<u32>, index: u32) -> f32 {
    let shift = pixel.y * 0xc13fa9a9u - pixel.x * 0x91e10da5u;
    return fraction_of(index * 0x9e3779b9u + shift);
}
