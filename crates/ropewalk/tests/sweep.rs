//! What the sweep SAH builder promises beyond what every builder does: no plane between two centres is cheaper than
//! the one that it took, at any node; and its trees are no worse than binned ones.

use glam::Vec3;
use ropewalk::{Aabb, BuildOptions, Builder, Bvh, FlatTriangle, Scene, glam};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::meshes;

fn build(scene: &Scene, max_leaf: u32) -> Bvh {
    let options = BuildOptions { builder: Builder::SweepSah, max_leaf, max_depth: 64, ..Default::default() };
    scene.build(&options).unwrap()
}

/// Half area times count.
fn cost(boxes: &[Aabb]) -> f64 {
    let bounds = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
    let size = bounds.size().as_dvec3();
    (size.x * size.y + size.y * size.z + size.z * size.x) * boxes.len() as f64
}

/// The cheapest of all planes between two centres, by trying each; `None` where all centres are one.
fn cheapest_by_force(boxes: &[Aabb]) -> Option<f64> {
    let doubled_center = |bounds: &Aabb, axis: usize| (bounds.min + bounds.max)[axis];
    let mut cheapest = None;
    for axis in 0..3 {
        let mut sorted = boxes.to_vec();
        sorted.sort_by(|a, b| doubled_center(a, axis).total_cmp(&doubled_center(b, axis)));
        for middle in 1..sorted.len() {
            if doubled_center(&sorted[middle - 1], axis) < doubled_center(&sorted[middle], axis) {
                let (low, high) = sorted.split_at(middle);
                let cost = cost(low) + cost(high);
                cheapest = Some(cheapest.map_or(cost, |least: f64| least.min(cost)));
            }
        }
    }
    cheapest
}

/// The triangles below a node.
fn below(bvh: &Bvh, node: usize) -> &[FlatTriangle] {
    let nodes = bvh.nodes();
    let (mut first, mut last) = (node, node);
    while !nodes[first].is_leaf() {
        first += 1;
    }
    while !nodes[last].is_leaf() {
        last = nodes[last].link as usize;
    }
    &bvh.triangles()[nodes[first].link as usize..(nodes[last].link + nodes[last].count) as usize]
}

/// Compares every decision of the tree with the force; gives back how many there were.
fn check_every_decision(name: &str, bvh: &Bvh, max_leaf: usize) -> Result<usize, String> {
    let boxes = |node: usize| -> Vec<Aabb> {
        below(bvh, node).iter().map(|triangle| triangle.triangle().bounds()).collect()
    };
    for (index, node) in bvh.nodes().iter().enumerate() {
        let all = boxes(index);
        let area = cost(&all) / all.len() as f64;
        // f32 sums and products of the builder against f64.
        let slack = 1e-5 * cost(&all);
        let cheapest = cheapest_by_force(&all);
        if node.is_leaf() {
            let better = cheapest.filter(|split| area + split + slack < cost(&all));
            if all.len() > max_leaf || better.is_some() {
                return Err(format!("{name}: node {index} should not be a leaf of {}", all.len()));
            }
            continue;
        }
        let taken = cost(&boxes(index + 1)) + cost(&boxes(node.link as usize));
        if cheapest.is_some_and(|cheapest| taken > cheapest + slack) {
            return Err(format!("{name}: node {index} costs {taken}, and could {cheapest:?}"));
        }
        if all.len() <= max_leaf && area + taken > cost(&all) + slack {
            return Err(format!("{name}: node {index} would be cheaper as a leaf"));
        }
    }
    Ok(bvh.nodes().len())
}

fn scenes() -> Vec<(&'static str, Scene)> {
    let mut walls = meshes::soup(150, 0.1, 4);
    meshes::append(&mut walls, &meshes::cuboid(Vec3::splat(-1.5), Vec3::splat(1.5)));
    meshes::append(&mut walls, &meshes::grid(1, 0.3, 5, 0.2));
    vec![
        ("sphere", Scene::from_mesh(meshes::icosphere(2))),
        ("soup", Scene::from_mesh(meshes::soup(300, 0.3, 2))),
        ("walls", Scene::from_mesh(walls)),
        ("fan", Scene::from_mesh(meshes::fan(40, 0.1))),
        ("grid", Scene::from_mesh(meshes::grid(2, 0.0, 9, 1.0))),
    ]
}

#[test]
fn no_plane_between_two_centres_is_cheaper() {
    for (name, scene) in scenes() {
        for max_leaf in [1, 2, 4, 16] {
            let nodes = check_every_decision(name, &build(&scene, max_leaf), max_leaf as usize).unwrap();
            assert!(nodes > 10, "{name}: {nodes} nodes test little");
        }
    }
}

/// The checker of this file: bins miss the best plane somewhere, and it must say so.
#[test]
fn a_worse_tree_is_found() {
    let (name, scene) = scenes().swap_remove(1);
    let options = BuildOptions { max_leaf: 2, bins: 2, ..BuildOptions::default() };
    assert!(check_every_decision(name, &scene.build(&options).unwrap(), 2).is_err());
    let unhappy = build(&scene, 8);
    assert!(check_every_decision(name, &unhappy, 1).is_err(), "leaves that are too large");
}

#[test]
fn the_parallel_part_decides_by_the_same_rule() {
    // More references than one thread builds alone: the root and its children are checked by force.
    let scene = Scene::from_mesh(meshes::soup(12_000, 0.05, 6));
    let bvh = build(&scene, 4);
    let boxes = |node: usize| -> Vec<Aabb> {
        below(&bvh, node).iter().map(|triangle| triangle.triangle().bounds()).collect()
    };
    let second = bvh.nodes()[0].link as usize;
    for node in [0, 1, second] {
        let (low, high) = (boxes(node + 1), boxes(bvh.nodes()[node].link as usize));
        let taken = cost(&low) + cost(&high);
        assert_eq!(low.len() + high.len(), boxes(node).len());
        // The force sorts three times; its planes are all it needs, so one of the 36,000 boxes unions a plane would
        // take long: a sample of places near the taken one and across the axis does.
        let cheapest = sampled_cheapest(&boxes(node));
        assert!(taken <= cheapest * (1.0 + 1e-5), "node {node}: {taken}, and could {cheapest}");
    }
}

/// The cheapest of one plane in fifty.
fn sampled_cheapest(boxes: &[Aabb]) -> f64 {
    let mut cheapest = f64::INFINITY;
    for axis in 0..3 {
        let mut sorted = boxes.to_vec();
        sorted.sort_by(|a, b| (a.min + a.max)[axis].total_cmp(&(b.min + b.max)[axis]));
        for middle in (1..sorted.len()).step_by(50) {
            let (low, high) = sorted.split_at(middle);
            cheapest = cheapest.min(cost(low) + cost(high));
        }
    }
    cheapest
}

/// Locally best splits need not make the best tree, but on the whole they make no worse one.
#[test]
fn trees_are_no_worse_than_binned_ones() {
    let mut ratios = Vec::new();
    for case in Case::every() {
        let binned = case.scene.build(&BuildOptions { max_leaf: 1, ..BuildOptions::default() }).unwrap();
        let swept = build(&case.scene, 1);
        if binned.report().sah_cost > 0.0 {
            ratios.push(swept.report().sah_cost / binned.report().sah_cost);
            assert!(ratios.last().is_some_and(|&ratio| ratio < 1.1), "{}: {ratios:?}", case.name);
        }
    }
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!(mean < 1.0, "{mean}: {ratios:?}");
}
