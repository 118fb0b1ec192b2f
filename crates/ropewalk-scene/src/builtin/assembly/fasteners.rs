//! Bolts, nuts, washers, pins and keys. Their axis is z; a head sits on the plane z = 0 and looks up.

use super::super::shape::lathe::{ring_of, turned};
use super::super::shape::outline::{arc, chamfered, circle, rounded};
use super::super::shape::sweep::{extrude, walls};
use super::super::shape::{Facing, Ring, Solid};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Segments of each side of a hexagon: enough for the curve in which a chamfer meets a flat.
const SIDE: u32 = 8;

/// Directions to points of a hexagon's outline and their distances, for a distance of 1 across half the flats.
fn hexagon() -> impl Iterator<Item = (DVec2, f64)> + Clone {
    (0..6 * SIDE).map(|i| {
        let side = f64::from(i / SIDE) * PI / 3.0;
        // Equal steps along the side, from corner to corner.
        let along = (2.0 * f64::from(i % SIDE) / f64::from(SIDE) - 1.0) * (PI / 6.0).tan();
        let point = DVec2::from_angle(side).rotate(DVec2::new(1.0, along));
        (point.normalize(), point.length())
    })
}

/// Rings of a hexagon prism whose corners a cone of 30 degrees has turned off: a round and a hexagonal one. `up`
/// is 1 for the upper end and -1 for the lower one, of which `z` is the height.
fn chamfered_end(solid: &mut Solid, flat: f64, z: f64, up: f64) -> [Ring; 2] {
    let round = 0.95 * flat;
    let slope = (PI / 6.0).tan();
    [
        solid.ring(hexagon().map(|(direction, _)| (direction * round).extend(z)).collect::<Vec<_>>()),
        solid.ring(
            hexagon()
                .map(|(direction, share)| {
                    let distance = share * flat;
                    (direction * distance).extend(z - up * slope * (distance - round))
                })
                .collect::<Vec<_>>(),
        ),
    ]
}

/// A bolt with a hexagon head. `radius` is that of the shank, `length` reaches from the head's seat to the tip.
pub(crate) fn hexagon_bolt(radius: f64, length: f64, material: u32) -> Solid {
    let (flat, height) = (1.6 * radius, 1.3 * radius);
    let seat = 0.06 * radius;
    let mut head = Solid::default();
    let [round, edge] = chamfered_end(&mut head, flat, height, 1.0);
    let low_edge: Vec<DVec3> =
        hexagon().map(|(direction, share)| (direction * share * flat).extend(seat)).collect();
    let low_edge = head.ring(low_edge);
    let washer = |z: f64| hexagon().map(move |(direction, _)| (direction * 0.93 * flat).extend(z));
    let face = head.ring(washer(seat).collect::<Vec<_>>());
    let base = head.ring(washer(0.0).collect::<Vec<_>>());
    let tip = head.vertex(DVec3::Z * height);
    let foot = head.vertex(DVec3::ZERO);
    head.cone(&round, tip, material);
    head.bridge(&edge, &round, material);
    head.bridge(&low_edge, &edge, material);
    head.bridge(&face, &low_edge, material);
    head.bridge(&base, &face, material);
    head.cone_below(&base, foot, material);
    let threaded = (2.5 * radius + 0.1).min(0.9 * length);
    let shank = turned(
        &chamfered(&[
            (0.0, -length + 0.5 * threaded, 0.0),
            (0.88 * radius, -length + 0.5 * threaded, 0.0),
            (0.88 * radius, -length + threaded, 0.0),
            (radius, -length + threaded + 0.12 * radius, 0.0),
            (radius, 0.02, 0.0),
            (0.0, 0.02, 0.0),
        ]),
        32,
        material,
    );
    Solid::of([head, shank, thread(radius, -length, -length + threaded, material)])
}

/// A threaded rod between two heights: its section is the same at every height, but turned. A cone has turned
/// off both ends, down to the core.
pub(crate) fn thread(radius: f64, bottom: f64, top: f64, material: u32) -> Solid {
    const AROUND: u32 = 20;
    const PER_TURN: f64 = 8.0;
    let pitch = 0.3 * radius;
    let core = radius - 0.6 * pitch;
    let steps = ((top - bottom) / pitch * PER_TURN).ceil().max(2.0) as u32;
    let mut solid = Solid::default();
    let turns: Vec<Ring> = (0..=steps)
        .map(|step| {
            let z = bottom + (top - bottom) * f64::from(step) / f64::from(steps);
            let cone = core + (z - bottom).min(top - z);
            let points = (0..AROUND).map(|i| {
                let share = f64::from(i) / f64::from(AROUND);
                let ridge = radius + (core - radius) * (2.0 * share - 1.0).abs();
                let angle = TAU * (share + (z - bottom) / pitch);
                (DVec2::from_angle(angle) * ridge.min(cone)).extend(z)
            });
            solid.ring(points)
        })
        .collect();
    walls(&mut solid, &turns, material);
    if let [first, .., last] = turns.as_slice() {
        solid.fill(first, &[], Facing::Down, material);
        solid.fill(last, &[], Facing::Up, material);
    }
    solid
}

