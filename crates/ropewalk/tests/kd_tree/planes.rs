//! Rays that lie in planes, begin on them, end at them, or meet several at once: where walks by `t` alone go wrong
//! (ALGORITHMS: C6).

use super::support::{blocks, interior, walks};
use ropewalk::glam::{DVec3, Vec3};
use ropewalk::kd_tree::{KdOptions, KdPlace};
use ropewalk::{Hit, KdTree, PreparedRay, Query, Ray, Scene, TraceOptions};
use ropewalk_testkit::compare::same_bits;
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;

/// Compares every walk with brute force.
fn check(what: &str, tree: &KdTree, rays: &[Ray]) {
    for query in [Query::Closest, Query::Any, Query::All] {
        let rays = if query == Query::Closest { rays } else { &rays[..rays.len() / 4] };
        let expected = tree.trace_by_force(query, rays, TraceOptions::default());
        for walk in walks() {
            let given = tree.trace(walk, query, rays, TraceOptions::default()).unwrap();
            same_bits(rays, &expected, &given, false)
                .unwrap_or_else(|error| panic!("{what}, {query}, {walk}: {error}"));
        }
    }
}

/// Trees with planes in common, with planes close to each other, and with small leaves.
fn trees() -> Vec<(&'static str, KdTree)> {
    let deep = KdOptions { intersection_cost: 10_000, ..KdOptions::default() };
    let grid = meshes::grid(1, 0.0, 12, 0.25);
    let far = meshes::mapped(blocks(), |point| point + DVec3::new(3e4, -2e4, 1e4));
    vec![
        ("blocks", Scene::from_mesh(blocks()).build_kd(&deep).unwrap()),
        ("interior", Scene::from_mesh(interior()).build_kd(&KdOptions::default()).unwrap()),
        ("grid", Scene::from_mesh(grid).build_kd(&deep).unwrap()),
        ("blocks far away", Scene::from_mesh(far).build_kd(&deep).unwrap()),
    ]
}

/// Some inner nodes of a tree: axis, split, cell.
fn planes(tree: &KdTree) -> Vec<(usize, f32, KdPlace)> {
    let nodes = tree.nodes().iter().zip(tree.places()).filter(|(node, _)| !node.is_leaf());
    let all: Vec<_> = nodes.map(|(node, place)| (node.axis(), node.split(), *place)).collect();
    let step = (all.len() / 120).max(1);
    all.into_iter().step_by(step).collect()
}

fn inside(random: &mut Random, place: &KdPlace) -> Vec3 {
    random.in_box(&place.bounds(), 1.0).as_vec3()
}

#[test]
fn rays_in_planes() {
    for (name, tree) in trees() {
        let mut random = Random::new(5);
        let mut rays = Vec::new();
        for (axis, split, place) in planes(&tree) {
            for turn in 1..3 {
                let along = (axis + turn) % 3;
                let mut origin = inside(&mut random, &place);
                origin[axis] = split;
                let mut dir = Vec3::AXES[along] * if random.between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
                rays.push(Ray::new(origin, dir));
                // From outside of the scene.
                let mut outside = origin;
                outside[along] -= dir[along] * (tree.bounds().size()[along] + 1.0);
                rays.push(Ray::new(outside, dir));
                // In two planes at once.
                outside[3 - axis - along] = place.max[3 - axis - along];
                rays.push(Ray::new(outside, dir));
                // In the plane, but not along an axis.
                dir[3 - axis - along] = random.between(-1.0, 1.0) as f32;
                rays.push(Ray::new(origin - dir * 3.0, dir));
                rays.push(Ray::new(origin, dir * 1e-3));
            }
        }
        check(name, &tree, &rays);
    }
}

