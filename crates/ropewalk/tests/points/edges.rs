//! The edges of what may be asked: radii to the last bit, masks, nothing there, too many wanted, no numbers, and trees
//! that are too deep.

use ropewalk::bvh::Node;
use ropewalk::glam::Vec3;
use ropewalk::point::catalogue::{self, PointRow};
use ropewalk::{
    Aabb, BuildOptions, Builder, Bvh, ClosestPoint, DeviceKind, FlatTriangle, Mesh, PointQuery, Scene,
    Status, TraceError, TraceOptions, Walk,
};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::meshes;
use ropewalk_testkit::points::{PointOracle, around, awkward, invalid, nearest_against_oracle};

const PLAIN: TraceOptions = TraceOptions { counters: false };

#[test]
fn the_radius_is_closed_to_the_last_bit() {
    let mut found = 0;
    for case in Case::every() {
        let flat = case.scene.flatten().unwrap();
        for builder in [Builder::BinnedSah, Builder::Sbvh] {
            let bvh = case.scene.build(&BuildOptions { builder, ..BuildOptions::default() }).unwrap();
            for query in awkward(&flat, 20, 4) {
                let closest = bvh.closest_point(&PointQuery { radius: f32::INFINITY, ..query });
                if !closest.is_found() {
                    continue;
                }
                found += 1;
                let at = bvh.closest_point(&query.within(closest.distance));
                assert_eq!(at.to_words(), closest.to_words(), "{}: {query:?}", case.name);
                if closest.distance > 0.0 {
                    let before = bvh.closest_point(&query.within(closest.distance.next_down()));
                    assert_eq!(before.to_words(), ClosestPoint::NONE.to_words(), "{}: {query:?}", case.name);
                }
            }
        }
    }
    assert!(found > 10_000, "{found}");
}

/// The rows that run here.
fn rows() -> impl Iterator<Item = PointRow> {
    catalogue::rows().into_iter().filter(|row| row.device == DeviceKind::Cpu)
}

#[test]
fn nothing_is_found_in_nothing() {
    let bvh = Scene::from_mesh(Mesh::default()).build(&BuildOptions::default()).unwrap();
    let queries = around(&Aabb::EMPTY, 5, 1);
    for row in rows() {
        let closest = bvh.closest_points(row.walk, &queries, PLAIN).unwrap();
        assert!(closest.points.iter().all(|point| point.to_words() == ClosestPoint::NONE.to_words()));
        let nearest = bvh.nearest_points(row.walk, 3, &queries, PLAIN).unwrap();
        assert_eq!((nearest.points.offsets, nearest.points.points), (vec![0; 6], vec![]));
        assert!(bvh.nearest_points(row.walk, 3, &[], PLAIN).unwrap().points.points.is_empty());
    }
}

#[test]
fn what_is_not_valid_finds_nothing_and_says_so() {
    let bvh = Scene::from_mesh(meshes::icosphere(2)).build(&BuildOptions::default()).unwrap();
    let queries = invalid();
    for row in rows() {
        let closest = bvh.closest_points(row.walk, &queries, PLAIN).unwrap();
        assert!(closest.points.iter().all(|point| point.to_words() == ClosestPoint::NONE.to_words()));
        assert!(closest.status.iter().all(|&status| status == Status::INVALID_RAY));
        let nearest = bvh.nearest_points(row.walk, 3, &queries, PLAIN).unwrap();
        assert!(nearest.points.points.is_empty() && nearest.status == closest.status);
    }
}

