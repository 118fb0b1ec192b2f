//! How materials send light on: Lambert's cosine law, and a GGX highlight (Walter et al. 2007) with Hammon's
//! visibility term and Schlick's Fresnel term, for metals and for what is not quite matt.
//!
//! A material of roughness 1 that is no metal is exactly Lambertian. Only sums, products, quotients and roots
//! take part: the same bits on every platform.

use crate::sky::Sky;
use crate::surface::SurfacePoint;
use glam::Vec3;
use ropewalk_scene::Material;
use std::f32::consts::FRAC_1_PI;

/// A material, checked and worked out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Finish {
    /// The share of light that is sent on in all directions.
    diffuse: Vec3,
    /// The share that is reflected at normal incidence.
    specular: Vec3,
    /// The same at grazing incidence; 0 for a matt surface.
    grazing: f32,
    /// The square of the roughness: the width of the highlight.
    alpha: f32,
    roughness: f32,
    /// Light given off.
    pub(crate) emissive: Vec3,
}

impl Finish {
    /// What has no material.
    pub(crate) const MATT: Self = Self {
        diffuse: Vec3::splat(0.6),
        specular: Vec3::ZERO,
        grazing: 0.0,
        alpha: 1.0,
        roughness: 1.0,
        emissive: Vec3::ZERO,
    };

    /// Works out a material. What is no number, or out of range, is brought into it.
    pub(crate) fn new(material: &Material) -> Self {
        let unit = |value: f32, plain: f32| if value.is_nan() { plain } else { value.clamp(0.0, 1.0) };
        let plain = Material::default();
        let color =
            Vec3::from_array(std::array::from_fn(|i| unit(material.base_color[i], plain.base_color[i])));
        let emissive =
            material.emissive.to_array().map(|value| if value > 0.0 { value.min(1e6) } else { 0.0 });
        let roughness = unit(material.roughness, 1.0);
        let metallic = unit(material.metallic, 0.0);
        let ior = if material.ior.is_finite() && material.ior >= 1.0 { material.ior } else { plain.ior };
        let dielectric = ((ior - 1.0) / (ior + 1.0)).powi(2) * (1.0 - roughness);
        let specular = Vec3::splat(dielectric).lerp(color, metallic);
        Self {
            diffuse: color * (1.0 - metallic),
            specular,
            grazing: (specular.max_element() * 50.0).min(1.0),
            // A smoother highlight of a point light would be smaller than a pixel's samples can catch.
            alpha: roughness.max(0.18).powi(2),
            roughness,
            emissive: emissive.into(),
        }
    }

    fn fresnel(&self, cos: f32) -> Vec3 {
        let rest = 1.0 - cos.clamp(0.0, 1.0);
        let fifth = rest * rest * rest * rest * rest;
        self.specular + (Vec3::splat(self.grazing) - self.specular).max(Vec3::ZERO) * fifth
    }

    /// The radiance towards the eye for an irradiance of one that falls along `-light` on a surface facing it.
    pub(crate) fn direct(&self, point: &SurfacePoint, light: Vec3) -> Vec3 {
        let (normal, view) = (point.normal, point.view);
        let cos_light = normal.dot(light);
        if cos_light <= 0.0 {
            return Vec3::ZERO;
        }
        let cos_view = normal.dot(view).max(1e-3);
        let half = (light + view).normalize_or(normal);
        let cos_half = normal.dot(half).clamp(0.0, 1.0);
        let squared = self.alpha * self.alpha;
        let fall = cos_half * cos_half * (squared - 1.0) + 1.0;
        let distribution = squared * FRAC_1_PI / (fall * fall);
        let visibility =
            0.5 / (2.0 * cos_light * cos_view * (1.0 - self.alpha) + (cos_light + cos_view) * self.alpha);
        let fresnel = self.fresnel(view.dot(half));
        let mirrored = fresnel * (distribution * visibility);
        (self.diffuse * (Vec3::ONE - fresnel) * FRAC_1_PI + mirrored) * cos_light
    }