#[test]
fn rays_that_begin_on_planes() {
    for (name, tree) in trees() {
        let mut random = Random::new(6);
        let mut rays = Vec::new();
        for (axis, split, place) in planes(&tree) {
            let mut origin = inside(&mut random, &place);
            origin[axis] = split;
            for _ in 0..3 {
                rays.push(Ray::new(origin, random.direction().as_vec3()));
            }
            rays.push(Ray::new(origin, Vec3::AXES[axis]));
            rays.push(Ray::new(origin, -Vec3::AXES[axis]));
            // At a corner of the cell, where three planes meet.
            let corner = Vec3::from(if random.between(0.0, 1.0) < 0.5 { place.min } else { place.max });
            rays.push(Ray::new(corner, random.direction().as_vec3()));
        }
        check(name, &tree, &rays);
    }
}

#[test]
fn rays_through_corners_and_edges_of_cells() {
    for (name, tree) in trees() {
        let mut random = Random::new(7);
        let mut rays = Vec::new();
        for (_, _, place) in planes(&tree) {
            let (min, max) = (Vec3::from(place.min), Vec3::from(place.max));
            let side = |bit: f64| if bit < 0.5 { min } else { max };
            let [x, y, z] = [(); 3].map(|()| side(random.between(0.0, 1.0)));
            let corner = Vec3::new(x.x, y.y, z.z);
            for dir in [
                Vec3::new(1.0, 1.0, 1.0),
                Vec3::new(1.0, -1.0, 0.0),
                Vec3::new(0.0, 0.5, 1.0),
                random.direction().as_vec3(),
            ] {
                for distance in [3.0, 1000.0] {
                    rays.push(Ray::new(corner - dir * distance, dir));
                }
            }
        }
        check(name, &tree, &rays);
    }
}

/// There the cells are as thin as the padding.
#[test]
fn rays_from_far_away() {
    for (name, tree) in trees() {
        let mut random = Random::new(8);
        let size = tree.bounds().size().length();
        let mut rays = Vec::new();
        for (_, _, place) in planes(&tree) {
            let target = inside(&mut random, &place);
            for far in [1e3, 1e6, 1e9] {
                let dir = random.direction().as_vec3();
                rays.push(Ray::new(target - dir * (far * size), dir));
                let axis = Vec3::AXES[(far.log10() as usize) % 3];
                rays.push(Ray::new(target - axis * (far * size), axis));
                // A component that is next to none.
                rays.push(Ray::new(target - axis * size, axis + dir * (1.0 / far)));
            }
        }
        check(name, &tree, &rays);
    }
}

/// Windows that begin or end exactly where a plane is met, or one float beside, or at a hit.
#[test]
fn windows_that_end_at_planes() {
    for (name, tree) in trees() {
        let mut random = Random::new(9);
        let mut rays = Vec::new();
        for (axis, split, place) in planes(&tree) {
            let dir = random.direction().as_vec3();
            let ray = Ray::new(inside(&mut random, &place) - dir * 4.0, dir);
            let Some(prepared) = PreparedRay::new(&ray) else { continue };
            let at = (split - prepared.origin_low[axis]) * prepared.inverse[axis];
            for t in [at, at.next_up(), at.next_down(), at * ropewalk::aabb::PAD_EXIT, tree.closest(&ray).t] {
                if t > 0.0 {
                    rays.push(ray.window(t, f32::INFINITY));
                    rays.push(ray.window(0.0, t));
                    rays.push(ray.window(t, t));
                }
            }
        }
        check(name, &tree, &rays);
    }
}

/// The judge of all these.
#[test]
fn a_wrong_answer_is_found() {
    let (_, tree) = &trees()[0];
    let rays = super::support::rays(3, 50);
    let expected = tree.trace_by_force(Query::Closest, &rays, TraceOptions::default());
    let mut wrong = expected.clone();
    if let ropewalk::Answer::Closest(hits) = &mut wrong.answer {
        let hit = hits.iter_mut().find(|hit| hit.is_hit()).unwrap();
        *hit = Hit { t: hit.t.next_up(), ..*hit };
    }
    assert!(same_bits(&rays, &expected, &expected, false).is_ok());
    assert!(same_bits(&rays, &expected, &wrong, false).is_err());
}
