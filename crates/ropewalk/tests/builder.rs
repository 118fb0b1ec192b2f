//! The promises of every builder: leaves and depth within their limits, valid trees of any input, errors for
//! options out of range, progress and cancelling, leaves first.

use glam::{DVec3, Vec3};
use ropewalk::bvh::{LeafOrder, MAX_DEPTH, Node};
use ropewalk::{BuildError, BuildOptions, Builder, Bvh, Mesh, NoMonitor, Scene, glam};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

const BUILDERS: [Builder; 3] = [Builder::BinnedSah, Builder::SweepSah, Builder::Sbvh];

fn by(builder: Builder) -> BuildOptions {
    BuildOptions { builder, ..BuildOptions::default() }
}

/// What is hard for a builder, beyond the cases of the suite.
fn nasty() -> Vec<(&'static str, Scene)> {
    let mut random = Random::new(8);
    let mut scenes: Vec<(&str, Scene)> =
        Case::every().into_iter().map(|case| (case.name, case.scene)).collect();
    let mut add = |name, mesh: Mesh| scenes.push((name, Scene::from_mesh(mesh)));

    let one = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let mut mesh = Mesh::default();
    (0..3000).for_each(|_| meshes::push(&mut mesh, one));
    add("the same triangle 3,000 times", mesh);

    let mut mesh = Mesh::default();
    for k in 0..2000 {
        meshes::push(&mut mesh, one.map(|corner| corner + DVec3::X * f64::from(k)));
    }
    add("a row", mesh);

    // Doubling distances: every split by area or middle cuts off one.
    let mut mesh = Mesh::default();
    for k in 0..120 {
        meshes::push(&mut mesh, one.map(|corner| (corner + DVec3::X) * 2f64.powi(k - 80)));
    }
    add("a geometric series", mesh);

    let mut mesh = Mesh::default();
    for k in 0..1000 {
        let far = if k % 10 == 0 { 1e11 } else { 1.0 };
        let center = random.in_cube() * far;
        meshes::push(&mut mesh, [(); 3].map(|()| center + random.in_cube() * 1e-3 * far));
    }
    add("near and far", mesh);

    let mut mesh = Mesh::default();
    for _ in 0..1000 {
        let center = random.in_cube() * 1e-30;
        meshes::push(&mut mesh, [(); 3].map(|()| center + random.in_cube() * 1e-30));
    }
    add("areas that vanish in f32", mesh);

    let mut mesh = meshes::soup(6000, 0.01, 9);
    mesh.positions.iter_mut().for_each(|position| position.z = 0.0);
    add("flat", mesh);
    scenes
}

fn most_in_a_leaf(bvh: &Bvh) -> u32 {
    bvh.nodes().iter().filter(|node| node.is_leaf()).map(|node| node.count).max().unwrap_or(0)
}

/// The deepest leaf, found by going down, not by the report.
fn depth(bvh: &Bvh) -> u32 {
    let mut deepest = 0;
    let mut pending = vec![(0u32, 0u32)];
    while let Some((index, depth)) = pending.pop() {
        let Some(node) = bvh.nodes().get(index as usize) else { continue };
        if node.is_leaf() {
            deepest = deepest.max(depth);
        } else {
            pending.extend([(index + 1, depth + 1), (node.link, depth + 1)]);
        }
    }
    deepest
}

#[test]
fn leaves_and_depth_keep_their_limits_on_any_input() {
    for (name, scene) in nasty() {
        let flat = scene.flatten().unwrap();
        let triangles = flat.triangles.len();
        for (max_leaf, max_depth, bins) in [
            (1, 64, 16),
            (1, 63, 16),
            (1, 31, 2),
            (1, 8, 32),
            (2, 3, 16),
            (3, 2, 8),
            (4, 48, 16),
            (8, 1, 7),
            (255, 64, 3),
            (16, 64, 16),
        ] {
            for builder in BUILDERS {
                for leaf_order in [LeafOrder::Split, LeafOrder::Left] {
                    let options = BuildOptions { max_leaf, max_depth, bins, leaf_order, ..by(builder) };
                    check_limits(name, &scene, &options, triangles);
                }
            }
        }
    }
}

