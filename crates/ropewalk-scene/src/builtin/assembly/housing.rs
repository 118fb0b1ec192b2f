//! The cast housing, split in the plane of the shafts, y = 0: a trough below, and a cover that is cut open.
//!
//! Each half is made of closed bodies that run into each other as the walls of a casting do: a shell along
//! the shafts, two end walls with half round seats, bosses around the seats, flanges with bolt holes, feet.

use super::super::shape::Solid;
use super::super::shape::cut::{Plane, cut};
use super::super::shape::outline::{arc, circle, convex_hull, half_ring, rectangle, rounded};
use super::super::shape::sweep::{Paint, Region, extrude};
use super::bearing::Bearing;
use super::palette::{CUT, PAINT};
use super::train::{INPUT_X, MIDDLE_X, OUTPUT_X};
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::PI;

/// Half the length of the inside along the shafts.
pub(crate) const INSIDE: f64 = 0.95;
/// The thickness of the end walls.
const END_WALL: f64 = 0.18;
/// Where the end walls end.
pub(crate) const END: f64 = INSIDE + END_WALL;
/// Where the bosses around the bearings end.
pub(crate) const BOSS_END: f64 = END + 0.2;
/// The thickness of the shell.
const SHELL: f64 = 0.16;
/// How far the flanges stand out, and how thick each is.
const FLANGE: f64 = 0.28;
/// The thickness of a flange.
pub(crate) const FLANGE_HEIGHT: f64 = 0.13;
/// The radius of the bolts through the flanges.
pub(crate) const FLANGE_BOLT: f64 = 0.05;
/// The radius of the bolts in the feet.
pub(crate) const FOOT_BOLT: f64 = 0.075;
/// The clearance of a bolt in its hole, as a factor.
const HOLE: f64 = 1.12;
/// The trough's underside, and that of its feet.
const BOTTOM: f64 = -1.78;
/// The underside of the feet.
pub(crate) const FEET_BOTTOM: f64 = -1.96;
/// The upper side of the feet.
pub(crate) const FEET_TOP: f64 = -1.78;
const CHAMFER: f64 = 0.02;

/// The seats: where, and how large the bearing, its boss and the room for the gear above it are.
const SEATS: [(f64, Bearing, f64); 3] =
    [(INPUT_X, Bearing::SMALL, 0.75), (MIDDLE_X, Bearing::SMALL, 1.36), (OUTPUT_X, Bearing::LARGE, 1.52)];

/// The thickness of a boss around its bearing.
pub(crate) const BOSS: f64 = 0.14;

const LEFT: f64 = INPUT_X - SEATS[0].2 - SHELL;
const RIGHT: f64 = OUTPUT_X + SEATS[2].2 + SHELL;

/// The places (x, z) of the bolts in the flanges.
pub(crate) fn flange_bolts() -> Vec<DVec2> {
    let (left, right, along) = (LEFT - FLANGE / 2.0, RIGHT + FLANGE / 2.0, END + FLANGE / 2.0);
    let gap = |i: usize, j: usize| (SEATS[i].0 + SEATS[i].1.outer + SEATS[j].0 - SEATS[j].1.outer) / 2.0;
    let mut places = Vec::new();
    for z in [-along, along] {
        places.extend([left, gap(0, 1), gap(1, 2), RIGHT - 0.42, right].map(|x| DVec2::new(x, z)));
    }
    for z in [-0.45, 0.45] {
        places.extend([left, right].map(|x| DVec2::new(x, z)));
    }
    places
}

/// The places (x, z) of the dowel pins in the flanges.
pub(crate) fn flange_pins() -> [DVec2; 2] {
    [DVec2::new(LEFT - FLANGE / 2.0, 0.86), DVec2::new(RIGHT + FLANGE / 2.0, -0.86)]
}

/// The places (x, z) of the feet's bolts.
pub(crate) fn foot_bolts() -> [DVec2; 4] {
    let (x, z) = (2.5, END + 0.26);
    [(-x, -z), (x, -z), (x, z), (-x, z)].map(|(x, z)| DVec2::new(x, z))
}

/// The plane in which the cover is cut: what is nearer to the viewer is gone.
pub(crate) fn section() -> Plane {
    Plane::through(DVec3::new(0.0, 0.0, -0.3), DVec3::new(-0.12, 0.0, 1.0))
}

/// Turns a body that was extruded along z so that it stands along y, its outline's y pointing to the front.
fn upright(solid: Solid) -> Solid {
    solid.moved(&DAffine3::from_rotation_x(-PI / 2.0))
}

