//! What the words of `ropewalk render` stand for.

use ropewalk_render::RenderSettings;
use std::fmt;
use std::str::FromStr;

/// The size of a picture. Whether it can be made is the renderer's to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Size {
    pub(super) width: u32,
    pub(super) height: u32,
}

impl Default for Size {
    fn default() -> Self {
        let RenderSettings { width, height, .. } = RenderSettings::default();
        Self { width, height }
    }
}

impl fmt::Display for Size {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}x{}", self.width, self.height)
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let side = |text: &str| text.trim().parse().ok();
        text.split_once(['x', 'X'])
            .and_then(|(width, height)| Some(Self { width: side(width)?, height: side(height)? }))
            .ok_or_else(|| "a size is written WIDTHxHEIGHT, such as 1280x720".into())
    }
}

/// An axis of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Up(pub(super) glam::Vec3);

impl FromStr for Up {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.strip_prefix(['-', '+']).unwrap_or(text) {
            "x" | "X" => Ok(glam::Vec3::X),
            "y" | "Y" => Ok(glam::Vec3::Y),
            "z" | "Z" => Ok(glam::Vec3::Z),
            _ => Err("it can be x, y, z, -x, -y or -z".to_owned()),
        }
        .map(|axis| Self(if text.starts_with('-') { -axis } else { axis }))
    }
}

/// A time that can be put on a line.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    text.trim()
        .parse()
        .ok()
        .filter(|time: &f64| time.is_finite())
        .ok_or_else(|| "a time is a number of seconds, such as 2.5".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_axes_are_read() {
        assert_eq!("640x480".parse(), Ok(Size { width: 640, height: 480 }));
        for bad in ["", "640", "640x", "x480", "640x480x3", "-1x5", "99999999999x1", "a x b"] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
        assert_eq!("-z".parse(), Ok(Up(glam::Vec3::NEG_Z)));
        assert_eq!("y".parse(), Ok(Up(glam::Vec3::Y)));
        assert!("up".parse::<Up>().is_err() && "--x".parse::<Up>().is_err());
    }

    #[test]
    fn times_are_numbers() {
        assert_eq!(finite("-2.5"), Ok(-2.5));
        assert!(["", "NaN", "inf", "1s"].into_iter().all(|wrong| finite(wrong).is_err()));
    }
}
