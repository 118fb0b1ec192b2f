// How a surface sends light on: the twin of ropewalk-render's bsdf/mod.rs.
// Source: the same.
// Invariants: same operations in the same order as in Rust. What is out of range in a material is brought into range.

#import bsdf_arithmetic
#import bsdf_fresnel
#import looks_shaded

struct Bsdf {
    // The share of light that is scattered in all directions, where nothing is mirrored.
    diffuse: vec3<f32>,
    // The share that is mirrored at normal incidence.
    specular: vec3<f32>,
    // The share that goes through, where nothing is mirrored.
    through: vec3<f32>,
    // The share that is mirrored at grazing incidence, where it is more than specular.
    grazing: f32,
    ambient: vec3<f32>,
    roughness: f32,
    is_sharp: bool,
    // The index of refraction on the side of the eye over that on the other.
    eta: f32,
}

// A number brought between 0 and 1. No number of the looks is NaN.
fn share_of(value: f32) -> f32 {
    return select(0.0, min(value, 1.0), value >= 0.0);
}

fn share_of_each(color: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(share_of(color.x), share_of(color.y), share_of(color.z));
}

fn new_bsdf(shaded: Shaded, front: bool) -> Bsdf {
    let base_color = share_of_each(shaded.base_color);
    let roughness = share_of(shaded.roughness);
    let metallic = share_of(shaded.metallic);
    let body = 1.0 - metallic;
    let transmission = share_of(shaded.transmission) * body;
    let solid = 1.0 - transmission;
    let ior = select(1.0, min(shaded.ior, 10.0), shaded.ior >= 1.0);
    var bsdf: Bsdf;
    if shaded.gives_specular {
        bsdf.specular = share_of_each(shaded.specular);
    } else {
        let glass = fresnel_at_normal(ior) * (1.0 - roughness);
        bsdf.specular = blend(vec3<f32>(glass), base_color, metallic);
    }
    if shaded.mirrors_sharply {
        bsdf.diffuse = min(base_color * body, vec3<f32>(solid));
        bsdf.through = vec3<f32>(transmission);
    } else {
        bsdf.diffuse = base_color * (body * solid);
        bsdf.through = base_color * transmission;
    }
    let largest = max(max(bsdf.specular.x, bsdf.specular.y), bsdf.specular.z);
    bsdf.grazing = select(min(largest * 50.0, 1.0), 0.0, shaded.mirrors_sharply);
    bsdf.ambient = share_of_each(shaded.ambient);
    bsdf.roughness = roughness;
    bsdf.is_sharp = shaded.mirrors_sharply || transmission > 0.0;
    bsdf.eta = select(ior, 1.0 / ior, front);
    return bsdf;
}

// Whether light goes through.
fn is_clear(bsdf: Bsdf) -> bool {
    return max(max(bsdf.through.x, bsdf.through.y), bsdf.through.z) > 0.0;
}

// The share that is mirrored at an angle of this cosine.
fn fresnel(bsdf: Bsdf, cos_eye: f32) -> vec3<f32> {
    if !is_clear(bsdf) {
        return schlick(bsdf.specular, bsdf.grazing, cos_eye);
    }
    let at_normal = fresnel_at_normal(bsdf.eta);
    let here = fresnel_of_border(min(max(cos_eye, 0.0), 1.0), bsdf.eta);
    let rise = max((here - at_normal) / (1.0 - at_normal), 0.0);
    return blend(bsdf.specular, vec3<f32>(1.0), rise);
}

// The part of light scattered back that is not lost to mirroring on its way in and out.
fn scattered_part(bsdf: Bsdf, cos_eye: f32, cos_light: f32) -> vec3<f32> {
    let rest = (vec3<f32>(1.0) - fresnel(bsdf, cos_eye)) * (vec3<f32>(1.0) - fresnel(bsdf, cos_light));
    if is_clear(bsdf) {
        return bsdf.diffuse * rest;
    }
    let mean = vec3<f32>(1.0) - schlick_mean(bsdf.specular, bsdf.grazing);
    return bsdf.diffuse * (rest / max(mean, vec3<f32>(1e-4)));
}