fn check_limits(name: &str, scene: &Scene, options: &BuildOptions, triangles: usize) {
    let bvh = scene.build(options).unwrap();
    bvh.validate().unwrap_or_else(|error| panic!("{name} {options:?}: {error}"));
    let report = bvh.report();
    let max_depth = options.max_depth;
    assert!(depth(&bvh) <= max_depth, "{name} {options:?}: depth {}", depth(&bvh));
    // A leaf may grow only where the depth cap leaves no room: halving all the way, rounded up.
    let room = triangles.div_ceil(1 << max_depth.min(60)).max(options.max_leaf as usize);
    let largest = most_in_a_leaf(&bvh);
    assert!(largest as usize <= room, "{name} {options:?}: {largest} in a leaf, {room} would do");
    let references = bvh.triangles().len();
    let allowed = match options.builder {
        Builder::Sbvh => triangles + triangles * options.duplication as usize / 100,
        _ => triangles,
    };
    assert!((triangles..=allowed).contains(&references), "{name} {options:?}: {references} of {triangles}");

    assert_eq!(report.depth, depth(&bvh), "{name}");
    assert_eq!(report.largest_leaf, largest, "{name}");
    assert_eq!((report.triangles, report.references), (triangles, references), "{name}");
    assert_eq!(bvh.has_repeats(), references > triangles, "{name}");
    assert_eq!(report.input, scene.flatten().unwrap().report, "{name}");
    assert_eq!(report.nodes, bvh.nodes().len());
    assert_eq!(report.nodes, (2 * report.leaves).saturating_sub(1), "{name}");
    assert_eq!(report.bytes, 32 * report.nodes + 48 * references);
    assert!(report.sah_cost.is_finite() && report.sah_cost >= 0.0, "{name}: {}", report.sah_cost);
}

#[test]
fn every_triangle_is_in_the_tree_as_it_was() {
    for (name, scene) in nasty() {
        let flat = scene.flatten().unwrap().triangles;
        for builder in BUILDERS {
            let bvh = scene.build(&by(builder)).unwrap();
            let mut built = bvh.triangles().to_vec();
            built.sort_by_key(|triangle| (triangle.instance(), triangle.geometry(), triangle.primitive));
            if builder == Builder::Sbvh {
                built.dedup();
            }
            assert!(built == flat, "{name} {builder:?}: the leaves do not hold the triangles of the scene");
        }
    }
}

#[test]
fn options_out_of_range_are_errors_that_name_the_range() {
    let scene = Scene::from_mesh(meshes::icosphere(1));
    let plain = BuildOptions::default();
    for (options, name, largest) in [
        (BuildOptions { max_leaf: 0, ..plain }, "max-leaf", "255"),
        (BuildOptions { max_leaf: 256, ..plain }, "max-leaf", "255"),
        (BuildOptions { max_leaf: u32::MAX, ..plain }, "max-leaf", "255"),
        (BuildOptions { max_depth: 0, ..plain }, "max-depth", "64"),
        (BuildOptions { max_depth: MAX_DEPTH + 1, ..plain }, "max-depth", "64"),
        (BuildOptions { max_depth: u32::MAX, ..plain }, "max-depth", "64"),
        (BuildOptions { bins: 0, ..plain }, "bins", "32"),
        (BuildOptions { bins: 1, ..plain }, "bins", "32"),
        (BuildOptions { bins: 33, ..plain }, "bins", "32"),
        (BuildOptions { duplication: 401, ..plain }, "duplication", "400"),
        (BuildOptions { reinsertion: 33, ..plain }, "reinsertion", "32"),
    ] {
        for scene in [&scene, &Scene::default()] {
            let error = scene.build(&options).expect_err(name);
            assert!(matches!(error, BuildError::Option { .. }));
            let text = error.to_string();
            assert!(text.contains(name) && text.contains(largest), "{text}");
        }
    }
}

