//! What shines: the lights of the file, or a sun of our own, behind the camera and to its left; when the camera
//! stands within the scene, where a sun may not reach, a lamp beside it too.
//!
//! Files measure light in units that hardly two of them share, from 1 to 100,000. So all lights of a file are
//! scaled together until the irradiance in the middle of the scene is that of our own sun: their colours and
//! their shares stay, and every file is bright enough and not too bright.

use crate::error::RenderError;
use crate::sampling::{disc, frame};
use crate::sky::Sky;
use crate::stage::Stage;
use glam::{Vec2, Vec3};
use ropewalk::Aabb;
use ropewalk_scene::{Camera, Light};
use std::f32::consts::PI;

/// The irradiance of our own sun on a surface that faces it.
const SUN: Vec3 = Vec3::new(0.92 * PI, 0.88 * PI, 0.81 * PI);
/// The irradiance of the lamp that stands beside an eye which is indoors, at any distance.
const LAMP: Vec3 = Vec3::new(0.52 * PI, 0.50 * PI, 0.46 * PI);
/// How far the lamp stands to the left of the eye and above it, as a share of the size of the scene: far enough
/// that things throw shadows that are seen, too near for a wall to come between.
const LAMP_OFFSET: f32 = 0.012;
/// The radius of a sun as seen from the scene, as a tangent: shadows with edges as soft as a large lamp gives.
const SUN_RADIUS: f32 = 0.025;
/// The radius of a point light, as a share of the size of the scene.
const POINT_RADIUS: f32 = 0.004;
/// A point light closer to the middle than this share of the scene's size counts as this far when it is scaled.
const CLOSEST: f32 = 0.1;

/// Which lights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum LightChoice {
    /// The file's; where it has none, a sun behind the camera and to its left, and a lamp beside a camera that
    /// stands within the scene.
    #[default]
    Automatic,
    /// A sun that shines along this direction.
    Sun(Vec3),
    /// No light but this radiance, the same from all sides: in it, things that send on all light cannot be seen
    /// (a furnace).
    Even(Vec3),
}

impl LightChoice {
    pub(crate) fn check(&self) -> Result<(), RenderError> {
        match self {
            Self::Sun(direction) if direction.as_dvec3().try_normalize().is_none() => {
                Err(RenderError::Setting {
                    setting: "the direction of the sun",
                    value: direction.to_string(),
                    wanted: "it must be three finite numbers, not all 0",
                })
            }
            Self::Even(radiance) if !(radiance.is_finite() && radiance.min_element() >= 0.0) => {
                Err(RenderError::Setting {
                    setting: "the radiance from all sides",
                    value: radiance.to_string(),
                    wanted: "it must be three finite numbers, none below 0",
                })
            }
            _ => Ok(()),
        }
    }
}

/// One light, scaled and of some size.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Source {
    /// Parallel light.
    Sun {
        to_light: Vec3,
        irradiance: Vec3,
        /// The tangent of half the angle under which it is seen.
        radius: f32,
    },
    /// A small ball.
    Point { position: Vec3, intensity: Vec3, radius: f32 },
    /// A small ball whose light does not fall with the distance: no lamp does that, but it lights near and far
    /// alike where nothing is known about a room.
    Lamp { position: Vec3, irradiance: Vec3, radius: f32 },
}

/// Light on its way to a place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Incoming {
    /// To the light, of unit length.
    pub(crate) to_light: Vec3,
    /// How far it is.
    pub(crate) distance: f32,
    /// The irradiance on a surface that faces it.
    pub(crate) irradiance: Vec3,
}

