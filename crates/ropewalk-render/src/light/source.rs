//! One thing that shines, and its light on the way to a place. `towards` has a twin in the kernel.

use crate::bsdf::arithmetic::{sum_of_three, unit};
use crate::lights::Source;
use crate::sampling::{disc, frame};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Words of a source.
pub(crate) const SOURCE_WORDS: usize = 8;

/// How light spreads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SourceKind {
    /// Parallel light: the place is the direction to it, the radius a tangent.
    Sun,
    /// From a small ball, falling with the square of the distance.
    Point,
    /// From a small ball, the same at all distances.
    Lamp,
}

/// One light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightSource {
    pub(crate) kind: SourceKind,
    /// Where it is, or the unit vector to a sun.
    pub(crate) place: Vec3,
    /// Its radius; the tangent of half the angle under which a sun is seen.
    pub(crate) radius: f32,
    /// The radiance of a white matt surface that faces it, at distance one where it falls with the distance.
    pub(crate) light: Vec3,
}

/// Light on its way to a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Incoming {
    /// To the light, of unit length.
    pub(crate) to_light: Vec3,
    /// How far it is; infinite for a sun.
    pub(crate) distance: f32,
    /// The radiance of a white matt surface here that faces it.
    pub(crate) light: Vec3,
}

impl LightSource {
    pub(crate) fn new(source: &Source) -> Self {
        match *source {
            Source::Sun { to_light, irradiance, radius } => {
                Self { kind: SourceKind::Sun, place: to_light, radius, light: irradiance * FRAC_1_PI }
            }
            Source::Point { position, intensity, radius } => {
                Self { kind: SourceKind::Point, place: position, radius, light: intensity * FRAC_1_PI }
            }
            Source::Lamp { position, irradiance, radius } => {
                Self { kind: SourceKind::Lamp, place: position, radius, light: irradiance * FRAC_1_PI }
            }
        }
    }

    /// The light that arrives at a place from the point of the source that `square` picks; `None` in the source's own
    /// middle, and where it is too far away for numbers.
    pub(crate) fn towards(&self, place: Vec3, square: Vec2) -> Option<Incoming> {
        let is_sun = self.kind == SourceKind::Sun;
        let to_middle = if is_sun { self.place } else { self.place - place };
        let square_to_middle = to_middle.dot(to_middle);
        if !(square_to_middle > 1e-30 && square_to_middle < 1e30) {
            return None;
        }
        let (a, b) = frame(to_middle / square_to_middle.sqrt());
        let offset = disc(square) * self.radius;
        let way = sum_of_three(to_middle, a, b, Vec3::new(1.0, offset.x, offset.y));
        let to_light = unit(way);
        if is_sun {
            return Some(Incoming { to_light, distance: f32::INFINITY, light: self.light });
        }
        let square_of_way = way.dot(way);
        let light = if self.kind == SourceKind::Point { self.light / square_of_way } else { self.light };
        // Within a hair of a lamp there would be no end to its light.
        Some(Incoming { to_light, distance: square_of_way.sqrt(), light: light.min(Vec3::splat(1e12)) })
    }

    /// The words: see [`crate::light`].
    pub(crate) fn words(&self) -> [u32; SOURCE_WORDS] {
        let kind = match self.kind {
            SourceKind::Sun => 0,
            SourceKind::Point => 1,
            SourceKind::Lamp => 2,
        };
        let [x, y, z] = self.place.to_array().map(f32::to_bits);
        let [red, green, blue] = self.light.to_array().map(f32::to_bits);
        [kind, x, y, z, self.radius.to_bits(), red, green, blue]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    const MIDDLE: Vec2 = Vec2::splat(0.5);

    #[test]
    fn light_is_that_of_the_sources_it_is_made_from() {
        let sources = [
            Source::Sun { to_light: Vec3::new(0.6, 0.0, 0.8), irradiance: Vec3::splat(2.0), radius: 0.02 },
            Source::Point { position: Vec3::new(1.0, 5.0, 2.0), intensity: Vec3::splat(30.0), radius: 0.1 },
            Source::Lamp { position: Vec3::new(-4.0, 1.0, 0.0), irradiance: Vec3::splat(0.5), radius: 0.3 },
        ];
        for source in sources {
            for square in [MIDDLE, Vec2::new(0.9, 0.1), Vec2::new(0.2, 0.7)] {
                let place = Vec3::new(0.3, -0.2, 0.1);
                let old = source.towards(place, square).unwrap();
                let new = LightSource::new(&source).towards(place, square).unwrap();
                assert!(new.to_light.distance(old.to_light) < 1e-6);
                assert!(new.distance == old.distance || (new.distance - old.distance).abs() < 1e-5);
                assert!((new.light * PI).distance(old.irradiance) < 1e-5 * old.irradiance.x);
            }
        }
    }

    #[test]
    fn what_is_no_way_gives_no_light() {
        let lamp = LightSource { kind: SourceKind::Point, place: Vec3::ONE, radius: 0.0, light: Vec3::ONE };
        assert_eq!(lamp.towards(Vec3::ONE, MIDDLE), None);
        assert_eq!(lamp.towards(Vec3::splat(1e30), MIDDLE), None);
        assert_eq!(lamp.towards(Vec3::NAN, MIDDLE), None);
        let near = lamp.towards(Vec3::ONE + Vec3::X * 1e-6, MIDDLE).unwrap();
        assert!(near.light.is_finite());
    }
}