#[test]
fn progress_only_grows_and_reaches_the_total() {
    for (builder, triangles) in
        BUILDERS.into_iter().flat_map(|builder| [1, 100, 5000, 100_000].map(|triangles| (builder, triangles)))
    {
        let scene = Scene::from_mesh(meshes::soup(triangles, 0.01, 3));
        let total = triangles as usize;
        let heard = Mutex::new(Vec::new());
        let monitor = |done: usize, of: usize| {
            assert_eq!(of, total);
            assert!(done <= total);
            heard.lock().unwrap().push(done);
            ControlFlow::Continue(())
        };
        let bvh = scene.build_monitored(&by(builder), &monitor).unwrap();
        let mut heard = heard.into_inner().unwrap();
        // Threads may overtake each other on the way to the monitor, but each amount is told once.
        heard.sort_unstable();
        assert!(heard.windows(2).all(|pair| pair[0] < pair[1]), "{triangles}");
        assert_eq!(heard.last(), Some(&total));
        assert!(triangles < 100_000 || heard.len() > 10, "a long build is heard of {} times", heard.len());
        let alone = scene.build_monitored(&by(builder), &NoMonitor).unwrap();
        assert!(alone.nodes() == bvh.nodes(), "listening changes nothing");
    }
}

#[test]
fn a_build_can_be_cancelled_at_any_point() {
    let scene = Scene::from_mesh(meshes::soup(100_000, 0.01, 3));
    BUILDERS.into_iter().for_each(|builder| check_cancelling(&scene, &by(builder)));
}

