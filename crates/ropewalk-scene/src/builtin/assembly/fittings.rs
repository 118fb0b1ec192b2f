//! What is fitted to the housing and to the shafts: end caps, sight glass, plugs, a plate, a lifting eye, the crank.
//! Their axis is z and they sit on the plane z = 0, looking up.

use super::super::shape::Solid;
use super::super::shape::cut::{Plane, cut};
use super::super::shape::lathe::{ring_of, turned};
use super::super::shape::outline::{arc, chamfered, circle, convex_hull, rectangle};
use super::super::shape::sweep::{Paint, Region, extrude};
use super::bearing::Bearing;
use super::fasteners::hexagon_bolt;
use super::housing::BOSS;
use super::palette::{BLUED, BRASS, CUT, DARK, GLASS, PAINT, RED, RUBBER, STEEL, ZINC};
use super::shafts::CRANK_SEAT;
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// The radius of the screws of the end caps.
pub(crate) const CAP_SCREW: f64 = 0.035;
/// The thickness of an end cap.
pub(crate) const CAP: f64 = 0.09;

/// The places of an end cap's screws.
pub(crate) fn cap_screws(bearing: &Bearing) -> Vec<DVec2> {
    let radius = bearing.outer + 0.5 * BOSS - 0.005;
    (0..8).map(|i| DVec2::from_angle(TAU * (f64::from(i) + 0.5) / 8.0) * radius).collect()
}

/// A cap that closes a bearing's seat; its boss stands at z = 0. With a hole for a shaft when `bore` is not zero.
pub(crate) fn end_cap(bearing: &Bearing, bore: f64) -> Solid {
    let rim = circle(DVec2::ZERO, bearing.outer + BOSS, 128);
    let mut holes: Vec<Vec<DVec2>> =
        cap_screws(bearing).into_iter().map(|place| circle(place, 1.1 * CAP_SCREW, 24)).collect();
    if bore > 0.0 {
        holes.push(circle(DVec2::ZERO, bore, 96));
    }
    let plate = extrude(&Region { outline: rim, holes }, 0.0, CAP, 0.015, PAINT);
    let hub = bearing.outer - 0.12;
    let raised = if bore > 0.0 {
        let profile = [
            (bore, 0.01),
            (hub, 0.01),
            (hub, CAP + 0.04),
            (hub - 0.02, CAP + 0.06),
            (bore + 0.02, CAP + 0.06),
            (bore, CAP + 0.04),
        ];
        ring_of(&profile.map(|(r, z)| DVec2::new(r, z)), 128, PAINT)
    } else {
        turned(
            &chamfered(&[
                (0.0, 0.01, 0.0),
                (hub, 0.01, 0.0),
                (hub, CAP + 0.06, 0.02),
                (0.0, CAP + 0.06, 0.0),
            ]),
            128,
            PAINT,
        )
    };
    Solid::of([plate, raised])
}

/// The lower half of an end cap, cut open in the plane of the shafts.
pub(crate) fn half_cap(bearing: &Bearing, bore: f64) -> Solid {
    // A hair below the plane, in which vertices of the cap lie.
    let plane = Plane::through(DVec3::new(0.0, -2e-3, 0.0), DVec3::Y);
    let cap = end_cap(bearing, bore);
    cut(&cap, &plane, CUT)
}

/// A round sight glass in a brass ring.
pub(crate) fn sight_glass() -> Solid {
    let ring = [(0.13, 0.0), (0.2, 0.0), (0.2, 0.05), (0.185, 0.065), (0.145, 0.065), (0.13, 0.05)];
    let ring = ring_of(&ring.map(|(r, z)| DVec2::new(r, z)), 72, BRASS);
    let mut dome = vec![DVec2::new(0.0, -0.02), DVec2::new(0.135, -0.02)];
    dome.extend((0..8).map(|i| {
        let angle = PI / 2.0 * f64::from(i) / 8.0;
        DVec2::new(0.135 * angle.cos(), 0.03 + 0.02 * angle.sin())
    }));
    dome.push(DVec2::new(0.0, 0.05));
    Solid::of([ring, turned(&dome, 72, GLASS)])
}

