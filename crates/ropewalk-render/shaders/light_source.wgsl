// One thing that shines, and its light on the way to a place: the twin of ropewalk-render's light/source.rs.
// Source: the same.
// Invariants: same operations in the same order as in Rust. The words are those of light/mod.rs.

#import looks_words
#import sampling

const LIGHT_SUN: u32 = 0u;
const LIGHT_POINT: u32 = 1u;

struct Incoming {
    // Whether any light arrives.
    is_there: bool,
    // To the light, of unit length.
    to_light: vec3<f32>,
    // How far it is; infinite for a sun.
    distance: f32,
    // The radiance of a white matt surface that faces it.
    light: vec3<f32>,
}

fn light_count() -> u32 {
    return looks_word(looks_word(#{LOOKS_LIGHT}u));
}

// The light that arrives at a place from the point of a source that `square` picks.
fn light_towards(source: u32, place: vec3<f32>, square: vec2<f32>) -> Incoming {
    let at = looks_word(#{LOOKS_LIGHT}u) + #{LIGHT_ENVIRONMENT_WORDS}u + #{LIGHT_SOURCE_WORDS}u * source;
    let kind = looks_word(at);
    let middle = looks_vector(at + 1u);
    let light = looks_vector(at + 5u);
    let to_middle = select(middle - place, middle, kind == LIGHT_SUN);
    let square_to_middle = dot(to_middle, to_middle);
    var incoming: Incoming;
    if !(square_to_middle > 1e-30 && square_to_middle < 1e30) {
        return incoming;
    }
    incoming.is_there = true;
    let frame = frame_of(to_middle / sqrt(square_to_middle));
    let offset = disc(square) * looks_float(at + 4u);
    let way = sum_of_three(to_middle, frame.tangent, frame.bitangent, vec3<f32>(1.0, offset.x, offset.y));
    incoming.to_light = unit(way);
    if kind == LIGHT_SUN {
        incoming.distance = batch.infinity;
        incoming.light = light;
        return incoming;
    }
    let square_of_way = dot(way, way);
    incoming.distance = sqrt(square_of_way);
    incoming.light = min(select(light, light / square_of_way, kind == LIGHT_POINT), vec3<f32>(1e12));
    return incoming;
}
