//! What the builder makes: valid trees, the same for any number of threads, within their bounds.

use super::support::{builds, interior, scenes};
use ropewalk::kd_tree::{Depth, KdNode, KdOptions, KdPlace, MAX_DEPTH, OUTSIDE};
use ropewalk::{BuildError, KdTree, Mesh, Scene, glam};
use ropewalk_testkit::meshes;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

#[test]
fn nodes_are_8_bytes_and_places_32() {
    assert_eq!((size_of::<KdNode>(), size_of::<KdPlace>()), (8, 32));
}

#[test]
fn every_tree_is_valid() {
    for (name, scene) in scenes() {
        for options in builds() {
            let tree = scene.build_kd(&options).unwrap();
            tree.validate().unwrap_or_else(|error| panic!("{name}, {options:?}: {error}"));
            let report = tree.report();
            let depth = options.max_depth.of(report.triangles);
            assert!(report.depth <= depth, "{name}, {options:?}");
            assert!(
                report.references <= report.triangles * options.duplication as usize,
                "{name}, {options:?}"
            );
            assert_eq!(report.references, tree.references().len());
            assert!(tree.passive_references() <= report.references);
            let parts = (tree.nodes().to_vec(), tree.references().to_vec(), tree.triangles().to_vec());
            let again = KdTree::from_parts(parts.0, parts.1, parts.2).unwrap();
            // Of what only touches a cell, rounding decides.
            let difference = again.passive_references().abs_diff(tree.passive_references());
            assert!(difference <= report.references / 50 + 2, "{name}: {difference}");
            assert_eq!(again.report().sah_cost, report.sah_cost, "{name}");
        }
    }
}

/// The lower child is the next node, and the upper one follows the lower one's last.
#[test]
fn the_first_child_is_beside_its_parent() {
    let tree = Scene::from_mesh(interior()).build_kd(&KdOptions::default()).unwrap();
    let places = tree.places();
    for (index, node) in (0..).zip(tree.nodes()).filter(|(_, node)| !node.is_leaf()) {
        assert_eq!(places[index as usize + 1].parent, index);
        assert_eq!(places[node.upper() as usize].parent, index);
        let [lower, upper] = [index + 1, node.upper()].map(|child| places[child as usize].bounds());
        assert_eq!(lower.max[node.axis()], node.split());
        assert_eq!(upper.min[node.axis()], node.split());
        assert_eq!(lower.union(upper), places[index as usize].bounds());
    }
}

/// A rope leads to a node beyond the face that covers it, and to none smaller that does.
#[test]
fn ropes_lead_beyond_the_faces() {
    for (name, scene) in scenes() {
        let tree = scene.build_kd(&KdOptions::default()).unwrap();
        let leaves = tree.places().iter().filter(|place| place.leaf != KdPlace::NONE);
        assert_eq!(tree.ropes().len(), tree.report().leaves, "{name}");
        for (place, ropes) in leaves.zip(tree.ropes()) {
            for (face, &rope) in ropes.iter().enumerate() {
                let (axis, upper) = (face / 2, face % 2 == 1);
                let at = if upper { place.max[axis] } else { place.min[axis] };
                if rope == OUTSIDE {
                    let bounds = tree.bounds();
                    assert_eq!(at, if upper { bounds.max[axis] } else { bounds.min[axis] }, "{name}");
                    continue;
                }
                let covers = |node: u32| {
                    let beyond = tree.places()[node as usize];
                    let touches = if upper { beyond.min[axis] } else { beyond.max[axis] };
                    let others = (0..3).filter(|&other| other != axis);
                    touches == at
                        && others
                            .into_iter()
                            .all(|it| beyond.min[it] <= place.min[it] && place.max[it] <= beyond.max[it])
                };
                assert!(covers(rope), "{name}");
                let node = tree.nodes()[rope as usize];
                assert!(node.is_leaf() || !(covers(rope + 1) || covers(node.upper())), "{name}");
            }
        }
    }
}

#[test]
fn any_number_of_threads_makes_the_same_tree() {
    let mut mesh = meshes::soup(6000, 0.1, 3);
    meshes::append(&mut mesh, &interior());
    let scene = Scene::from_mesh(mesh);
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| scene.build_kd(&KdOptions::default()).unwrap())
    };
    let one = build(1);
    for threads in [2, 4] {
        let other = build(threads);
        assert!(one.nodes() == other.nodes() && one.references() == other.references(), "{threads} threads");
        assert_eq!(one.passive_references(), other.passive_references());
    }
}

#[test]
fn small_scenes_have_small_trees() {
    let build =
        |count| Scene::from_mesh(meshes::soup(count, 0.5, 1)).build_kd(&KdOptions::default()).unwrap();
    let none = build(0);
    assert!(none.nodes().is_empty() && none.places().is_empty() && none.ropes().is_empty());
    assert!(none.bounds().is_empty() && !none.has_repeats());
    let one = build(1);
    assert_eq!((one.nodes(), one.references()), (&[KdNode::leaf(0, 1)][..], &[0][..]));
    assert_eq!(one.ropes(), [[OUTSIDE; 6]]);
}

/// Long slanted triangles through each other: their boxes overlap every cell, and only the bound keeps them out of all.
#[test]
fn memory_is_bounded() {
    let mut mesh = Mesh::default();
    for k in 0..2000 {
        let turn =
            glam::DQuat::from_rotation_z(f64::from(k) * 0.01) * glam::DQuat::from_rotation_x(f64::from(k));
        meshes::push(
            &mut mesh,
            [glam::DVec3::NEG_ONE, glam::DVec3::ONE, glam::DVec3::new(1.0, 0.9, 1.0)].map(|it| turn * it),
        );
    }
    let scene = Scene::from_mesh(mesh);
    for duplication in [1, 4, 32] {
        let options =
            KdOptions { duplication, intersection_cost: 10_000, traversal_cost: 1, ..KdOptions::default() };
        let tree = scene.build_kd(&options).unwrap();
        tree.validate().unwrap();
        assert!(tree.references().len() <= 2000 * duplication as usize, "{duplication}");
    }
}

#[test]
fn the_monitor_sees_every_triangle_and_may_stop() {
    let scene = Scene::from_mesh(meshes::soup(20_000, 0.05, 3));
    let most = AtomicUsize::new(0);
    let watch = |done: usize, total: usize| {
        assert!(done <= total && total == 20_000);
        most.fetch_max(done, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    scene.build_kd_monitored(&KdOptions::default(), &watch).unwrap();
    assert_eq!(most.into_inner(), 20_000);
    let stop = |_: usize, _: usize| ControlFlow::Break(());
    let stopped = scene.build_kd_monitored(&KdOptions::default(), &stop);
    assert_eq!(stopped.unwrap_err(), BuildError::Cancelled);
}

#[test]
fn options_out_of_range_are_errors() {
    let options = KdOptions { max_depth: Depth::Cap(MAX_DEPTH + 1), ..KdOptions::default() };
    let error = Scene::default().build_kd(&options).unwrap_err();
    assert!(error.to_string().contains("between 1 and 60"), "{error}");
}
