//! A small scene that has everything: mirrors, glass, rough metal, textures of every wrap and filter, holes, lamps; curved
//! surfaces, turned and stretched and mirrored instances.

use crate::gpu::item;
use crate::integrator::TreeSettings;
use crate::light::Lights;
use crate::lights::LightChoice;
use crate::looks::Looks;
use crate::ray_tree::{Request, Root, Sample, Tree};
use crate::stage::{Stage, StageOptions};
use crate::tracing::Tracing;
use crate::{Ground, RenderSettings};
use glam::{Affine3A, Quat, Vec2, Vec3};
use ropewalk::{Instance, Mesh, Ray, Structure, Transform, Walk};
use ropewalk_scene::{
    Camera, CornerAttribute, Filter, Light, Material, MaterialAssignment, Model, Surface, Texture,
    TextureUse, Wrap,
};

/// What a picture of the scene is made of.
pub(super) struct Set {
    pub(super) stage: Stage,
    pub(super) lights: Lights,
    pub(super) looks: Looks,
    pub(super) request: Request,
    pub(super) camera: Camera,
}

/// A fixed sequence of numbers.
pub(super) struct Random(u64);

impl Random {
    pub(super) const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// From 0 to 1, below 1.
    pub(super) fn number(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u32 << 24) as f32
    }

    /// Each component from -1 to 1.
    pub(super) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number()) * 2.0 - Vec3::ONE
    }

    pub(super) fn direction(&mut self) -> Vec3 {
        loop {
            let vector = self.vector();
            if vector.length_squared() > 0.01 {
                return vector.normalize();
            }
        }
    }

    pub(super) fn color(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }
}

/// A ball with normals and coordinates.
fn ball(rings: u32) -> (Mesh, Surface) {
    let sectors = 2 * rings;
    let (mut mesh, mut coordinates) = (Mesh::default(), Vec::new());
    for ring in 0..=rings {
        let polar = std::f32::consts::PI * ring as f32 / rings as f32;
        for sector in 0..=sectors {
            let turn = std::f32::consts::TAU * sector as f32 / sectors as f32;
            mesh.positions.push(Vec3::new(polar.sin() * turn.cos(), polar.cos(), polar.sin() * turn.sin()));
            coordinates
                .push(Vec2::new(3.0 * sector as f32 / sectors as f32 - 1.0, ring as f32 / rings as f32));
        }
    }
    for ring in 0..rings {
        for sector in 0..sectors {
            let first = ring * (sectors + 1) + sector;
            let below = first + sectors + 1;
            mesh.triangles.extend([[first, first + 1, below], [first + 1, below + 1, below]]);
        }
    }
    let normals = Some(CornerAttribute { values: mesh.positions.clone(), indices: None });
    let texture_coordinates = Some(CornerAttribute { values: coordinates, indices: None });
    (mesh, Surface { normals, texture_coordinates, ..Surface::default() })
}

/// A level square around the origin.
fn square(repeats: f32) -> (Mesh, Surface) {
    let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let corners = vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
    let values = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
    let values = values.map(|[u, v]| Vec2::new(u, v) * repeats - Vec2::splat(0.3)).to_vec();
    let texture_coordinates = Some(CornerAttribute { values, indices: Some(vec![[0, 1, 2], [0, 2, 3]]) });
    (Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]), Surface { texture_coordinates, ..Surface::default() })
}

fn texture(name: &str, [width, height]: [u32; 2], is_srgb: bool, seed: u64) -> Texture {
    let mut random = Random::new(seed);
    let mut byte = || (random.number() * 256.0) as u8;
    let texels = (0..width * height).map(|_| [byte(), byte(), byte(), byte()]).collect();
    Texture { name: name.into(), width, height, texels, is_srgb }
}

/// One material of each kind.
pub(super) fn materials() -> Vec<Material> {
    let used = |texture, wrap: [Wrap; 2], filter| {
        let (scale, offset) = (Vec2::new(1.3, -0.7), Vec2::new(0.21, 0.4));
        Some(TextureUse { texture, wrap, filter, scale, offset })
    };
    let plain = Material::default();
    vec![
        Material {
            base_color: Vec3::new(0.9, 0.8, 0.7),
            base_color_texture: used(0, [Wrap::Repeat, Wrap::Mirror], Filter::Linear),
            ..plain.clone()
        },
        Material {
            transmission: 1.0,
            roughness: 0.0,
            base_color: Vec3::new(0.9, 1.0, 0.95),
            ..plain.clone()
        },
        Material {
            metallic: 1.0,
            roughness: 0.6,
            base_color: Vec3::new(0.9, 0.7, 0.3),
            metallic_roughness_texture: used(1, [Wrap::Clamp, Wrap::Repeat], Filter::Linear),
            ..plain.clone()
        },
        Material {
            specular: Some(Vec3::new(0.5, 0.4, 0.3)),
            mirrors_sharply: true,
            roughness: 0.3,
            ambient: Some(Vec3::new(0.2, 0.3, 0.4)),
            base_color_texture: used(2, [Wrap::Mirror, Wrap::Clamp], Filter::Nearest),
            ..plain.clone()
        },
        Material {
            alpha_cutoff: 0.5,
            base_color_texture: used(1, [Wrap::Repeat, Wrap::Repeat], Filter::Nearest),
            ..plain.clone()
        },
        Material {
            emissive: Vec3::new(2.0, 1.5, 0.5),
            emissive_texture: used(0, [Wrap::Clamp, Wrap::Clamp], Filter::Nearest),
            roughness: 0.2,
            ..plain.clone()
        },
        Material {
            mirrors_sharply: true,
            transmission: 0.6,
            ior: 1.0,
            specular: Some(Vec3::splat(0.2)),
            ..plain.clone()
        },
        plain,
    ]
}