/// The outlines (x, -z) of the flange's pieces: between the bosses, and around the two short ends.
fn flange_pieces() -> Vec<Vec<DVec2>> {
    let (inner, outer) = (INSIDE + 0.02, END + FLANGE);
    let boss = |i: usize, side: f64| SEATS[i].0 + side * (SEATS[i].1.outer + 0.6 * BOSS);
    let mut pieces = Vec::new();
    for (i, j) in [(0, 1), (1, 2)] {
        let (from, to) = (boss(i, 1.0), boss(j, -1.0));
        pieces.push(rectangle(DVec2::new(from, inner), DVec2::new(to, outer), 0.0));
        pieces.push(rectangle(DVec2::new(from, -outer), DVec2::new(to, -inner), 0.0));
    }
    let corner = 0.2;
    let (edge, wall, end) = (LEFT - FLANGE, LEFT + SHELL - 0.02, boss(0, -1.0));
    pieces.push(end_piece(edge, wall, end, inner, outer, corner));
    let (edge, wall, end) = (RIGHT + FLANGE, RIGHT - SHELL + 0.02, boss(2, 1.0));
    pieces.push(end_piece(edge, wall, end, inner, outer, corner));
    pieces
}

/// A bracket that reaches from the edge around the short end of the housing to the first boss on either side.
fn end_piece(edge: f64, wall: f64, end: f64, inner: f64, outer: f64, corner: f64) -> Vec<DVec2> {
    let corners = [
        (edge, -outer, corner),
        (end, -outer, 0.0),
        (end, -inner, 0.0),
        (wall, -inner, 0.05),
        (wall, inner, 0.05),
        (end, inner, 0.0),
        (end, outer, 0.0),
        (edge, outer, corner),
    ];
    rounded(&corners.map(|(x, y, radius)| (DVec2::new(x, y), radius)), 8)
}

/// The flanges of one half, between two heights, with the holes for bolts and pins.
fn flanges(bottom: f64, top: f64) -> Vec<Solid> {
    let places: Vec<(DVec2, f64)> = flange_bolts()
        .into_iter()
        .map(|place| (place, HOLE * FLANGE_BOLT))
        .chain(flange_pins().map(|place| (place, 0.04)))
        .collect();
    flange_pieces()
        .into_iter()
        .map(|outline| {
            let holes = places
                .iter()
                .map(|&(place, radius)| (DVec2::new(place.x, -place.y), radius))
                .filter(|&(center, _)| super::super::shape::outline::contains(&outline, center))
                .map(|(center, radius)| circle(center, radius, 32))
                .collect();
            upright(extrude(&Region { outline, holes }, bottom, top, CHAMFER, PAINT))
        })
        .collect()
}

/// Half round bites at y = 0 along the way from one x to the other, for a wall above or below.
fn seats(points: &mut Vec<DVec2>, rightwards: bool) {
    let mut order: Vec<usize> = vec![0, 1, 2];
    let (from, to) = if rightwards { (PI, 0.0) } else { (0.0, -PI) };
    if !rightwards {
        order.reverse();
    }
    for i in order {
        points.extend(arc(DVec2::new(SEATS[i].0, 0.0), SEATS[i].1.outer, from, to, 48));
    }
}

/// The half bosses of one half of the housing.
fn bosses(below: bool) -> impl Iterator<Item = Solid> {
    SEATS.into_iter().flat_map(move |(x, bearing, _)| {
        [-1.0, 1.0].map(|side: f64| {
            let outline = half_ring(DVec2::new(x, 0.0), bearing.outer, bearing.outer + BOSS, below, 64);
            let (a, b) = (side * (INSIDE - 0.03), side * BOSS_END);
            extrude(&outline.into(), a.min(b), a.max(b), CHAMFER, PAINT)
        })
    })
}

/// The lower half. Windows in its front wall let one look at the wheels.
pub(crate) fn trough() -> Solid {
    let corner = 0.34;
    let mut outline = rounded(
        &[(LEFT, 0.0, 0.0), (LEFT, BOTTOM, corner), (RIGHT, BOTTOM, corner), (RIGHT, 0.0, 0.0)]
            .map(|(x, y, radius)| (DVec2::new(x, y), radius)),
        12,
    );
    let mut shell = outline.clone();
    let (left, right, floor) = (LEFT + SHELL, RIGHT - SHELL, BOTTOM + 0.2);
    shell.extend(rounded(
        &[(right, 0.0, 0.0), (right, floor, corner - SHELL), (left, floor, corner - SHELL), (left, 0.0, 0.0)]
            .map(|(x, y, radius)| (DVec2::new(x, y), radius)),
        12,
    ));
    seats(&mut outline, false);
    let wall = |windows: Vec<Vec<DVec2>>, from: f64, to: f64| {
        let region = Region { outline: outline.clone(), holes: windows };
        extrude(&region, from, to, CHAMFER, Paint { ends: PAINT, sides: PAINT, holes: CUT })
    };
    let mut bodies = vec![
        extrude(&shell.into(), -INSIDE - 0.06, INSIDE + 0.06, 0.0, PAINT),
        wall(windows(), INSIDE, END),
        wall(Vec::new(), -END, -INSIDE),
    ];
    bodies.extend(bosses(true));
    bodies.extend(flanges(-FLANGE_HEIGHT, 0.0));
    bodies.extend(feet());
    Solid::of(bodies)
}

