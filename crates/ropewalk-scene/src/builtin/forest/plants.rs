//! What grows and lies under trees: grass, ferns, toadstools, stones.

use super::super::shape::Solid;
use super::super::shape::lathe::turned;
use super::super::shape::outline::arc;
use super::super::shape::primitives::icosphere;
use super::foliage::{Card, Foliage};
use super::{Random, unit_vector};
use glam::{DAffine3, DVec2, DVec3};
use rand::RngExt;
use std::f64::consts::{PI, TAU};

/// A tuft of grass: blades that bend over.
pub(crate) fn grass(blades: u32, height: f64, greens: [u32; 3], random: &mut Random) -> Foliage {
    let mut tuft = Foliage::default();
    for i in 0..blades {
        let angle = TAU * f64::from(i) / f64::from(blades) + random.random_range(-0.4..0.4);
        let out = DVec3::new(angle.cos(), 0.0, angle.sin());
        let foot = out * random.random_range(0.02..0.16) - DVec3::Y * 0.03;
        let length = height * random.random_range(0.5..1.1);
        let along = (DVec3::Y + out * random.random_range(0.1..0.7)).normalize() * length;
        let aside = out.cross(DVec3::Y) + out * random.random_range(-0.5..0.5);
        let card = Card {
            foot,
            along,
            across: aside * random.random_range(0.008..0.014),
            fold: 0.6,
            material: greens[random.random_range(0..3)],
        };
        tuft.card(&card, DVec3::Y + out * 0.3);
    }
    tuft
}

/// A fern: fronds in a rosette, leaflets in pairs along each.
pub(crate) fn fern(fronds: u32, length: f64, greens: [u32; 3], random: &mut Random) -> Foliage {
    let mut fern = Foliage::default();
    for i in 0..fronds {
        let angle = TAU * (f64::from(i) + random.random_range(-0.25..0.25)) / f64::from(fronds);
        let out = DVec3::new(angle.cos(), 0.0, angle.sin());
        let length = length * random.random_range(0.75..1.1);
        let material = greens[random.random_range(0..3)];
        let at =
            |share: f64| (out * (0.85 * share) + DVec3::Y * (1.15 * share - 0.95 * share * share)) * length;
        let aside = out.cross(DVec3::Y);
        for step in 1..14 {
            let share = f64::from(step) / 14.0;
            let size = 0.26 * length * (share * PI).sin().powf(0.7) * (1.15 - 0.5 * share);
            let forward = (at(share + 0.05) - at(share)).normalize();
            for side in [-1.0, 1.0] {
                let along = (aside * side + forward * 0.45 - DVec3::Y * 0.15).normalize() * size;
                let card =
                    Card { foot: at(share), along, across: forward * (0.2 * size), fold: 0.1, material };
                fern.card(&card, DVec3::Y + out * 0.4);
            }
        }
    }
    fern
}

/// A toadstool: a spotted cap on a stem. Its stem and spots have one material, its cap another.
pub(crate) fn toadstool(height: f64, cap: u32, stem: u32, gills: u32) -> Solid {
    let (radius, rim) = (0.62 * height, 0.68 * height);
    let stem_line =
        [(0.0, -0.1), (0.17, -0.1), (0.19, 0.03), (0.15, 0.12), (0.11, 0.4), (0.10, 0.72), (0.0, 0.72)];
    let stem_solid = turned(&stem_line.map(|(r, z)| DVec2::new(r, z) * height), 20, stem);
    let mut dome = vec![DVec2::new(0.0, rim), DVec2::new(0.85 * radius, rim - 0.05 * height)];
    dome.extend(
        arc(DVec2::new(0.0, rim), radius, 0.0, 0.47 * PI, 9)
            .iter()
            .map(|p| DVec2::new(p.x, rim + (p.y - rim) * 0.68)),
    );
    dome.push(DVec2::new(0.0, rim + 0.68 * radius));
    let mut cap_solid = turned(&dome, 24, cap);
    // The first ring of the profile is the edge of the gills: what lies below the rim looks down.
    for (triangle, material) in cap_solid.triangles.iter().zip(&mut cap_solid.materials) {
        if triangle.iter().all(|&vertex| cap_solid.positions[vertex as usize].z <= rim + 1e-9) {
            *material = gills;
        }
    }
    let mut bodies = vec![stem_solid, cap_solid];
    for (ring, (count, tilt)) in [(1, 0.12), (4, 0.62), (7, 1.12)].into_iter().enumerate() {
        for i in 0..count {
            let angle = TAU * f64::from(i) / f64::from(count) + 0.8 * ring as f64;
            let (sin, cos) = f64::sin_cos(tilt);
            let place = DVec3::new(sin * angle.cos(), sin * angle.sin(), 0.68 * cos) * radius;
            let size = radius * (0.13 - 0.02 * ring as f64);
            bodies.push(icosphere(size, 1, stem).shifted(place + DVec3::Z * rim));
        }
    }
    Solid::of(bodies).moved(&DAffine3::from_rotation_x(-PI / 2.0))
}

/// A stone: a ball with dents, sunk into the ground.
pub(crate) fn stone(size: f64, material: u32, random: &mut Random) -> Solid {
    let mut stone = icosphere(1.0, 3, material);
    let dents: Vec<(DVec3, f64)> =
        (0..9).map(|_| (unit_vector(random), random.random_range(0.55..0.95))).collect();
    let stretch = DVec3::new(random.random_range(0.9..1.4), random.random_range(0.55..0.8), 1.0) * size;
    for position in &mut stone.positions {
        let mut reach: f64 = 1.0;
        for &(direction, depth) in &dents {
            // Each dent is a plane that shaves the ball, and a little is left standing.
            let toward = position.dot(direction);
            if toward > depth {
                reach = reach.min(0.12 + 0.88 * depth / toward);
            }
        }
        *position = *position * reach * stretch + DVec3::Y * (0.3 * stretch.y);
    }
    stone
}

#[cfg(test)]
mod tests {
    use super::super::super::shape::check::volume;
    use super::*;

    #[test]
    fn bodies_are_closed() {
        assert!(volume(&toadstool(0.2, 0, 1, 2)).unwrap() > 0.0);
        let mut random = super::super::random(3);
        for _ in 0..5 {
            assert!(volume(&stone(0.5, 0, &mut random)).unwrap() > 0.1);
        }
        assert_eq!(grass(20, 0.4, [0, 1, 2], &mut random).solid.triangles.len(), 40);
    }
}
