//! Five bevelled cubes on a ground: the smallest scene of Toczek, Houzet and Mancini 2010.
//!
//! The paper gives the counts, 222 triangles and 124 vertices with the ground's 2 and 4, which Euler's formula
//! turns into five closed bodies of 44 and 24. Where the cubes stand is our own choice.

use super::shape::primitives::{bevelled_cube, ground_square};
use super::stage::{Stage, camera, material};
use crate::{Light, Model};
use glam::{DAffine3, DQuat, DVec3, Vec3};

struct Cube {
    name: &'static str,
    edge: f64,
    /// Its middle.
    place: [f64; 3],
    /// How far it is turned about the vertical, in degrees.
    turn: f64,
    color: [f32; 3],
}

const fn cube(name: &'static str, edge: f64, place: [f64; 3], turn: f64, color: [f32; 3]) -> Cube {
    Cube { name, edge, place, turn, color }
}

const CUBES: [Cube; 5] = [
    cube("Cube.000", 1.3, [-1.35, 0.65, -0.55], 24.0, [0.70, 0.10, 0.05]),
    cube("Cube.001", 1.0, [0.55, 0.5, -1.05], -12.0, [0.75, 0.45, 0.06]),
    cube("Cube.002", 0.8, [1.55, 0.4, 0.35], 38.0, [0.06, 0.30, 0.36]),
    cube("Cube.003", 0.6, [0.0, 0.3, 0.75], 10.0, [0.70, 0.66, 0.56]),
    // It stands on the first one.
    cube("Cube.004", 0.7, [-1.3, 1.65, -0.5], -8.0, [0.12, 0.16, 0.40]),
];

/// The scene.
pub(crate) fn cubes() -> Model {
    let mut materials: Vec<_> = CUBES.iter().map(|cube| material(cube.name, cube.color, 0.6, 0.0)).collect();
    materials.push(material("Ground", [0.6, 0.6, 0.58], 1.0, 0.0));
    let mut stage = Stage::new(materials);
    for (index, cube) in CUBES.iter().enumerate() {
        // Flat shading suits faces this plain.
        let object = stage.flat_part(cube.name, &bevelled_cube(cube.edge, 0.06, index as u32));
        let turn = DQuat::from_rotation_y(cube.turn.to_radians());
        stage.place(object, &DAffine3::from_rotation_translation(turn, DVec3::from(cube.place)));
    }
    let ground = stage.flat_part("Ground", &ground_square(20.0, CUBES.len() as u32));
    stage.place(ground, &DAffine3::IDENTITY);
    stage.finish(
        camera("front", [2.6, 3.1, 5.6], [-0.05, 0.62, -0.2], 32.0),
        Light::Sun { direction: Vec3::new(0.55, -1.0, -0.75), color: Vec3::new(1.0, 0.96, 0.88) * 2.4 },
    )
}
