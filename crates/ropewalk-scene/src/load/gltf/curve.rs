//! Curves through keys: what an animation's sampler says for a time.
//!
//! The value holds before the first key and behind the last. Between two keys it steps, runs straight, or bends as the tangents
//! beside the keys say (Hermite's cubic); rotations run straight along the shorter arc (slerp, Shoemake 1985). A look at a
//! curve costs a binary search, since times rise.

use super::accessor::Accessor;
use super::moving_document::{Sampler, SamplerError};
use glam::{DQuat, DVec3};

/// What lies between keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Interpolation {
    Step,
    Linear,
    Cubic,
}

/// Values of `WIDTH` components over time; for cubic curves each with the tangent before and the one behind it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve<const WIDTH: usize> {
    /// Rising, finite, at least one.
    times: Vec<f32>,
    values: Vec<[f32; WIDTH]>,
    interpolation: Interpolation,
}

/// The keys around a time.
enum Around {
    /// On a key, or beyond the ends.
    At(usize),
    /// Between a key and the next: how far along, from 0 to 1, and how many seconds apart they are.
    Between { before: usize, along: f64, seconds: f64 },
}

impl<const WIDTH: usize> Curve<WIDTH> {
    /// Reads the keys of a sampler. The accessors are open: what they hold is within the file.
    pub(super) fn read(
        sampler: &Sampler,
        input: &Accessor<'_, 1>,
        output: &Accessor<'_, WIDTH>,
    ) -> Result<Self, SamplerError> {
        let interpolation = match sampler.interpolation.as_deref() {
            None | Some("LINEAR") => Interpolation::Linear,
            Some("STEP") => Interpolation::Step,
            Some("CUBICSPLINE") => Interpolation::Cubic,
            Some(_) => return Err("with an unknown interpolation"),
        };
        let rows = if interpolation == Interpolation::Cubic { 3 } else { 1 };
        if input.count() == 0 {
            return Err("without keys");
        }
        if output.count() != input.count().saturating_mul(rows) {
            return Err("with another number of values than their times ask for");
        }
        let times: Vec<f32> = (0..input.count()).map(|key| input.vector(key)[0]).collect();
        if !times.iter().all(|time| time.is_finite()) || !times.is_sorted_by(|one, next| one < next) {
            return Err("whose times do not rise, or are no numbers");
        }
        let values: Vec<[f32; WIDTH]> = (0..output.count()).map(|value| output.vector(value)).collect();
        if !values.iter().flatten().all(|component| component.is_finite()) {
            return Err("with values that are no numbers");
        }
        Ok(Self { times, values, interpolation })
    }

    /// The times of the first and the last key.
    pub(super) fn ends(&self) -> (f64, f64) {
        let time = |key: Option<&f32>| key.copied().map_or(0.0, f64::from);
        (time(self.times.first()), time(self.times.last()))
    }

    fn around(&self, time: f64) -> Around {
        let behind = self.times.partition_point(|&key| f64::from(key) <= time);
        let Some(before) = behind.checked_sub(1) else { return Around::At(0) };
        let key = |index: usize| self.times.get(index).copied().map(f64::from);
        match (key(before), key(behind)) {
            (Some(start), Some(end)) => {
                let seconds = end - start;
                Around::Between { before, along: (time - start) / seconds, seconds }
            }
            _ => Around::At(before),
        }
    }

    /// The value of a key, or with `part` 0 and 2 the tangents beside it.
    fn row(&self, key: usize, part: usize) -> [f64; WIDTH] {
        let row = if self.interpolation == Interpolation::Cubic { 3 * key + part } else { key };
        self.values.get(row).map_or([0.0; WIDTH], |value| value.map(f64::from))
    }

