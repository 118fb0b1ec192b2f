//! The paper's Figure 9: a picture of how many objects' structures the ray of each pixel enters.

use serde::Serialize;

/// The colour of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Band {
    /// The pixel has no such ray: what it sees is nothing, or turned away from the light.
    None,
    /// Up to three structures, also none.
    Blue,
    /// Up to six.
    Green,
    /// Up to nine.
    Red,
    /// More.
    White,
}

impl Band {
    /// Every band, in the order of their numbers.
    pub const EVERY: [Self; 5] = [Self::None, Self::Blue, Self::Green, Self::Red, Self::White];

    /// The band of a ray that enters so many structures.
    #[must_use]
    pub const fn of(entered: u32) -> Self {
        match entered {
            0..=3 => Self::Blue,
            4..=6 => Self::Green,
            7..=9 => Self::Red,
            _ => Self::White,
        }
    }

    /// The colour, as sRGB bytes. The paper says the hues; pixels without a ray are black.
    #[must_use]
    pub const fn srgb(self) -> [u8; 3] {
        match self {
            Self::None => [0, 0, 0],
            Self::Blue => [40, 70, 200],
            Self::Green => [40, 170, 60],
            Self::Red => [215, 45, 40],
            Self::White => [255, 255, 255],
        }
    }
}

/// A picture, and how many pixels have each colour.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeatMap {
    /// The scene's file or name.
    pub scene: String,
    /// The class of the rays.
    pub rays: &'static str,
    /// What the objects have.
    pub bottom: String,
    /// Whether objects are in their oriented boxes.
    pub oriented_boxes: bool,
    /// Pixels a side.
    pub side: usize,
    /// Pixels without such a ray.
    pub none: usize,
    /// Pixels whose ray enters three structures at most.
    pub blue: usize,
    /// Four to six.
    pub green: usize,
    /// Seven to nine.
    pub red: usize,
    /// More.
    pub white: usize,
    /// Row by row.
    #[serde(skip)]
    bands: Vec<Band>,
}

impl HeatMap {
    /// From the pixel of each ray and the structures that it enters. Pixels that are none of the picture's are left out.
    #[must_use]
    pub fn new(
        (scene, rays, bottom): (&str, &'static str, String),
        oriented_boxes: bool,
        side: usize,
        pixels: &[u32],
        entered: &[u32],
    ) -> Self {
        let mut bands = vec![Band::None; side * side];
        for (&pixel, &entered) in pixels.iter().zip(entered) {
            if let Some(band) = bands.get_mut(pixel as usize) {
                *band = Band::of(entered);
            }
        }
        let [none, blue, green, red, white] =
            Band::EVERY.map(|band| bands.iter().filter(|&&other| other == band).count());
        Self { scene: scene.into(), rays, bottom, oriented_boxes, side, none, blue, green, red, white, bands }
    }

    /// The pixels of each band, in the order of [`Band::EVERY`]; their sum is the number of pixels.
    #[must_use]
    pub fn histogram(&self) -> [usize; 5] {
        [self.none, self.blue, self.green, self.red, self.white]
    }

    /// What part of the pixels that have a ray is blue, green, red and white, in percent; zeros where none has one.
    #[must_use]
    pub fn shares(&self) -> [f64; 4] {
        let [_, colored @ ..] = self.histogram();
        let all: usize = colored.iter().sum();
        colored.map(|count| 100.0 * count as f64 / all.max(1) as f64)
    }

    /// The picture, three bytes a pixel, sRGB, row by row.
    #[must_use]
    pub fn to_srgb8(&self) -> Vec<u8> {
        self.bands.iter().flat_map(|band| band.srgb()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_histogram_sums_to_the_pixels() {
        let pixels: Vec<u32> = (0..14).chain([400]).collect();
        let entered: Vec<u32> = (0..15).collect();
        let map = HeatMap::new(("room", "shadow", "kd-tree".into()), true, 4, &pixels, &entered);
        assert_eq!(map.histogram(), [2, 4, 3, 3, 4]);
        assert_eq!(map.histogram().iter().sum::<usize>(), 16);
        assert!((map.shares().iter().sum::<f64>() - 100.0).abs() < 1e-9);
        assert!((map.shares()[0] - 400.0 / 14.0).abs() < 1e-9);
        let bytes = map.to_srgb8();
        assert_eq!(bytes.len(), 4 * 4 * 3);
        assert_eq!(bytes[3 * 3..][..3], Band::Blue.srgb());
        assert_eq!(bytes[3 * 4..][..3], Band::Green.srgb());
        assert_eq!(bytes[3 * 9..][..3], Band::Red.srgb());
        assert_eq!(bytes[3 * 10..][..3], Band::White.srgb());
        assert_eq!(bytes[3 * 15..], [0, 0, 0]);
        let json = serde_json::to_value(&map).unwrap();
        assert_eq!((&json["blue"], &json["white"]), (&4.into(), &4.into()));
        let none = HeatMap::new(("void", "shadow", "kd-tree".into()), false, 2, &[], &[]);
        assert_eq!((none.histogram(), none.shares()), ([4, 0, 0, 0, 0], [0.0; 4]));
    }
}
