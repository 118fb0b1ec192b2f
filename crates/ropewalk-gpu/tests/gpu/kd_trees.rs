//! Kd-trees of the usual scenes and of a shape that no builder makes, and the rays that are hard on them.

use crate::lists::placed;
use crate::rays::Random;
use crate::scenes::{Case, chain, duplicates, instances, lattice, one_triangle, sphere};
use ropewalk::glam::Vec3;
use ropewalk::kd_tree::{Depth, KdNode, MAX_DEPTH};
use ropewalk::{KdOptions, KdTree, Mesh, Ray, Scene, Structure};

/// Kd-trees of all kinds.
pub(crate) fn every() -> Vec<Case> {
    let plain = KdOptions::default();
    let shallow = KdOptions { max_depth: Depth::Cap(8), ..plain };
    // Planes cost next to nothing, so leaves are small and many are empty.
    let fine = KdOptions { max_depth: Depth::Cap(MAX_DEPTH), traversal_cost: 1, ..plain };
    let soup = || placed(Vec3::splat(1.0), Vec3::ZERO);
    vec![
        case("empty", Scene::default(), plain),
        case("one triangle", Scene::from_mesh(one_triangle()), plain),
        case("soup", soup(), plain),
        case("shallow soup", soup(), shallow),
        case("fine soup", soup(), KdOptions { duplication: 8, ..fine }),
        case("huge soup", placed(Vec3::splat(1e11), Vec3::ZERO), plain),
        case("tiny soup", placed(Vec3::splat(1e-12), Vec3::ZERO), plain),
        case("soup far away", placed(Vec3::splat(1.0), Vec3::new(1e6, -1e6, 3e5)), plain),
        case("lattice", Scene::from_mesh(lattice()), plain),
        case("fine lattice", Scene::from_mesh(lattice()), fine),
        case("coplanar duplicates", Scene::from_mesh(duplicates()), plain),
        // Small: rays from very far away are in all cells at once, and lavapipe counts their loops.
        case("sphere", Scene::from_mesh(sphere(6)), plain),
        case("instances", instances(), KdOptions { max_depth: Depth::Cap(6), ..plain }),
        case("deep chain", Scene::from_mesh(chain()), fine),
        comb_case("comb of depth 31", 31),
        comb_case("comb of depth 60", MAX_DEPTH),
    ]
}

fn case(name: &'static str, scene: Scene, options: KdOptions) -> Case {
    let tree = scene.build_kd(&options).expect("the scene is in range");
    Case { name, structure: Structure::KdTree(tree) }
}

fn comb_case(name: &'static str, depth: u32) -> Case {
    Case { name, structure: Structure::KdTree(comb(depth)) }
}

/// A tree in which each inner node has a leaf, below its plane or above it, down to this depth: slices of large triangles.
pub(crate) fn comb(depth: u32) -> KdTree {
    let slices = depth as usize + 1;
    let mut random = Random::new(u64::from(depth));
    let mut mesh = Mesh::default();
    for slice in 0..slices as u32 {
        let x = slice as f32;
        let spread = |random: &mut Random| 20.0 + 5.0 * random.number();
        mesh.positions.extend([
            Vec3::new(x, -spread(&mut random), -spread(&mut random)),
            Vec3::new(x + 0.5, spread(&mut random), -spread(&mut random)),
            Vec3::new(x + 1.0, random.number(), spread(&mut random)),
        ]);
        mesh.triangles.push([3 * slice, 3 * slice + 1, 3 * slice + 2]);
    }
    let triangles = Scene::from_mesh(mesh).flatten().unwrap().triangles;
    let mut nodes = Vec::new();
    // Upper children to come, with their slices; a lower part that is no leaf is gone into at once.
    let mut pending: Vec<(usize, std::ops::Range<usize>)> = vec![(usize::MAX, 0..slices)];
    while let Some((parent, mut part)) = pending.pop() {
        if let Some(KdNode { axis_and_link, split_or_first }) = nodes.get(parent).copied() {
            let split = f32::from_bits(split_or_first);
            nodes[parent] = KdNode::inner((axis_and_link & 3) as usize, split, nodes.len() as u32);
        }
        while part.len() > 1 {
            let middle = if random.below(2) == 0 { part.start + 1 } else { part.end - 1 };
            pending.push((nodes.len(), middle..part.end));
            nodes.push(KdNode::inner(0, middle as f32, 0));
            part.end = middle;
        }
        nodes.push(KdNode::leaf(part.start as u32, 1));
    }
    let references = (0..slices as u32).collect();
    KdTree::from_parts(nodes, references, triangles).unwrap()
}

/// Rays in the planes of a tree, along lines in which two of them meet, through such lines, and from a plane on.
pub(crate) fn in_planes(tree: &KdTree) -> Vec<Ray> {
    let planes: Vec<(usize, f32)> =
        tree.nodes().iter().filter(|node| !node.is_leaf()).map(|node| (node.axis(), node.split())).collect();
    let mut random = Random::new(23);
    let mut rays = Vec::new();
    if planes.is_empty() {
        return rays;
    }
    let bounds = tree.bounds();
    let size = bounds.size();
    for index in 0..250 {
        let (axis, split) = planes[random.below(planes.len())];
        let (other, other_split) = planes[random.below(planes.len())];
        let zero = if index % 2 == 0 { 0.0 } else { -0.0 };
        let mut at = bounds.center() + random.vector() * size * 0.5;
        at[axis] = split;
        let any = random.vector() * size;
        let mut within = any;
        within[axis] = zero;
        rays.push(Ray::new(at, within));
        rays.push(Ray::new(at - within, within));
        rays.push(Ray::new(at, any));
        rays.push(Ray::new(at - any, any).window(1.0, f32::INFINITY));
        rays.push(Ray::new(at - any, any).window(0.0, 1.0));
        if other == axis {
            continue;
        }
        at[other] = other_split;
        let mut along = Vec3::splat(zero);
        along[3 - axis - other] = if index % 4 < 2 { 1.0 } else { -1.0 };
        rays.push(Ray::new(at, along));
        rays.push(Ray::new(at - along * size.max_element(), along));
        rays.push(Ray::new(at - any, any));
        rays.push(Ray::new(at, any));
    }
    rays
}

/// The trees are what they are called.
#[test]
fn combs_are_as_deep_as_they_are_called() {
    for depth in [1, 31, MAX_DEPTH] {
        let tree = comb(depth);
        assert_eq!((tree.report().depth, tree.report().leaves), (depth, depth as usize + 1));
        assert!(in_planes(&tree).len() > 1000);
    }
    let depths = every().into_iter().map(|case| (case.name, case.structure.report().depth));
    for (name, depth) in depths {
        println!("{name}: depth {depth}");
        assert!(name != "deep chain" || depth > 31, "{depth}");
    }
}
