// What a picture asks of its trees: the twin of ropewalk-render's ray_tree/request.rs, which says which word is which.
// Source: the same.
// Invariants: none.

#import looks_words

fn request_word(word: u32) -> u32 {
    return looks_word(looks_word(#{LOOKS_REQUEST}u) + word);
}

fn request_float(word: u32) -> f32 {
    return bitcast<f32>(request_word(word));
}

fn request_bounces() -> u32 {
    return request_word(0u);
}

fn request_has(flag: u32) -> bool {
    return (request_word(1u) & flag) != 0u;
}

const REQUEST_SHADOWS: u32 = 1u;
const REQUEST_REFLECTIONS: u32 = 2u;
const REQUEST_REFRACTIONS: u32 = 4u;