/// However many are wanted, memory is taken for what is found.
#[test]
fn more_may_be_wanted_than_there_are() {
    let scene = Scene::from_mesh(meshes::soup(300, 0.5, 9));
    let oracle = PointOracle::of_scene(&scene).unwrap();
    for builder in [Builder::BinnedSah, Builder::Sbvh] {
        let bvh =
            scene.build(&BuildOptions { builder, duplication: 300, ..BuildOptions::default() }).unwrap();
        let queries = around(&bvh.bounds(), 10, 7);
        for k in [299, 300, 301, usize::MAX] {
            let lists = bvh.nearest_points(Walk::default(), k, &queries, PLAIN).unwrap();
            nearest_against_oracle(&oracle, k, &queries, &lists).unwrap();
            assert_eq!(lists.points.of(3).len(), k.min(300));
        }
        let none = bvh.nearest_points(Walk::default(), 0, &queries, PLAIN).unwrap();
        assert!(none.points.points.is_empty() && none.status.iter().all(|status| status.is_complete()));
    }
}

/// The shorter list begins the longer one.
#[test]
fn a_list_grows_at_its_end() {
    let scene = Case::named("parts").unwrap().scene;
    let bvh = scene.build(&BuildOptions::default()).unwrap();
    let (mut list, mut longer) = (Vec::new(), Vec::new());
    for query in awkward(&scene.flatten().unwrap(), 20, 8) {
        for k in 1..12 {
            bvh.nearest(&query, k, &mut list);
            bvh.nearest(&query, k + 1, &mut longer);
            assert_eq!(list, longer[..list.len()], "{query:?}");
        }
    }
}

#[test]
fn walks_for_rays_alone_are_refused() {
    let bvh = Scene::from_mesh(meshes::icosphere(0)).build(&BuildOptions::default()).unwrap();
    for walk in ["recursive", "stack:order=culled", "restart-trail:memory=workgroup"] {
        let error = bvh.closest_points(walk.parse().unwrap(), &[], PLAIN).unwrap_err();
        assert!(error.to_string().contains("closest-point") && error.to_string().contains("order=ordered"));
        assert!(bvh.nearest_points(walk.parse().unwrap(), 2, &[], PLAIN).is_err());
    }
}

/// A chain of triangles, each one level deeper than the one before.
fn chain(depth: u32) -> Bvh {
    let corner = |at: u32| Vec3::new(at as f32, (at % 3) as f32, (at % 5) as f32);
    let triangles: Vec<FlatTriangle> = (0..=depth)
        .map(|at| FlatTriangle {
            v0: corner(at).into(),
            primitive: at,
            v1: (corner(at) + Vec3::X).into(),
            geometry_and_mirror: 0,
            v2: (corner(at) + Vec3::Y).into(),
            instance_and_mask: 0xff00_0000,
        })
        .collect();
    let mut nodes = Vec::new();
    for at in 0..=depth {
        let bounds = triangles[at as usize..].iter().map(|triangle| triangle.triangle().bounds());
        if at < depth {
            nodes.push(Node::inner(&bounds.fold(Aabb::EMPTY, Aabb::union), 2 * at + 2));
        }
        nodes.push(Node::leaf(&triangles[at as usize].triangle().bounds(), at, 1));
    }
    Bvh::from_parts(nodes, triangles).unwrap()
}

#[test]
fn a_tree_deeper_than_the_register_is_refused_and_served_by_others() {
    for depth in [30, 31, 32, 62, 63, 64] {
        let bvh = chain(depth);
        assert_eq!(bvh.report().depth, depth);
        let queries = around(&bvh.bounds(), 200, 2);
        let expected = bvh.closest_points(Walk::BruteForce, &queries, PLAIN).unwrap();
        for (register, levels) in [("u32", 31), ("u64", 63), ("array", 64), ("auto", 64)] {
            for short_stack in [0, 2] {
                let walk = format!("restart-trail:short-stack={short_stack},register={register}");
                match bvh.closest_points(walk.parse().unwrap(), &queries, PLAIN) {
                    Ok(given) => {
                        assert!(depth <= levels, "{walk}, depth {depth}");
                        assert_eq!(given.points, expected.points);
                    }
                    Err(TraceError::TooDeep { limit, .. }) => {
                        assert!(depth > levels && limit == levels, "{walk}, depth {depth}");
                    }
                    Err(other) => panic!("{other}"),
                }
            }
        }
    }
}
