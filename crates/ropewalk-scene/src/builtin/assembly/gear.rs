//! Gears, spur and helical: teeth around a plain disc, or around a rim with a thinner web and a hub.
//!
//! A helical gear is the section of a spur gear turned along the axis in proportion to the height: every slice
//! meshes as a spur gear does, when the mate is turned the other way.

use super::super::shape::outline::circle;
use super::super::shape::sweep::{Layer, rings, walls};
use super::super::shape::{Facing, Ring, Solid};
use super::palette::STEEL;
use super::teeth::Teeth;
use glam::DVec2;
use std::f64::consts::{PI, TAU};

/// What is inside the teeth.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Body {
    /// A disc as wide as the teeth.
    Plain,
    /// A rim and a hub with a thinner web between them, with holes in it.
    Web { rim: f64, hub: f64, hub_width: f64, web_width: f64, holes: u32, hole_radius: f64, hole_circle: f64 },
}

/// A gear, its axis along z, its middle at the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gear {
    pub(crate) teeth: Teeth,
    pub(crate) width: f64,
    /// The angle of the teeth to the axis at the pitch circle; positive for a right-handed helix.
    pub(crate) helix: f64,
    pub(crate) bore: f64,
    /// The width of the keyway, which lies on the positive y axis.
    pub(crate) key: f64,
    pub(crate) body: Body,
    /// The material of body and teeth.
    pub(crate) paint: (u32, u32),
}

impl Gear {
    /// The closed solid.
    pub(crate) fn solid(&self) -> Solid {
        let mut solid = Solid::default();
        let outer = self.outer(&mut solid);
        let half_bore = match self.body {
            Body::Plain => self.width / 2.0,
            Body::Web { hub_width, .. } => hub_width / 2.0,
        };
        let chamfer = 0.014;
        let mut keyway = self.keyway();
        keyway.reverse();
        let layers = [
            (-half_bore, chamfer),
            (chamfer - half_bore, 0.0),
            (half_bore - chamfer, 0.0),
            (half_bore, chamfer),
        ];
        let bore = rings(&mut solid, &keyway, &layers.map(|(z, inset)| Layer { z, inset, angle: 0.0 }));
        walls(&mut solid, &bore, STEEL);
        let holes = self.holes(&mut solid);
        for (end, facing) in [(0, Facing::Down), (1, Facing::Up)] {
            let pick = |rings: &[Ring]| rings[end * (rings.len() - 1)].clone();
            let holes: Vec<Ring> = holes.iter().map(|hole| pick(hole)).collect();
            self.face(&mut solid, &pick(&outer), &pick(&bore), &holes, facing);
        }
        solid
    }

    /// The toothed surface: its lowest and its highest ring.
    fn outer(&self, solid: &mut Solid) -> Vec<Ring> {
        let outline = self.teeth.outline();
        let chamfer = 0.1 * self.teeth.module;
        let half = self.width / 2.0;
        let twist = self.helix.tan() / self.teeth.pitch_radius();
        // A slice of a helical gear turns by about a degree, so that its flanks look smooth.
        let slices = ((twist * self.width).abs() / 0.025).ceil().max(1.0) as u32;
        let mut layers = vec![(-half, chamfer)];
        layers.extend((0..=slices).map(|i| {
            let share = f64::from(i) / f64::from(slices);
            ((half - chamfer) * (2.0 * share - 1.0), 0.0)
        }));
        layers.push((half, chamfer));
        let layers: Vec<Layer> =
            layers.into_iter().map(|(z, inset)| Layer { z, inset, angle: z * twist }).collect();
        let all = rings(solid, &outline, &layers);
        let (body, teeth) = self.paint;
        walls(solid, &all[..2], body);
        walls(solid, &all[1..all.len() - 1], teeth);
        walls(solid, &all[all.len() - 2..], body);
        let mut ends = all;
        ends.drain(1..ends.len() - 1);
        ends
    }

