//! What a user writes for a camera, in the manner of structures and walks: `NAME[:key=value,...]`.

use super::Framing;
use crate::error::RenderError;
use glam::Vec3;
use std::str::FromStr;

/// Which camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum CameraChoice {
    /// The first camera of the file; where it has none, everything is framed from outside.
    #[default]
    Automatic,
    /// Everything is framed from outside.
    Frame(Framing),
    /// From within, along the longest line of sight: for buildings.
    Inside {
        /// The vertical field of view in radians.
        vertical_fov: Option<f32>,
    },
    /// From a point to a point.
    Look {
        /// Where the eye is.
        eye: Vec3,
        /// Where it looks.
        target: Vec3,
        /// What is up in the picture; else what is up in the scene.
        up: Option<Vec3>,
        /// The vertical field of view in radians.
        vertical_fov: Option<f32>,
    },
    /// A camera of the file, by its name or by its number from 0.
    OfFile(String),
}

impl CameraChoice {
    /// How a choice is written, for help texts and errors.
    pub const FORMS: &str = "a camera is auto, frame[:azimuth=DEG,elevation=DEG,fov=DEG], inside[:fov=DEG], \
                             look:eye=X/Y/Z,target=X/Y/Z[,up=X/Y/Z][,fov=DEG], or the name or number of one in the file";
}

impl FromStr for CameraChoice {
    type Err = RenderError;

    /// Reads what [`CameraChoice::FORMS`] describes. Whatever has none of these forms is a name in the file.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        let mut keys = Keys::parse(name, rest)?;
        let choice = match name {
            "auto" => Self::Automatic,
            "frame" => {
                let plain = Framing::default();
                Self::Frame(Framing {
                    azimuth: keys.angle("azimuth")?.unwrap_or(plain.azimuth),
                    elevation: keys.angle("elevation")?.unwrap_or(plain.elevation),
                    vertical_fov: keys.field_of_view()?.unwrap_or(plain.vertical_fov),
                })
            }
            "inside" => Self::Inside { vertical_fov: keys.field_of_view()? },
            "look" => {
                let wanted = |key: &str| RenderError::Camera(format!("look: {key}=X/Y/Z is missing"));
                Self::Look {
                    eye: keys.point("eye")?.ok_or_else(|| wanted("eye"))?,
                    target: keys.point("target")?.ok_or_else(|| wanted("target"))?,
                    up: keys.point("up")?,
                    vertical_fov: keys.field_of_view()?,
                }
            }
            _ => return Ok(Self::OfFile(text.into())),
        };
        keys.finish()?;
        Ok(choice)
    }
}

struct Keys<'a> {
    name: &'a str,
    pairs: Vec<(&'a str, &'a str)>,
}

impl<'a> Keys<'a> {
    fn parse(name: &'a str, rest: &'a str) -> Result<Self, RenderError> {
        // Only the known forms have keys; a file's camera may have a colon in its name.
        let has_keys = matches!(name, "auto" | "frame" | "inside" | "look");
        let parts = rest.split(',').filter(|part| has_keys && !part.is_empty());
        let pairs = parts
            .map(|part| {
                part.split_once('=').ok_or_else(|| {
                    RenderError::Camera(format!("{name}: '{part}' is not of the form key=value"))
                })
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { name, pairs })
    }

    fn take(&mut self, key: &str) -> Option<&'a str> {
        let place = self.pairs.iter().position(|(name, _)| *name == key)?;
        Some(self.pairs.remove(place).1)
    }

    fn number(&self, key: &str, text: &str) -> Result<f32, RenderError> {
        match text.trim().parse::<f32>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(RenderError::Camera(format!("{}: {key}: '{text}' is not a number", self.name))),
        }
    }

    fn angle(&mut self, key: &str) -> Result<Option<f32>, RenderError> {
        self.take(key).map(|text| self.number(key, text).map(f32::to_radians)).transpose()
    }

    fn field_of_view(&mut self) -> Result<Option<f32>, RenderError> {
        let Some(text) = self.take("fov") else { return Ok(None) };
        let degrees = self.number("fov", text)?;
        if (0.01..=175.0).contains(&degrees) {
            Ok(Some(degrees.to_radians()))
        } else {
            let what = format!("{}: fov={text}: it must lie between 0.01 and 175 degrees", self.name);
            Err(RenderError::Camera(what))
        }
    }

    fn point(&mut self, key: &str) -> Result<Option<Vec3>, RenderError> {
        let Some(text) = self.take(key) else { return Ok(None) };
        let numbers =
            text.split('/').map(|part| self.number(key, part)).collect::<Result<Vec<f32>, RenderError>>()?;
        match numbers[..] {
            [x, y, z] => Ok(Some(Vec3::new(x, y, z))),
            _ => Err(RenderError::Camera(format!(
                "{}: {key}={text}: three numbers X/Y/Z are wanted",
                self.name
            ))),
        }
    }

    fn finish(self) -> Result<(), RenderError> {
        match self.pairs.first() {
            None => Ok(()),
            Some((key, _)) => Err(RenderError::Camera(format!(
                "{}: the key '{key}' is unknown or given twice; {}",
                self.name,
                CameraChoice::FORMS
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_read() {
        let read = |text: &str| text.parse::<CameraChoice>().unwrap();
        assert_eq!(read("auto"), CameraChoice::Automatic);
        assert_eq!(read("frame"), CameraChoice::Frame(Framing::default()));
        let CameraChoice::Frame(framing) = read("frame:azimuth=90,fov=20") else { panic!() };
        assert!(
            (framing.azimuth - 1.570_796_4).abs() < 1e-6
                && (framing.vertical_fov - 0.349_065_86).abs() < 1e-6
        );
        assert_eq!(read("inside"), CameraChoice::Inside { vertical_fov: None });
        let look = read("look:eye=1/-2/3e2,target=0/0/0,up=0/0/1");
        let expected = CameraChoice::Look {
            eye: Vec3::new(1.0, -2.0, 300.0),
            target: Vec3::ZERO,
            up: Some(Vec3::Z),
            vertical_fov: None,
        };
        assert_eq!(look, expected);
        assert_eq!(read("Camera:left"), CameraChoice::OfFile("Camera:left".into()));
    }

    #[test]
    fn mistakes_are_named() {
        let message = |text: &str| text.parse::<CameraChoice>().unwrap_err().to_string();
        assert!(message("look:eye=1/2/3").contains("target=X/Y/Z is missing"));
        assert!(message("look:eye=1/2,target=0/0/0").contains("three numbers"));
        assert!(message("look:eye=a/2/3,target=0/0/0").contains("'a' is not a number"));
        assert!(message("look:eye=NaN/2/3,target=0/0/0").contains("not a number"));
        assert!(message("frame:fov=180").contains("between 0.01 and 175"));
        assert!(message("frame:height=3").contains("azimuth=DEG"));
        assert!(message("inside:fov").contains("key=value"));
        assert!(message("auto:fov=3").contains("'fov'"));
    }
}
