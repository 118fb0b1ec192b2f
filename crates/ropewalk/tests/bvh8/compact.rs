//! Compact trees: what they take, how far their boxes may be from the triangles, and what they refuse. That they answer as all
//! others do is also in the tests of every preset.

use crate::hits::check;
use crate::levels;
use crate::scenes::{builds, rays, scene};
use ropewalk::bvh8::Preset;
use ropewalk::glam::DVec3;
use ropewalk::{Bvh8, Bvh8Options, Mesh, Query, Scene, UpdateError};
use ropewalk_testkit::meshes;

fn build(scene: &Scene, preset: Preset) -> Bvh8 {
    let tree = scene.build_packed(&Bvh8Options { preset, level: None }).unwrap();
    assert_eq!(tree.validate(), Ok(()), "{preset:?}");
    tree
}

fn bytes(tree: &Bvh8) -> f64 {
    tree.report().bytes as f64 / tree.report().triangles as f64
}

#[test]
fn shared_vertices_and_small_boxes_take_half_the_memory() {
    let mesh = Scene::from_mesh(meshes::icosphere(5));
    let (full, compact) = (build(&mesh, Preset::Balanced), build(&mesh, Preset::Compact));
    assert!(bytes(&compact) < 30.0 && bytes(&compact) < 0.6 * bytes(&full), "{}", bytes(&compact));
    // Vertices count by what they are, not by how the mesh names them: here each triangle has its own.
    let mut apart = Mesh::default();
    let flat = mesh.flatten().unwrap();
    for triangle in &flat.triangles {
        let first = apart.positions.len() as u32;
        apart.positions.extend(triangle.triangle().vertices);
        apart.triangles.push([first, first + 1, first + 2]);
    }
    assert_eq!(build(&Scene::from_mesh(apart), Preset::Compact).report().bytes, compact.report().bytes);
    // And where no two are alike.
    let soup = build(&Scene::from_mesh(meshes::soup(20_000, 0.05, 3)), Preset::Compact);
    assert!(bytes(&soup) < 60.0, "{}", bytes(&soup));
}

#[test]
fn an_interior_takes_36_bytes_a_triangle_at_most() {
    let Some(scene) = crate::many::kitchen() else {
        println!("skipped: the kitchen is not there");
        return;
    };
    let tree = build(&scene, Preset::Compact);
    assert!(bytes(&tree) <= 36.0, "{}", bytes(&tree));
}

/// Far out, huge, tiny, flat and all of them at once: wherever hits are, compact trees have those of the binary tree.
#[test]
fn extreme_extents_lose_no_hit() {
    let soup = || meshes::soup(300, 0.4, 9);
    let map = |map: &dyn Fn(DVec3) -> DVec3| meshes::mapped(soup(), map);
    let mut mixed = map(&|point| point * 1e9);
    meshes::append(&mut mixed, &map(&|point| point * 1e-3 + 5.0));
    meshes::append(&mut mixed, &map(&|point| point * 1e-12));
    let mut line = meshes::grid(2, 0.0, 6, 1e-3);
    meshes::append(&mut line, &map(&|point| DVec3::new(point.x * 1e6, point.y, 0.0)));
    let cases = [
        ("huge", map(&|point| point * 2e11)),
        ("as large as can be", map(&|point| point.clamp(DVec3::splat(-1.0), DVec3::splat(1.0)) * 9.9e11)),
        ("small", map(&|point| point * 1e-9)),
        ("tiny", map(&|point| point * 1e-17)),
        ("below every step", map(&|point| point * 1e-31)),
        ("subnormal", map(&|point| point * 1e-41)),
        ("far", map(&|point| point + DVec3::new(1e6, -3e7, 2e5))),
        ("flat", map(&|point| DVec3::new(point.x, 0.25, point.z))),
        ("flat and far", map(&|point| DVec3::new(-8e5, point.y, point.z))),
        ("nearly flat", map(&|point| DVec3::new(point.x, point.y, 1.0 + point.z * 1e-7))),
        ("mixed", mixed),
        ("long", line),
    ];
    for (name, mesh) in cases {
        let scene = Scene::from_mesh(mesh);
        let rays = rays(&scene, 40);
        let bvh = scene.build(&builds()[0]).unwrap();
        let mut tree = build(&scene, Preset::Compact);
        for level in levels() {
            tree = tree.at(level);
            for query in Query::EVERY {
                check(name, &bvh, &tree, query, &rays);
            }
        }
    }
}

/// The twin in full has the same tree where leaves are chosen alike, and boxes are a little larger here: some more visits, no
/// other hits.
#[test]
fn boxes_are_nearly_as_tight() {
    use ropewalk::{TraceOptions, Walk};
    let scene = Scene::from_mesh(meshes::icosphere(5));
    let rays = rays(&scene, 200);
    let visits = |preset| {
        let tree = build(&scene, preset);
        let options = TraceOptions { counters: true };
        let counters = tree.trace(Walk::default(), Query::Closest, &rays, options).unwrap().counters.unwrap();
        counters.iter().map(|counters| f64::from(counters.inner_visits + counters.leaf_visits)).sum::<f64>()
    };
    let (full, compact) = (visits(Preset::Balanced), visits(Preset::Compact));
    assert!(compact < 1.15 * full, "{compact} visits, {full} in full");
}

#[test]
fn a_refit_is_refused_and_nothing_changes() {
    let scene = scene("shells");
    let mut tree = build(&scene, Preset::Compact);
    let before = (tree.triangles(), *tree.report());
    let mut moved = scene.clone();
    moved.objects[0].geometries[0].positions[0] *= 1.5;
    for other in [&moved, &scene] {
        let why = tree.refit(other).unwrap_err();
        assert_eq!(why, UpdateError::SharedVertices);
        assert!(why.to_string().contains("build it anew"), "{why}");
    }
    assert_eq!((tree.triangles(), *tree.report()), before);
    assert_eq!(tree.validate(), Ok(()));
}