fn model(is_studio: bool) -> Model {
    let mut model = Model {
        materials: materials(),
        textures: vec![
            texture("color", [16, 8], true, 1),
            texture("shape", [7, 5], false, 2),
            texture("tiles", [4, 4], true, 3),
        ],
        lights: vec![
            Light::Point { position: Vec3::new(2.0, 4.0, 3.0), color: Vec3::new(30.0, 28.0, 25.0) },
            Light::Sun { direction: Vec3::new(0.4, -1.0, -0.3), color: Vec3::new(1.0, 1.2, 1.4) },
        ],
        ..Model::default()
    };
    if !is_studio {
        model.background = Some(Vec3::new(0.3, 0.5, 0.8));
        model.ambient = Some(Vec3::new(0.4, 0.3, 0.2));
    }
    let shapes: Vec<(Mesh, Surface)> = (0..model.materials.len())
        .map(|index| if index == 3 || index == 4 { square(2.5) } else { ball(8) })
        .collect();
    for (index, (mesh, surface)) in shapes.into_iter().enumerate() {
        model.scene.add_object(mesh);
        model.surfaces.push(vec![Surface { materials: MaterialAssignment::One(index as u32), ..surface }]);
    }
    let mut place = |object: u32, scale: Vec3, turn: Vec3, place: Vec3| {
        let turn = Quat::from_scaled_axis(turn);
        let to_world = Affine3A::from_scale_rotation_translation(scale, turn, place);
        model.scene.instances.push(Instance::new(object, Transform::new(to_world).unwrap()));
    };
    place(3, Vec3::splat(4.0), Vec3::ZERO, Vec3::new(0.0, -1.0, 0.0));
    place(0, Vec3::new(1.0, 0.7, 1.2), Vec3::new(0.3, 0.4, 0.1), Vec3::new(-1.6, -0.2, 0.3));
    place(1, Vec3::splat(0.8), Vec3::ZERO, Vec3::new(0.3, 0.0, 1.2));
    place(2, Vec3::new(0.7, -0.7, 0.7), Vec3::new(1.0, 0.2, 0.4), Vec3::new(1.8, -0.2, -0.4));
    place(4, Vec3::splat(1.1), Vec3::new(1.2, 0.3, 0.2), Vec3::new(-0.4, 1.1, -0.9));
    place(5, Vec3::splat(0.4), Vec3::ZERO, Vec3::new(0.6, -0.5, 2.5));
    place(6, Vec3::splat(0.5), Vec3::new(0.1, 0.9, 0.0), Vec3::new(-0.7, -0.4, 1.9));
    place(7, Vec3::splat(0.5), Vec3::ZERO, Vec3::new(1.3, -0.5, 1.6));
    model
}

impl Set {
    /// In the studio, or with the light and the background of a file.
    pub(super) fn new(is_studio: bool, tree: TreeSettings, ground: Ground) -> Self {
        let camera = Camera {
            name: String::new(),
            position: Vec3::new(0.6, 1.3, 6.0),
            forward: Vec3::new(-0.1, -0.25, -1.0),
            up: Vec3::Y,
            vertical_fov: 0.7,
        };
        Self::of(model(is_studio), camera, tree, ground)
    }

    /// Of a model seen by a camera.
    pub(super) fn of(model: Model, camera: Camera, tree: TreeSettings, ground: Ground) -> Self {
        let stage = Stage::new(model, &StageOptions { ground, ..StageOptions::default() });
        let settings = RenderSettings { tree, samples: 4, ambient_rays: 8, ..RenderSettings::default() };
        let lights = Lights::new(&stage, &camera, &LightChoice::Automatic, false);
        let request = Request::new(&stage, &settings);
        let looks = Looks::new(&stage, &lights.words(), &request.words()).unwrap();
        Self { stage, lights, looks, request, camera }
    }

    pub(super) fn tree(&self) -> Tree<'_> {
        Tree { looks: &self.looks, lights: &self.lights, request: self.request }
    }

    pub(super) fn most_waiting(&self) -> usize {
        self.request.most_waiting(self.lights.sources.len())
    }

    /// The rays of a small picture, and what they find on the CPU.
    pub(super) fn roots(&self, structure: &Structure, walk: Walk, [width, height]: [u32; 2]) -> Vec<Root> {
        let forward = self.camera.forward.normalize();
        let right = forward.cross(self.camera.up).normalize();
        let up = right.cross(forward);
        let half = (0.5 * self.camera.vertical_fov).tan();
        let ray = |x: u32, y: u32| {
            let across = ((x as f32 + 0.37) / width as f32 * 2.0 - 1.0) * half * width as f32 / height as f32;
            let above = (1.0 - (y as f32 + 0.61) / height as f32 * 2.0) * half;
            Ray::new(self.camera.position, forward + right * across + up * above)
        };
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let tracing = Tracing { tracer: structure, walk, looks: Some(&self.looks) };
        pixels
            .map(|pixel| {
                let ray = ray(pixel.0, pixel.1);
                let (hit, status) = tracing.closest(&ray, None).unwrap();
                assert!(status.is_complete());
                let behind = Vec3::new(0.3, 0.4, pixel.1 as f32 / height as f32);
                Root { sample: Sample { pixel, index: (pixel.0 + pixel.1) % 4, behind }, ray, hit }
            })
            .collect()
    }
}

/// The words of rays and hits, for programs that work out places.
pub(super) fn place_items(roots: &[Root]) -> Vec<u32> {
    roots.iter().flat_map(|root| item::words(root, true)).collect()
}
