// Textures in one atlas: the twin of ropewalk-render's looks/texture.rs.
// Source: the same; Reichl et al. 2010, section 4.2.3.
// Invariants: coordinates are wrapped in whole texels before the atlas is read. Same operations in the same order as in Rust.

#import looks_words

const WRAP_REPEAT: u32 = #{WRAP_REPEAT}u;
const WRAP_MIRROR: u32 = #{WRAP_MIRROR}u;

// The coordinate, or 0 where it is no number or has no fraction.
fn tamed(coordinate: f32) -> f32 {
    return select(0.0, coordinate, (bitcast<u32>(coordinate) & 0x7fffffffu) < 0x4b000000u);
}

// The coordinate in texels, within the first period of the picture.
fn in_texels(coordinate: f32, wrap: u32, size: u32) -> f32 {
    let texels = f32(size);
    if wrap == WRAP_REPEAT {
        return (coordinate - floor(coordinate)) * texels;
    }
    if wrap == WRAP_MIRROR {
        let half = coordinate * 0.5;
        return ((half - floor(half)) * 2.0) * texels;
    }
    return min(max(coordinate, 0.0), 1.0) * texels;
}

// The texel of the picture for one that lies at most a texel outside of its first period.
fn wrapped(texel: i32, wrap: u32, size_of_picture: u32) -> u32 {
    let size = i32(size_of_picture);
    if wrap == WRAP_REPEAT {
        if texel < 0 {
            return u32(texel + size);
        }
        if texel >= size {
            return u32(texel - size);
        }
        return u32(texel);
    }
    if wrap == WRAP_MIRROR {
        var place = texel;
        if place < 0 {
            place += 2 * size;
        }
        if place >= 2 * size {
            place -= 2 * size;
        }
        if place >= size {
            place = 2 * size - 1 - place;
        }
        return u32(place);
    }
    return u32(min(max(texel, 0), size - 1));
}

// (1 - share) * a + share * b.
fn mix_numbers(a: f32, b: f32, share: f32) -> f32 {
    return dot(vec2<f32>(a, b), vec2<f32>(1.0 - share, share));
}

fn mix_texels(a: vec4<f32>, b: vec4<f32>, share: f32) -> vec4<f32> {
    return vec4<f32>(
        mix_numbers(a.x, b.x, share),
        mix_numbers(a.y, b.y, share),
        mix_numbers(a.z, b.z, share),
        mix_numbers(a.w, b.w, share),
    );
}

// A texel of a texture as linear numbers.
fn texel_at(description: u32, x: i32, y: i32) -> vec4<f32> {
    let flags = looks_word(description + 4u);
    let column = looks_word(description) + wrapped(x, flags & 3u, looks_word(description + 2u));
    let row = looks_word(description + 1u) + wrapped(y, (flags >> 2u) & 3u, looks_word(description + 3u));
    let texel = table_b[row * looks_word(#{LOOKS_ATLAS}u) + column];
    let plain = looks_word(#{LOOKS_BYTES}u) + 256u;
    let color = select(plain, plain - 256u, (flags & #{TEXTURE_IS_SRGB}u) != 0u);
    return vec4<f32>(
        looks_float(color + (texel & 0xffu)),
        looks_float(color + ((texel >> 8u) & 0xffu)),
        looks_float(color + ((texel >> 16u) & 0xffu)),
        looks_float(plain + (texel >> 24u)),
    );
}

// What a texture description gives: red, green, blue, linear, and alpha. The description must be one.
fn look_up(description: u32, uv: vec2<f32>) -> vec4<f32> {
    let at = looks_row(#{LOOKS_TEXTURES}u, description, #{LOOKS_TEXTURE_WORDS}u);
    let flags = looks_word(at + 4u);
    let u = tamed(looks_float(at + 5u) * tamed(uv.x) + looks_float(at + 7u));
    let v = tamed(looks_float(at + 6u) * tamed(uv.y) + looks_float(at + 8u));
    let x = in_texels(u, flags & 3u, looks_word(at + 2u));
    let y = in_texels(v, (flags >> 2u) & 3u, looks_word(at + 3u));
    let is_linear = (flags & #{TEXTURE_IS_LINEAR}u) != 0u;
    // The middle of texel i lies at i + 0.5.
    let left = select(x, x - 0.5, is_linear);
    let low = select(y, y - 0.5, is_linear);
    let across = left - floor(left);
    let up = low - floor(low);
    let column = i32(floor(left));
    let row = i32(floor(low));
    // One texel, or four: in a loop, so that there is one copy of what reads a texel.
    let count = select(1u, 4u, is_linear);
    var texel: vec4<f32>;
    var first: vec4<f32>;
    for (var i = 0u; i < count; i += 1u) {
        let next = texel_at(at, column + i32(i & 1u), row + i32(i >> 1u));
        if i == 1u {
            first = mix_texels(texel, next, across);
        } else if i == 3u {
            texel = mix_texels(first, mix_texels(texel, next, across), up);
        } else {
            texel = next;
        }
    }
    return texel;
}
