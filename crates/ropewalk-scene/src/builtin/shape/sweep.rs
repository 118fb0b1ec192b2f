//! Extrusion of an outline with holes: straight, with chamfered edges, or twisted along the way.
//!
//! The body is a stack of [`Layer`]s. Each says how far the outline is drawn in at its height and how far it is
//! turned: two layers near an end make a chamfer, many turned ones a helical gear or a thread.

use super::outline::{inset, is_counter_clockwise, reversed};
use super::{Facing, Ring, Solid};
use glam::DVec2;

/// An outline with holes.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    pub(crate) outline: Vec<DVec2>,
    pub(crate) holes: Vec<Vec<DVec2>>,
}

impl From<Vec<DVec2>> for Region {
    fn from(outline: Vec<DVec2>) -> Self {
        Self { outline, holes: Vec::new() }
    }
}

/// A height of a swept body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layer {
    pub(crate) z: f64,
    /// How far the outline is drawn in, and holes widened.
    pub(crate) inset: f64,
    /// How far it is turned about the axis, in radians.
    pub(crate) angle: f64,
}

/// The materials of a swept body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paint {
    pub(crate) ends: u32,
    pub(crate) sides: u32,
    pub(crate) holes: u32,
}

impl From<u32> for Paint {
    fn from(all: u32) -> Self {
        Self { ends: all, sides: all, holes: all }
    }
}

/// The rings of one outline through all layers, lowest first.
pub(crate) fn rings(solid: &mut Solid, outline: &[DVec2], layers: &[Layer]) -> Vec<Ring> {
    layers
        .iter()
        .map(|layer| {
            let turn = DVec2::from_angle(layer.angle);
            let points = inset(outline, layer.inset).into_iter().map(|point| turn.rotate(point));
            solid.ring(points.map(|point| point.extend(layer.z)).collect::<Vec<_>>())
        })
        .collect()
}

/// Walls between neighbouring rings.
pub(crate) fn walls(solid: &mut Solid, rings: &[Ring], material: u32) {
    for pair in rings.windows(2) {
        solid.bridge(&pair[0], &pair[1], material);
    }
}

/// The body of a region through layers, lowest first.
pub(crate) fn sweep(region: &Region, layers: &[Layer], paint: Paint) -> Solid {
    let mut solid = Solid::default();
    let orient = |points: &[DVec2], counter_clockwise: bool| {
        if is_counter_clockwise(points) == counter_clockwise {
            points.to_vec()
        } else {
            reversed(points.to_vec())
        }
    };
    let outer = rings(&mut solid, &orient(&region.outline, true), layers);
    let holes: Vec<Vec<Ring>> =
        region.holes.iter().map(|hole| rings(&mut solid, &orient(hole, false), layers)).collect();
    walls(&mut solid, &outer, paint.sides);
    for hole in &holes {
        walls(&mut solid, hole, paint.holes);
    }
    let ends = [(0, Facing::Down), (layers.len() - 1, Facing::Up)];
    for (end, facing) in ends {
        let holes: Vec<&[u32]> = holes.iter().map(|hole| hole[end].as_slice()).collect();
        solid.fill(&outer[end], &holes, facing, paint.ends);
    }
    solid
}

/// The body of a region between two heights, with all edges chamfered.
pub(crate) fn extrude(
    region: &Region,
    bottom: f64,
    top: f64,
    chamfer: f64,
    paint: impl Into<Paint>,
) -> Solid {
    let layer = |z, inset| Layer { z, inset, angle: 0.0 };
    let layers = if chamfer == 0.0 {
        vec![layer(bottom, 0.0), layer(top, 0.0)]
    } else {
        vec![
            layer(bottom, chamfer),
            layer(bottom + chamfer, 0.0),
            layer(top - chamfer, 0.0),
            layer(top, chamfer),
        ]
    };
    sweep(region, &layers, paint.into())
}

#[cfg(test)]
mod tests {
    use super::super::check::volume;
    use super::super::outline::{circle, rectangle};
    use super::*;

    #[test]
    fn a_plate_with_holes_is_closed_and_of_the_right_volume() {
        let plate = Region {
            outline: rectangle(DVec2::ZERO, DVec2::new(4.0, 2.0), 0.0),
            holes: vec![
                circle(DVec2::new(1.0, 1.0), 0.5, 400),
                rectangle(DVec2::splat(0.2), DVec2::splat(0.4), 0.0),
            ],
        };
        let exact = (8.0 - std::f64::consts::PI * 0.25 - 0.04) * 0.5;
        assert!((volume(&extrude(&plate, 1.0, 1.5, 0.0, 3)).unwrap() - exact).abs() < 1e-4);
        let chamfered = volume(&extrude(&plate, 1.0, 1.5, 0.02, 3)).unwrap();
        assert!(chamfered < exact && chamfered > 0.97 * exact);
    }

    #[test]
    fn a_twisted_bar_keeps_its_volume() {
        // A round bar off the axis: a spring.
        let bar = Region::from(circle(DVec2::X, 0.5, 100));
        let layers: Vec<Layer> = (0..=200)
            .map(|i| Layer { z: f64::from(i) / 100.0, inset: 0.0, angle: f64::from(i) / 200.0 })
            .collect();
        let exact = 2.0 * 0.25 * std::f64::consts::PI;
        assert!((volume(&sweep(&bar, &layers, 0.into())).unwrap() - exact).abs() < 0.01);
    }
}
