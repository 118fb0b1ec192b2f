//! What a picture shows.

use crate::error::RenderError;
use crate::film::Film;
use crate::picture::Legend;
use crate::ramp;
use crate::ramp::oklab_to_linear;
use glam::Vec3;
use ropewalk::Hit;
use std::fmt;
use std::str::FromStr;

/// What a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum View {
    /// Light and shadow.
    #[default]
    Shaded,
    /// Shading normals in the scene's space, turned to the eye, as colours: x, y, z as red, green, blue.
    Normals,
    /// The distance along the view, near is bright, in even steps of one over the distance.
    Depth,
    /// A hue for each instance and geometry, a shade for each triangle; the same every time.
    Ids,
    /// A heat map of what the walk did for the primary rays: inner visits and primitive tests.
    Visits,
}

impl View {
    /// Every view.
    pub const EVERY: [Self; 5] = [Self::Shaded, Self::Normals, Self::Depth, Self::Ids, Self::Visits];

    /// The name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Shaded => "shaded",
            Self::Normals => "normals",
            Self::Depth => "depth",
            Self::Ids => "ids",
            Self::Visits => "visits",
        }
    }
}

impl fmt::Display for View {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for View {
    type Err = RenderError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::EVERY.into_iter().find(|view| view.name() == text).ok_or_else(|| {
            let names = Self::EVERY.map(Self::name).join(", ");
            RenderError::Word(format!("there is no view '{text}'; the views are {names}"))
        })
    }
}

/// The colour behind everything in views that show data.
pub(crate) const DATA_BACKGROUND: Vec3 = Vec3::splat(0.015);

/// A normal as a colour whose bytes, not whose light, are linear in the components, as everyone draws them.
pub(crate) fn normal_color(normal: Vec3) -> Vec3 {
    let linear = |component: f32| crate::decode_srgb(f64::from(component * 0.5 + 0.5)) as f32;
    Vec3::new(linear(normal.x), linear(normal.y), linear(normal.z))
}

/// The colour of who was hit.
pub(crate) fn id_color(hit: &Hit) -> Vec3 {
    // Neighbouring instances get hues a golden angle apart; the hash is for geometries and triangles.
    let turn = hit.instance_index.wrapping_mul(0x9e37_79b9).wrapping_add(hash(hit.geometry_index));
    let shade = (hash(hit.primitive_index) >> 8) as f32 / 16_777_216.0;
    let lightness = 0.56 + 0.26 * shade;
    let (sin, cos) = (f64::from(turn) / 4_294_967_296.0 * std::f64::consts::TAU).sin_cos();
    let chroma = 0.12;
    let lab = Vec3::new(lightness, chroma * cos as f32, chroma * sin as f32);
    oklab_to_linear(lab).clamp(Vec3::ZERO, Vec3::ONE)
}

/// Mixes the bits of a word; 0 stays 0.
const fn hash(word: u32) -> u32 {
    let word = (word ^ word >> 16).wrapping_mul(0x7feb_352d);
    let word = (word ^ word >> 15).wrapping_mul(0x846c_a68b);
    word ^ word >> 16
}

/// Turns measured values into colours once the whole picture is known, for the views that need it.
pub(crate) fn colorize(view: View, film: &mut Film) -> Option<Legend> {
    match view {
        View::Depth => Some(colorize_depth(film)),
        View::Visits => Some(colorize_visits(film)),
        View::Shaded | View::Normals | View::Ids => None,
    }
}

fn colorize_depth(film: &mut Film) -> Legend {
    let (mut near, mut far) = (f32::INFINITY, 0.0_f32);
    for &depth in film.depth.iter().filter(|depth| depth.is_finite()) {
        near = near.min(depth);
        far = far.max(depth);
    }
    if near > far {
        return Legend { low: 0.0, high: 0.0, unit: "units of the scene from the eye" };
    }
    // Even steps of 1 / depth, as on the picture plane: a far ground does not flatten what is near.
    let inverse = |depth: f32| 1.0 / f64::from(depth).max(1e-300);
    let range = (inverse(near) - inverse(far)).max(f64::MIN_POSITIVE);
    for ((color, &depth), &coverage) in film.color.iter_mut().zip(&film.depth).zip(&film.coverage) {
        if depth.is_finite() {
            // Bytes from 50 to 250: the farthest thing still stands out from the background.
            let shade = 0.20 + 0.78 * ((inverse(depth) - inverse(far)) / range).clamp(0.0, 1.0);
            let grey = Vec3::splat(crate::decode_srgb(shade) as f32);
            *color = DATA_BACKGROUND.lerp(grey, coverage).to_array();
        }
    }
    Legend { low: near, high: far, unit: "units of the scene from the eye" }
}

fn colorize_visits(film: &mut Film) -> Legend {
    let mut sorted: Vec<f32> = film.visits.clone();
    // The top of the ramp is the value that one pixel in a thousand exceeds: a few hot pixels must not turn
    // everything else dark.
    let rank = sorted.len().saturating_sub(1 + sorted.len() / 1000);
    let high = if sorted.is_empty() { 0.0 } else { *sorted.select_nth_unstable_by(rank, f32::total_cmp).1 };
    for (color, &visits) in film.color.iter_mut().zip(&film.visits) {
        *color = ramp::color(visits / high.max(1.0)).to_array();
    }
    Legend { low: 0.0, high: high.max(1.0), unit: "inner visits + primitive tests a primary ray" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for view in View::EVERY {
            assert_eq!(view.to_string().parse::<View>().unwrap(), view);
        }
        let error = "shiny".parse::<View>().unwrap_err().to_string();
        assert!(error.contains("shaded, normals, depth, ids, visits"), "{error}");
    }

    #[test]
    fn neighbours_have_distinct_colours() {
        let hit = Hit { t: 1.0, primitive_index: 0, geometry_index: 0, instance_index: 0, ..Hit::MISS };
        let all = [
            hit,
            Hit { instance_index: 1, ..hit },
            Hit { geometry_index: 1, ..hit },
            Hit { primitive_index: 1, ..hit },
            Hit { primitive_index: 2, ..hit },
        ];
        for (i, a) in all.iter().enumerate() {
            for b in &all[..i] {
                assert!(id_color(a).distance(id_color(b)) > 0.02, "{a:?} and {b:?}");
            }
        }
    }

    #[test]
    fn near_is_bright_and_hot_pixels_do_not_darken_the_map() {
        let mut film = Film::new(4, 500, true).unwrap();
        film.depth[0] = 2.0;
        film.depth[1] = 4.0;
        film.coverage[0] = 1.0;
        film.coverage[1] = 1.0;
        let legend = colorize(View::Depth, &mut film).unwrap();
        assert_eq!((legend.low, legend.high), (2.0, 4.0));
        assert!(film.color[0][0] > film.color[1][0] && film.color[1][0] > DATA_BACKGROUND.x);
        film.visits.fill(10.0);
        film.visits[7] = 1e6;
        let legend = colorize(View::Visits, &mut film).unwrap();
        assert_eq!(legend.high, 10.0);
        assert_eq!(film.color[0], film.color[7]);
    }

    #[test]
    fn an_empty_picture_has_a_legend_too() {
        let mut film = Film::new(2, 2, true).unwrap();
        for view in [View::Depth, View::Visits] {
            let legend = colorize(view, &mut film).unwrap();
            assert!(legend.low.is_finite() && legend.high.is_finite());
        }
    }
}
