//! Involute teeth: the outline of a spur gear, and how two of them mesh.
//!
//! The flanks are true involutes of the base circle, so two gears of one module and one pressure angle run at
//! a constant ratio. Below the base circle the flank goes on radially; a fillet leads into the root circle, with
//! the standard clearance of a quarter module.

use glam::DVec2;
use std::f64::consts::{PI, TAU};

/// The angle at which flanks press on each other at the pitch circle.
pub(crate) const PRESSURE_ANGLE: f64 = 20.0 * PI / 180.0;

/// How much narrower a tooth is than half the pitch, in modules. The gap between two flanks is twice that.
pub(crate) const THINNING: f64 = 0.02;

/// The shape of the teeth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Teeth {
    pub(crate) count: u32,
    /// The pitch diameter over the number of teeth, in the plane of rotation.
    pub(crate) module: f64,
}

impl Teeth {
    pub(crate) fn pitch_radius(&self) -> f64 {
        self.module * f64::from(self.count) / 2.0
    }

    pub(crate) fn base_radius(&self) -> f64 {
        self.pitch_radius() * PRESSURE_ANGLE.cos()
    }

    pub(crate) fn tip_radius(&self) -> f64 {
        self.pitch_radius() + self.module
    }

    pub(crate) fn root_radius(&self) -> f64 {
        self.pitch_radius() - 1.25 * self.module
    }

    /// The pressure angle at a radius; zero on the radial flank below the base circle.
    fn pressure_angle(&self, radius: f64) -> f64 {
        (self.base_radius() / radius).min(1.0).acos()
    }

    /// Half the angle of a tooth at a radius.
    fn half_angle(&self, radius: f64) -> f64 {
        let involute = |angle: f64| angle.tan() - angle;
        let at_pitch =
            PI / (2.0 * f64::from(self.count)) - THINNING * self.module / (2.0 * self.pitch_radius());
        at_pitch + involute(PRESSURE_ANGLE) - involute(self.pressure_angle(radius))
    }

    /// A point of the flank and the direction out of the tooth there.
    fn flank(&self, radius: f64) -> (DVec2, DVec2) {
        let radial = DVec2::from_angle(self.half_angle(radius));
        let (sin, cos) = self.pressure_angle(radius).sin_cos();
        (radial * radius, radial.perp() * cos + radial * sin)
    }

    /// Half a tooth, from the middle of its tip to the middle of the gap, at growing angles.
    fn half_tooth(&self) -> Vec<DVec2> {
        const FLANK: u32 = 9;
        const FILLET: u32 = 4;
        let fillet = 0.3 * self.module;
        // The flank ends where a circle that touches it also touches the root circle from outside.
        let (mut low, mut high) = (self.root_radius(), self.tip_radius());
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            let (point, out) = self.flank(middle);
            if (point + out * fillet).length() < self.root_radius() + fillet {
                low = middle;
            } else {
                high = middle;
            }
        }
        let (foot, out) = self.flank(high);
        let center = foot + out * fillet;

