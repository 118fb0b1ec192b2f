//! Traversal lists of the usual scenes: every number of directions, source, order and volume.

use crate::scenes::{Case, duplicates, instances, lattice, one_triangle, soup, sphere};
use ropewalk::glam::Vec3;
use ropewalk::traversal_list::{Bounds, ChildOrder, Cull, Directions, ListOptions, Source};
use ropewalk::{Mesh, Scene, Structure};

/// Lists with one kind of volumes.
pub(crate) fn every(bounds: Bounds) -> Vec<Case> {
    let plain = ListOptions { bounds, ..ListOptions::default() };
    let by = |source, directions, order| ListOptions { source, directions, order, ..plain };
    use ChildOrder::{EarliestFirst, LatestLast};
    use Directions::{Eight, One, Six, Two};
    use Source::{Octree, Sah, Sbvh};
    vec![
        case("empty", Scene::default(), plain),
        case("one triangle", Scene::from_mesh(one_triangle()), by(Octree, Six, EarliestFirst)),
        case("soup by an octree", placed(Vec3::splat(1.0), Vec3::ZERO), by(Octree, Eight, EarliestFirst)),
        case("stretched soup", placed(Vec3::new(1.0, 0.1, 7.0), Vec3::ZERO), by(Sah, One, LatestLast)),
        case("soup with spatial splits", placed(Vec3::splat(1.0), Vec3::ZERO), by(Sbvh, Two, EarliestFirst)),
        case("huge soup", placed(Vec3::splat(1e11), Vec3::ZERO), by(Sah, Six, EarliestFirst)),
        case("tiny soup", placed(Vec3::splat(1e-12), Vec3::ZERO), by(Octree, Two, LatestLast)),
        case(
            "soup far away",
            placed(Vec3::splat(1.0), Vec3::new(1e6, -1e6, 3e5)),
            by(Sah, Eight, EarliestFirst),
        ),
        case("lattice", Scene::from_mesh(lattice()), by(Octree, Six, LatestLast)),
        case("coplanar duplicates", Scene::from_mesh(duplicates()), by(Sah, Eight, LatestLast)),
        case("sphere", Scene::from_mesh(sphere(24)), by(Sbvh, Eight, LatestLast)),
        case("instances", instances(), by(Octree, Six, EarliestFirst)),
    ]
}

/// Lists of one side, which leave out what their rays cannot see.
pub(crate) fn one_sided(bounds: Bounds) -> Vec<Case> {
    let plain = ListOptions { bounds, cull: Cull::Exact, ..ListOptions::default() };
    let by = |source, directions| ListOptions { source, directions, ..plain };
    vec![
        case("one-sided triangle", Scene::from_mesh(one_triangle()), plain),
        case("one-sided soup", placed(Vec3::splat(1.0), Vec3::ZERO), by(Source::Sah, Directions::Eight)),
        case("one-sided parts", placed(Vec3::splat(1.0), Vec3::ZERO), by(Source::Sbvh, Directions::Two)),
        case("one-sided lattice", Scene::from_mesh(lattice()), by(Source::Octree, Directions::Six)),
        case("one-sided duplicates", Scene::from_mesh(duplicates()), by(Source::Octree, Directions::One)),
        case("one-sided sphere", Scene::from_mesh(sphere(24)), by(Source::Sah, Directions::Six)),
        case("one-sided instances", instances(), by(Source::Octree, Directions::Eight)),
    ]
}

/// Lists of two layers, either of which may have nothing in it.
pub(crate) fn layered(bounds: Bounds) -> Vec<Case> {
    let layers = |moving, cull, directions| ListOptions {
        bounds,
        moving: Some(moving),
        cull,
        directions,
        ..ListOptions::default()
    };
    let cases = vec![
        case("two layers", instances(), layers(9, Cull::None, Directions::Eight)),
        case("two layers of one side", instances(), layers(12, Cull::Exact, Directions::Six)),
        case("all moves", instances(), layers(0, Cull::None, Directions::Two)),
        case("nothing moves", instances(), layers(99, Cull::None, Directions::One)),
        case("two empty layers", Scene::default(), layers(1, Cull::None, Directions::Eight)),
    ];
    for case in &cases {
        let Structure::List(list) = &case.structure else { panic!("lists were built") };
        assert_eq!(list.layers(), 2, "{}", case.name);
    }
    cases
}

pub(crate) fn case(name: &'static str, scene: Scene, options: ListOptions) -> Case {
    Case { name, structure: Structure::List(scene.build_list(&options).expect("the scene is in range")) }
}

/// A soup of another size and shape at another place.
pub(crate) fn placed(scale: Vec3, offset: Vec3) -> Scene {
    let Mesh { mut positions, triangles } = soup(400);
    positions.iter_mut().for_each(|position| *position = *position * scale + offset);
    Scene::from_mesh(Mesh { positions, triangles })
}