impl Source {
    /// The light that arrives at a place from the point of the source that `square` picks.
    pub(crate) fn towards(&self, place: Vec3, square: Vec2) -> Option<Incoming> {
        match *self {
            Self::Sun { to_light, irradiance, radius } => {
                let (a, b) = frame(to_light);
                let offset = disc(square) * radius;
                let to_light = (to_light + a * offset.x + b * offset.y).normalize();
                Some(Incoming { to_light, distance: f32::INFINITY, irradiance })
            }
            Self::Point { position, intensity, radius } => {
                let (to_light, distance) = way_to_ball(place, position, radius, square)?;
                let irradiance = intensity / (distance * distance);
                irradiance.is_finite().then_some(Incoming { to_light, distance, irradiance })
            }
            Self::Lamp { position, irradiance, radius } => {
                let (to_light, distance) = way_to_ball(place, position, radius, square)?;
                Some(Incoming { to_light, distance, irradiance })
            }
        }
    }

    /// The irradiance in the middle of a scene of some size, and the direction to the light.
    fn at_middle(&self, middle: Vec3, size: f32) -> (f32, Vec3) {
        match *self {
            Self::Sun { to_light, irradiance, .. } => (irradiance.max_element(), to_light),
            Self::Point { position, intensity, .. } => {
                let way = position - middle;
                let distance = way.length().max(CLOSEST * size);
                (intensity.max_element() / (distance * distance), way.normalize_or(Vec3::Y))
            }
            Self::Lamp { position, irradiance, .. } => {
                (irradiance.max_element(), (position - middle).normalize_or(Vec3::Y))
            }
        }
    }

    fn scaled(self, by: f32) -> Self {
        match self {
            Self::Sun { to_light, irradiance, radius } => {
                Self::Sun { to_light, irradiance: irradiance * by, radius }
            }
            Self::Point { position, intensity, radius } => {
                Self::Point { position, intensity: intensity * by, radius }
            }
            Self::Lamp { position, irradiance, radius } => {
                Self::Lamp { position, irradiance: irradiance * by, radius }
            }
        }
    }
}

/// The direction and the distance from a place to a point of a ball's disc.
fn way_to_ball(place: Vec3, position: Vec3, radius: f32, square: Vec2) -> Option<(Vec3, f32)> {
    let (a, b) = frame((position - place).try_normalize()?);
    let offset = disc(square) * radius;
    let way = position + a * offset.x + b * offset.y - place;
    Some((way.try_normalize()?, way.length()))
}

/// All light of a picture.
#[derive(Clone, Debug)]
pub(crate) struct Lighting {
    pub(crate) sources: Vec<Source>,
    pub(crate) sky: Sky,
    /// The radiance from all sides, where that is the only light.
    pub(crate) even: Option<Vec3>,
    /// What the lights of the file are multiplied by; `None` where none of them is left.
    pub(crate) scale: Option<f32>,
    /// Lights of the file that are left out because their numbers are none.
    pub(crate) left_out: usize,
}

