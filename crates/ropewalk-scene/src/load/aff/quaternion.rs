//! Quaternions as the benchmark's own programs reckon with them, since its published frames show what these make: axes are
//! not normalised, so quaternions need not be of unit length, and angles whose sine is below 0.001 count as none.

use glam::{DMat3, DVec3};

/// A quaternion that need not be of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Quaternion {
    pub(super) w: f64,
    pub(super) v: DVec3,
}

/// Sines below this count as none.
const SMALLEST_SINE: f64 = 0.001;

impl Quaternion {
    pub(super) const NAN: Self = Self { w: f64::NAN, v: DVec3::NAN };

    /// The turn about an axis by an angle in degrees. The length of the axis stays in the quaternion.
    pub(super) fn from_axis_angle(axis: DVec3, degrees: f64) -> Self {
        let (sine, cosine) = (degrees.to_radians() / 2.0).sin_cos();
        Self { w: cosine, v: axis * sine }
    }

    pub(super) fn negated(self) -> Self {
        Self { w: -self.w, v: -self.v }
    }

    pub(super) fn conjugate(self) -> Self {
        Self { w: self.w, v: -self.v }
    }

    pub(super) fn dot(self, other: Self) -> f64 {
        self.w * other.w + self.v.dot(other.v)
    }

    pub(super) fn times(self, other: Self) -> Self {
        Self {
            w: self.w * other.w - self.v.dot(other.v),
            v: self.w * other.v + other.w * self.v + self.v.cross(other.v),
        }
    }

    /// The axis times half the angle.
    pub(super) fn log(self) -> DVec3 {
        let angle = self.w.acos();
        let sine = angle.sin();
        // The angle is NaN where the quaternion is too long.
        if self.w.abs() < 1.0 && sine.abs() >= SMALLEST_SINE { self.v * (angle / sine) } else { self.v }
    }

    /// The inverse of the logarithm.
    pub(super) fn exp(v: DVec3) -> Self {
        let angle = v.length();
        let sine = angle.sin();
        Self { w: angle.cos(), v: if sine.abs() >= SMALLEST_SINE { v * (sine / angle) } else { v } }
    }

    /// The great arc from one to the other, on the side that they are on.
    pub(super) fn slerp(from: Self, to: Self, u: f64) -> Self {
        let angle = from.dot(to).clamp(-1.0, 1.0).acos();
        let sine = angle.sin();
        if sine < SMALLEST_SINE {
            return from;
        }
        let (a, b) = (((1.0 - u) * angle).sin() / sine, (u * angle).sin() / sine);
        Self { w: a * from.w + b * to.w, v: a * from.v + b * to.v }
    }

    /// The rotation: by twice the angle whose cosine is `w`, about `v`.
    pub(super) fn to_matrix(self) -> DMat3 {
        let angle = 2.0 * self.w.clamp(-1.0, 1.0).acos();
        rotation(self.v, angle)
    }
}

/// The rotation by an angle in radians about an axis of any length; none about an axis of length zero.
pub(super) fn rotation(axis: DVec3, angle: f64) -> DMat3 {
    axis.try_normalize().map_or(DMat3::IDENTITY, |axis| DMat3::from_axis_angle(axis, angle))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_is_right_handed() {
        let quarter = Quaternion::from_axis_angle(DVec3::Y, 90.0).to_matrix();
        assert!((quarter * DVec3::X).distance(DVec3::NEG_Z) < 1e-15);
        assert_eq!(Quaternion::from_axis_angle(DVec3::ZERO, 90.0).to_matrix(), DMat3::IDENTITY);
        assert_eq!(rotation(DVec3::ZERO, 1.0), DMat3::IDENTITY);
    }

    #[test]
    fn turns_follow_each_other_and_have_logarithms() {
        let (one, other) =
            (Quaternion::from_axis_angle(DVec3::Y, 40.0), Quaternion::from_axis_angle(DVec3::X, 70.0));
        let product = one.times(other).to_matrix();
        assert!(product.abs_diff_eq(one.to_matrix() * other.to_matrix(), 1e-14));
        assert!((one.log() - DVec3::Y * 20f64.to_radians()).length() < 1e-15);
        let back = Quaternion::exp(one.log());
        assert!((back.w - one.w).abs() < 1e-15 && back.v.distance(one.v) < 1e-15);
        let half = Quaternion::slerp(Quaternion::from_axis_angle(DVec3::Y, 0.0), one, 0.5);
        assert!(half.v.distance(Quaternion::from_axis_angle(DVec3::Y, 20.0).v) < 1e-15);
    }

    #[test]
    fn quaternions_that_are_too_long_are_no_nan() {
        // Axes of length 1.08 occur; the cosine of an angle comes out above 1.
        let long = Quaternion::from_axis_angle(DVec3::splat(0.62), 200.0);
        let step = long.conjugate().times(long);
        assert!(step.w > 1.0 && step.log().is_finite());
        assert!(step.to_matrix().is_finite());
    }
}
