//! A clearing in a forest: the scene that makes rays walk far.
//!
//! Tens of thousands of small leaves and blades in all directions fill their boxes badly, so a ray enters
//! many boxes and hits little: the opposite of a scene of walls. Everything grows from seeds of fixed value;
//! kinds of plants are objects, and plants are instances of them, each turned and scaled its own way. One unit is
//! a metre.

mod foliage;
mod plants;
mod terrain;
mod tree;

use super::stage::{Stage, camera, material};
use crate::{Light, Material, Model};
use foliage::Foliage;
use glam::{DAffine3, DQuat, DVec2, DVec3, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::TAU;
use tree::{Habit, Tree};

type Random = Pcg64Mcg;

fn random(seed: u64) -> Random {
    Random::seed_from_u64(seed)
}

/// A direction, all equally likely.
fn unit_vector(random: &mut Random) -> DVec3 {
    let (y, angle) = (random.random_range(-1.0..1.0_f64), random.random_range(0.0..TAU));
    let flat = (1.0 - y * y).sqrt();
    DVec3::new(flat * angle.cos(), y, flat * angle.sin())
}

const MEADOW: u32 = 0;
const EARTH: u32 = 1;
const BARK: u32 = 2;
const BIRCH_BARK: u32 = 3;
const CUT_WOOD: u32 = 4;
const STONE: u32 = 5;
const CAP: u32 = 6;
const STEM: u32 = 7;
const OAK_GREENS: [u32; 3] = [8, 9, 10];
const BIRCH_GREENS: [u32; 3] = [11, 12, 13];
const FIR_GREENS: [u32; 3] = [14, 15, 16];
const GRASS_GREENS: [u32; 3] = [17, 18, 19];

fn materials() -> Vec<Material> {
    [
        ("meadow", [0.13, 0.21, 0.045]),
        ("earth", [0.26, 0.18, 0.10]),
        ("bark", [0.17, 0.115, 0.07]),
        ("birch bark", [0.62, 0.60, 0.55]),
        ("cut wood", [0.58, 0.40, 0.20]),
        ("stone", [0.34, 0.34, 0.33]),
        ("toadstool cap", [0.62, 0.045, 0.025]),
        ("toadstool stem", [0.78, 0.74, 0.64]),
        ("oak leaf, dark", [0.085, 0.20, 0.035]),
        ("oak leaf", [0.125, 0.26, 0.045]),
        ("oak leaf, light", [0.18, 0.33, 0.06]),
        ("birch leaf, dark", [0.21, 0.34, 0.06]),
        ("birch leaf", [0.30, 0.42, 0.07]),
        ("birch leaf, yellow", [0.50, 0.44, 0.07]),
        ("fir needle, dark", [0.028, 0.095, 0.055]),
        ("fir needle", [0.04, 0.125, 0.065]),
        ("fir needle, light", [0.065, 0.165, 0.075]),
        ("grass, dark", [0.11, 0.23, 0.035]),
        ("grass", [0.17, 0.32, 0.05]),
        ("grass, light", [0.27, 0.39, 0.08]),
    ]
    .map(|(name, color)| material(name, color, 0.9, 0.0))
    .into()
}

/// A broad tree with a short trunk and a wide crown.
const OAK: Habit = Habit {
    trunk_height: 6.4,
    trunk_radius: 0.36,
    bare: 0.36,
    levels: 3,
    forks: 4,
    spread: 0.95,
    shortening: 0.56,
    crooked: 0.16,
    rise: 0.28,
    leaves_per_twig: 10,
    leaf_length: 0.31,
    bark: BARK,
    greens: OAK_GREENS,
};

/// A slender tree with a white trunk and twigs that hang.
const BIRCH: Habit = Habit {
    trunk_height: 8.6,
    trunk_radius: 0.17,
    bare: 0.34,
    levels: 2,
    forks: 8,
    spread: 0.8,
    shortening: 0.27,
    crooked: 0.09,
    rise: -0.15,
    leaves_per_twig: 10,
    leaf_length: 0.21,
    bark: BIRCH_BARK,
    greens: BIRCH_GREENS,
};

/// Stems that fork at the ground.
const BUSH: Habit = Habit {
    trunk_height: 0.9,
    trunk_radius: 0.035,
    bare: 0.2,
    levels: 2,
    forks: 4,
    spread: 0.85,
    shortening: 0.72,
    crooked: 0.2,
    rise: 0.25,
    leaves_per_twig: 10,
    leaf_length: 0.11,
    bark: BARK,
    greens: OAK_GREENS,
};

/// Where the eye stands, seen from above.
const EYE: DVec2 = DVec2::new(-2.6, 10.5);

/// The scene.
pub(crate) fn forest() -> Model {
    let mut forest = Forest { stage: Stage::new(materials()), taken: Vec::new(), random: random(2010) };
    let ground = forest.stage.part("ground", &terrain::surface(MEADOW));
    let path = forest.stage.part("path", &terrain::trail(EARTH));
    for object in [ground, path] {
        forest.stage.place(object, &DAffine3::IDENTITY);
    }
    forest.things();
    forest.trees();
    forest.undergrowth();
    forest.grass();
    let height = |x: f64, z: f64| terrain::height(x, z) as f32;
    let eye = [EYE.x as f32, height(EYE.x, EYE.y) + 1.65, EYE.y as f32];
    forest.stage.finish(
        camera("eye height", eye, [0.7, height(0.7, -4.0) + 1.9, -4.0], 50.0),
        Light::Sun { direction: Vec3::new(0.7, -1.0, -0.42), color: Vec3::new(1.0, 0.93, 0.78) * 3.2 },
    )
}

/// The forest in the making.
struct Forest {
    stage: Stage,
    /// The places that are taken, each with a radius.
    taken: Vec<(DVec2, f64)>,
    random: Random,
}

impl Forest {
    fn tree(&mut self, name: &str, tree: &Tree) -> u32 {
        let normals = super::shape::normals::smooth(&tree.wood, 1.2);
        let leaves = (&tree.leaves.solid, Some(tree.leaves.normals()));
        self.stage.parts(name, &[(&tree.wood, Some(normals)), leaves])
    }

    fn foliage(&mut self, name: &str, foliage: &Foliage) -> u32 {
        self.stage.parts(name, &[(&foliage.solid, Some(foliage.normals()))])
    }

    /// Plants an object at a place, turned and scaled at random.
    fn plant(&mut self, object: u32, place: DVec2, scale: std::ops::Range<f64>) {
        let scale = self.random.random_range(scale);
        let turn = DQuat::from_rotation_y(self.random.random_range(0.0..TAU));
        let point = DVec3::new(place.x, terrain::height(place.x, place.y), place.y);
        self.stage
            .place(object, &DAffine3::from_scale_rotation_translation(DVec3::splat(scale), turn, point));
    }

    /// A free place at a distance from the middle, if one is found soon; it is taken from then on.
    fn free_place(&mut self, distances: std::ops::Range<f64>, room: f64) -> Option<DVec2> {
        for _ in 0..40 {
            // The square root spreads places evenly over the area.
            let (near, far) = (distances.start * distances.start, distances.end * distances.end);
            let distance = self.random.random_range(near..far).sqrt();
            let place = DVec2::from_angle(self.random.random_range(0.0..TAU)) * distance;
            let off_path = terrain::from_path(place.x, place.y) > 0.9 + 0.3 * room;
            let in_sight = place.distance(EYE) > 1.2 + 1.6 * room;
            let free = self.taken.iter().all(|&(other, radius)| other.distance(place) > radius + room);
            if off_path && in_sight && free {
                self.taken.push((place, room));
                return Some(place);
            }
        }
        None
    }

    /// Stones, a log, and a ring of toadstools.
    fn things(&mut self) {
        let log = self.stage.part("fallen log", &tree::log(3.2, 0.3, BARK, CUT_WOOD));
        let place = DVec2::new(3.1, 1.6);
        let point = DVec3::new(place.x, terrain::height(place.x, place.y) - 0.03, place.y);
        self.stage.place(log, &DAffine3::from_rotation_translation(DQuat::from_rotation_y(0.55), point));
        self.taken.extend([-1.0, 0.0, 1.0].map(|step| (place + DVec2::new(0.85, -0.52) * step, 0.5)));
        let toadstool = self.stage.part("toadstool", &plants::toadstool(0.24, CAP, STEM, STEM));
        for i in 0..17 {
            let angle = TAU * f64::from(i) / 17.0 + self.random.random_range(-0.1..0.1);
            let place = DVec2::new(-1.9, 5.0) + DVec2::from_angle(angle) * self.random.random_range(0.8..1.0);
            self.taken.push((place, 0.12));
            self.plant(toadstool, place, 0.5..1.2);
        }
        for kind in 0..3 {
            let mut seeds = random(50 + kind);
            let stone = self.stage.part(&format!("stone {kind}"), &plants::stone(0.5, STONE, &mut seeds));
            for _ in 0..8 {
                if let Some(place) = self.free_place(4.0..22.0, 0.5) {
                    self.plant(stone, place, 0.3..1.3);
                }
            }
        }
    }

    fn trees(&mut self) {
        let oak = self.tree("oak", &tree::broad_leaved(&OAK, &mut random(11)));
        let old_oak = self.tree(
            "old oak",
            &tree::broad_leaved(&Habit { crooked: 0.24, bare: 0.28, ..OAK }, &mut random(12)),
        );
        let birch = self.tree("birch", &tree::broad_leaved(&BIRCH, &mut random(13)));
        let fir = self.tree("fir", &tree::fir(9.0, BARK, FIR_GREENS, &mut random(14)));
        let young_fir = self.tree("young fir", &tree::fir(5.5, BARK, FIR_GREENS, &mut random(15)));
        // Near the clearing each tree has its place in the picture; further away chance decides.
        for (object, x, z) in [
            (old_oak, -5.6, 0.2),
            (birch, 6.6, 4.0),
            (birch, 7.9, 0.6),
            (oak, 5.6, -6.4),
            (birch, -1.9, -7.4),
            (fir, 1.8, -9.8),
            (fir, -8.4, -5.4),
            (oak, -8.6, 6.2),
        ] {
            let place = DVec2::new(x, z);
            self.taken.push((place, 1.6));
            self.plant(object, place, 0.9..1.15);
        }
        for i in 0..66 {
            let object = [oak, young_fir, birch, young_fir, fir, old_oak][i % 6];
            if let Some(place) = self.free_place(9.0..38.0, 1.7) {
                self.plant(object, place, 0.75..1.4);
            }
        }
    }

    fn undergrowth(&mut self) {
        let bush = self.tree("bush", &tree::broad_leaved(&BUSH, &mut random(21)));
        let wide = Habit { spread: 1.1, greens: BIRCH_GREENS, leaf_length: 0.09, ..BUSH };
        let wide = self.tree("wide bush", &tree::broad_leaved(&wide, &mut random(22)));
        let fern = self.foliage("fern", &plants::fern(11, 0.8, GRASS_GREENS, &mut random(23)));
        for i in 0..40 {
            let object = [bush, wide][i % 2];
            if let Some(place) = self.free_place(5.5..26.0, 0.7) {
                self.plant(object, place, 0.7..1.7);
            }
        }
        for _ in 0..60 {
            if let Some(place) = self.free_place(4.5..20.0, 0.45) {
                self.plant(fern, place, 0.6..1.2);
            }
        }
    }

    fn grass(&mut self) {
        let tall = self.foliage("tall grass", &plants::grass(26, 0.55, GRASS_GREENS, &mut random(31)));
        let short = self.foliage("short grass", &plants::grass(34, 0.26, GRASS_GREENS, &mut random(32)));
        for i in 0..1400 {
            let object = if i % 3 == 0 { tall } else { short };
            let near = if i % 2 == 0 { 0.0..11.0 } else { 0.0..19.0 };
            if let Some(place) = self.free_place(near, 0.07) {
                self.plant(object, place, 0.7..1.35);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_material_has_its_place() {
        let materials = materials();
        for (index, name) in
            [(CAP, "toadstool cap"), (FIR_GREENS[0], "fir needle, dark"), (GRASS_GREENS[2], "grass, light")]
        {
            assert_eq!(materials[index as usize].name, name);
        }
    }
}
