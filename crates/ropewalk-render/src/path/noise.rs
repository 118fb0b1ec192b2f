//! How noisy a picture is, from the samples themselves.
//!
//! The error of a pixel is the standard error of its mean: the root of the variance of its samples over their number.
//! Samples are spread more evenly than by chance, so the true error is smaller; and edges within a pixel count as noise,
//! although they are what the samples are there to draw. It is an upper bound that falls with the samples as the
//! error does.

use glam::Vec3;
use std::fmt;

/// How noisy the pixels of a picture are. Brightness is the mean of the three colours, linear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Pixels with at least two samples.
    pub pixels: u64,
    /// The sum of their standard errors.
    pub sum: f64,
    /// The largest standard error.
    pub largest: f32,
    /// The column and the row of the pixel that has it.
    pub noisiest: (u32, u32),
}

impl Noise {
    /// Counts a pixel's samples.
    pub(crate) fn add(&mut self, pixel: (u32, u32), samples: &[Vec3]) {
        if samples.len() < 2 {
            return;
        }
        let brightness = |sample: &Vec3| f64::from(sample.x + sample.y + sample.z) / 3.0;
        let values = || samples.iter().filter(|sample| sample.is_finite()).map(brightness);
        let count = samples.len() as f64;
        let mean = values().sum::<f64>() / count;
        let squares: f64 = values().map(|value| (value - mean).powi(2)).sum();
        let error = (squares / ((count - 1.0) * count)).sqrt();
        self.pixels += 1;
        self.sum += error;
        if error as f32 > self.largest {
            self.largest = error as f32;
            self.noisiest = pixel;
        }
    }

    /// The mean standard error; 0 without pixels.
    #[must_use]
    pub fn mean(&self) -> f64 {
        if self.pixels == 0 { 0.0 } else { self.sum / self.pixels as f64 }
    }
}

impl fmt::Display for Noise {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = self.noisiest;
        write!(
            formatter,
            "mean standard error {:.5}, noisiest pixel {x},{y} with {:.4}",
            self.mean(),
            self.largest
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_that_of_the_mean() {
        let mut noise = Noise::default();
        noise.add((0, 0), &[Vec3::ONE; 4]);
        assert_eq!((noise.pixels, noise.largest, noise.mean()), (1, 0.0, 0.0));
        noise.add((3, 4), &[Vec3::ZERO, Vec3::splat(2.0), Vec3::ZERO, Vec3::splat(2.0)]);
        // The variance of the four is 4 / 3.
        assert!((noise.largest - (1.0_f32 / 3.0).sqrt()).abs() < 1e-6);
        assert_eq!(noise.noisiest, (3, 4));
        noise.add((5, 5), &[Vec3::ONE]);
        assert_eq!(noise.pixels, 2, "one sample says nothing");
        assert!(noise.to_string().contains("noisiest pixel 3,4"), "{noise}");
    }
}
