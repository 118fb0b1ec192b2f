// How much a surface mirrors at an angle: the twin of ropewalk-render's bsdf/fresnel.rs.
// Source: Fresnel's equations for unpolarised light; Schlick 1994.
// Invariants: same operations in the same order as in Rust.

#import bsdf_arithmetic

// The squared sine, behind the border, of a ray whose cosine on this side is `cos_here`; 1 and more where there is none.
fn sine_behind_squared(cos_here: f32, eta: f32) -> f32 {
    return eta * eta * ((1.0 - cos_here) * (1.0 + cos_here));
}

// The share of light that the border of two clear media mirrors.
fn fresnel_of_border(cos_here: f32, eta: f32) -> f32 {
    if eta == 1.0 {
        return 0.0;
    }
    let square = sine_behind_squared(cos_here, eta);
    if square >= 1.0 {
        return 1.0;
    }
    let cos_behind = sqrt(1.0 - square);
    let across = (eta * cos_here - cos_behind) / (eta * cos_here + cos_behind);
    let along = (eta * cos_behind - cos_here) / (eta * cos_behind + cos_here);
    let both = vec2<f32>(across, along);
    return dot(both, both) * 0.5;
}

// The share that is mirrored at normal incidence.
fn fresnel_at_normal(eta: f32) -> f32 {
    let share = (eta - 1.0) / (eta + 1.0);
    return share * share;
}

// The direction behind the border of a ray along the unit vector `dir`, which comes to the side that the unit normal points
// to; zero where all light is mirrored.
fn refract_ray(dir: vec3<f32>, normal: vec3<f32>, eta: f32) -> vec3<f32> {
    if eta == 1.0 {
        return dir;
    }
    let cos_here = min(max(-dot(dir, normal), 0.0), 1.0);
    let square = sine_behind_squared(cos_here, eta);
    if square >= 1.0 {
        return vec3<f32>(0.0);
    }
    let along = eta * cos_here - sqrt(1.0 - square);
    return unit(sum_of_two(dir, eta, normal, along));
}

// Schlick's curve.
fn schlick(at_normal: vec3<f32>, grazing: f32, cos_eye: f32) -> vec3<f32> {
    let rest = kept(1.0 - min(max(cos_eye, 0.0), 1.0));
    let square = rest * rest;
    let fifth = square * square * rest;
    return kept_vector(at_normal + max(vec3<f32>(grazing) - at_normal, vec3<f32>(0.0)) * fifth);
}

// The mean of it over the hemisphere, weighed with the cosine.
fn schlick_mean(at_normal: vec3<f32>, grazing: f32) -> vec3<f32> {
    return kept_vector(at_normal + max(vec3<f32>(grazing) - at_normal, vec3<f32>(0.0)) * (1.0f / 21.0f));
}
