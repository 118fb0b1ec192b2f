// Sums of products that come out the same on the CPU and here: the twin of ropewalk-render's bsdf/arithmetic.rs.
// Source: the same. Mesa's compiler moves constants through sums and products, 1 - (0.5 + x) to 0.5 - x, and sums of products
//   with a common factor; it does neither with dot(), nor across what it cannot see through.
// Invariants: what is summed is summed by dot(); between a value that ends in a constant and one that begins with a constant
//   stands kept().

#import looks_words

// The same number, in a way that no compiler sees through: with a word of the looks that is zero.
fn kept(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) | looks_word(#{LOOKS_ZERO}u));
}

fn kept_vector(v: vec3<f32>) -> vec3<f32> {
    return bitcast<vec3<f32>>(bitcast<vec3<u32>>(v) | vec3<u32>(looks_word(#{LOOKS_ZERO}u)));
}

// The vector of length one along a vector that is not zero.
fn unit(vector: vec3<f32>) -> vec3<f32> {
    return vector / sqrt(dot(vector, vector));
}

// a * x + b * y.
fn sum_of_two(a: vec3<f32>, x: f32, b: vec3<f32>, y: f32) -> vec3<f32> {
    let weights = vec2<f32>(x, y);
    return vec3<f32>(
        dot(vec2<f32>(a.x, b.x), weights),
        dot(vec2<f32>(a.y, b.y), weights),
        dot(vec2<f32>(a.z, b.z), weights),
    );
}

// a * x + b * y + c * z, with the weights in a vector.
fn sum_of_three(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, weights: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(
        dot(vec3<f32>(a.x, b.x, c.x), weights),
        dot(vec3<f32>(a.y, b.y, c.y), weights),
        dot(vec3<f32>(a.z, b.z, c.z), weights),
    );
}

// From a where the share is 0 to b where it is 1.
fn blend(a: vec3<f32>, b: vec3<f32>, share: f32) -> vec3<f32> {
    return sum_of_two(a, 1.0 - share, b, share);
}

// The direction into which a mirror with this unit normal throws what goes along -to_eye.
fn mirrored(normal: vec3<f32>, to_eye: vec3<f32>) -> vec3<f32> {
    let twice = dot(normal, to_eye) * 2.0;
    return unit(sum_of_two(normal, twice, to_eye, -1.0));
}
