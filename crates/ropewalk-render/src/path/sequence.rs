//! The numbers that paths are made of: a low-discrepancy sequence in two dimensions for each decision, scrambled.
//!
//! Each pair of dimensions is Sobol's (0, 2)-sequence: of any `2^k` samples in a row from a multiple of `2^k` on, one
//! lies in each box of a grid of `2^k` boxes of any shape. It is scrambled by hashing after Owen (Burley 2020,
//! with Vegdahl's constants), each pixel and each decision with its own seed, and the samples are shuffled in the same
//! way, so that decisions are independent of each other while each by itself stays even. Whole numbers alone: the same
//! on every machine.

use crate::sampling::{frame, unit};
use glam::{Vec2, Vec3};

/// The samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sequence {
    seed: u32,
    index: u32,
}

impl Sequence {
    /// Sample number `index` of a pixel.
    pub(crate) fn new(pixel: (u32, u32), index: u32) -> Self {
        Self { seed: hashed(hashed(pixel.0).wrapping_add(pixel.1)), index }
    }

    /// The point of the unit square for a decision.
    pub(crate) fn square(&self, decision: u32) -> Vec2 {
        let seed = hashed(self.seed ^ hashed(decision.wrapping_add(0x9e37_79b9)));
        let index = scrambled(self.index.reverse_bits(), seed).reverse_bits();
        let [x, y] = sobol(index);
        Vec2::new(
            unit(scrambled_fraction(x, hashed(seed ^ 1))),
            unit(scrambled_fraction(y, hashed(seed ^ 2))),
        )
    }

    /// A number from 0 to 1, below 1, for a decision.
    pub(crate) fn number(&self, decision: u32) -> f32 {
        self.square(decision).x
    }
}

/// Wellons's hash of a word.
fn hashed(word: u32) -> u32 {
    let word = (word ^ word >> 16).wrapping_mul(0x7feb_352d);
    let word = (word ^ word >> 15).wrapping_mul(0x846c_a68b);
    word ^ word >> 16
}

/// Point number `index` of Sobol's sequence in its first two dimensions, as fractions of 2^32.
fn sobol(index: u32) -> [u32; 2] {
    let mut second = 0;
    // The second dimension's directions are Pascal's triangle, modulo two.
    let (mut direction, mut rest) = (1_u32 << 31, index);
    while rest != 0 {
        if rest & 1 != 0 {
            second ^= direction;
        }
        direction ^= direction >> 1;
        rest >>= 1;
    }
    [index.reverse_bits(), second]
}

/// Changes each bit by a hash of the seed and of the bits below it.
fn scrambled(word: u32, seed: u32) -> u32 {
    let mut word = word ^ word.wrapping_mul(0x3d20_adea);
    word = word.wrapping_add(seed);
    word = word.wrapping_mul((seed >> 16) | 1);
    word ^= word.wrapping_mul(0x0552_6c56);
    word ^ word.wrapping_mul(0x53a2_2864)
}

/// Owen's scrambling of a fraction of 2^32: each bit is changed by what stands before it.
fn scrambled_fraction(fraction: u32, seed: u32) -> u32 {
    scrambled(fraction.reverse_bits(), seed).reverse_bits()
}

/// The point on the unit circle a given turn along: from polynomials that are right to the last bits, unlike those of
/// [`crate::sampling`], since here light would be lost.
pub(crate) fn circle(turn: f32) -> Vec2 {
    let quarters = turn * 4.0;
    let quarter = quarters.floor();
    let angle = (quarters - quarter - 0.5) * std::f32::consts::FRAC_PI_2;
    let square = angle * angle;
    let cos =
        1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0 - square * (1.0 / 40_320.0))));
    let sin = angle
        * (1.0
            - square
                * (1.0 / 6.0
                    - square * (1.0 / 120.0 - square * (1.0 / 5040.0 - square * (1.0 / 362_880.0)))));
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let (x, y) = ((cos - sin) * half, (cos + sin) * half);
    match quarter as i32 & 3 {
        0 => Vec2::new(x, y),
        1 => Vec2::new(-y, x),
        2 => Vec2::new(-x, -y),
        _ => Vec2::new(y, -x),
    }
}

