//! Deep groove ball bearings: two rings with raceways, balls, and a ribbon cage of two pressed halves.

use super::super::shape::Solid;
use super::super::shape::lathe::{ring_of, ring_sector};
use super::super::shape::outline::chamfered;
use super::super::shape::primitives::icosphere;
use super::palette::{BRASS, BRIGHT, CUT, STEEL};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// The measures of a bearing; its axis is z, its middle the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bearing {
    pub(crate) bore: f64,
    pub(crate) outer: f64,
    pub(crate) width: f64,
    pub(crate) ball: f64,
    pub(crate) balls: u32,
}

impl Bearing {
    /// The bearings of the input and the middle shaft.
    pub(crate) const SMALL: Self = Self { bore: 0.25, outer: 0.55, width: 0.27, ball: 0.095, balls: 8 };
    /// The bearings of the output shaft.
    pub(crate) const LARGE: Self = Self { bore: 0.325, outer: 0.70, width: 0.33, ball: 0.12, balls: 8 };

    /// The radius of the circle on which the balls run.
    pub(crate) fn pitch(&self) -> f64 {
        (self.bore + self.outer) / 2.0
    }

    /// The profile of a ring. `side` is -1 for the inner ring and 1 for the outer one.
    fn profile(&self, side: f64) -> Vec<DVec2> {
        let half = self.width / 2.0;
        let back = if side < 0.0 { self.bore } else { self.outer };
        // The raceway is 4 % wider than the ball and touches it at its deepest line.
        let groove = 1.04 * self.ball;
        let center = self.pitch() - side * (groove - self.ball);
        let shoulder = self.pitch() + side * 0.62 * self.ball;
        let edge = (groove * groove - (shoulder - center).powi(2)).sqrt();
        let start = edge.atan2((shoulder - center).abs());
        let chamfer = 0.022;
        let corners = [
            (shoulder, edge, 0.0),
            (shoulder, half, 0.5 * chamfer),
            (back, half, chamfer),
            (back, -half, chamfer),
            (shoulder, -half, 0.5 * chamfer),
            (shoulder, -edge, 0.0),
        ];
        let mut points = chamfered(&corners);
        points.extend((1..16).map(|i| {
            let angle = -start + 2.0 * start * f64::from(i) / 16.0;
            DVec2::new(center + side * groove * angle.cos(), groove * angle.sin())
        }));
        points
    }

    pub(crate) fn inner_ring(&self) -> Solid {
        ring_of(&self.profile(-1.0), 96, BRIGHT)
    }

    pub(crate) fn outer_ring(&self) -> Solid {
        ring_of(&self.profile(1.0), 128, BRIGHT)
    }

    /// The outer ring with a piece cut out, from angle to angle, so that one looks at the balls.
    pub(crate) fn open_outer_ring(&self, from: f64, to: f64) -> Solid {
        ring_sector(&self.profile(1.0), to, from + TAU, 112, BRIGHT, CUT)
    }

    pub(crate) fn ball(&self) -> Solid {
        icosphere(self.ball, 3, BRIGHT)
    }

    /// The places of the balls, the first one at an angle.
    pub(crate) fn ball_places(&self, start: f64) -> impl Iterator<Item = DVec3> {
        let (pitch, balls) = (self.pitch(), self.balls);
        (0..balls).map(move |i| {
            (DVec2::from_angle(start + TAU * f64::from(i) / f64::from(balls)) * pitch).extend(0.0)
        })
    }

    /// The half of the cage above the middle plane; the other half is the same, turned about the x axis. The
    /// sheet bends around each ball and lies flat between two.
    pub(crate) fn cage_half(&self) -> Solid {
        let (pocket, sheet, half_breadth) = (1.06 * self.ball, 0.12 * self.ball, 0.22 * self.ball);
        let pitch = self.pitch();
        let reach = pocket + sheet;
        let half_cell = PI * pitch / f64::from(self.balls);
        let mut stations: Vec<f64> = (0..=24).map(|i| -reach * (PI * f64::from(i) / 24.0).cos()).collect();
        stations.push(half_cell);
        let arch = |radius: f64, x: f64| (radius * radius - x * x).max(0.0).sqrt();
        // A gap between the halves, too thin to be seen, keeps their faces apart.
        let seam = 1e-4;
        let mut solid = Solid::default();
        let mut sections = Vec::new();
        for cell in 0..self.balls {
            for &x in &stations {
                let angle = TAU * f64::from(cell) / f64::from(self.balls) + x / pitch;
                let (low, high) = (arch(pocket, x).max(seam), arch(reach, x).max(sheet));
                let (inner, outer) = (pitch - half_breadth, pitch + half_breadth);
                let corner = |r: f64, z: f64| (DVec2::from_angle(angle) * r).extend(z);
                let section =
                    [corner(inner, low), corner(outer, low), corner(outer, high), corner(inner, high)];
                sections.push(solid.ring(section));
            }
        }
        for (i, section) in sections.iter().enumerate() {
            let next = &sections[(i + 1) % sections.len()];
            solid.bridge(next, section, BRASS);
        }
        solid
    }

    /// A plain sleeve that keeps a gear and this bearing apart.
    pub(crate) fn spacer(&self, length: f64) -> Solid {
        let (inner, outer) = (self.bore + 0.042, self.bore + 0.1);
        let corners = [
            (outer, 0.0, 0.0),
            (outer, length, 0.012),
            (inner, length, 0.006),
            (inner, 0.0, 0.006),
            (outer, 0.0, 0.012),
            (outer, length * 0.5, 0.0),
        ];
        ring_of(&chamfered(&corners)[1..], 96, STEEL)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::shape::check::volume;
    use super::*;

    #[test]
    fn parts_are_closed() {
        for bearing in [Bearing::SMALL, Bearing::LARGE] {
            let parts = [
                bearing.inner_ring(),
                bearing.outer_ring(),
                bearing.open_outer_ring(0.5, 2.0),
                bearing.ball(),
                bearing.cage_half(),
                bearing.spacer(0.1),
            ];
            for part in parts {
                assert!(volume(&part).unwrap() > 0.0);
            }
        }
    }

    #[test]
    fn balls_touch_both_raceways_and_no_neighbour() {
        for bearing in [Bearing::SMALL, Bearing::LARGE] {
            let center = DVec2::new(bearing.pitch(), 0.0);
            for side in [-1.0, 1.0] {
                let nearest = bearing
                    .profile(side)
                    .iter()
                    .map(|point| point.distance(center))
                    .fold(f64::INFINITY, f64::min);
                assert!((nearest - bearing.ball).abs() < 1e-9, "{nearest}");
            }
            let places: Vec<DVec3> = bearing.ball_places(0.1).collect();
            assert!(places[0].distance(places[1]) > 2.3 * bearing.ball);
        }
    }
}