/// A plug with a hexagon head and a collar.
pub(crate) fn plug() -> Solid {
    let collar = turned(
        &chamfered(&[(0.0, -0.02, 0.0), (0.13, -0.02, 0.0), (0.13, 0.03, 0.01), (0.0, 0.03, 0.0)]),
        64,
        BRASS,
    );
    Solid::of([collar, hexagon_bolt(0.065, 0.1, BRASS).shifted(DVec3::Z * 0.03)])
}

/// A breather: a fluted knob on a stem.
pub(crate) fn breather() -> Solid {
    let stem = turned(
        &chamfered(&[(0.0, -0.05, 0.0), (0.08, -0.05, 0.0), (0.08, 0.08, 0.0), (0.0, 0.08, 0.0)]),
        48,
        BRASS,
    );
    let flutes: Vec<DVec2> = (0..144)
        .map(|i| {
            let angle = TAU * f64::from(i) / 144.0;
            DVec2::from_angle(angle) * (0.15 + 0.005 * (18.0 * angle).cos())
        })
        .collect();
    Solid::of([stem, extrude(&flutes.into(), 0.06, 0.2, 0.008, ZINC)])
}

/// A lifting eye: a ring on a foot.
pub(crate) fn lifting_eye() -> Solid {
    let foot = turned(
        &chamfered(&[
            (0.0, -0.03, 0.0),
            (0.17, -0.03, 0.0),
            (0.17, 0.05, 0.02),
            (0.09, 0.09, 0.0),
            (0.07, 0.16, 0.0),
            (0.0, 0.16, 0.0),
        ]),
        64,
        ZINC,
    );
    let ring = ring_of(&circle(DVec2::new(0.15, 0.0), 0.045, 24), 72, ZINC);
    let standing = DAffine3::from_translation(DVec3::Z * 0.27) * DAffine3::from_rotation_x(PI / 2.0);
    Solid::of([foot, ring.moved(&standing)])
}

/// The screws of the inspection plate: their radius and places.
pub(crate) const PLATE_SCREW: f64 = 0.03;

/// The places of the inspection plate's screws.
pub(crate) fn plate_screws() -> Vec<DVec2> {
    let (x, y) = (0.42, 0.2);
    [(-x, -y), (0.0, -y), (x, -y), (x, y), (0.0, y), (-x, y)].map(|(x, y)| DVec2::new(x, y)).into()
}

/// The thickness of the inspection plate with its gasket.
pub(crate) const PLATE: f64 = 0.09;

/// An inspection plate on a raised seat.
pub(crate) fn inspection_plate() -> Solid {
    let seat = rectangle(DVec2::new(-0.52, -0.3), DVec2::new(0.52, 0.3), 0.1);
    let plate = Region {
        outline: rectangle(DVec2::new(-0.5, -0.28), DVec2::new(0.5, 0.28), 0.09),
        holes: plate_screws().into_iter().map(|place| circle(place, 1.1 * PLATE_SCREW, 20)).collect(),
    };
    Solid::of([extrude(&seat.into(), -0.08, 0.04, 0.01, PAINT), extrude(&plate, 0.035, PLATE, 0.01, STEEL)])
}

/// A name plate with raised lines and a rivet in each corner.
pub(crate) fn name_plate() -> Solid {
    let plate = rectangle(DVec2::new(-0.36, -0.2), DVec2::new(0.36, 0.2), 0.04);
    let mut bodies = vec![extrude(&plate.into(), -0.01, 0.02, 0.005, BRASS)];
    let bar = |x0: f64, y0: f64, x1: f64, y1: f64| {
        extrude(&rectangle(DVec2::new(x0, y0), DVec2::new(x1, y1), 0.0).into(), 0.01, 0.026, 0.003, DARK)
    };
    bodies.push(bar(-0.27, 0.05, 0.27, 0.12));
    bodies.push(bar(-0.27, -0.03, 0.1, 0.0));
    bodies.push(bar(-0.27, -0.1, 0.18, -0.07));
    for (x, y) in [(-0.32, -0.16), (0.32, -0.16), (0.32, 0.16), (-0.32, 0.16)] {
        let mut dome = vec![DVec2::ZERO, DVec2::new(0.022, 0.0)];
        dome.extend(arc(DVec2::new(0.0, 0.018), 0.022, 0.0, 0.45 * PI, 6));
        dome.push(DVec2::new(0.0, 0.04));
        bodies.push(turned(&dome, 24, STEEL).shifted(DVec3::new(x, y, 0.0)));
    }
    Solid::of(bodies)
}

