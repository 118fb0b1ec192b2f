//! Materials, lights and the camera.

use super::animation::Keyframes;
use super::document::Standing;
use super::tokens::Tokens;
use crate::{Camera, Light, LoadError, Material};
use glam::{DAffine3, DVec3, Vec3};
use std::f32::consts::PI;

/// The numbers of a material, as in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Finish {
    ambient: DVec3,
    diffuse: DVec3,
    specular: DVec3,
    /// The exponent of the highlight, transmittance, index of refraction.
    shine: f64,
    transmittance: f64,
    ior: f64,
}

impl Finish {
    /// For shapes that stand before the first material; the format names none.
    pub(super) const NONE: Self = Self {
        ambient: DVec3::splat(0.1),
        diffuse: DVec3::ONE,
        specular: DVec3::ZERO,
        shine: 0.0,
        transmittance: 0.0,
        ior: 1.0,
    };

    /// `fm`: three colours and three numbers.
    pub(super) fn read_fm(tokens: &mut Tokens<'_>) -> Result<Self, LoadError> {
        Ok(Self {
            ambient: tokens.vector()?,
            diffuse: tokens.vector()?,
            specular: tokens.vector()?,
            shine: tokens.number()?,
            transmittance: tokens.number()?,
            ior: tokens.number()?,
        })
    }

    /// `f`: a colour, and the shares of diffuse and specular light. Files leave away what stands at the end.
    pub(super) fn read_f(tokens: &mut Tokens<'_>) -> Result<Self, LoadError> {
        let color = tokens.vector()?;
        let mut values = [1.0, 0.0, 1.0, 0.0, 1.0];
        for value in &mut values {
            if !tokens.number_is_next() {
                break;
            }
            *value = tokens.number()?;
        }
        let [diffuse, specular, shine, transmittance, ior] = values;
        let specular = DVec3::splat(specular);
        Ok(Self { ambient: color, diffuse: color * diffuse, specular, shine, transmittance, ior })
    }

    /// The same for equal materials only.
    pub(super) fn key(&self) -> [u64; 12] {
        let [a, b, c] = self.ambient.to_array();
        let [d, e, f] = self.diffuse.to_array();
        let [g, h, i] = self.specular.to_array();
        // Adding zero makes one of the two zeros.
        [a, b, c, d, e, f, g, h, i, self.shine, self.transmittance, self.ior]
            .map(|value| (value + 0.0).to_bits())
    }

    /// The material of a model. Values out of their range are brought into it. The colour of the highlight serves as that
    /// of the mirror too, as ray tracers of the benchmark have it; where it is black nothing is said of mirrors.
    pub(super) fn material(&self, name: String) -> Material {
        let share = |value: f64| value.clamp(0.0, 1.0) as f32;
        let color = |color: DVec3| Vec3::from(color.to_array().map(share));
        // The exponent belongs to the mirrored ray; one that belongs to the half vector is four times as large.
        let exponent = 4.0 * self.shine.max(0.0);
        let is_shiny = self.specular.max_element() > 0.0;
        let ior = match self.ior {
            ior if ior >= 1.0 => ior as f32,
            // Files write 0 for opaque materials, and for thin glass that bends nothing.
            _ if self.transmittance > 0.0 => 1.0,
            _ => Material::default().ior,
        };
        Material {
            name,
            base_color: color(self.diffuse),
            specular: is_shiny.then(|| color(self.specular)),
            mirrors_sharply: is_shiny,
            ambient: Some(color(self.ambient)),
            roughness: if is_shiny { (2.0 / (exponent + 2.0)).powf(0.25) as f32 } else { 1.0 },
            transmission: share(self.transmittance),
            ior: ior.min(f32::MAX),
            ..Material::default()
        }
    }
}

/// A light in its block.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PlacedLight {
    pub(super) node: Option<usize>,
    /// Through the static blocks around it.
    to_node: DAffine3,
    name: Option<String>,
    position: DVec3,
    color: DVec3,
}

impl PlacedLight {
    /// `l`, or `la` where a name comes first.
    pub(super) fn read(
        tokens: &mut Tokens<'_>,
        has_name: bool,
        node: Option<usize>,
        to_node: DAffine3,
    ) -> Result<Self, LoadError> {
        let name = if has_name { Some(tokens.name("the name of a light")?) } else { None };
        let position = tokens.vector()?;
        let color = if tokens.number_is_next() { tokens.vector()? } else { DVec3::ONE };
        Ok(Self { node, to_node, name, position, color })
    }

    /// The name whose track moves it.
    pub(super) fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// The light at a time, or `None` where it cannot be placed. Lights of the format do not fall off with distance.
    pub(super) fn at(
        &self,
        time: f64,
        keyframes: Option<&Keyframes>,
        standing: &Standing,
        origin: DVec3,
    ) -> Option<Light> {
        let track = keyframes.and_then(|keyframes| keyframes.translation.as_ref());
        let position = track.map_or(self.position, |track| track.at(time));
        let position = (standing.to_world * self.to_node).transform_point3(position);
        let color = self.color.max(DVec3::ZERO).as_vec3();
        let position = (position - origin).as_vec3();
        (position.is_finite() && color.is_finite()).then_some(Light::Lamp { position, color })
    }
}

/// `v`: the view from outside of all blocks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct View {
    from: DVec3,
    at: DVec3,
    up: DVec3,
    /// Between the lower and the upper edge of the picture, in degrees.
    angle: f64,
    /// Where it stands in the file.
    pub(super) place: String,
}

impl View {
    pub(super) fn read(tokens: &mut Tokens<'_>, place: String) -> Result<Self, LoadError> {
        tokens.expect("from")?;
        let from = tokens.vector()?;
        tokens.expect("at")?;
        let at = tokens.vector()?;
        tokens.expect("up")?;
        let up = tokens.vector()?;
        tokens.expect("angle")?;
        let angle = tokens.number()?;
        tokens.expect("hither")?;
        tokens.number()?;
        tokens.expect("resolution")?;
        tokens.integer()?;
        tokens.integer()?;
        Ok(Self { from, at, up, angle, place })
    }

    /// The camera at a time; the tracks named `camera` replace what the view says of eye and direction. `None` where
    /// they span no picture.
    pub(super) fn camera(&self, time: f64, keyframes: Option<&Keyframes>, origin: DVec3) -> Option<Camera> {
        let track = keyframes.and_then(|keyframes| keyframes.translation.as_ref());
        let position = (track.map_or(self.from, |track| track.at(time)) - origin).as_vec3();
        let turn = keyframes.and_then(|keyframes| keyframes.rotation(time));
        let (forward, up) =
            turn.map_or((self.at - self.from, self.up), |turn| (turn * DVec3::NEG_Z, turn * DVec3::Y));
        let (forward, up) = (forward.try_normalize()?, up.try_normalize()?);
        // Vectors of length one that are closer than this to parallel span no picture in f32.
        let spans = forward.cross(up).length() > 1e-4;
        let vertical_fov = self.angle.to_radians() as f32;
        let is_usable = spans && position.is_finite() && vertical_fov > 0.0 && vertical_fov < PI;
        let (forward, up) = (forward.as_vec3(), up.as_vec3());
        is_usable.then(|| Camera { name: "camera".into(), position, forward, up, vertical_fov })
    }
}
