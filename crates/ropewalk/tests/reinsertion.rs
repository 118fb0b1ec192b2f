//! The promises of reinsertion, after every builder: valid trees of the same leaves, a cost that never rises, the
//! depth cap, the same tree for any number of threads, the same hits.

use glam::{DVec3, Vec3};
use ropewalk::bvh::{LeafOrder, Node};
use ropewalk::{BuildError, BuildOptions, Builder, Bvh, FlatTriangle, Hit, Mesh, Query, Ray, Scene, glam};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;
use ropewalk_testkit::rays::{RayClass, RayMaker};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

const BUILDERS: [Builder; 3] = [Builder::BinnedSah, Builder::SweepSah, Builder::Sbvh];

/// Few bins and small leaves: much is left to gain.
fn options(builder: Builder, reinsertion: u32) -> BuildOptions {
    BuildOptions { builder, reinsertion, max_leaf: 2, bins: 4, ..BuildOptions::default() }
}

/// The cases of the suite, and what is hard for moving subtrees in particular.
fn scenes() -> Vec<(&'static str, Scene)> {
    let mut random = Random::new(61);
    let mut scenes: Vec<(&str, Scene)> =
        Case::every().into_iter().map(|case| (case.name, case.scene)).collect();
    let mut add = |name, mesh: Mesh| scenes.push((name, Scene::from_mesh(mesh)));
    for triangles in 1..=5 {
        add("a few triangles", meshes::soup(triangles, 0.3, 62));
    }
    let one = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let mut mesh = Mesh::default();
    (0..1000).for_each(|_| meshes::push(&mut mesh, one));
    add("the same triangle 1,000 times", mesh);

    let mut mesh = meshes::soup(2000, 0.05, 63);
    mesh.positions.iter_mut().for_each(|position| position.y = 0.25);
    add("flat boxes", mesh);

    let mut mesh = Mesh::default();
    for k in 0..500 {
        meshes::push(&mut mesh, one.map(|corner| (corner + DVec3::X * f64::from(k)).with_y(0.0)));
    }
    add("boxes without area", mesh);

    for (name, scale) in [("as large as it may be", 9e11), ("vanishing areas", 1e-21), ("subnormal", 1e-39)] {
        add(name, meshes::mapped(meshes::soup(600, 0.1, 64), |point| point * scale));
    }
    let huge = |point: DVec3| if point.x > 0.0 { point * 1e30 } else { point };
    add("beyond what is allowed", meshes::mapped(meshes::soup(600, 0.1, 65), huge));

    let mut mesh = Mesh::default();
    for k in 0..1500 {
        let far = [1e-6, 1.0, 1e6, 1e11][k % 4];
        let center = random.in_cube() * far;
        meshes::push(&mut mesh, [(); 3].map(|()| center + random.in_cube() * 1e-2 * far));
    }
    add("four scales at one place", mesh);
    scenes
}

/// Triangles of sizes 2^-k towards zero, `k` at most 100: a tree of them wants to be a chain.
fn chain(triangles: i32, seed: u64) -> Scene {
    let (mut mesh, mut random) = (Mesh::default(), Random::new(seed));
    for k in 0..triangles {
        let size = 0.5f64.powi(k % 100);
        let center = DVec3::new(size, 0.3 * size, 0.1 * size);
        meshes::push(&mut mesh, [(); 3].map(|()| center + random.in_cube() * (0.3 * size)));
    }
    Scene::from_mesh(mesh)
}

fn words(triangle: &FlatTriangle) -> Vec<u32> {
    let corners = [triangle.v0, triangle.v1, triangle.v2];
    let ids = [triangle.primitive, triangle.geometry_and_mirror, triangle.instance_and_mask];
    corners.as_flattened().iter().map(|x| x.to_bits()).chain(ids).collect()
}

/// The leaves without their order: boxes and triangles.
fn leaves(bvh: &Bvh) -> Vec<Vec<u32>> {
    let leaf = |node: &Node| {
        let range = node.link as usize..(node.link + node.count) as usize;
        let triangles = bvh.triangles()[range].iter().flat_map(words);
        [node.min, node.max].as_flattened().iter().map(|x| x.to_bits()).chain(triangles).collect()
    };
    let mut leaves: Vec<Vec<u32>> = bvh.nodes().iter().filter(|node| node.is_leaf()).map(leaf).collect();
    leaves.sort_unstable();
    leaves
}

/// Whether the triangles of the leaves follow each other as the leaves do.
fn memory_follows_the_tree(bvh: &Bvh) -> bool {
    let mut next = 0;
    bvh.nodes().iter().filter(|node| node.is_leaf()).all(|leaf| {
        let follows = leaf.link == next;
        next += leaf.count;
        follows
    })
}