    /// The value at a time; `straight` runs from one key to the next.
    fn at(
        &self,
        time: f64,
        straight: impl Fn([f64; WIDTH], [f64; WIDTH], f64) -> [f64; WIDTH],
    ) -> [f64; WIDTH] {
        let (before, u, seconds) = match self.around(time) {
            Around::At(key) => return self.row(key, 1),
            Around::Between { before, along, seconds } => (before, along, seconds),
        };
        let (from, to) = (self.row(before, 1), self.row(before + 1, 1));
        match self.interpolation {
            Interpolation::Step => from,
            Interpolation::Linear => straight(from, to, u),
            Interpolation::Cubic => {
                let (out, into) = (self.row(before, 2), self.row(before + 1, 0));
                let (square, cube) = (u * u, u * u * u);
                std::array::from_fn(|part| {
                    from[part] * (2.0 * cube - 3.0 * square + 1.0)
                        + to[part] * (3.0 * square - 2.0 * cube)
                        + seconds * out[part] * (cube - 2.0 * square + u)
                        + seconds * into[part] * (cube - square)
                })
            }
        }
    }
}

impl Curve<3> {
    /// The translation or scale at a time.
    pub(super) fn vector(&self, time: f64) -> DVec3 {
        DVec3::from(self.at(time, |from, to, u| DVec3::from(from).lerp(DVec3::from(to), u).to_array()))
    }
}

impl Curve<4> {
    /// The rotation at a time, of unit length where the keys have any.
    pub(super) fn rotation(&self, time: f64) -> DQuat {
        let unit = |value: [f64; 4]| {
            let value = DQuat::from_array(value);
            value * value.length().recip()
        };
        unit(self.at(time, |from, to, u| {
            let (from, to) = (unit(from), unit(to));
            // Keys without a length are NaN here, and what they turn is hidden.
            if from.is_finite() && to.is_finite() { from.slerp(to, u).to_array() } else { [f64::NAN; 4] }
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_1_SQRT_2;

    fn curve<const WIDTH: usize>(
        interpolation: Interpolation,
        times: &[f32],
        values: &[[f32; WIDTH]],
    ) -> Curve<WIDTH> {
        Curve { times: times.into(), values: values.into(), interpolation }
    }

    #[test]
    fn values_step_run_and_bend() {
        let values = [[0.0; 3], [2.0, 4.0, 0.0]];
        let step = curve(Interpolation::Step, &[1.0, 3.0], &values);
        let linear = curve(Interpolation::Linear, &[1.0, 3.0], &values);
        for (time, stepped, straight) in [
            (0.0, 0.0, 0.0),
            (1.0, 0.0, 0.0),
            (2.0, 0.0, 1.0),
            (2.5, 0.0, 1.5),
            (3.0, 2.0, 2.0),
            (9.0, 2.0, 2.0),
        ] {
            assert_eq!(step.vector(time).x, stepped, "{time}");
            assert_eq!(linear.vector(time), DVec3::new(straight, 2.0 * straight, 0.0), "{time}");
        }
        assert_eq!(linear.ends(), (1.0, 3.0));
        // With tangents of one unit a second between 0 at 1 and 2 at 3 the cubic is the straight line.
        let tangent = [1.0, 0.0, 0.0];
        let rows = [tangent, [0.0; 3], tangent, tangent, [2.0, 0.0, 0.0], tangent];
        let cubic = curve(Interpolation::Cubic, &[1.0, 3.0], &rows);
        for time in [1.0, 1.25, 2.0, 2.9, 3.0] {
            assert!((cubic.vector(time).x - (time - 1.0)).abs() < 1e-12, "{time}");
        }
        // Without, it is smooth at both ends.
        let rows = [[0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3], [2.0, 0.0, 0.0], [0.0; 3]];
        let cubic = curve(Interpolation::Cubic, &[1.0, 3.0], &rows);
        assert_eq!(cubic.vector(2.0).x, 1.0);
        assert!((cubic.vector(1.5).x - 2.0 * 0.15625).abs() < 1e-12);
    }

    #[test]
    fn rotations_take_the_shorter_arc() {
        let quarter = FRAC_1_SQRT_2 as f32;
        for sign in [1.0, -1.0] {
            let keys = [[0.0, 0.0, 0.0, 1.0], [0.0, sign * quarter, 0.0, sign * quarter]];
            let linear = curve(Interpolation::Linear, &[0.0, 1.0], &keys);
            let turned = linear.rotation(0.5) * DVec3::X;
            assert!(turned.distance(DVec3::new(FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2)) < 1e-6, "{turned}");
        }
        let none = curve(Interpolation::Linear, &[0.0], &[[0.0; 4]]);
        assert!(!none.rotation(0.0).is_finite());
    }
}
