// What a tree of rays asks of a surface: the twin of ropewalk-render's bsdf/shading.rs.
// Source: Walter et al. 2007 for the facets, Hammon 2017 for how many of them are seen and lit.
// Invariants: same operations in the same order as in Rust.

#import bsdf
#import light_environment

// What goes towards the eye of light that would make a white matt surface facing it shine with a radiance of one.
fn direct(bsdf: Bsdf, normal: vec3<f32>, to_eye: vec3<f32>, to_light: vec3<f32>) -> vec3<f32> {
    let cos_light = dot(normal, to_light);
    if cos_light <= 0.0 {
        return vec3<f32>(0.0);
    }
    let roughness = max(bsdf.roughness, 0.18);
    let cos_eye = max(dot(normal, to_eye), 1e-3);
    let between = to_light + to_eye;
    let square = dot(between, between);
    let half = select(normal, between / sqrt(square), square > 1e-12);
    let height = highlight(roughness * roughness, dot(normal, half), cos_light, cos_eye);
    let mirrored_part = fresnel(bsdf, dot(to_eye, half)) * height;
    let sum = scattered_part(bsdf, cos_eye, cos_light) + mirrored_part;
    return min(sum * cos_light, vec3<f32>(1e6));
}

// The share of mirrored light that a ray is sent for.
fn followed_share(bsdf: Bsdf) -> f32 {
    let smoothness = kept(1.0 - bsdf.roughness);
    let square = smoothness * smoothness;
    return select(square * square, 1.0, bsdf.is_sharp);
}

// The weight of what a mirrored ray brings.
fn mirror_weight(bsdf: Bsdf, cos_eye: f32) -> vec3<f32> {
    return fresnel(bsdf, cos_eye) * followed_share(bsdf);
}

// The weight of what a refracted ray brings.
fn through_weight(bsdf: Bsdf, cos_eye: f32) -> vec3<f32> {
    return bsdf.through * (vec3<f32>(1.0) - fresnel(bsdf, cos_eye));
}

// What goes towards the eye of the light that comes from everywhere around, nothing being in its way.
fn surroundings(bsdf: Bsdf, normal: vec3<f32>, to_eye: vec3<f32>, follows_mirrors: bool) -> vec3<f32> {
    let cos_eye = min(max(dot(normal, to_eye), 0.0), 1.0);
    let rest = kept(1.0 - cos_eye);
    let square = rest * rest;
    let fifth = square * square * rest;
    let grazing = max(vec3<f32>(bsdf.grazing * kept(1.0 - bsdf.roughness)), bsdf.specular);
    let rough = bsdf.specular + (grazing - bsdf.specular) * fifth;
    let followed = kept(followed_share(bsdf));
    let sharp = kept_vector(fresnel(bsdf, cos_eye) * followed);
    let blurred = kept_vector(rough * (1.0 - followed));
    let scattered = bsdf.diffuse * (vec3<f32>(1.0) - sharp - blurred) * environment_scattered(normal);
    let here = select(blurred + sharp, blurred, follows_mirrors);
    let direction = mirrored(normal, to_eye);
    let reflected = here * environment_mirrored(direction, bsdf.roughness);
    return kept_vector(scattered) + kept_vector(reflected) + bsdf.ambient * environment_ambient();
}

// How much brighter than a white matt surface a surface of microfacets shines that mirrors everything.
fn highlight(alpha: f32, cos_half: f32, cos_light: f32, cos_eye: f32) -> f32 {
    let squared = kept(alpha * alpha);
    let cos_between = kept(min(max(cos_half, 0.0), 1.0));
    let fall = kept(cos_between * cos_between * kept(squared - 1.0) + 1.0);
    let facets = squared / (fall * fall);
    let sums = vec2<f32>(cos_light * cos_eye * 2.0, cos_light + cos_eye);
    return facets / (dot(sums, vec2<f32>(1.0 - alpha, alpha)) * 2.0);
}
