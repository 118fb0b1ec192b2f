//! The light that bounces between microfacets (Kulla and Conty 2017), for paths.
//!
//! GGX as it stands counts light that meets one facet. Light that meets a second one is lost: up to 60 percent on the
//! roughest metal. How much is sent on is measured here once, in a table over roughness and angle, and what is missing
//! comes back as light that is scattered nearly evenly. Trees of rays go without: their kernel has no such table, and
//! rough metal in them is darker by what is lost.
//!
//! **Cost.** 16 roughnesses, 32 cosines, 256 samples each: 131,072 evaluations, a few milliseconds a picture.

use super::lobes;
use crate::sampling::{self, Purpose};
use glam::Vec3;

const ROUGHNESSES: usize = 16;
const COSINES: usize = 32;
const SAMPLES: u32 = 256;

/// The share of light that GGX facets send on at once which mirror everything.
#[derive(Clone, Debug)]
pub(crate) struct Energy {
    /// By roughness, then by cosine.
    shares: Vec<[f32; COSINES]>,
    /// Their means over the hemisphere, weighed with the cosine.
    means: [f32; ROUGHNESSES],
}

impl Energy {
    pub(crate) fn new() -> Self {
        let mut means = [0.0; ROUGHNESSES];
        let shares = (0..ROUGHNESSES).map(|row| {
            let roughness = (row as f32 / (ROUGHNESSES - 1) as f32).max(lobes::SMOOTHEST);
            std::array::from_fn(|column| {
                // Not quite grazing, where there would be nothing to see.
                let cos = (column as f32 / (COSINES - 1) as f32).max(1e-3);
                measured(roughness, cos)
            })
        });
        let shares: Vec<[f32; COSINES]> = shares.collect();
        for (mean, row) in means.iter_mut().zip(&shares) {
            let step = 1.0 / (COSINES - 1) as f32;
            let at = |column: usize| row[column] * (column as f32 * step) * 2.0 * step;
            // By trapezes; the first one's lower side is zero.
            *mean = (1..COSINES).map(at).sum::<f32>() - 0.5 * at(COSINES - 1);
        }
        Self { shares, means }
    }

    /// The share that is sent on at a cosine.
    pub(crate) fn share(&self, roughness: f32, cos: f32) -> f32 {
        let (row, down) = place(roughness, ROUGHNESSES);
        let (column, along) = place(cos, COSINES);
        let value = |row: usize, column: usize| {
            self.shares.get(row).and_then(|row| row.get(column)).copied().unwrap_or(1.0)
        };
        let of_row = |row: usize| value(row, column) * (1.0 - along) + value(row, column + 1) * along;
        (of_row(row) * (1.0 - down) + of_row(row + 1) * down).min(1.0)
    }

    /// The mean share.
    pub(crate) fn mean(&self, roughness: f32) -> f32 {
        let (row, down) = place(roughness, ROUGHNESSES);
        let value = |row: usize| self.means.get(row).copied().unwrap_or(1.0);
        (value(row) * (1.0 - down) + value(row + 1) * down).min(1.0)
    }

    /// What bounces between facets, as the radiance of a surface for light that makes a white matt one shine with one;
    /// the cosine is not in it. `fresnel` is the mean that a facet mirrors.
    pub(crate) fn between_facets(&self, roughness: f32, fresnel: Vec3, cos_eye: f32, cos_light: f32) -> Vec3 {
        let mean = self.mean(roughness);
        let missing = 1.0 - mean;
        if missing < 1e-4 {
            return Vec3::ZERO;
        }
        let tint = fresnel * fresnel * mean / (Vec3::ONE - fresnel * missing);
        let eye = 1.0 - self.share(roughness, cos_eye);
        let light = 1.0 - self.share(roughness, cos_light);
        tint * (eye * light / missing)
    }
}

/// The row below a value from 0 to 1 in a table of so many, and how far it is to the next.
fn place(value: f32, rows: usize) -> (usize, f32) {
    let at = value.clamp(0.0, 1.0) * (rows - 1) as f32;
    let row = (at as usize).min(rows - 2);
    (row, at - row as f32)
}

fn measured(roughness: f32, cos: f32) -> f32 {
    let to_eye = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    for index in 0..SAMPLES {
        let square = sampling::point(Purpose::Sky, (0, 0), index, SAMPLES);
        let to_light = lobes::from_facet(roughness, Vec3::Z, to_eye, square);
        let chance = lobes::facet_chance(roughness, Vec3::Z, to_eye, to_light);
        if to_light.z > 0.0 && chance > 0.0 {
            sum += lobes::facets(roughness, Vec3::Z, to_eye, to_light) * to_light.z / chance;
        }
    }
    sum / SAMPLES as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_facets_send_on_all_and_rough_ones_lose_light() {
        let energy = Energy::new();
        assert!(energy.share(0.1, 1.0) > 0.99 && energy.share(1.0, 1.0) < 0.6);
        for row in 0..=20 {
            let roughness = row as f32 / 20.0;
            for column in 0..=20 {
                let share = energy.share(roughness, column as f32 / 20.0);
                assert!((0.2..=1.0).contains(&share), "{share} at {roughness}, {column}");
            }
            assert!(energy.mean(roughness) <= 1.0 && energy.mean(roughness) > 0.4);
        }
    }
}
