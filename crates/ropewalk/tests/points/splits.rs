//! Spatial splits made by hand: the boxes of a triangle's parts share their planes to the last bit and have no margin,
//! and a twin that is not split sets the limit to the last bit.

use ropewalk::bvh::Node;
use ropewalk::glam::{DQuat, DVec3, Vec3};
use ropewalk::{Aabb, BuildOptions, Bvh, FlatTriangle, PointQuery, Scene, TraceOptions, Walk};
use ropewalk_testkit::meshes;
use ropewalk_testkit::points::{same_closest_points, same_nearest_points};
use ropewalk_testkit::random::Random;

/// The first half of the triangles in parts, a part a leaf, and the second half whole.
pub(crate) fn in_parts(triangles: &[FlatTriangle], parts: u32) -> Bvh {
    let mut leaves: Vec<(Aabb, FlatTriangle)> = Vec::new();
    for (index, triangle) in triangles.iter().enumerate() {
        let parts = if index < triangles.len() / 2 { parts } else { 1 };
        let bounds = triangle.triangle().bounds();
        let plane = |index: u32| match index {
            0 => bounds.min.x,
            _ if index == parts => bounds.max.x,
            _ => bounds.min.x + (bounds.max.x - bounds.min.x) * (index as f32 / parts as f32),
        };
        leaves.extend((0..parts).map(|index| {
            let (low, high) = (bounds.min.with_x(plane(index)), bounds.max.with_x(plane(index + 1)));
            (Aabb::new(low, high), *triangle)
        }));
    }
    let mut nodes = Vec::new();
    split(&mut leaves, 0, &mut nodes);
    Bvh::from_parts(nodes, leaves.into_iter().map(|(_, triangle)| triangle).collect()).unwrap()
}

/// Halves at the middle of the longest axis.
fn split(leaves: &mut [(Aabb, FlatTriangle)], first: u32, nodes: &mut Vec<Node>) {
    let bounds = leaves.iter().map(|leaf| leaf.0).fold(Aabb::EMPTY, Aabb::union);
    if leaves.len() == 1 {
        nodes.push(Node::leaf(&bounds, first, 1));
        return;
    }
    let axis = bounds.size().max_position();
    leaves.sort_by(|a, b| a.0.center()[axis].total_cmp(&b.0.center()[axis]));
    let (at, middle) = (nodes.len(), leaves.len() / 2);
    nodes.push(Node::inner(&bounds, 0));
    let (low, high) = leaves.split_at_mut(middle);
    split(low, first, nodes);
    nodes[at].link = nodes.len() as u32;
    split(high, first + middle as u32, nodes);
}

#[test]
fn cut_parts_lose_nothing_to_rounding() {
    // Long splinters that lean, each there twice: the one in parts goes first, but where the other one is met before
    // it, its distance is the limit to the last bit.
    let lean = DQuat::from_xyzw(0.3, -0.2, 0.5, 0.7).normalize();
    let mut mesh =
        meshes::mapped(meshes::soup(300, 0.4, 21), |point| lean * (point * DVec3::new(8.0, 0.5, 0.5)));
    let twin = mesh.clone();
    meshes::append(&mut mesh, &twin);
    let scene = Scene::from_mesh(mesh);
    let flat = scene.flatten().unwrap();
    let whole = scene.build(&BuildOptions::default()).unwrap();
    let split = in_parts(&flat.triangles, 16);
    assert!(split.has_repeats() && split.report().references == 17 * 300);
    let mut random = Random::new(5);
    let queries: Vec<PointQuery> = (0..40_000)
        .map(|_| {
            let [a, b, c] = random.pick(&flat.triangles).triangle().vertices.map(Vec3::as_dvec3);
            let (u, v) = (random.unit(), random.unit());
            let away = random.direction() * random.pick(&[0.0, 1e-6, 1e-5, 1e-2, 1e2, 1e3]);
            PointQuery::new((a + (b - a) * u * (1.0 - v) + (c - a) * v + away).as_vec3())
        })
        .collect();
    let plain = TraceOptions::default();
    let closest = whole.closest_points(Walk::BruteForce, &queries, plain).unwrap();
    let nearest = whole.nearest_points(Walk::BruteForce, 4, &queries, plain).unwrap();
    for walk in ["stack", "restart-trail:short-stack=2"].map(|walk| walk.parse().unwrap()) {
        let given = split.closest_points(walk, &queries, plain).unwrap();
        same_closest_points(&queries, &closest, &given, false).unwrap_or_else(|wrong| panic!("{wrong}"));
        let given = split.nearest_points(walk, 4, &queries, plain).unwrap();
        same_nearest_points(&queries, &nearest, &given, false).unwrap_or_else(|wrong| panic!("{wrong}"));
    }
}