    /// The radiance towards the eye from the whole sky, nothing being in its way.
    pub(crate) fn ambient(&self, point: &SurfacePoint, sky: &Sky) -> Vec3 {
        let (normal, view) = (point.normal, point.view);
        let cos_view = normal.dot(view).clamp(0.0, 1.0);
        let mirrored = normal * (2.0 * normal.dot(view)) - view;
        // A rough surface gathers its reflection from so wide a cone that little of the grazing gain is left.
        let rest = 1.0 - cos_view;
        let fifth = rest * rest * rest * rest * rest;
        let grazing = Vec3::splat(self.grazing * (1.0 - self.roughness)).max(self.specular);
        let fresnel = self.specular + (grazing - self.specular) * fifth;
        self.diffuse * (Vec3::ONE - fresnel) * sky.diffuse(normal)
            + fresnel * sky.reflected(mirrored, self.roughness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(normal: Vec3, view: Vec3) -> SurfacePoint {
        SurfacePoint {
            position: Vec3::ZERO,
            origin: Vec3::ZERO,
            geometric_normal: normal,
            normal,
            view,
            material: 0,
            is_ground: false,
            triangle: None,
        }
    }

    #[test]
    fn a_matt_surface_is_lambertian() {
        let finish = Finish::new(&Material { base_color: Vec3::new(0.2, 0.5, 0.8), ..Material::default() });
        let full = Vec3::new(0.2, 0.5, 0.8) * FRAC_1_PI;
        for view in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.999, 0.0447)] {
            let at = point(Vec3::Z, view);
            assert!(finish.direct(&at, Vec3::Z).distance(full) < 1e-6);
            assert!(finish.direct(&at, Vec3::new(0.0, 0.8, 0.6)).distance(full * 0.6) < 1e-6);
            assert_eq!(finish.direct(&at, -Vec3::Z), Vec3::ZERO);
        }
    }

    #[test]
    fn metal_has_a_highlight_where_the_mirror_is() {
        let finish = Finish::new(&Material { metallic: 1.0, roughness: 0.3, ..Material::default() });
        let at = point(Vec3::Z, Vec3::new(0.6, 0.0, 0.8));
        let mirror = finish.direct(&at, Vec3::new(-0.6, 0.0, 0.8)).x;
        let beside = finish.direct(&at, Vec3::new(0.6, 0.0, 0.8)).x;
        assert!(mirror > 1.0 && mirror > 20.0 * beside, "{mirror} and {beside}");
    }

    #[test]
    fn no_more_light_leaves_than_arrives() {
        for (metallic, roughness) in [(0.0, 0.2), (0.0, 1.0), (1.0, 0.3), (1.0, 1.0), (0.5, 0.5)] {
            let material = Material { base_color: Vec3::ONE, metallic, roughness, ..Material::default() };
            let finish = Finish::new(&material);
            let at = point(Vec3::Z, Vec3::new(0.5, 0.0, 0.75_f32.sqrt()));
            // The sum over light from everywhere of the cosine-weighted reflection: at most one.
            let count = 20_000;
            let mut sum = 0.0;
            for index in 0..count {
                let square = crate::sampling::point(crate::sampling::Purpose::Sky, (0, 0), index, count);
                let light = crate::sampling::cosine_direction(Vec3::Z, square);
                let cos = light.z.max(1e-4);
                sum += f64::from(finish.direct(&at, light).x / cos) * std::f64::consts::PI / f64::from(count);
            }
            assert!(sum < 1.03, "metallic {metallic}, roughness {roughness}: {sum}");
            // Light that bounces twice between microfacets is not modelled: rough metal loses two thirds.
            assert!(sum > 0.3, "metallic {metallic}, roughness {roughness}: {sum}");
        }
    }

    #[test]
    fn a_material_of_nonsense_gives_numbers() {
        let nan = f32::NAN;
        let finish = Finish::new(&Material {
            base_color: Vec3::new(nan, -3.0, f32::INFINITY),
            emissive: Vec3::new(nan, f32::INFINITY, -1.0),
            roughness: nan,
            metallic: nan,
            ior: nan,
            ..Material::default()
        });
        assert!(finish.emissive.is_finite() && finish.emissive.min_element() >= 0.0);
        let at = point(Vec3::Z, Vec3::Z);
        assert!(finish.direct(&at, Vec3::Z).is_finite());
        assert!(finish.ambient(&at, &Sky::new(Vec3::Y, Vec3::Z)).is_finite());
        // The light behind the eye's back, exactly opposite: no half-way vector.
        assert!(finish.direct(&point(Vec3::Z, -Vec3::Z), Vec3::Z).is_finite());
    }
}
