//! The film: what each pixel has gathered, linear, 20 bytes a pixel (24 with visits).

use crate::error::RenderError;

/// Planes of the picture, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear red, green and blue.
    pub color: Vec<[f32; 3]>,
    /// The share of the pixel's samples that hit something.
    pub coverage: Vec<f32>,
    /// The smallest depth of the pixel's samples, along the view; infinite where nothing was hit.
    pub depth: Vec<f32>,
    /// The mean of inner visits and primitive tests of the pixel's primary rays; empty when they were not counted.
    pub visits: Vec<f32>,
}

impl Film {
    /// A film on which nothing was seen.
    ///
    /// # Errors
    /// When there is not enough memory for it.
    pub fn new(width: u32, height: u32, visits: bool) -> Result<Self, RenderError> {
        let pixels = width as usize * height as usize;
        let bytes = pixels as u64 * if visits { 24 } else { 20 };
        let memory = |_| RenderError::Memory { width, height, bytes };
        Ok(Self {
            width,
            height,
            color: filled(pixels, [0.0; 3]).map_err(memory)?,
            coverage: filled(pixels, 0.0).map_err(memory)?,
            depth: filled(pixels, f32::INFINITY).map_err(memory)?,
            visits: filled(if visits { pixels } else { 0 }, 0.0).map_err(memory)?,
        })
    }

    /// The number of pixels.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.color.len()
    }
}

fn filled<T: Copy>(count: usize, value: T) -> Result<Vec<T>, std::collections::TryReserveError> {
    let mut plane = Vec::new();
    plane.try_reserve_exact(count)?;
    plane.resize(count, value);
    Ok(plane)
}
