//! What a render gives back.

use crate::film::Film;
use crate::image_file::{self, ImageFormat};
use crate::metadata::Metadata;
use crate::sampling;
use crate::statistics::Statistics;
use crate::tone;
use crate::{ImageError, View};
use glam::Vec3;
use rayon::prelude::*;
use ropewalk_scene::Camera;
use std::path::Path;

/// A rendered picture, still linear, and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The pixels.
    pub film: Film,
    /// What it shows.
    pub view: View,
    /// Stops of exposure, applied when bytes are made.
    pub exposure: f32,
    /// The camera that was used.
    pub camera: Camera,
    /// What the ends of the scale mean, for [`View::Depth`] and [`View::Visits`].
    pub legend: Option<Legend>,
    /// What was done.
    pub statistics: Statistics,
    /// Whole rows that are finished, from the top.
    pub finished_rows: u32,
    /// Whether the render was stopped before its last row.
    pub partial: bool,
    /// What a user may want to know, such as that there was nothing to see.
    pub notes: Vec<String>,
}

/// What the ends of a scale mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Legend {
    /// The value at the low end: brightest for depth, darkest for visits.
    pub low: f32,
    /// The value at the high end.
    pub high: f32,
    /// What is counted.
    pub unit: &'static str,
}

impl Picture {
    /// The picture as bytes, three a pixel, sRGB. Light is exposed, gets a shoulder, and is dithered by less than
    /// one step so that soft gradients show no bands; data is shown as it is.
    #[must_use]
    pub fn to_srgb8(&self) -> Vec<u8> {
        self.film.to_srgb8(self.view, self.exposure)
    }

    /// Writes a PNG or an EXR, as the name's ending says; an EXR holds linear light without exposure.
    ///
    /// # Errors
    /// When the ending is unknown or the file cannot be written; then nothing is left under its name.
    pub fn save(&self, path: &Path) -> Result<(), ImageError> {
        self.save_with(path, &Metadata::default())
    }

    /// Writes a file that says something about itself.
    ///
    /// # Errors
    /// As [`Picture::save`].
    pub fn save_with(&self, path: &Path, metadata: &Metadata) -> Result<(), ImageError> {
        match image_file::check(path)? {
            ImageFormat::Png => {
                let (width, height) = (self.film.width, self.film.height);
                image_file::write_png_with(path, width, height, &self.to_srgb8(), metadata)
            }
            ImageFormat::Exr => image_file::write_exr_with(path, &self.film, metadata),
        }
    }
}

impl Film {
    /// The film as bytes, three a pixel, sRGB: see [`Picture::to_srgb8`].
    #[must_use]
    pub fn to_srgb8(&self, view: View, exposure: f32) -> Vec<u8> {
        let width = self.width as usize;
        let mut bytes = vec![0; self.pixels() * 3];
        bytes.par_chunks_exact_mut(3).zip(&self.color).enumerate().with_min_len(4096).for_each(
            |(index, (pixel, &color))| {
                let encoded = if view == View::Shaded {
                    let threshold = sampling::fraction(((index % width) as u32, (index / width) as u32), 0);
                    let shown = tone::filmic(Vec3::from(color), exposure);
                    shown.to_array().map(|component| tone::dither_srgb8(component, threshold))
                } else {
                    color.map(tone::encode_srgb8)
                };
                pixel.copy_from_slice(&encoded);
            },
        );
        bytes
    }
}
