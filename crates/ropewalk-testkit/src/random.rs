//! Random numbers that are the same on every machine and in every version: PCG-XSH-RR 64/32 (O'Neill 2014) for
//! the bits, and arithmetic that IEEE 754 defines (no sine, no logarithm) for everything made of them.

use glam::DVec3;
use rand::Rng;
use rand_pcg::Pcg32;
use ropewalk::Aabb;

/// A seeded source.
#[derive(Clone, Debug)]
pub struct Random(Pcg32);

impl Random {
    /// The source of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(Pcg32::new(seed, 0x726f_7065))
    }

    /// 32 bits.
    pub fn bits(&mut self) -> u32 {
        self.0.next_u32()
    }

    /// Uniform in `[0, 1)`, a multiple of 2^-32.
    pub fn unit(&mut self) -> f64 {
        f64::from(self.bits()) / 4_294_967_296.0
    }

    /// Uniform in `[low, high)`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in `0..end`; 0 when `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        // The product's high half: a bias of end / 2^32, which no test can see.
        ((u64::from(self.bits()) * end as u64) >> 32) as usize
    }

    /// True once in `n` times.
    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    /// One of some values. `choices` must not be empty.
    pub fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// Uniform in the cube `[-1, 1)^3`.
    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0))
    }

    /// Uniform on the unit sphere, by rejection.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let point = self.in_cube();
            let length_squared = point.length_squared();
            if (1e-4..=1.0).contains(&length_squared) {
                return point / length_squared.sqrt();
            }
        }
    }

    /// Uniform in a box grown about its middle by a factor.
    pub fn in_box(&mut self, bounds: &Aabb, factor: f64) -> DVec3 {
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        (low + high) * 0.5 + self.in_cube() * (high - low) * (0.5 * factor)
    }

    /// Puts values into a random order (Fisher and Yates).
    pub fn shuffle<T>(&mut self, values: &mut [T]) {
        for end in (2..=values.len()).rev() {
            values.swap(end - 1, self.below(end));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers are part of the tests' meaning: a count in a test stands for these very rays.
    #[test]
    fn the_bits_never_change() {
        let mut random = Random::new(1);
        let bits: Vec<u32> = (0..4).map(|_| random.bits()).collect();
        assert_eq!(bits, EXPECTED, "{bits:#x?}");
    }
    const EXPECTED: [u32; 4] = [0xee73_cd99, 0x4b5b_e96a, 0xfa1b_f8cd, 0x53ef_e774];

    #[test]
    fn everything_stays_in_its_range() {
        let mut random = Random::new(2);
        let mut seen = [false; 5];
        for _ in 0..1000 {
            assert!((0.0..1.0).contains(&random.unit()));
            assert!((random.direction().length() - 1.0).abs() < 1e-12);
            seen[random.below(5)] = true;
        }
        assert_eq!(seen, [true; 5]);
        assert_eq!(random.below(0), 0);
        let mut order: Vec<u32> = (0..100).collect();
        random.shuffle(&mut order);
        assert_ne!(order, (0..100).collect::<Vec<_>>());
        order.sort_unstable();
        assert_eq!(order, (0..100).collect::<Vec<_>>());
    }
}