/// A direction of the hemisphere around `normal`, more often near it, as the cosine weighs.
pub(crate) fn cosine_direction(normal: Vec3, square: Vec2) -> Vec3 {
    let disc = circle(square.y) * square.x.sqrt();
    let (tangent, bitangent) = frame(normal);
    tangent * disc.x + bitangent * disc.y + normal * (1.0 - square.x).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many boxes of a grid are empty of `count` samples.
    fn empty_boxes(squares: &[Vec2], columns: u32, rows: u32) -> usize {
        let mut filled = vec![false; (columns * rows) as usize];
        for square in squares {
            let (x, y) = ((square.x * columns as f32) as u32, (square.y * rows as f32) as u32);
            filled[(y * columns + x) as usize] = true;
        }
        filled.iter().filter(|&&is_filled| !is_filled).count()
    }

    #[test]
    fn every_box_of_every_grid_has_its_sample() {
        for pixel in [(0, 0), (17, 4), (1000, 999)] {
            for decision in 0..6 {
                let squares: Vec<Vec2> =
                    (0..64).map(|index| Sequence::new(pixel, index).square(decision)).collect();
                for (columns, rows) in [(64, 1), (32, 2), (16, 4), (8, 8), (4, 16), (2, 32), (1, 64)] {
                    assert_eq!(empty_boxes(&squares, columns, rows), 0, "{pixel:?} {decision} {columns}");
                }
            }
        }
        // The test can tell: a plain hash leaves a third of the boxes empty.
        let squares: Vec<Vec2> =
            (0..64).map(|index| Vec2::new(unit(hashed(index)), unit(hashed(index + 99)))).collect();
        assert!(empty_boxes(&squares, 8, 8) > 10);
    }

    #[test]
    fn numbers_lie_in_their_range_and_have_the_mean_of_a_half() {
        let mut sum = Vec2::ZERO;
        for x in 0..32 {
            for y in 0..32 {
                let square = Sequence::new((x, y), 3).square(5);
                assert!(square.min_element() >= 0.0 && square.max_element() < 1.0);
                sum += square / 1024.0;
            }
        }
        assert!(sum.distance(Vec2::splat(0.5)) < 0.03, "{sum}");
    }

    #[test]
    fn decisions_do_not_depend_on_each_other() {
        // The mean of the product of two independent numbers is the product of their means.
        let mut products = [0.0; 4];
        for pixel in 0..64 {
            for index in 0..64 {
                let sequence = Sequence::new((pixel, 7), index);
                let (a, b) = (sequence.square(0), sequence.square(1));
                for (sum, product) in products.iter_mut().zip([a.x * a.y, a.x * b.x, a.y * b.x, a.x * b.y]) {
                    *sum += product / 4096.0;
                }
            }
        }
        assert!(products.iter().all(|product| (product - 0.25).abs() < 0.01), "{products:?}");
    }

    #[test]
    fn a_mean_of_n_samples_beats_chance() {
        // The share of the square below a curve, whose error falls with 1 / n and not with its root.
        let error = |count: u32| {
            let mut sum = 0.0;
            for pixel in 0..64 {
                let below = |index: &u32| {
                    let square = Sequence::new((pixel, 0), *index).square(0);
                    square.y < square.x * square.x
                };
                let share = (0..count).filter(below).count() as f64 / f64::from(count);
                sum += (share - 1.0 / 3.0).powi(2) / 64.0;
            }
            sum.sqrt()
        };
        let (few, many) = (error(64), error(256));
        assert!(few < 0.6 * (2.0 / 9.0 / 64.0_f64).sqrt(), "{few}");
        assert!(many < 0.5 * few, "{few} and {many}");
    }

    #[test]
    fn directions_have_length_one() {
        for step in 0..1000 {
            let turn = step as f32 / 1000.0;
            let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
            assert!(circle(turn).distance(Vec2::new(cos, sin)) < 1e-6, "{turn}");
            let direction = cosine_direction(Vec3::new(0.6, 0.0, -0.8), Vec2::new(turn, 1.0 - turn));
            assert!((direction.length() - 1.0).abs() < 1e-6);
        }
    }
}
