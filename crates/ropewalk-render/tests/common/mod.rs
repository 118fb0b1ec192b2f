//! Small models and short ways for the tests.
#![allow(dead_code, reason = "each test file uses its own share")]

use ropewalk::glam::{Vec2, Vec3};
use ropewalk::{
    Answer, Mesh, NoMonitor, Query, Ray, Scene, Structure, StructureSpec, TraceOptions, Traced, Transform,
    Walk,
};
use ropewalk_render::{
    CameraChoice, Ground, Picture, RenderSettings, Renderer, Stage, StageOptions, Trace, image_file,
};
use ropewalk_scene::{
    CornerAttribute, Light, Material, MaterialAssignment, Model, Surface, Texture, TextureUse,
};
use std::error::Error;
use std::ops::ControlFlow;
use std::path::PathBuf;

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

/// A checkered picture.
pub(crate) fn checkers() -> Texture {
    let texel = |index: u32| {
        let is_light = (index % 8 / 4 + index / 8 / 4).is_multiple_of(2);
        if is_light { [230, 225, 215, 255] } else { [70, 90, 120, 255] }
    };
    Texture {
        name: "checkers".into(),
        width: 8,
        height: 8,
        texels: (0..64).map(texel).collect(),
        is_srgb: true,
    }
}

/// A picture with round holes.
pub(crate) fn lattice() -> Texture {
    let texel = |index: u32| {
        let (x, y) = (index % 16, index / 16);
        let from_middle = (x as f32 - 7.5).hypot(y as f32 - 7.5);
        [220, 180, 60, if from_middle < 6.0 { 0 } else { 255 }]
    };
    Texture {
        name: "lattice".into(),
        width: 16,
        height: 16,
        texels: (0..256).map(texel).collect(),
        is_srgb: true,
    }
}

/// What trees of rays are for: a mirror, a ball of glass, a textured floor, a lattice with holes, something glossy, and
/// something that glows, under two lamps.
pub(crate) fn mirrors_and_glass() -> Model {
    let mirror = Material { metallic: 1.0, roughness: 0.0, ..matt(0.9, 0.85, 0.75) };
    let glass = Material { transmission: 1.0, roughness: 0.0, ior: 1.5, ..matt(1.0, 1.0, 1.0) };
    let glossy = Material { roughness: 0.2, ..matt(0.7, 0.1, 0.1) };
    let glowing = Material { emissive: Vec3::new(0.6, 1.2, 0.4), ..matt(0.1, 0.1, 0.1) };
    let old = Material {
        specular: Some(Vec3::splat(0.4)),
        mirrors_sharply: true,
        roughness: 0.5,
        ..matt(0.2, 0.3, 0.6)
    };
    let use_ = TextureUse { scale: Vec2::splat(6.0), ..TextureUse::plain(0) };
    let tiles = Material {
        base_color_texture: Some(use_),
        specular: Some(Vec3::splat(0.08)),
        roughness: 0.1,
        ..matt(1.0, 1.0, 1.0)
    };
    let use_ = TextureUse { scale: Vec2::splat(5.0), ..TextureUse::plain(1) };
    let lattice_work = Material { base_color_texture: Some(use_), alpha_cutoff: 0.5, ..matt(1.0, 1.0, 1.0) };
    let screen = Mesh::new(
        vec![
            Vec3::new(-2.2, 0.0, 1.2),
            Vec3::new(-0.9, 0.0, 1.9),
            Vec3::new(-0.9, 1.3, 1.9),
            Vec3::new(-2.2, 1.3, 1.2),
        ],
        vec![[0, 1, 2], [0, 2, 3]],
    );
    let lights = vec![
        Light::Point { position: Vec3::new(-4.0, 6.0, 5.0), color: Vec3::new(1.0, 0.95, 0.85) },
        Light::Sun { direction: Vec3::new(-0.5, -1.0, -0.3), color: Vec3::new(0.01, 0.012, 0.015) },
    ];
    let mut model = model(
        vec![
            (floor(Vec3::ZERO, 4.0), tiles),
            (sphere(Vec3::new(-1.0, 1.0, -0.8), 1.0, 3), mirror),
            (sphere(Vec3::new(0.9, 0.75, 0.6), 0.75, 3), glass),
            (sphere(Vec3::new(0.0, 0.35, 1.9), 0.35, 2), glossy),
            (sphere(Vec3::new(2.1, 0.4, -0.6), 0.4, 2), glowing),
            (sphere(Vec3::new(1.6, 0.5, -2.2), 0.5, 2), old),
            (screen, lattice_work),
        ],
        lights,
    );
    model.textures = vec![checkers(), lattice()];
    let corners =
        || Some(CornerAttribute { values: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y], indices: None });
    for object in [0, 6] {
        model.surfaces[object][0].texture_coordinates = corners();
    }
    model
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

pub(crate) fn look(eye: Vec3, target: Vec3, degrees: f32) -> CameraChoice {
    CameraChoice::Look { eye, target, up: Some(Vec3::Y), vertical_fov: Some(degrees.to_radians()) }
}

/// A tracer for which nothing is ever in the way of light.
pub(crate) struct Open(pub(crate) Structure);

impl Trace for Open {
    fn trace_batch(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, Box<dyn Error + Send + Sync>> {
        let mut traced = self.0.trace(walk, query, rays, options)?;
        if let Answer::Any(blocked) = &mut traced.answer {
            blocked.fill(false);
        }
        Ok(traced)
    }
}

/// Compares a picture with the stored one, byte by byte. With `ROPEWALK_UPDATE_IMAGES=1` it is written anew.
pub(crate) fn check_stored(name: &str, picture: &Picture) {
    let path: PathBuf =
        [env!("CARGO_MANIFEST_DIR"), "tests", "images", &format!("{name}.png")].iter().collect();
    let (width, height, bytes) = (picture.film.width, picture.film.height, picture.to_srgb8());
    if std::env::var_os("ROPEWALK_UPDATE_IMAGES").is_some_and(|value| value == "1") {
        image_file::write_png(&path, width, height, &bytes).expect("the picture can be written");
    }
    let expected = image::open(&path).expect("the picture is stored").to_rgb8();
    assert_eq!((expected.width(), expected.height()), (width, height), "{name}");
    let different = expected.as_raw().iter().zip(&bytes).filter(|(a, b)| a != b).count();
    assert_eq!(different, 0, "{name}: {different} bytes differ");
}