    /// The outline of the bore with its keyway, counter-clockwise.
    fn keyway(&self) -> Vec<DVec2> {
        let half_key = self.key / 2.0;
        let start = (half_key / self.bore).asin();
        let mut points: Vec<DVec2> = (0..=64)
            .map(|i| PI / 2.0 + start + (TAU - 2.0 * start) * f64::from(i) / 64.0)
            .map(|angle| DVec2::from_angle(angle) * self.bore)
            .collect();
        let depth = self.bore + 0.45 * self.key;
        points.extend([DVec2::new(half_key, depth), DVec2::new(-half_key, depth)]);
        points
    }

    /// The walls of the holes through the web; each as its rings, lowest first.
    fn holes(&self, solid: &mut Solid) -> Vec<Vec<Ring>> {
        let Body::Web { web_width, holes, hole_radius, hole_circle, .. } = self.body else {
            return Vec::new();
        };
        let (half, chamfer) = (web_width / 2.0, 0.012);
        (0..holes)
            .map(|i| {
                let center = DVec2::from_angle(TAU * f64::from(i) / f64::from(holes)) * hole_circle;
                let mut hole = circle(center, hole_radius, 40);
                hole.reverse();
                let layers =
                    [(-half, chamfer), (chamfer - half, 0.0), (half - chamfer, 0.0), (half, chamfer)];
                let rings = rings(solid, &hole, &layers.map(|(z, inset)| Layer { z, inset, angle: 0.0 }));
                walls(solid, &rings, self.paint.0);
                rings
            })
            .collect()
    }

    /// One side of the gear, from the teeth to the bore.
    fn face(&self, solid: &mut Solid, outer: &[u32], bore: &[u32], holes: &[Ring], facing: Facing) {
        let paint = self.paint.0;
        let Body::Web { rim, hub, hub_width, web_width, .. } = self.body else {
            solid.fill(outer, &[bore], facing, paint);
            return;
        };
        let sign = if facing == Facing::Up { 1.0 } else { -1.0 };
        let (face, web, hub_face) = (self.width / 2.0, web_width / 2.0, hub_width / 2.0);
        let mut level = |radius: f64, height: f64| -> Ring {
            solid.flat_ring(&circle(DVec2::ZERO, radius, 120), sign * height)
        };
        let (edge, fillet) = (0.015, 0.04);
        let rim_rings = [
            level(rim, face),
            level(rim - edge, face - edge),
            level(rim - edge, web + fillet),
            level(rim - edge - 0.3 * fillet, web + 0.3 * fillet),
            level(rim - edge - fillet, web),
        ];
        let hub_rings = [
            level(hub + fillet, web),
            level(hub + 0.3 * fillet, web + 0.3 * fillet),
            level(hub, web + fillet),
            level(hub, hub_face - edge),
            level(hub - edge, hub_face),
        ];
        solid.fill(outer, &[&rim_rings[0]], facing, paint);
        let mut inner: Vec<&[u32]> = vec![&hub_rings[0]];
        inner.extend(holes.iter().map(Vec::as_slice));
        solid.fill(&rim_rings[4], &inner, facing, paint);
        solid.fill(&hub_rings[4], &[bore], facing, paint);
        for pair in rim_rings.windows(2).chain(hub_rings.windows(2)) {
            // Seen from outside both ways go inwards; below, the other side of them is out.
            match facing {
                Facing::Up => solid.bridge(&pair[0], &pair[1], paint),
                Facing::Down => solid.bridge(&pair[1], &pair[0], paint),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::shape::check::volume;
    use super::*;

    #[test]
    fn solids_are_closed() {
        let teeth = Teeth { count: 30, module: 0.05 };
        let web = Body::Web {
            rim: 0.62,
            hub: 0.3,
            hub_width: 0.4,
            web_width: 0.1,
            holes: 5,
            hole_radius: 0.09,
            hole_circle: 0.45,
        };
        for (body, helix) in [(Body::Plain, 0.0), (Body::Plain, 0.3), (web, 0.0), (web, -0.3)] {
            let gear = Gear { teeth, width: 0.3, helix, bore: 0.2, key: 0.08, body, paint: (0, 1) };
            let volume = volume(&gear.solid()).unwrap();
            assert!(volume > 0.1 && volume < 0.3 * PI * teeth.tip_radius().powi(2), "{volume}");
        }
    }
}
