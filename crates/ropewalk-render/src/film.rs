//! The film: what each pixel has gathered, linear, 20 bytes a pixel (24 with visits, 36 more with layers).

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
    /// What the surfaces are, whatever the light; `None` when it was not asked for.
    pub layers: Option<Layers>,
}

/// What surfaces are, a plane each.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// The mean base colour; black where nothing was hit.
    pub albedo: Vec<[f32; 3]>,
    /// The mean shading normal, in the scene's space, turned to the eye; zero where nothing was hit.
    pub normal: Vec<[f32; 3]>,
    /// Instance, geometry and primitive of the first sample that hit something; else [`Layers::NOBODY`].
    pub ids: Vec<[u32; 3]>,
}

impl Layers {
    /// The indices where nothing was hit.
    pub const NOBODY: [u32; 3] = [u32::MAX; 3];
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
            layers: None,
        })
    }

    /// The same film with layers.
    ///
    /// # Errors
    /// When there is not enough memory for them.
    pub fn with_layers(mut self) -> Result<Self, RenderError> {
        let (width, height, pixels) = (self.width, self.height, self.pixels());
        let memory = |_| RenderError::Memory { width, height, bytes: pixels as u64 * 60 };
        self.layers = Some(Layers {
            albedo: filled(pixels, [0.0; 3]).map_err(memory)?,
            normal: filled(pixels, [0.0; 3]).map_err(memory)?,
            ids: filled(pixels, Layers::NOBODY).map_err(memory)?,
        });
        Ok(self)
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