impl Lighting {
    /// Sets the lights for a picture. With `hard`, they have no size.
    pub(crate) fn new(stage: &Stage, camera: &Camera, choice: &LightChoice, hard: bool) -> Self {
        let bounds = stage.bounds();
        let middle = if bounds.is_empty() { Vec3::ZERO } else { bounds.center() };
        let size = bounds.size().length().max(f32::MIN_POSITIVE);
        let softness = if hard { 0.0 } else { 1.0 };
        let sun = |to_light| Source::Sun { to_light, irradiance: SUN, radius: SUN_RADIUS * softness };
        let of_file = &stage.model().lights;
        let mut of_file_by = None;
        let (mut sources, left_out) = match choice {
            LightChoice::Even(radiance) => {
                let sky = Sky { even: Some(*radiance), ..Sky::new(stage.up(), stage.up()) };
                return Self { sources: Vec::new(), sky, even: Some(*radiance), scale: None, left_out: 0 };
            }
            LightChoice::Sun(direction) => {
                (vec![sun(-direction.as_dvec3().normalize_or(-stage.up().as_dvec3()).as_vec3())], 0)
            }
            LightChoice::Automatic => {
                let sources: Vec<Source> =
                    of_file.iter().filter_map(|light| of(light, size * softness, softness)).collect();
                let left_out = of_file.len() - sources.len();
                let sum: f32 = sources.iter().map(|source| source.at_middle(middle, size).0).sum();
                let scale = SUN.max_element() / sum;
                if scale.is_finite() && scale > 0.0 {
                    of_file_by = Some(scale);
                    (sources.into_iter().map(|source| source.scaled(scale)).collect(), left_out)
                } else {
                    (Vec::new(), of_file.len())
                }
            }
        };
        if sources.is_empty() {
            let indoors = is_within(&bounds, camera.position);
            sources.push(sun(behind_the_left_shoulder(stage.up(), camera, indoors)));
            if indoors {
                let left = stage.up().cross(camera.forward).normalize_or_zero();
                let position = camera.position + (left + stage.up()) * (LAMP_OFFSET * size);
                sources.push(Source::Lamp {
                    position,
                    irradiance: LAMP,
                    radius: POINT_RADIUS * size * softness,
                });
            }
        }
        let key = sources
            .iter()
            .map(|source| source.at_middle(middle, size))
            .reduce(|best, next| if next.0 > best.0 { next } else { best })
            .map_or(stage.up(), |(_, direction)| direction);
        let sky = Sky::new(stage.up(), key);
        Self { sources, sky, even: None, scale: of_file_by, left_out }
    }
}

fn is_within(bounds: &Aabb, point: Vec3) -> bool {
    bounds.min.cmple(point).all() && bounds.max.cmpge(point).all()
}

/// A light of the file, or `None` when it gives no light or its numbers are none.
fn of(light: &Light, size: f32, softness: f32) -> Option<Source> {
    let shines = |color: Vec3| color.is_finite() && color.min_element() >= 0.0 && color.max_element() > 0.0;
    match *light {
        Light::Sun { direction, color } => {
            let to_light = -direction.as_dvec3().try_normalize()?.as_vec3();
            shines(color).then_some(Source::Sun {
                to_light,
                irradiance: color,
                radius: SUN_RADIUS * softness,
            })
        }
        Light::Point { position, color } => (shines(color) && position.is_finite())
            .then_some(Source::Point { position, intensity: color, radius: POINT_RADIUS * size }),
        Light::Lamp { position, color } => (shines(color) && position.is_finite()).then_some(Source::Lamp {
            position,
            irradiance: color,
            radius: POINT_RADIUS * size,
        }),
    }
}

