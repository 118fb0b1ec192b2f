//! Small scenes with everything in them that walks and triangle tests go wrong on.

use crate::rays::Random;
use ropewalk::bvh::LeafOrder;
use ropewalk::glam::{Affine3A, Quat, Vec3};
use ropewalk::{BuildOptions, Instance, Mesh, Object, Scene, Structure, Transform};

pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) structure: Structure,
}

/// Every scene.
pub(crate) fn every() -> Vec<Case> {
    let leaves = |max_leaf| BuildOptions { max_leaf, ..BuildOptions::default() };
    let left = BuildOptions { leaf_order: LeafOrder::Left, ..leaves(1) };
    let case = |name, scene: Scene, options: BuildOptions| Case {
        name,
        structure: Structure::Bvh(scene.build(&options).expect("the scene is in range")),
    };
    let soup = |scale: f32, offset: Vec3| {
        let mut mesh = soup(400);
        for position in &mut mesh.positions {
            *position = *position * scale + offset;
        }
        Scene::from_mesh(mesh)
    };
    vec![
        case("empty", Scene::default(), leaves(4)),
        case("one triangle", Scene::from_mesh(one_triangle()), leaves(4)),
        case("two triangles", Scene::from_mesh(quad(0.0)), leaves(1)),
        case("soup, leaves of 1", soup(1.0, Vec3::ZERO), leaves(1)),
        case("soup, leaves of 8", soup(1.0, Vec3::ZERO), leaves(8)),
        case("soup, leaf left", soup(1.0, Vec3::ZERO), left),
        case("huge soup", soup(1e11, Vec3::ZERO), leaves(4)),
        case("tiny soup", soup(1e-12, Vec3::ZERO), leaves(4)),
        case("soup far away", soup(1.0, Vec3::new(1e6, -1e6, 3e5)), leaves(2)),
        case("lattice", Scene::from_mesh(lattice()), leaves(2)),
        case("coplanar duplicates", Scene::from_mesh(duplicates()), leaves(3)),
        case("sphere", Scene::from_mesh(sphere(24)), leaves(4)),
        case("instances", instances(), leaves(4)),
        case("deep chain", Scene::from_mesh(chain()), leaves(1)),
    ]
}

pub(crate) fn one_triangle() -> Mesh {
    Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])
}

fn quad(z: f32) -> Mesh {
    let corner = |x, y| Vec3::new(x, y, z);
    let corners = vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
    Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]])
}

/// Triangles of very different sizes and needles, all over the place.
pub(crate) fn soup(triangles: u32) -> Mesh {
    let mut random = Random::new(7);
    let mut mesh = Mesh::default();
    for index in 0..triangles {
        let size = if index % 10 == 0 { 1.0 } else { 0.12 };
        let needle = if index % 7 == 0 { 1e-4 } else { 1.0 };
        let center = random.vector();
        let edges = [random.vector() * size, random.vector() * size * needle];
        mesh.positions.extend([center, center + edges[0], center + edges[1]]);
        mesh.triangles.push([3 * index, 3 * index + 1, 3 * index + 2]);
    }
    mesh
}

/// Quads in all three axis planes at whole numbers: rays of whole numbers run in faces and through vertices.
pub(crate) fn lattice() -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for plane in -2..=2 {
            for u in -2..2 {
                for v in -2..2 {
                    let first = mesh.positions.len() as u32;
                    for (du, dv) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
                        let mut corner = [0.0; 3];
                        corner[axis] = plane as f32;
                        corner[(axis + 1) % 3] = (u + du) as f32;
                        corner[(axis + 2) % 3] = (v + dv) as f32;
                        mesh.positions.push(corner.into());
                    }
                    mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
                }
            }
        }
    }
    mesh
}

/// The same quad several times, turned over too, and one that is a float away.
pub(crate) fn duplicates() -> Mesh {
    let mut mesh = Mesh::default();
    for (copy, z) in [0.5_f32, 0.5, 0.5, 0.5_f32.next_up(), 0.5_f32.next_down(), 0.5].into_iter().enumerate()
    {
        let first = mesh.positions.len() as u32;
        let quad = quad(z);
        mesh.positions.extend(quad.positions);
        mesh.triangles.extend(quad.triangles.into_iter().map(|[a, b, c]| {
            let [a, b, c] = [a + first, b + first, c + first];
            if copy % 2 == 0 { [a, b, c] } else { [c, b, a] }
        }));
    }
    mesh
}

/// A closed sphere of latitudes and longitudes, with its needles at the poles.
pub(crate) fn sphere(rings: u32) -> Mesh {
    let sectors = 2 * rings;
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        let polar = std::f32::consts::PI * ring as f32 / rings as f32;
        for sector in 0..sectors {
            let turn = std::f32::consts::TAU * sector as f32 / sectors as f32;
            let radius = if ring % rings == 0 { 0.0 } else { polar.sin() };
            mesh.positions.push(Vec3::new(radius * turn.cos(), radius * turn.sin(), polar.cos()));
        }
    }
    for ring in 0..rings {
        for sector in 0..sectors {
            let next = (sector + 1) % sectors;
            let [a, b] = [ring * sectors + sector, ring * sectors + next];
            let [c, d] = [a + sectors, b + sectors];
            mesh.triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    mesh
}

/// Two objects, one of several geometries, placed with turns, mirrors, shears and masks, some on top of each other.
pub(crate) fn instances() -> Scene {
    let mut scene = Scene::default();
    let ball = scene.add_object(sphere(6));
    let parts =
        scene.add_object(Object { geometries: vec![quad(0.0), Mesh::default(), quad(0.5), one_triangle()] });
    let mut random = Random::new(11);
    for index in 0..24 {
        let turn = Quat::from_scaled_axis(random.vector() * 3.0);
        let mut scale = Vec3::splat(0.35);
        if index % 3 == 1 {
            scale.x = -scale.x;
        }
        let mut place = Affine3A::from_scale_rotation_translation(scale, turn, random.vector());
        if index % 4 == 0 {
            place.matrix3.x_axis.y += 0.2;
        }
        let mut instance =
            Instance::new([ball, parts][index % 2], Transform::new(place).expect("it can be undone"));
        instance.mask = [0xff, 0x01, 0x02, 0x80, 0x00, 0x1ff][index % 6];
        scene.instances.push(instance);
        if index % 5 == 0 {
            scene.instances.push(instance);
        }
    }
    scene
}

/// Triangles that double in size and distance: the tree is a chain.
pub(crate) fn chain() -> Mesh {
    let mut mesh = Mesh::default();
    for level in 0..34 {
        let size = 2.0_f32.powi(level - 14);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(
            [Vec3::new(1.0, -0.3, -0.2), Vec3::new(1.0, 0.4, -0.3), Vec3::new(1.0, 0.0, 0.5)]
                .map(|p| p * size),
        );
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    mesh
}
