//! Small models and short ways for the tests.
#![allow(dead_code, reason = "each test file uses its own share")]

use ropewalk::glam::Vec3;
use ropewalk::{Mesh, NoMonitor, Scene, Structure, StructureSpec, Transform};
use ropewalk_render::{Ground, Picture, RenderSettings, Renderer, Stage, StageOptions, Trace};
use ropewalk_scene::{Light, Material, MaterialAssignment, Model, Surface};
use std::ops::ControlFlow;

/// A sphere of triangles that are nearly equal: an icosahedron, divided.
pub(crate) fn sphere(center: Vec3, radius: f32, divisions: u32) -> Mesh {
    let golden = (1.0 + 5.0_f32.sqrt()) / 2.0;
    let mut points = Vec::new();
    for (a, b) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
        points.extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)]);
    }
    let edge = 2.01;
    let mut triangles: Vec<[Vec3; 3]> = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let (a, b, c) = (points[i], points[j], points[k]);
                if a.distance(b) < edge && b.distance(c) < edge && c.distance(a) < edge {
                    let outward = (b - a).cross(c - a).dot(a) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for _ in 0..divisions {
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]| {
                let scale = |v: Vec3| v.normalize() * a.length();
                let (ab, bc, ca) = (scale(a + b), scale(b + c), scale(c + a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let positions = triangles.iter().flatten().map(|point| center + point.normalize() * radius).collect();
    Mesh::new(positions, (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// A level square, its front up.
pub(crate) fn floor(center: Vec3, half: f32) -> Mesh {
    let corner = |x: f32, z: f32| center + Vec3::new(x, 0.0, z) * half;
    let corners = vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
    Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]])
}

/// A model of some meshes, each an object with a material.
pub(crate) fn model(parts: Vec<(Mesh, Material)>, lights: Vec<Light>) -> Model {
    let mut model = Model { lights, ..Model::default() };
    for (index, (mesh, material)) in parts.into_iter().enumerate() {
        let object = model.scene.add_object(mesh);
        model.scene.add_instance(object, Transform::IDENTITY);
        model.materials.push(material);
        let materials = MaterialAssignment::One(index as u32);
        model.surfaces.push(vec![Surface { materials, ..Surface::default() }]);
    }
    model
}

/// A matt material of a colour.
pub(crate) fn matt(red: f32, green: f32, blue: f32) -> Material {
    Material { base_color: Vec3::new(red, green, blue), ..Material::default() }
}

/// A scene in which everything takes part: a floor to be made, a matt, a glossy and a metal thing, a shadow.
pub(crate) fn still_life() -> Model {
    let steel = Material { metallic: 1.0, roughness: 0.3, ..matt(0.6, 0.6, 0.62) };
    let varnish = Material { roughness: 0.25, ..matt(0.1, 0.3, 0.7) };
    model(
        vec![
            (sphere(Vec3::new(-1.1, 1.0, 0.0), 1.0, 2), steel),
            (sphere(Vec3::new(1.0, 0.7, 0.5), 0.7, 2), varnish),
            (sphere(Vec3::new(0.3, 0.3, 1.6), 0.3, 0), matt(0.8, 0.2, 0.1)),
        ],
        Vec::new(),
    )
}

pub(crate) fn build(scene: &Scene) -> Structure {
    StructureSpec::default().build(scene, &NoMonitor).expect("the scene is sound")
}

pub(crate) fn bare(model: Model) -> Stage {
    Stage::new(model, &StageOptions { ground: Ground::Off, ..StageOptions::default() })
}

pub(crate) fn render(stage: &Stage, tracer: &dyn Trace, settings: &RenderSettings) -> Picture {
    Renderer::new(stage, tracer)
        .render(settings, &|_, _| ControlFlow::Continue(()))
        .expect("the settings are in range")
}
