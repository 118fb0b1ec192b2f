//! The Cornell box (Goral et al. 1984) in its form with two spheres, one of mirror and one of glass.
//!
//! A room of 2 by 2 by 2 that is open in front: one red wall, one green, the others white, and a square lamp below the
//! ceiling. The lamp gives off light as a surface, which paths find; a light at a point below it serves renderers that follow
//! rays to lights alone. The spheres are triangles with the normals of the true sphere, so that reflections are round; 20,480
//! each keep refractions round too.

use super::shape::Solid;
use super::shape::primitives::icosphere;
use super::stage::{Stage, camera, material};
use crate::{CornerAttribute, Light, Material, Model};
use glam::{DAffine3, DVec3, Vec3};

const WHITE: u32 = 0;
const RED: u32 = 1;
const GREEN: u32 = 2;
const LAMP: u32 = 3;
const MIRROR: u32 = 4;
const GLASS: u32 = 5;

/// A name, a material, a corner, and the edges from it; the square looks to where they turn counter-clockwise.
type Square = (&'static str, u32, [f64; 3], [f64; 3], [f64; 3]);

const SQUARES: [Square; 6] = [
    ("floor", WHITE, [-1.0, 0.0, 1.0], [2.0, 0.0, 0.0], [0.0, 0.0, -2.0]),
    ("ceiling", WHITE, [-1.0, 2.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]),
    ("back wall", WHITE, [-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]),
    ("left wall", RED, [-1.0, 0.0, 1.0], [0.0, 0.0, -2.0], [0.0, 2.0, 0.0]),
    ("right wall", GREEN, [1.0, 0.0, -1.0], [0.0, 0.0, 2.0], [0.0, 2.0, 0.0]),
    ("lamp", LAMP, [-0.25, 1.99, -0.25], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5]),
];

/// A name, a material, and a middle.
const SPHERES: [(&str, u32, [f64; 3]); 2] =
    [("mirror sphere", MIRROR, [-0.42, RADIUS, -0.35]), ("glass sphere", GLASS, [0.42, RADIUS, 0.3])];

const RADIUS: f64 = 0.38;

/// The scene.
pub(crate) fn cornell() -> Model {
    let mut stage = Stage::new(vec![
        material("white", [0.73, 0.73, 0.73], 1.0, 0.0),
        material("red", [0.65, 0.06, 0.05], 1.0, 0.0),
        material("green", [0.12, 0.45, 0.09], 1.0, 0.0),
        Material { emissive: Vec3::new(12.0, 10.8, 8.4), ..material("lamp", [0.73, 0.73, 0.73], 1.0, 0.0) },
        material("mirror", [0.95, 0.95, 0.95], 0.0, 1.0),
        Material { transmission: 1.0, ior: 1.5, ..material("glass", [1.0, 1.0, 1.0], 0.0, 0.0) },
    ]);
    for (name, material, corner, u, v) in SQUARES {
        let object = stage.flat_part(name, &square(corner.into(), u.into(), v.into(), material));
        stage.place(object, &DAffine3::IDENTITY);
    }
    for (name, material, middle) in SPHERES {
        let sphere = icosphere(RADIUS, 5, material);
        let values = sphere.positions.iter().map(|position| position.normalize().as_vec3()).collect();
        let object = stage.parts(name, &[(&sphere, Some(CornerAttribute { values, indices: None }))]);
        stage.place(object, &DAffine3::from_translation(middle.into()));
    }
    let model = stage.finish(
        camera("front", [0.0, 1.0, 3.9], [0.0, 1.0, 0.0], 39.0),
        Light::Point { position: Vec3::new(0.0, 1.9, 0.0), color: Vec3::new(3.0, 2.7, 2.1) },
    );
    // It is dark around the box. A little light from everywhere stands for what the walls send to each other.
    Model { background: Some(Vec3::ZERO), ambient: Some(Vec3::splat(0.15)), ..model }
}

fn square(corner: DVec3, u: DVec3, v: DVec3, material: u32) -> Solid {
    let mut solid = Solid::default();
    let ring = solid.ring([corner, corner + u, corner + u + v, corner + v]);
    solid.quad([ring[0], ring[1], ring[2], ring[3]], material);
    solid
}
