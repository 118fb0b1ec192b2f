//! Surfaces of revolution about the z axis.
//!
//! A profile is a path of points (radius, z) with the material on its left. A path that starts and ends on
//! the axis makes a shaft or a disc; one that closes in itself makes a ring.

use super::fill::signed_area;
use super::{Ring, Solid, successors};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

fn point(profile: DVec2, angle: f64) -> DVec3 {
    (DVec2::from_angle(angle) * profile.x).extend(profile.y)
}

fn ring(solid: &mut Solid, profile: DVec2, segments: u32) -> Ring {
    solid.ring(
        (0..segments).map(|i| point(profile, TAU * f64::from(i) / f64::from(segments))).collect::<Vec<_>>(),
    )
}

/// A body turned from a path that starts on the axis below and ends on the axis above.
pub(crate) fn turned(profile: &[DVec2], segments: u32, material: u32) -> Solid {
    let mut solid = Solid::default();
    let [bottom, between @ .., top] = profile else { return solid };
    let rings: Vec<Ring> = between.iter().map(|&p| ring(&mut solid, p, segments)).collect();
    let (Some(first), Some(last)) = (rings.first(), rings.last()) else { return solid };
    super::sweep::walls(&mut solid, &rings, material);
    let bottom = solid.vertex(point(*bottom, 0.0));
    solid.cone_below(first, bottom, material);
    let top = solid.vertex(point(*top, 0.0));
    solid.cone(last, top, material);
    solid
}

/// A ring turned from a closed profile that stays clear of the axis.
pub(crate) fn ring_of(profile: &[DVec2], segments: u32, material: u32) -> Solid {
    let mut solid = Solid::default();
    let profile = counter_clockwise(profile);
    let rings: Vec<Ring> = profile.iter().map(|&p| ring(&mut solid, p, segments)).collect();
    for (i, j) in successors(rings.len()) {
        solid.bridge(&rings[i], &rings[j], material);
    }
    solid
}

/// A part of a ring, from angle to angle, with plane faces in another material where it was cut.
pub(crate) fn ring_sector(
    profile: &[DVec2],
    from: f64,
    to: f64,
    segments: u32,
    material: u32,
    cut: u32,
) -> Solid {
    let mut solid = Solid::default();
    let profile = counter_clockwise(profile);
    let slices: Vec<Ring> = (0..=segments)
        .map(|i| {
            let angle = from + (to - from) * f64::from(i) / f64::from(segments);
            solid.ring(profile.iter().map(|&p| point(p, angle)).collect::<Vec<_>>())
        })
        .collect();
    for pair in slices.windows(2) {
        // The walk along a slice with the next one overhead has the outside on its left.
        solid.bridge(&pair[1], &pair[0], material);
    }
    let radial = |angle: f64| DVec2::from_angle(angle).extend(0.0);
    if let [first, .., last] = slices.as_slice() {
        solid.fill_plane(&[first], radial(from), DVec3::Z, cut);
        solid.fill_plane(&[last], DVec3::Z, radial(to), cut);
    }
    solid
}

fn counter_clockwise(profile: &[DVec2]) -> Vec<DVec2> {
    let mut profile = profile.to_vec();
    if signed_area(&profile) < 0.0 {
        profile.reverse();
    }
    profile
}

#[cfg(test)]
mod tests {
    use super::super::check::volume;
    use super::super::outline::{circle, rectangle};
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn turned_bodies_are_closed_and_of_the_right_volume() {
        let profile = [(0.0, -1.0), (2.0, -1.0), (2.0, 1.0), (0.0, 1.0)].map(|(r, z)| DVec2::new(r, z));
        assert!((volume(&turned(&profile, 500, 0)).unwrap() - 8.0 * PI).abs() < 0.01);
        let torus = circle(DVec2::new(3.0, 0.0), 1.0, 200);
        let exact = 6.0 * PI * PI;
        assert!((volume(&ring_of(&torus, 200, 0)).unwrap() - exact).abs() < 0.05);
        let quarter = volume(&ring_sector(&torus, 0.3, 0.3 + PI / 2.0, 100, 0, 1)).unwrap();
        assert!((quarter - exact / 4.0).abs() < 0.05);
    }

    #[test]
    fn the_direction_of_a_closed_profile_does_not_matter() {
        let mut profile = rectangle(DVec2::new(1.0, 0.0), DVec2::new(2.0, 1.0), 0.0);
        let one = volume(&ring_of(&profile, 32, 0)).unwrap();
        profile.reverse();
        let other = volume(&ring_of(&profile, 32, 0)).unwrap();
        assert!(one > 0.0 && (one - other).abs() < 1e-12);
    }
}