/// A rubber pad under a foot, as thick as given.
pub(crate) fn pad(height: f64) -> Solid {
    let outline = rectangle(DVec2::new(-0.44, -0.4), DVec2::new(0.44, 0.4), 0.12);
    extrude(&outline.into(), 0.0, height, 0.012, RUBBER)
}

/// How long the crank is, from axis to axis.
pub(crate) const CRANK_LENGTH: f64 = 1.05;
/// How thick its arm is.
pub(crate) const CRANK_WIDTH: f64 = 0.16;

/// The arm of the crank. Its hub sits on the shaft at the origin, the handle's seat lies along x.
pub(crate) fn crank_arm() -> Solid {
    let mut points = circle(DVec2::ZERO, 0.29, 96);
    points.extend(circle(DVec2::X * CRANK_LENGTH, 0.14, 64));
    let arm = Region {
        outline: convex_hull(&points),
        holes: vec![circle(DVec2::ZERO, 0.2, 64), circle(DVec2::X * CRANK_LENGTH, 0.055, 32)],
    };
    let arm = extrude(&arm, 0.0, CRANK_WIDTH, 0.03, Paint { ends: BLUED, sides: BLUED, holes: STEEL });
    let hub = [
        (CRANK_SEAT, -0.05),
        (0.31, -0.05),
        (0.33, -0.03),
        (0.33, CRANK_WIDTH + 0.03),
        (0.31, CRANK_WIDTH + 0.05),
        (CRANK_SEAT, CRANK_WIDTH + 0.05),
    ];
    Solid::of([arm, ring_of(&hub.map(|(r, z)| DVec2::new(r, z)), 96, BLUED)])
}

/// The grip of the crank on its pin.
pub(crate) fn crank_grip() -> Solid {
    let pin = turned(
        &chamfered(&[
            (0.0, -CRANK_WIDTH - 0.03, 0.0),
            (0.05, -CRANK_WIDTH - 0.03, 0.01),
            (0.05, 0.1, 0.0),
            (0.0, 0.1, 0.0),
        ]),
        40,
        ZINC,
    );
    let steps = [
        (0.08, 0.02),
        (0.105, 0.035),
        (0.112, 0.1),
        (0.125, 0.2),
        (0.14, 0.32),
        (0.145, 0.42),
        (0.135, 0.52),
        (0.11, 0.59),
        (0.07, 0.635),
        (0.03, 0.65),
    ];
    let mut profile = vec![DVec2::new(0.0, 0.02)];
    // A smooth line through the steps: Catmull and Rom's spline.
    for i in 0..steps.len() - 1 {
        let at = |j: usize| DVec2::from(steps[j.min(steps.len() - 1)]);
        let [a, b, c, d] = [at(i.saturating_sub(1)), at(i), at(i + 1), at(i + 2)];
        for k in 0..4 {
            let t = f64::from(k) / 4.0;
            let bend = (b - c) * 1.5 + (d - a) * 0.5;
            profile.push(b + ((c - a) * 0.5 + (a - b * 2.5 + c * 2.0 - d * 0.5) * t + bend * (t * t)) * t);
        }
    }
    profile.push(DVec2::from(steps[steps.len() - 1]));
    profile.push(DVec2::new(0.0, 0.655));
    Solid::of([pin, turned(&profile, 64, RED)])
}

#[cfg(test)]
mod tests {
    use super::super::super::shape::check::volume;
    use super::*;

    #[test]
    fn fittings_are_closed() {
        let parts = [
            ("end cap", end_cap(&Bearing::SMALL, 0.0)),
            ("bored cap", end_cap(&Bearing::LARGE, 0.4)),
            ("half cap", half_cap(&Bearing::SMALL, 0.0)),
            ("sight glass", sight_glass()),
            ("plug", plug()),
            ("breather", breather()),
            ("lifting eye", lifting_eye()),
            ("inspection plate", inspection_plate()),
            ("name plate", name_plate()),
            ("crank arm", crank_arm()),
            ("crank grip", crank_grip()),
        ];
        for (name, part) in parts {
            let volume = volume(&part).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(volume > 0.0, "{name} is inside out");
        }
    }
}
