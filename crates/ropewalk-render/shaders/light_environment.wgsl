// What surrounds the scene: the twin of ropewalk-render's light/environment.rs and of sky.rs.
// Source: the same.
// Invariants: same operations in the same order as in Rust. The words are those of light/mod.rs.

#import looks_words
#import bsdf_arithmetic

fn light_vector(word: u32) -> vec3<f32> {
    return looks_vector(looks_word(#{LOOKS_LIGHT}u) + word);
}

fn is_studio() -> bool {
    return looks_word(looks_word(#{LOOKS_LIGHT}u) + 1u) == 0u;
}

// From 0 to 1 between two edges, level at both.
fn smooth_step(from_value: f32, to_value: f32, value: f32) -> f32 {
    let low = kept(from_value);
    let high = kept(to_value);
    let share = kept(min(max((value - low) / (high - low), 0.0), 1.0));
    return share * share * (3.0 - 2.0 * share);
}

// The mean radiance that a matt surface sees.
fn environment_scattered(normal: vec3<f32>) -> vec3<f32> {
    if !is_studio() {
        return light_vector(29u);
    }
    let share = kept(0.5 + 0.5 * dot(normal, light_vector(2u)));
    return blend(light_vector(14u), light_vector(17u), share);
}

// The radiance that a surface of some roughness sees in its mirror direction.
fn environment_mirrored(direction: vec3<f32>, roughness: f32) -> vec3<f32> {
    if !is_studio() {
        return light_vector(8u);
    }
    let height = min(max(dot(direction, light_vector(2u)), -1.0), 1.0);
    let above = blend(light_vector(20u), light_vector(23u), sqrt(max(height, 0.0)));
    let blur = kept(0.06 + 0.7 * roughness);
    let sharp = blend(light_vector(14u), above, smooth_step(-blur, blur, height));
    let lamp_size = kept(0.10 + 0.6 * roughness);
    let lamp = smooth_step(1.0 - lamp_size, 1.0 - 0.3 * lamp_size, dot(direction, light_vector(5u)))
        * (0.10 / lamp_size);
    let blurred = blend(sharp, environment_scattered(direction), roughness * roughness);
    return blurred + light_vector(26u) * lamp;
}

// The radiance that a ray sees which leaves the scene.
fn environment_radiance(direction: vec3<f32>) -> vec3<f32> {
    return environment_mirrored(direction, 0.0);
}

// Light that reaches every place alike.
fn environment_ambient() -> vec3<f32> {
    return select(light_vector(11u), vec3<f32>(0.0), is_studio());
}
