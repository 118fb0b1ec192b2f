//! `--light`: the scene's own lights, a sun, a point, or even light from everywhere.

use glam::Vec3;
use ropewalk_render::LightChoice;
use ropewalk_scene::{Light, Model};
use std::str::FromStr;

/// Which light is meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LightArgument {
    /// The file's lights; where it has none, a sun behind the camera.
    Automatic,
    /// A sun that shines along this direction.
    Sun(Vec3),
    /// A light at this point.
    Point(Vec3),
    /// This radiance from everywhere and no lamp: what the scene gives off itself is seen beside it.
    Even(Vec3),
}

impl FromStr for LightArgument {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong =
            || "it can be auto, sun:X/Y/Z (the way its light shines), point:X/Y/Z or even:R/G/B".to_owned();
        match text.split_once(':') {
            None if text == "auto" => Ok(Self::Automatic),
            Some(("sun", direction)) => point(direction).map(Self::Sun).ok_or_else(wrong),
            Some(("point", position)) => point(position).map(Self::Point).ok_or_else(wrong),
            Some(("even", radiance)) => point(radiance).map(Self::Even).ok_or_else(wrong),
            _ => Err(wrong()),
        }
    }
}

fn point(text: &str) -> Option<Vec3> {
    let numbers: Vec<f32> = text.split('/').map(|part| part.trim().parse().ok()).collect::<Option<_>>()?;
    let numbers: [f32; 3] = numbers.try_into().ok()?;
    Some(Vec3::from(numbers)).filter(|point| point.is_finite())
}

impl LightArgument {
    /// Puts the light into the model, or says how the renderer is to light it.
    pub(crate) fn choose(self, model: &mut Model) -> LightChoice {
        match self {
            Self::Automatic => LightChoice::Automatic,
            Self::Sun(direction) => LightChoice::Sun(direction),
            Self::Even(radiance) => LightChoice::Even(radiance),
            Self::Point(position) => {
                // The renderer scales the lights of a file to a good exposure, so any brightness will do.
                model.lights = vec![Light::Point { position, color: Vec3::ONE }];
                LightChoice::Automatic
            }
        }
    }

    /// The part of the choice that the renderer checks before any work is done.
    pub(crate) fn checked(self) -> LightChoice {
        self.choose(&mut Model::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_are_read() {
        assert_eq!("auto".parse(), Ok(LightArgument::Automatic));
        assert_eq!("sun:1/-2/0.5".parse(), Ok(LightArgument::Sun(Vec3::new(1.0, -2.0, 0.5))));
        assert_eq!("point:0/1e3/0".parse(), Ok(LightArgument::Point(Vec3::new(0.0, 1e3, 0.0))));
        assert_eq!("even:1/1/0.5".parse(), Ok(LightArgument::Even(Vec3::new(1.0, 1.0, 0.5))));
        for bad in [
            "",
            "even:1",
            "sun",
            "sun:",
            "sun:1/2",
            "sun:1/2/3/4",
            "sun:a/b/c",
            "point:NaN/0/0",
            "lamp:1/2/3",
            "auto:1",
        ] {
            assert!(bad.parse::<LightArgument>().is_err(), "{bad}");
        }
    }

    #[test]
    fn a_point_becomes_the_only_light() {
        let mut model = Model::default();
        model.lights.push(Light::Sun { direction: Vec3::X, color: Vec3::ONE });
        assert_eq!(LightArgument::Point(Vec3::Y).choose(&mut model), LightChoice::Automatic);
        assert_eq!(model.lights, [Light::Point { position: Vec3::Y, color: Vec3::ONE }]);
    }
}