fn check_cancelling(scene: &Scene, options: &BuildOptions) {
    let calls = AtomicUsize::new(0);
    let count = |_: usize, _: usize| {
        calls.fetch_add(1, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    scene.build_monitored(options, &count).unwrap();
    let calls = calls.into_inner();
    for stop_at in [1, 2, calls / 2, calls - 1, calls] {
        let heard = AtomicUsize::new(0);
        let stop = |_: usize, _: usize| {
            if heard.fetch_add(1, Ordering::Relaxed) + 1 >= stop_at {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let error = scene.build_monitored(options, &stop).expect_err("cancelled");
        assert_eq!(error, BuildError::Cancelled, "at call {stop_at} of {calls}");
    }
    // Stopped at once it must not do the whole work first.
    let heard = AtomicUsize::new(0);
    let stop = |_: usize, _: usize| {
        heard.fetch_add(1, Ordering::Relaxed);
        ControlFlow::Break(())
    };
    assert_eq!(scene.build_monitored(options, &stop).unwrap_err(), BuildError::Cancelled);
    assert!(heard.into_inner() < calls / 2 + 8, "the other threads go on");
}

#[test]
fn putting_leaves_first_swaps_children_and_nothing_else() {
    for (name, scene, builder) in
        nasty().into_iter().flat_map(|(name, scene)| BUILDERS.map(|builder| (name, scene.clone(), builder)))
    {
        let build = |leaf_order| scene.build(&BuildOptions { leaf_order, max_leaf: 2, ..by(builder) });
        let (split, left) = (build(LeafOrder::Split).unwrap(), build(LeafOrder::Left).unwrap());
        assert!(split.triangles() == left.triangles(), "{name}: the triangles moved");
        assert_eq!(split.nodes().len(), left.nodes().len(), "{name}");
        let mut pending = vec![(0u32, 0u32)];
        while let Some((a, b)) = pending.pop() {
            let (Some(plain), Some(swapped)) = (split.nodes().get(a as usize), left.nodes().get(b as usize))
            else {
                assert!(split.nodes().is_empty(), "{name}");
                continue;
            };
            assert_eq!(plain.bounds(), swapped.bounds(), "{name}");
            assert_eq!(plain.count, swapped.count, "{name}");
            if plain.is_leaf() {
                assert_eq!(plain.link, swapped.link, "{name}");
                continue;
            }
            let is_leaf = |bvh: &Bvh, index: u32| bvh.nodes()[index as usize].is_leaf();
            let (of_plain, of_swapped) = ([a + 1, plain.link], [b + 1, swapped.link]);
            let leaves = of_plain.map(|child| is_leaf(&split, child));
            if leaves[0] != leaves[1] {
                assert!(is_leaf(&left, of_swapped[0]), "{name}: the leaf of node {b} is not first");
            }
            let same_order = !leaves[1] || leaves[0];
            let of_plain = if same_order { of_plain } else { [of_plain[1], of_plain[0]] };
            pending.extend(of_plain.into_iter().zip(of_swapped));
        }
    }
}

/// The chain goes as deep as it may, at every cap, and no deeper.
#[test]
fn deep_chains_stop_at_the_cap() {
    let scene = Case::named("chain").unwrap().scene;
    for builder in BUILDERS {
        let deepest = |max_depth, bins| {
            let bvh = scene.build(&BuildOptions { max_leaf: 1, max_depth, bins, ..by(builder) }).unwrap();
            depth(&bvh)
        };
        let free = deepest(64, 16);
        assert!(free > 12, "{builder:?}: the chain is only {free} deep: it tests nothing");
        assert!(deepest(63, 16) <= 63 && deepest(31, 16) <= 31, "{builder:?}");
        assert_eq!(deepest(8, 16), 8, "a hundred triangles need seven levels, and the chain wants more");
        // Few bins see less and cut off less at a time: deeper still.
        assert!(deepest(64, 2) <= 64, "{builder:?}");
    }
}

/// A tree made by hand as deep as a tree may be: every walk finds what is at its end.
#[test]
fn a_tree_of_the_largest_depth_is_walked_to_its_end() {
    use ropewalk::{Query, Ray, StructureKind, TraceError, TraceOptions, Walk, catalogue};
    let levels = MAX_DEPTH;
    let mut mesh = Mesh::default();
    for k in 0..=levels {
        let x = DVec3::X * f64::from(k);
        meshes::push(&mut mesh, [x, x + DVec3::Y, x + DVec3::Z]);
    }
    let flat = Scene::from_mesh(mesh).flatten().unwrap();
    // Node k holds everything from triangle k on. Each inner node has its leaf second, so that a walk that goes
    // first child first must keep them all.
    let bounds = |from: usize| {
        let boxes = flat.triangles[from..].iter().map(|triangle| triangle.triangle().bounds());
        boxes.fold(ropewalk::Aabb::EMPTY, ropewalk::Aabb::union)
    };
    let mut nodes = Vec::new();
    for k in 0..levels {
        // Depth-first: all inner nodes, the deepest leaf, then the other leaves from the deepest up.
        let second = levels + 1 + (levels - 1 - k);
        nodes.push(Node::inner(&bounds(k as usize), second));
    }
    nodes.push(Node::leaf(&bounds(levels as usize), levels, 1));
    for k in (0..levels).rev() {
        nodes.push(Node::leaf(&flat.triangles[k as usize].triangle().bounds(), k, 1));
    }
    let bvh = Bvh::from_parts(nodes, flat.triangles).unwrap();
    assert_eq!(bvh.report().depth, MAX_DEPTH);
    let forth = Ray::new(Vec3::new(-1.0, 0.2, 0.2), Vec3::X);
    let back = Ray::new(Vec3::new(100.0, 0.2, 0.2), Vec3::NEG_X);
    for walk in Walk::EVERY {
        for query in [Query::Closest, Query::Any, Query::Count] {
            if catalogue::check(StructureKind::Bvh, walk, query, ropewalk::DeviceKind::Cpu).is_err() {
                continue;
            }
            let options = TraceOptions { counters: true };
            let traced = match bvh.trace(walk, query, &[forth, back], options) {
                Err(TraceError::TooDeep { limit, .. }) if limit < MAX_DEPTH => continue,
                traced => traced.unwrap(),
            };
            let depth = traced.totals().unwrap().stack_depth;
            assert!(depth <= MAX_DEPTH, "{walk}");
            match traced.answer {
                ropewalk::Answer::Closest(hits) => {
                    assert_eq!((hits[0].primitive_index, hits[1].primitive_index), (0, levels), "{walk}");
                }
                ropewalk::Answer::Any(hits) => assert_eq!(hits, [true; 2], "{walk}"),
                ropewalk::Answer::Count(counts) => assert_eq!(counts, [levels + 1; 2], "{walk}"),
                ropewalk::Answer::All(_) => {}
            }
        }
    }
}