/// The windows: pieces of rings around two of the shafts.
fn windows() -> Vec<Vec<DVec2>> {
    let window = |x: f64, inner: f64, outer: f64, from: f64, to: f64| {
        let center = DVec2::new(x, 0.0);
        let (from, to) = (from.to_radians(), to.to_radians());
        let mut points = arc(center, outer, from, to, 40);
        points.extend(arc(center, inner, to, from, 40));
        points
    };
    vec![window(OUTPUT_X, 1.0, 1.42, 212.0, 328.0), window(MIDDLE_X, 0.86, 1.28, 205.0, 284.0)]
}

/// Feet with bolt holes, and ribs that carry the wall on them.
fn feet() -> Vec<Solid> {
    let mut bodies = Vec::new();
    for place in foot_bolts() {
        let out = place.y.signum();
        let (inner, outer) = (out * (INSIDE - 0.25), out * (END + 0.5));
        let (low, high) = (-inner.max(outer), -inner.min(outer));
        let outline = rectangle(DVec2::new(place.x - 0.42, low), DVec2::new(place.x + 0.42, high), 0.12);
        let hole = circle(DVec2::new(place.x, -place.y), HOLE * FOOT_BOLT, 40);
        let foot = extrude(&Region { outline, holes: vec![hole] }, FEET_BOTTOM, FEET_TOP, CHAMFER, PAINT);
        bodies.push(upright(foot));
        for side in [-0.3, 0.3] {
            let wall = END - 0.05;
            let rib = [
                (wall, FEET_TOP - 0.03),
                (END + 0.42, FEET_TOP - 0.03),
                (END + 0.36, FEET_TOP + 0.06),
                (wall, FEET_TOP + 0.75),
            ];
            let rib: Vec<DVec2> = rib.map(|(z, y)| DVec2::new(z, y)).into();
            let rib = extrude(&rib.into(), -0.05, 0.05, 0.015, PAINT);
            // From (out, up, breadth) to (x, y, z): a turn about y, to the front or to the back.
            let turn = DAffine3::from_rotation_y(-out * PI / 2.0);
            bodies.push(rib.moved(&turn).shifted(DVec3::new(place.x + side, 0.0, 0.0)));
        }
    }
    bodies
}

/// The outline of the cover above y = 0, left to right over the top, drawn in by a distance.
fn arch(inside: bool) -> Vec<DVec2> {
    let mut points = Vec::new();
    for (x, _, room) in SEATS {
        points.extend(circle(DVec2::new(x, 0.0), room + if inside { 0.0 } else { SHELL }, 160));
    }
    let hull = convex_hull(&points);
    let mut above: Vec<DVec2> = hull.into_iter().filter(|point| point.y > 1e-6).collect();
    above.sort_by(|a, b| b.to_angle().total_cmp(&a.to_angle()));
    let (left, right) = if inside { (LEFT + SHELL, RIGHT - SHELL) } else { (LEFT, RIGHT) };
    above.insert(0, DVec2::new(left, 0.0));
    above.push(DVec2::new(right, 0.0));
    above
}

/// The highest point of the cover's outside at some x.
pub(crate) fn cover_height(x: f64) -> f64 {
    let arch = arch(false);
    arch.windows(2)
        .find(|pair| pair[0].x <= x && x <= pair[1].x)
        .map_or(0.0, |pair| pair[0].y + (pair[1].y - pair[0].y) * (x - pair[0].x) / (pair[1].x - pair[0].x))
}

/// The upper half, cut open.
pub(crate) fn cover() -> Solid {
    let outside: Vec<DVec2> = arch(false).into_iter().rev().collect();
    let mut shell = outside.clone();
    shell.extend(arch(true));
    let mut wall = outside;
    seats(&mut wall, true);
    let mut bodies = vec![
        extrude(&shell.into(), -INSIDE - 0.06, INSIDE + 0.06, 0.0, PAINT),
        extrude(&wall.clone().into(), INSIDE, END, CHAMFER, PAINT),
        extrude(&wall.into(), -END, -INSIDE, CHAMFER, PAINT),
    ];
    bodies.extend(bosses(false));
    bodies.extend(flanges(0.0, FLANGE_HEIGHT));
    let section = section();
    Solid::of(bodies.iter().map(|body| cut(body, &section, CUT)))
}

#[cfg(test)]
mod tests {
    use super::super::super::shape::check::volume;
    use super::*;

    #[test]
    fn both_halves_are_closed() {
        let trough = trough();
        assert!(volume(&trough).unwrap() > 1.0);
        let cover = cover();
        assert!(volume(&cover).unwrap() > 1.0);
        assert!(cover.materials.contains(&CUT) && trough.materials.contains(&CUT));
        assert!(cover.positions.iter().all(|&position| section().beyond(position) < 1e-9));
    }

    #[test]
    fn every_hole_lies_in_a_flange() {
        for place in flange_bolts().into_iter().chain(flange_pins()) {
            let pieces = flange_pieces();
            let at = DVec2::new(place.x, -place.y);
            let around = circle(at, 2.0 * FLANGE_BOLT, 16);
            let held = pieces.iter().filter(|piece| {
                around.iter().all(|&p| super::super::super::shape::outline::contains(piece, p))
            });
            assert_eq!(held.count(), 1, "{place}");
        }
    }
}