/// A hexagon nut that stands on z = 0.
pub(crate) fn hexagon_nut(radius: f64, material: u32) -> Solid {
    let (flat, height, lead) = (1.6 * radius, 1.6 * radius, 0.1 * radius);
    let mut nut = Solid::default();
    let [top_round, top_edge] = chamfered_end(&mut nut, flat, height, 1.0);
    let [low_round, low_edge] = chamfered_end(&mut nut, flat, 0.0, -1.0);
    let mut bore = |r: f64, z: f64| {
        nut.ring(hexagon().map(|(direction, _)| (direction * r).extend(z)).collect::<Vec<_>>())
    };
    let inner = 0.9 * radius;
    let (top_lead, top_bore) = (bore(radius + lead, height), bore(inner, height - lead));
    let (low_bore, low_lead) = (bore(inner, lead), bore(radius + lead, 0.0));
    let rings = [&low_round, &low_edge, &top_edge, &top_round, &top_lead, &top_bore, &low_bore, &low_lead];
    for (i, ring) in rings.iter().enumerate() {
        nut.bridge(ring, rings[(i + 1) % rings.len()], material);
    }
    nut
}

/// A screw with a cylindrical head and a hexagon socket.
pub(crate) fn socket_screw(radius: f64, length: f64, material: u32) -> Solid {
    let (head, height, socket) = (1.5 * radius, 2.0 * radius, 0.85 * radius);
    let bevel = 0.18 * radius;
    let mut screw = Solid::default();
    let mut level = |r: f64, z: f64| screw.flat_ring(&circle(DVec2::ZERO, r, 48), z);
    let outside = [
        level(radius, -length),
        level(radius, 0.0),
        level(head - 0.5 * bevel, 0.0),
        level(head, 0.5 * bevel),
        level(head, height - bevel),
        level(head - bevel, height),
    ];
    let corner = |scale: f64| -> Vec<DVec2> {
        (0..6).rev().map(|i| DVec2::from_angle(f64::from(i) * PI / 3.0) * scale).collect()
    };
    let lip = screw.flat_ring(&corner(socket * 1.08), height);
    let edge = screw.flat_ring(&corner(socket), height - 0.08 * radius);
    let floor = screw.flat_ring(&corner(socket), height - 1.1 * radius);
    for pair in outside.windows(2) {
        screw.bridge(&pair[0], &pair[1], material);
    }
    screw.fill(&outside[0], &[], Facing::Down, material);
    screw.fill(&outside[5], &[&lip], Facing::Up, material);
    screw.bridge(&edge, &lip, material);
    screw.bridge(&floor, &edge, material);
    screw.fill(&floor, &[], Facing::Up, material);
    screw
}

/// A washer that lies on z = 0 under a bolt of that radius.
pub(crate) fn washer(radius: f64, material: u32) -> Solid {
    let (inner, outer, height, edge) = (1.08 * radius, 2.0 * radius, 0.32 * radius, 0.06 * radius);
    let corners = [
        (outer - edge, 0.0),
        (outer, edge),
        (outer, height - edge),
        (outer - edge, height),
        (inner + edge, height),
        (inner, height - edge),
        (inner, edge),
        (inner + edge, 0.0),
    ];
    ring_of(&corners.map(|(r, z)| DVec2::new(r, z)), 56, material)
}

/// How thick a washer is.
pub(crate) fn washer_height(radius: f64) -> f64 {
    0.32 * radius
}

/// A pin with round ends, standing in a hole: its middle is the origin.
pub(crate) fn dowel_pin(radius: f64, length: f64, material: u32) -> Solid {
    let half = length / 2.0;
    let dome = 0.35 * radius;
    let mut profile = vec![DVec2::new(0.0, -half)];
    let corner = |z: f64, from: f64, to: f64| arc(DVec2::new(radius - dome, z), dome, from, to, 5);
    profile.extend(corner(dome - half, -PI / 2.0, 0.0));
    profile.extend(corner(half - dome, 0.0, PI / 2.0));
    profile.push(DVec2::new(0.0, half));
    turned(&profile, 40, material)
}

/// A parallel key with round ends. It lies along z, `breadth` wide along x, from y = `bottom` to `top`.
pub(crate) fn key(breadth: f64, length: f64, bottom: f64, top: f64, material: u32) -> Solid {
    let (x, y) = (breadth / 2.0, length / 2.0);
    let outline = rounded(
        &[(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| (DVec2::new(x, y), 0.85 * breadth / 2.0)),
        8,
    );
    let lying = glam::DAffine3::from_rotation_x(-PI / 2.0);
    extrude(&outline.into(), bottom, top, 0.006, material).moved(&lying)
}

#[cfg(test)]
mod tests {
    use super::super::super::shape::check::volume;
    use super::*;

    #[test]
    fn parts_are_closed() {
        let parts = [
            ("bolt", hexagon_bolt(0.05, 0.4, 0)),
            ("nut", hexagon_nut(0.05, 0)),
            ("screw", socket_screw(0.04, 0.2, 0)),
            ("washer", washer(0.05, 0)),
            ("pin", dowel_pin(0.05, 0.3, 0)),
            ("key", key(0.1, 0.5, 0.2, 0.3, 0)),
            ("thread", thread(0.1, 0.0, 0.4, 0)),
        ];
        for (name, part) in parts {
            let volume = volume(&part).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(volume > 0.0, "{name} is inside out");
        }
    }

    #[test]
    fn a_head_is_a_hexagon_with_its_corners_turned_off() {
        let bolt = hexagon_bolt(0.1, 0.5, 0);
        let across_corners =
            bolt.positions.iter().map(|p| p.truncate().length()).fold(f64::NEG_INFINITY, f64::max);
        assert!((across_corners - 0.16 / (PI / 6.0).cos()).abs() < 1e-9);
        let top = bolt.positions.iter().filter(|p| p.z > 0.13 - 1e-9);
        assert!(top.map(|p| p.truncate().length()).fold(0.0, f64::max) < 0.16, "the top face is round");
    }
}
