//! Materials, cameras and lights.

use super::document::{self, Document, get};
use super::nodes::Placed;
use crate::{Camera, Light, LoadReport, Material};
use glam::{DAffine3, DVec3, Vec3};

/// A material, without its pictures. Factors outside of their range are brought into it.
///
/// `MASK` makes holes where alpha is below the cutoff. `BLEND` mixes a surface with what is behind it, in an order that rays
/// do not have: here as much light goes through as the factor's alpha leaves, unbent, and of a picture what is more
/// transparent than not is a hole.
pub(super) fn material(material: &document::Material) -> Material {
    let plain = Material::default();
    let surface = &material.pbr_metallic_roughness;
    let extensions = &material.extensions;
    let [red, green, blue, alpha] = surface.base_color_factor.unwrap_or([1.0; 4]);
    let alpha = bounded(Some(alpha), 0.0, 1.0, 1.0);
    let strength = bounded(extensions.emissive_strength.emissive_strength, 0.0, f32::MAX, 1.0);
    let emissive = Vec3::from(material.emissive_factor.unwrap_or_default()) * strength;
    let ior = extensions.refraction.ior.filter(|&ior| ior >= 1.0);
    let ior = bounded(ior, 1.0, f32::MAX, plain.ior);
    let transmission = bounded(extensions.transmission.transmission_factor, 0.0, 1.0, 0.0);
    let metallic = bounded(surface.metallic_factor, 0.0, 1.0, 1.0);
    let cutoff = bounded(material.alpha_cutoff, 0.0, f32::MAX, 0.5);
    let alpha_of_picture = if surface.base_color_texture.is_some() { 0.5 } else { 0.0 };
    let (opacity, alpha_cutoff, through, ior) = match material.alpha_mode.as_deref() {
        Some("MASK") => (alpha, cutoff, 0.0, ior),
        Some("BLEND") if alpha < 1.0 && transmission == 0.0 => (1.0, alpha_of_picture, 1.0 - alpha, 1.0),
        Some("BLEND") => (1.0, alpha_of_picture, 0.0, ior),
        _ => (1.0, 0.0, 0.0, ior),
    };
    Material {
        name: material.name.clone().unwrap_or_default(),
        base_color: color(Vec3::new(red, green, blue)).min(Vec3::ONE),
        emissive: color(emissive),
        roughness: bounded(surface.roughness_factor, 0.0, 1.0, 1.0),
        metallic,
        // It is for what is no metal. Where a picture says how much is metal, only the renderer knows.
        specular: extensions.specular.as_ref().filter(|_| metallic == 0.0).map(|it| specular(it, ior)),
        transmission: transmission.max(through),
        ior,
        opacity,
        alpha_cutoff,
        ..plain
    }
}

/// The share that is mirrored at normal incidence, by KHR_materials_specular.
fn specular(specular: &document::Specular, ior: f32) -> Vec3 {
    let tint = color(Vec3::from(specular.specular_color_factor.unwrap_or([1.0; 3])));
    let plain = ((ior - 1.0) / (ior + 1.0)).powi(2);
    (tint * plain).min(Vec3::ONE) * bounded(specular.specular_factor, 0.0, 1.0, 1.0)
}

fn bounded(value: Option<f32>, low: f32, high: f32, otherwise: f32) -> f32 {
    value.filter(|value| value.is_finite()).unwrap_or(otherwise).clamp(low, high)
}

/// A colour without parts that are negative or not finite.
fn color(color: Vec3) -> Vec3 {
    Vec3::from(color.to_array().map(|part| bounded(Some(part), 0.0, f32::MAX, 0.0)))
}

/// The camera at a node, if there is one that can be used. What else there is goes into the report.
pub(super) fn camera(
    document: &Document,
    placed: &Placed,
    origin: DVec3,
    report: &mut LoadReport,
) -> Option<Camera> {
    let node = document.nodes.get(placed.node)?;
    let camera = get(&document.cameras, node.camera?)?;
    let place = || document.node_place(placed.node);
    let Some(perspective) = &camera.perspective else {
        report.skip("cameras without perspective", place);
        return None;
    };
    let position = (placed.to_world.translation - origin).as_vec3();
    let forward = direction(&placed.to_world, DVec3::NEG_Z);
    let up = direction(&placed.to_world, DVec3::Y);
    // Vectors of length one that are closer than this to parallel span no picture in f32.
    let axes = forward.zip(up).filter(|(forward, up)| forward.cross(*up).length() > 1e-4);
    let fov = perspective.yfov;
    let Some((forward, up)) =
        axes.filter(|_| position.is_finite() && fov > 0.0 && fov < std::f32::consts::PI)
    else {
        report.skip("cameras whose placement or field of view is not usable", place);
        return None;
    };
    let name = camera.name.clone().or_else(|| node.name.clone()).unwrap_or_default();
    Some(Camera { name, position, forward, up, vertical_fov: fov })
}

/// The light at a node, in the units of the file: candela for points, lux for suns.
pub(super) fn light(
    document: &Document,
    placed: &Placed,
    origin: DVec3,
    report: &mut LoadReport,
) -> Option<Light> {
    let node = document.nodes.get(placed.node)?;
    let light = get(&document.extensions.punctual.lights, node.extensions.light.as_ref()?.light)?;
    let place = || document.node_place(placed.node);
    let intensity = bounded(light.intensity, 0.0, f32::MAX, 1.0);
    let color = color(Vec3::from(light.color.unwrap_or([1.0; 3])) * intensity);
    let position = (placed.to_world.translation - origin).as_vec3();
    let found = match light.kind.as_str() {
        "directional" => {
            direction(&placed.to_world, DVec3::NEG_Z).map(|direction| Light::Sun { direction, color })
        }
        "point" | "spot" => position.is_finite().then_some(Light::Point { position, color }),
        _ => None,
    };
    if found.is_none() {
        report.skip("lights whose placement or kind is not usable", place);
    }
    found
}

/// A direction of a node in the world, of length one.
fn direction(to_world: &DAffine3, direction: DVec3) -> Option<Vec3> {
    let unit = to_world.transform_vector3(direction).try_normalize()?;
    Some(unit.as_vec3())
}