#[test]
fn every_tree_stays_valid_and_its_cost_never_rises() {
    for (name, scene) in scenes() {
        for builder in BUILDERS {
            let before = scene.build(&options(builder, 0)).unwrap();
            let mut cost = before.report().sah_cost;
            for rounds in [1, 2, 5, 32] {
                let options = options(builder, rounds);
                let after = scene.build(&options).unwrap();
                let at = format!("{name}, {builder:?}, {rounds} rounds");
                after.validate().unwrap_or_else(|error| panic!("{at}: {error}"));
                let report = after.report();
                assert!(report.sah_cost <= cost, "{at}: {} after {cost}", report.sah_cost);
                assert!(report.depth <= options.max_depth, "{at}: depth {}", report.depth);
                assert!(memory_follows_the_tree(&after), "{at}");
                assert!(leaves(&before) == leaves(&after), "{at}: the leaves are not what they were");
                assert_eq!(before.has_repeats(), after.has_repeats(), "{at}");
                cost = report.sah_cost;
            }
        }
    }
}

#[test]
fn trees_with_much_to_gain_gain_much() {
    let mut long = Mesh::default();
    let mut random = Random::new(66);
    for _ in 0..2000 {
        let (center, along) = (random.in_cube(), random.pick(&[DVec3::X, DVec3::Y, DVec3::Z]));
        meshes::push(&mut long, [center - along, center + along, center + random.in_cube() * 0.01]);
    }
    let two_bins = BuildOptions { bins: 2, max_leaf: 1, ..BuildOptions::default() };
    for (name, mesh, share) in [
        ("long triangles", long, 0.9),
        ("a soup", meshes::soup(4000, 0.05, 67), 0.97),
        ("a sphere", meshes::icosphere(4), 0.99),
    ] {
        let scene = Scene::from_mesh(mesh);
        let mut cost = scene.build(&two_bins).unwrap().report().sah_cost;
        let first = cost;
        for reinsertion in 1..=3 {
            let bvh = scene.build(&BuildOptions { reinsertion, ..two_bins }).unwrap();
            let now = bvh.report().sah_cost;
            assert!(now < cost, "{name}, round {reinsertion}: {now} after {cost}");
            cost = now;
        }
        assert!(cost < share * first, "{name}: {cost}, at first {first}");
    }
}

#[test]
fn the_depth_cap_is_kept() {
    for triangles in [3, 40, 100, 400] {
        let scene = chain(triangles, 68);
        for builder in BUILDERS {
            for max_depth in [1, 4, 8, 31, 63, 64] {
                for max_leaf in [1, 4] {
                    let options = BuildOptions { builder, max_depth, max_leaf, ..BuildOptions::default() };
                    let before = scene.build(&options).unwrap();
                    for reinsertion in [1, 2, 5, 32] {
                        let after = scene.build(&BuildOptions { reinsertion, ..options }).unwrap();
                        let at = format!("{triangles} triangles, {options:?}, {reinsertion} rounds");
                        after.validate().unwrap_or_else(|error| panic!("{at}: {error}"));
                        assert!(after.report().depth <= max_depth, "{at}: depth {}", after.report().depth);
                        assert!(after.report().sah_cost <= before.report().sah_cost, "{at}");
                        assert_eq!(after.report().largest_leaf, before.report().largest_leaf, "{at}");
                    }
                }
            }
        }
    }
}

/// Large enough that every part that may use threads does.
#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_gives_the_same_tree() {
    let mut mesh = meshes::soup(12_000, 0.1, 69);
    meshes::append(&mut mesh, &meshes::icosphere(4));
    let copy = mesh.clone();
    // Duplicates, where equal gains must be told apart.
    meshes::append(&mut mesh, &copy);
    let scene = Scene::from_mesh(mesh);
    for builder in BUILDERS {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| scene.build(&options(builder, 3)).unwrap())
        };
        let first = with(1);
        for threads in [2, 4, 4, 8] {
            let again = with(threads);
            assert!(first.nodes() == again.nodes(), "{builder:?}, {threads} threads: the nodes differ");
            let [a, b] = [&first, &again].map(|bvh| bvh.triangles().iter().map(words).collect::<Vec<_>>());
            assert!(a == b, "{builder:?}, {threads} threads: the triangles differ");
        }
    }
}

#[test]
fn hits_are_the_same_to_the_bit() {
    for case in Case::every() {
        for builder in BUILDERS {
            let before = case.scene.build(&options(builder, 0)).unwrap();
            for leaf_order in [LeafOrder::Split, LeafOrder::Left] {
                let after = case.scene.build(&BuildOptions { leaf_order, ..options(builder, 4) }).unwrap();
                after.validate().unwrap_or_else(|error| panic!("{} {builder:?}: {error}", case.name));
                for ray in &case.rays {
                    let [a, b] = [&before, &after].map(|bvh| bvh.closest(ray).to_words());
                    assert_eq!(a, b, "{} {builder:?} {ray:?}", case.name);
                    assert_eq!(before.any(ray), after.any(ray), "{} {builder:?} {ray:?}", case.name);
                }
            }
        }
    }
}

