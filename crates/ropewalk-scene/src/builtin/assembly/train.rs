//! The gear train: axes, teeth and ratios. What turns, about what, and how fast follows from here alone.
//!
//! Three parallel shafts lie side by side in the plane where the housing is split. A pair of helical gears
//! leads from the input shaft to the middle one, a pair of spur gears on to the output: 1 turn in is
//! 19 * 17 / (46 * 43) = 0.163 turns out. One unit is a decimetre; z runs along the shafts, y is up, and the
//! axes lie at y = 0.

use super::teeth::Teeth;
use std::f64::consts::PI;

/// The pinion on the input shaft.
pub(crate) const INPUT_PINION: Teeth = Teeth { count: 19, module: 0.05 };
/// Its mate on the middle shaft.
pub(crate) const MIDDLE_WHEEL: Teeth = Teeth { count: 46, module: 0.05 };
/// The pinion on the middle shaft.
pub(crate) const MIDDLE_PINION: Teeth = Teeth { count: 17, module: 0.06 };
/// Its mate on the output shaft.
pub(crate) const OUTPUT_WHEEL: Teeth = Teeth { count: 43, module: 0.06 };
/// The helix of the input pinion; its mate has the opposite one.
pub(crate) const HELIX: f64 = 18.0 * PI / 180.0;

/// Where the input shaft lies.
pub(crate) const INPUT_X: f64 = -2.125;
/// Where the middle shaft lies: half the sum of the pitch diameters further.
pub(crate) const MIDDLE_X: f64 = INPUT_X + 0.05 * (19.0 + 46.0) / 2.0;
/// Where the output shaft lies.
pub(crate) const OUTPUT_X: f64 = MIDDLE_X + 0.06 * (17.0 + 43.0) / 2.0;

/// The middle of the helical pair along the shafts.
pub(crate) const FIRST_STAGE_Z: f64 = -0.45;
/// The middle of the spur pair.
pub(crate) const SECOND_STAGE_Z: f64 = 0.4;

/// How far each shaft is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Angles {
    pub(crate) input: f64,
    pub(crate) middle: f64,
    pub(crate) output: f64,
}

/// How far the shafts are turned when the input is, in radians, so that all teeth interlock.
pub(crate) fn angles(input: f64) -> Angles {
    let middle = INPUT_PINION.mate_angle(input, 0.0, &MIDDLE_WHEEL);
    Angles { input, middle, output: MIDDLE_PINION.mate_angle(middle, 0.0, &OUTPUT_WHEEL) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_stand_where_the_teeth_need_them() {
        assert!((MIDDLE_X - INPUT_X - INPUT_PINION.center_distance(&MIDDLE_WHEEL)).abs() < 1e-12);
        assert!((OUTPUT_X - MIDDLE_X - MIDDLE_PINION.center_distance(&OUTPUT_WHEEL)).abs() < 1e-12);
    }

    #[test]
    fn the_ratio_is_that_of_the_teeth() {
        let (start, end) = (angles(0.0), angles(1.0));
        assert!(
            (end.middle - start.middle + 19.0 / 46.0).abs() < 1e-12,
            "neighbours turn against each other"
        );
        assert!((end.output - start.output - 19.0 * 17.0 / (46.0 * 43.0)).abs() < 1e-12);
    }
}
