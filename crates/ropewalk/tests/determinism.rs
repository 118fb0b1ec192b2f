//! The same input makes the same tree and the same hits, to the bit, for any number of threads and every time.

use glam::DVec3;
use ropewalk::bvh::LeafOrder;
use ropewalk::{BuildOptions, Builder, Bvh, Hit, Query, Ray, Scene, TraceOptions, Traced, Walk, glam};
use ropewalk_testkit::meshes;
use ropewalk_testkit::rays::{RayClass, RayMaker};

/// Large enough that every part of the builders that may use threads does: more than 65,536 triangles.
fn scene() -> Scene {
    let mut mesh = meshes::soup(60_000, 0.02, 1);
    // Equal centres and duplicates, where a sort that is not stable would show.
    meshes::append(&mut mesh, &meshes::icosphere(5));
    let copy = mesh.clone();
    meshes::append(&mut mesh, &copy);
    // Large slanted walls, so that spatial splits are worth their references.
    meshes::append(
        &mut mesh,
        &meshes::mapped(meshes::grid(1, 0.2, 6, 0.3), |point| point + DVec3::Y * (point.x - 0.5 * point.z)),
    );
    Scene::from_mesh(mesh)
}

fn words(bvh: &Bvh) -> Vec<u32> {
    let words = |part: &[u32]| part.to_vec();
    let nodes = bvh.nodes().iter().flat_map(|node| {
        let [low, high] = [node.min, node.max].map(|corner| corner.map(f32::to_bits));
        words(&[low[0], low[1], low[2], node.link, high[0], high[1], high[2], node.count])
    });
    let triangles = bvh.triangles().iter().flat_map(|triangle| {
        let mut words: Vec<u32> =
            [triangle.v0, triangle.v1, triangle.v2].as_flattened().iter().map(|x| x.to_bits()).collect();
        words.extend([triangle.primitive, triangle.geometry_and_mirror, triangle.instance_and_mask]);
        words
    });
    nodes.chain(triangles).collect()
}

fn rays(scene: &Scene) -> Vec<Ray> {
    let flat = scene.flatten().unwrap();
    let maker = RayMaker::new(&flat, 4);
    let none = |rays: &[Ray]| vec![Hit::MISS; rays.len()];
    [RayClass::Random, RayClass::Primary, RayClass::Vertices, RayClass::Invalid]
        .into_iter()
        .flat_map(|class| maker.make(class, 3000, &none))
        .collect()
}

/// Everything that must be the same: trees, answers and counters.
#[derive(PartialEq)]
struct Seen {
    trees: Vec<Vec<u32>>,
    answers: Vec<Traced>,
}

fn look(scene: &Scene, rays: &[Ray]) -> Seen {
    let mut seen = Seen { trees: Vec::new(), answers: Vec::new() };
    let plain = BuildOptions::default();
    for options in [
        plain,
        BuildOptions { leaf_order: LeafOrder::Left, ..plain },
        BuildOptions { builder: Builder::SweepSah, ..plain },
        BuildOptions { builder: Builder::Sbvh, ..plain },
        BuildOptions { builder: Builder::Sbvh, duplication: 3, reinsertion: 1, ..plain },
    ] {
        let bvh = scene.build(&options).unwrap();
        let (mut hits, mut any) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
        bvh.closest_batch(rays, &mut hits);
        bvh.any_batch(rays, &mut any);
        for ((ray, hit), any) in rays.iter().zip(&hits).zip(any) {
            let alone = bvh.closest(ray);
            assert_eq!(hit.to_words(), alone.to_words(), "a batch and a single ray differ");
            assert_eq!(any, alone.is_hit());
        }
        let options = TraceOptions { counters: true };
        seen.answers
            .extend(Query::EVERY.map(|query| bvh.trace(Walk::default(), query, rays, options).unwrap()));
        seen.trees.push(words(&bvh));
    }
    seen
}

fn assert_same(first: &Seen, again: &Seen, what: &str) {
    assert!(first.trees == again.trees, "{what}: the tree differs");
    assert!(first.answers == again.answers, "{what}: an answer or a counter differs");
}

#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_gives_the_same_tree_and_hits() {
    let scene = scene();
    let rays = rays(&scene);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| look(&scene, &rays))
    };
    let first = with(1);
    // Eight more than once: a race would not show every time.
    for threads in [2, 3, 8, 8, 8] {
        assert_same(&first, &with(threads), &format!("{threads} threads"));
    }
}

#[test]
fn building_again_gives_the_same_tree_and_hits() {
    let scene = scene();
    let rays = rays(&scene);
    let first = look(&scene, &rays);
    for _ in 0..2 {
        assert_same(&first, &look(&scene, &rays), "again");
    }
}