        let tip = self.tip_radius();
        let mut points = vec![DVec2::X * tip, DVec2::from_angle(self.half_angle(tip) * 0.6) * tip];
        points.extend((0..FLANK).map(|i| self.flank(tip + (high - tip) * f64::from(i) / f64::from(FLANK)).0));
        let turn = (foot - center).angle_to(-center);
        points.extend((0..=FILLET).map(|i| {
            center + DVec2::from_angle(turn * f64::from(i) / f64::from(FILLET)).rotate(foot - center)
        }));
        points.push(DVec2::from_angle(PI / f64::from(self.count)) * self.root_radius());
        points
    }

    /// The outline of all teeth; the first one points along x.
    pub(crate) fn outline(&self) -> Vec<DVec2> {
        let half = self.half_tooth();
        let mirrored = half[1..half.len() - 1].iter().rev().map(|point| DVec2::new(point.x, -point.y));
        let tooth: Vec<DVec2> = mirrored.chain(half.iter().copied()).collect();
        (0..self.count)
            .flat_map(|i| {
                let turn = DVec2::from_angle(TAU * f64::from(i) / f64::from(self.count));
                tooth.iter().map(move |&point| turn.rotate(point)).collect::<Vec<_>>()
            })
            .collect()
    }

    /// The distance between the axes of two gears that mesh.
    #[cfg(test)]
    pub(crate) fn center_distance(&self, mate: &Self) -> f64 {
        self.pitch_radius() + mate.pitch_radius()
    }

    /// The angle of a mate that stands in `direction`, when this gear is turned by `angle`: a gap of the mate
    /// faces the tooth.
    pub(crate) fn mate_angle(&self, angle: f64, direction: f64, mate: &Self) -> f64 {
        let ratio = f64::from(self.count) / f64::from(mate.count);
        direction + PI - (angle - direction) * ratio - PI / f64::from(mate.count)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::shape::outline::contains;
    use super::*;

    /// The distance from a point to the nearest edge of a loop.
    fn distance(points: &[DVec2], point: DVec2) -> f64 {
        (0..points.len())
            .map(|i| {
                let (a, b) = (points[i], points[(i + 1) % points.len()]);
                let share = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                point.distance(a.lerp(b, share))
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// How deep the teeth of one gear stand in the other at their deepest, and how close they come.
    fn clash(a: &[DVec2], b: &[DVec2]) -> (f64, f64) {
        let (mut deepest, mut closest) = (0.0_f64, f64::INFINITY);
        for (one, other) in [(a, b), (b, a)] {
            let reach = other.iter().map(|p| p.x).fold(f64::NEG_INFINITY, f64::max);
            let start = other.iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
            for &point in one.iter().filter(|p| p.x > start - 0.05 && p.x < reach + 0.05) {
                let gap = distance(other, point);
                if contains(other, point) {
                    deepest = deepest.max(gap);
                }
                closest = closest.min(gap);
            }
        }
        (deepest, closest)
    }

    fn placed(teeth: &Teeth, angle: f64, x: f64) -> Vec<DVec2> {
        let turn = DVec2::from_angle(angle);
        teeth.outline().iter().map(|&p| turn.rotate(p) + DVec2::X * x).collect()
    }

    fn worst(pinion: Teeth, mate: Teeth, shift: f64) -> (f64, f64) {
        let distance = pinion.center_distance(&mate);
        let pitch = TAU / f64::from(pinion.count);
        (0..24).fold((0.0_f64, 0.0_f64), |worst, step| {
            let angle = pitch * f64::from(step) / 24.0;
            let mate_angle = pinion.mate_angle(angle, 0.0, &mate) + shift;
            let (deep, close) = clash(&placed(&pinion, angle, 0.0), &placed(&mate, mate_angle, distance));
            (worst.0.max(deep), worst.1.max(close))
        })
    }

    #[test]
    fn teeth_interlock_without_overlap() {
        for (a, b, module) in [(19, 46, 0.05), (17, 43, 0.06), (20, 20, 1.0)] {
            let [pinion, mate] = [a, b].map(|count| Teeth { count, module });
            let (deepest, gap) = worst(pinion, mate, 0.0);
            // The outlines are chords of the flanks: they stand a little inside them.
            assert!(deepest < 1e-9, "{a}:{b} overlap by {deepest}");
            assert!(gap < 2.0 * THINNING * module, "{a}:{b} stand {gap} apart");
            let quarter_pitch = PI / f64::from(2 * b);
            let (deepest, _) = worst(pinion, mate, quarter_pitch);
            assert!(deepest > 0.1 * module, "the test must see a wrong angle");
        }
    }

    #[test]
    fn the_flank_is_an_involute() {
        let teeth = Teeth { count: 46, module: 0.05 };
        let base = teeth.base_radius();
        let mut expected = None;
        for step in 0..20 {
            let radius = base * 1.001 + (teeth.tip_radius() - base * 1.001) * f64::from(step) / 19.0;
            let (point, out) = teeth.flank(radius);
            // The normal of an involute touches the base circle, and the string's length is the arc unwound.
            assert!((point.perp_dot(out).abs() - base).abs() < 1e-12);
            let string = (radius * radius - base * base).sqrt();
            let origin = string / base + (point - out * string).to_angle();
            let expected = *expected.get_or_insert(origin);
            assert!((origin - expected).abs() < 1e-9, "{origin} {expected}");
        }
    }
}