/// What the rounds are for: fewer visits, not only a lower cost.
#[test]
fn rays_visit_fewer_nodes_of_a_bad_tree_after_it() {
    let mut mesh = Mesh::default();
    let mut random = Random::new(70);
    for _ in 0..3000 {
        let (center, along) = (random.in_cube(), random.pick(&[DVec3::X, DVec3::Y, DVec3::Z]) * 0.3);
        meshes::push(&mut mesh, [center - along, center + along, center + random.in_cube() * 0.01]);
    }
    let scene = Scene::from_mesh(mesh);
    let flat = scene.flatten().unwrap();
    let none = |rays: &[Ray]| vec![Hit::MISS; rays.len()];
    let rays = RayMaker::new(&flat, 71).make(RayClass::Random, 4000, &none);
    let visits = |reinsertion: u32| {
        let bvh = scene.build(&options(Builder::BinnedSah, reinsertion)).unwrap();
        let counted = ropewalk::TraceOptions { counters: true };
        let traced = bvh.trace(ropewalk::Walk::default(), Query::Closest, &rays, counted).unwrap();
        traced.totals().unwrap().inner_visits as f64
    };
    let (before, after) = (visits(0), visits(3));
    assert!(after < 0.9 * before, "{after} visits, {before} before");
}

#[test]
fn rounds_can_be_cancelled() {
    let scene = Scene::from_mesh(meshes::soup(3000, 0.2, 72));
    let options = options(Builder::BinnedSah, 32);
    let calls = AtomicUsize::new(0);
    let count = |done: usize, total: usize| {
        assert!(done <= total && total == 3000);
        calls.fetch_add(1, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    let plain = BuildOptions { reinsertion: 0, ..options };
    scene.build_monitored(&plain, &count).unwrap();
    let of_the_builder = calls.swap(0, Ordering::Relaxed);
    scene.build_monitored(&options, &count).unwrap();
    let all = calls.load(Ordering::Relaxed);
    assert!(all > of_the_builder + 3, "{all} calls, {of_the_builder} of them before the rounds");
    for allowed in of_the_builder..all {
        let calls = AtomicUsize::new(0);
        let stop = |_: usize, _: usize| {
            let go_on = calls.fetch_add(1, Ordering::Relaxed) < allowed;
            if go_on { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let built = scene.build_monitored(&options, &stop);
        assert_eq!(built.err(), Some(BuildError::Cancelled), "after {allowed} of {all} calls");
    }
}

#[test]
fn too_many_rounds_are_an_error_that_names_the_range() {
    let scene = Scene::from_mesh(meshes::icosphere(1));
    let reinsertion = BuildOptions::MAX_REINSERTION + 1;
    let error =
        scene.build(&BuildOptions { reinsertion, ..BuildOptions::default() }).unwrap_err().to_string();
    assert!(error.contains("reinsertion") && error.contains("32"), "{error}");
}

/// What the tests above rely on objects to trees that a wrong move would make.
#[test]
fn wrong_moves_are_noticed() {
    let scene = Scene::from_mesh(meshes::soup(200, 0.6, 73));
    let bvh = scene.build(&options(Builder::BinnedSah, 2)).unwrap();
    let (nodes, triangles) = (bvh.nodes().to_vec(), bvh.triangles().to_vec());
    assert!(Bvh::from_parts(nodes.clone(), triangles.clone()).is_ok());
    let leaf_at: Vec<usize> = (0..nodes.len()).filter(|&index| nodes[index].is_leaf()).collect();
    let (first, last) = (leaf_at[0], leaf_at[leaf_at.len() - 1]);
    let inner = (1..nodes.len()).find(|&index| !nodes[index].is_leaf()).unwrap();
    type Harm<'a> = &'a dyn Fn(&mut Vec<Node>, &mut Vec<FlatTriangle>);
    let wrong: [(&str, Harm<'_>); 5] = [
        ("leaves change places, the boxes above stay", &|nodes, _| nodes.swap(first, last)),
        ("a leaf moves, its triangles stay", &|nodes, _| {
            let (a, b) = (nodes[first].link, nodes[last].link);
            (nodes[first].link, nodes[last].link) = (b, a);
        }),
        ("triangles move, the leaves stay", &|_, triangles| triangles.reverse()),
        ("a box is not made larger for what came", &|nodes, _| {
            nodes[inner].max = Vec3::from(nodes[inner].max).lerp(nodes[inner].min.into(), 0.5).into();
        }),
        ("a link leads where the node was", &|nodes, _| nodes[inner].link += 1),
    ];
    for (what, harm) in wrong {
        let (mut nodes, mut triangles) = (nodes.clone(), triangles.clone());
        harm(&mut nodes, &mut triangles);
        assert!(Bvh::from_parts(nodes, triangles).is_err(), "{what}: not noticed");
    }
    let other = scene.build(&options(Builder::BinnedSah, 0)).unwrap();
    assert!(leaves(&bvh) == leaves(&other) && bvh.nodes() != other.nodes());
    let others = scene.build(&BuildOptions { max_leaf: 1, ..options(Builder::BinnedSah, 0) }).unwrap();
    assert!(leaves(&bvh) != leaves(&others));
}
