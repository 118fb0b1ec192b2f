//! Lists of two sides against brute force, their shape, and the mistakes of the paper's pseudocode, which must be found out.

use super::support::{every, mixed, rays};
use ropewalk::aabb::Interval;
use ropewalk::glam::Vec3;
use ropewalk::traversal_list::{Bounds, ChildOrder, Directions, Element, ListOptions, Source, list_of};
use ropewalk::{Hit, Mesh, PreparedRay, Ray, Scene, TraversalList, glam};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;

#[test]
fn every_list_hits_what_brute_force_hits() {
    let scene = mixed();
    let triangles = scene.flatten().unwrap().triangles;
    let rays = rays(600);
    let brute_force = |ray: &Ray| {
        let ray = PreparedRay::new(ray).unwrap();
        let hits = triangles.iter().filter_map(|triangle| triangle.intersect(&ray, ray.t_max));
        hits.fold(Hit::MISS, |best, hit| if hit.precedes(&best) { hit } else { best })
    };
    let expected: Vec<Hit> = rays.iter().map(brute_force).collect();
    assert!(expected.iter().filter(|hit| hit.is_hit()).count() > 300);
    for options in every() {
        for big in [1, 50, 1000] {
            let list = scene.build_list(&ListOptions { big, ..options }).unwrap();
            list.validate().unwrap();
            for (ray, expected) in rays.iter().zip(&expected) {
                assert_eq!(list.closest(ray).to_words(), expected.to_words(), "{options:?} {ray:?}");
                assert_eq!(list.any(ray), expected.is_hit(), "{options:?} {ray:?}");
            }
            if options.source != Source::Octree {
                break;
            }
        }
    }
}

/// The cases of the conformance suite, whose trees hold few but awkward triangles.
#[test]
fn every_list_of_every_case_is_valid() {
    for case in Case::every() {
        for options in every() {
            match case.scene.build_list(&options) {
                Ok(list) => {
                    list.validate().unwrap_or_else(|error| panic!("{}, {options:?}: {error}", case.name));
                    let elements = options.directions.lists() * list.report().nodes;
                    assert!(list.report().bytes >= elements * size_of::<Element>(), "{}", case.name);
                }
                Err(error) => assert!(case.scene.flatten().is_err(), "{}: {error}", case.name),
            }
        }
    }
}

#[test]
fn small_scenes_have_the_lists_of_the_paper() {
    let list =
        |count| Scene::from_mesh(meshes::soup(count, 0.5, 1)).build_list(&ListOptions::default()).unwrap();
    assert!(list(0).list(0).is_empty() && list(0).bounds().is_empty());
    assert_eq!(list(1).list(7).iter().map(|element| element.escape).collect::<Vec<_>>(), [0]);
    // A node and its two triangles.
    assert_eq!(list(2).list(0).iter().map(|element| element.escape).collect::<Vec<_>>(), [-1, 1, 0]);
    assert!(list(2).list(8).is_empty(), "there is no ninth");
}

/// Turned round, the direction's last is the first: the list of the opposite direction in the other order is the same
/// hierarchy backwards.
#[test]
fn earliest_first_is_latest_last_backwards() {
    for bounds in [Bounds::Sphere, Bounds::Aabb] {
        let build = |order| {
            let options =
                ListOptions { directions: Directions::Six, bounds, order, ..ListOptions::default() };
            mixed_without_twins().build_list(&options).unwrap()
        };
        let (earliest, latest) = (build(ChildOrder::EarliestFirst), build(ChildOrder::LatestLast));
        let triangles = |list: &TraversalList, index| -> Vec<u32> {
            list.list(index).iter().filter(|it| it.is_triangle()).map(|it| it.payload[3]).collect()
        };
        for axis in 0..3 {
            let mut backwards = triangles(&earliest, 2 * axis + 1);
            backwards.reverse();
            assert_eq!(triangles(&latest, 2 * axis), backwards, "{bounds:?}, axis {axis}");
        }
    }
}

/// No two triangles begin or end at the same place.
fn mixed_without_twins() -> Scene {
    Scene::from_mesh(meshes::soup(500, 0.3, 9))
}

/// Triangles that all fall into one group for ever: the fall-back halves them, and the list stays shallow.
#[test]
fn what_cannot_be_divided_ends() {
    let mut mesh = Mesh::default();
    for _ in 0..1000 {
        meshes::push(&mut mesh, [glam::DVec3::ZERO, glam::DVec3::X, glam::DVec3::Y]);
    }
    let mut random = Random::new(3);
    for k in 0..140 {
        let size = 0.5f64.powi(k);
        meshes::push(&mut mesh, [(); 3].map(|()| (random.in_cube() * 0.1 + 1.0) * size));
    }
    let scene = Scene::from_mesh(mesh);
    for big in [1, 50, 1000] {
        let list = scene.build_list(&ListOptions { big, ..ListOptions::default() }).unwrap();
        list.validate().unwrap();
        assert!(list.report().depth < 100, "{}", list.report().depth);
        let mut hits = Vec::new();
        list.all(&Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z), &mut hits);
        assert!(hits.len() >= 1000, "{} hits", hits.len());
    }
}

#[test]
fn options_out_of_range_are_errors() {
    for big in [0, 1001] {
        let error = mixed().build_list(&ListOptions { big, ..ListOptions::default() }).unwrap_err();
        assert!(error.to_string().contains("between 1 and 1000"), "{error}");
    }
}

/// The closest hit by the loop of the paper, with a test of spheres of the caller's.
fn closest_by(list: &TraversalList, ray: &PreparedRay, test: impl Fn(Interval) -> f32) -> Hit {
    let elements = list.list(list_of(list.options().directions, ray));
    let (mut best, mut at) = (Hit::MISS, 0);
    while let Some(element) = elements.get(at) {
        let mut next = element.escape;
        if element.is_triangle() {
            if let Some(hit) = list.triangle(element).intersect(ray, ray.t_max.min(best.t))
                && hit.precedes(&best)
            {
                best = hit;
            }
        } else {
            let interval = element.sphere().interval(ray, f32::MAX);
            if interval.is_hit() && test(interval) <= best.t {
                next = 1;
            }
        }
        if next <= 0 {
            break;
        }
        at += next as usize;
    }
    best
}

/// A helper that gives the smallest positive root gives the exit of a sphere that the ray starts in, and what is nearer is
/// culled (ALGORITHMS: C1).
#[test]
fn the_smallest_positive_root_loses_hits() {
    let scene = mixed();
    let list = scene.build_list(&ListOptions::default()).unwrap();
    let mut lost = 0;
    for ray in rays(4000) {
        let expected = list.closest(&ray).to_words();
        let ray = PreparedRay::new(&ray).unwrap();
        assert_eq!(closest_by(&list, &ray, |interval| interval.entry).to_words(), expected);
        let root = |interval: Interval| if interval.entry > 0.0 { interval.entry } else { interval.exit };
        lost += usize::from(closest_by(&list, &ray, root).to_words() != expected);
    }
    println!("{lost} of 4000 rays lose their hit");
    assert!(lost > 0);
}