/// The direction to our own sun: 46 degrees up, whatever the camera's own tilt. Indoors it stands higher and less to
/// the side, to come in through a roof and over walls.
fn behind_the_left_shoulder(up: Vec3, camera: &Camera, indoors: bool) -> Vec3 {
    let level = |direction: Vec3| direction.reject_from_normalized(up).try_normalize();
    // A camera that looks straight down has its own up ahead.
    let ahead = level(camera.forward.normalize_or_zero())
        .or_else(|| level(camera.up.normalize_or_zero()))
        .unwrap_or_else(|| frame(up).0);
    let right = ahead.cross(up);
    let way = if indoors {
        up * 0.88 - right * 0.2 - ahead * 0.42
    } else {
        up * 0.72 - right * 0.64 - ahead * 0.26
    };
    way.normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StageOptions;
    use ropewalk::{Mesh, Scene};
    use ropewalk_scene::Model;

    fn stage(lights: Vec<Light>) -> Stage {
        let mesh = Mesh::new(vec![Vec3::splat(-1.0), Vec3::ONE, Vec3::new(1.0, -1.0, 0.0)], vec![[0, 1, 2]]);
        let model = Model { scene: Scene::from_mesh(mesh), lights, ..Model::default() };
        Stage::new(model, &StageOptions::default())
    }

    fn camera(forward: Vec3) -> Camera {
        Camera { name: String::new(), position: Vec3::ZERO, forward, up: Vec3::Y, vertical_fov: 1.0 }
    }

    fn irradiance(stage: &Stage) -> Vec3 {
        let lighting = Lighting::new(stage, &camera(Vec3::NEG_Z), &LightChoice::Automatic, true);
        lighting
            .sources
            .iter()
            .filter_map(|source| source.towards(Vec3::ZERO, Vec2::splat(0.5)))
            .map(|incoming| incoming.irradiance)
            .sum()
    }

    #[test]
    fn files_of_any_unit_are_equally_bright() {
        let color = Vec3::new(1.0, 0.5, 0.25);
        for unit in [1e-3, 1.0, 1e5] {
            let sun = Light::Sun { direction: Vec3::new(0.0, -3.0, 0.0), color: color * unit };
            let lamp = Light::Point { position: Vec3::new(0.0, 4.0, 0.0), color: color * unit };
            let even = Light::Lamp { position: Vec3::new(0.0, 9.0, 0.0), color: color * unit };
            for lights in [vec![sun.clone()], vec![lamp.clone()], vec![even.clone()], vec![sun, lamp, even]] {
                let sum = irradiance(&stage(lights));
                assert!(sum.distance(color * SUN.x) < 1e-3, "{sum}");
            }
        }
    }

    #[test]
    fn lights_that_are_none_are_left_out() {
        let bad = vec![
            Light::Sun { direction: Vec3::ZERO, color: Vec3::ONE },
            Light::Sun { direction: Vec3::X, color: Vec3::ZERO },
            Light::Point { position: Vec3::NAN, color: Vec3::ONE },
            Light::Point { position: Vec3::X, color: Vec3::splat(f32::NAN) },
            Light::Point { position: Vec3::X, color: Vec3::new(-1.0, 1.0, 1.0) },
        ];
        let stage = stage(bad);
        let lighting = Lighting::new(&stage, &camera(Vec3::NEG_Z), &LightChoice::Automatic, false);
        assert_eq!(lighting.left_out, 5);
        assert!(matches!(lighting.sources[0], Source::Sun { .. }), "a sun of our own takes their place");
    }

    #[test]
    fn our_own_sun_is_behind_and_to_the_left() {
        for forward in [Vec3::NEG_Z, Vec3::new(0.0, -0.9, -0.4), Vec3::NEG_Y] {
            let to_light = behind_the_left_shoulder(Vec3::Y, &camera(forward), false);
            assert!((to_light.length() - 1.0).abs() < 1e-5);
            assert!(to_light.y > 0.7, "{to_light}");
            if forward == Vec3::NEG_Z {
                assert!(to_light.x < -0.3 && to_light.z > 0.2, "{to_light}");
            }
        }
    }

    #[test]
    fn an_eye_indoors_has_a_lamp() {
        let stage = stage(Vec::new());
        let count = |position: Vec3| {
            let camera = Camera { position, ..camera(Vec3::NEG_Z) };
            Lighting::new(&stage, &camera, &LightChoice::Automatic, false).sources.len()
        };
        assert_eq!((count(Vec3::ZERO), count(Vec3::splat(5.0))), (2, 1));
    }

    #[test]
    fn a_light_in_the_place_itself_gives_none() {
        let lamp = Source::Point { position: Vec3::ONE, intensity: Vec3::ONE, radius: 0.0 };
        assert!(lamp.towards(Vec3::ONE, Vec2::splat(0.5)).is_none());
        let lit = lamp.towards(Vec3::new(1.0, 3.0, 1.0), Vec2::splat(0.5)).unwrap();
        assert_eq!((lit.to_light, lit.distance, lit.irradiance), (Vec3::NEG_Y, 2.0, Vec3::splat(0.25)));
    }

    #[test]
    fn a_direction_that_is_none_is_refused() {
        for direction in [Vec3::ZERO, Vec3::NAN] {
            assert!(LightChoice::Sun(direction).check().is_err());
        }
        assert!(LightChoice::Sun(Vec3::NEG_Y).check().is_ok());
    }
}
