//! Filtered queries: by every structure and walk of the catalogue, against the hits of all that a filter keeps.

use ropewalk::glam::{Affine3A, DVec3, Vec3};
use ropewalk::{
    Answer, DeviceKind, Hit, HitLists, NoMonitor, Query, Ray, Scene, Status, Structure, TraceOptions,
    Transform, Walk, catalogue,
};
use ropewalk_testkit::meshes::{icosphere, soup};
use ropewalk_testkit::random::Random;

/// Two instances of a soup and one of a sphere, so that rays hit many triangles one behind the other.
fn scene() -> Scene {
    let mut scene = Scene::default();
    let (soup, sphere) = (scene.add_object(soup(300, 0.4, 5)), scene.add_object(icosphere(2)));
    for (object, at) in [(soup, Vec3::ZERO), (soup, Vec3::new(0.5, 0.25, 0.125)), (sphere, Vec3::splat(0.25))]
    {
        let moved = Affine3A::from_translation(at);
        scene.add_instance(object, Transform::new(moved).unwrap());
    }
    scene
}

/// Rays from everywhere, some with a window, one that is not valid.
fn rays() -> Vec<Ray> {
    let mut random = Random::new(11);
    let mut rays: Vec<Ray> = (0..250)
        .map(|index| {
            let (origin, towards): (DVec3, DVec3) = (random.in_cube() * 2.0, random.in_cube() * 0.5);
            let ray = Ray::new(origin.as_vec3(), (towards - origin).as_vec3());
            if index % 3 == 0 { ray.window(0.25, 1.25) } else { ray }
        })
        .collect();
    rays.push(Ray::new(Vec3::ZERO, Vec3::ZERO));
    rays
}

/// Keeps a third of the triangles, and of those some places only.
fn keep(hit: &Hit) -> bool {
    (hit.primitive_index.wrapping_mul(0x9e37_79b9) >> 16).is_multiple_of(3)
        && (hit.instance_index != 1 || hit.barycentrics[0] < 0.5)
}

/// What the answer must be, out of the hits of all.
fn expected(query: Query, all: &HitLists, rays: usize, keep: &dyn Fn(&Hit) -> bool) -> Answer {
    let kept = |ray: usize| all.of(ray).iter().copied().filter(|hit| keep(hit));
    match query {
        Query::Closest => {
            Answer::Closest((0..rays).map(|ray| kept(ray).next().unwrap_or(Hit::MISS)).collect())
        }
        Query::Any => Answer::Any((0..rays).map(|ray| kept(ray).next().is_some()).collect()),
        Query::Count => Answer::Count((0..rays).map(|ray| kept(ray).count() as u32).collect()),
        Query::All => {
            let mut lists = HitLists { offsets: vec![0], hits: Vec::new() };
            for ray in 0..rays {
                lists.hits.extend(kept(ray));
                lists.offsets.push(lists.hits.len() as u64);
            }
            Answer::All(lists)
        }
    }
}

fn all(structure: &Structure, rays: &[Ray]) -> HitLists {
    let traced = structure.trace(Walk::BruteForce, Query::All, rays, TraceOptions::default()).unwrap();
    match traced.answer {
        Answer::All(lists) => lists,
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_walk_takes_the_hits_that_are_kept() {
    let (scene, rays) = (scene(), rays());
    let mut known: Option<(String, Structure, HitLists)> = None;
    let (mut rows, mut passed_over) = (0, 0);
    for row in catalogue::rows().into_iter().filter(|row| row.device == DeviceKind::Cpu) {
        let name = row.structure.to_string();
        if known.as_ref().is_none_or(|(known, ..)| *known != name) {
            let structure = row.structure.build(&scene, &NoMonitor).unwrap();
            let all = all(&structure, &rays);
            known = Some((name, structure, all));
        }
        let Some((name, structure, all)) = &known else { continue };
        let right = expected(row.query, all, rays.len(), &keep);
        for options in [TraceOptions { counters: false }, TraceOptions { counters: true }] {
            let traced = structure.trace_filtered(row.walk, row.query, &rays, options, &keep).unwrap();
            assert_eq!(traced.answer, right, "{name} {} {}", row.walk, row.query);
            assert_eq!(traced.count_status(Status::INVALID_RAY), 1);
            assert_eq!(traced.counters.is_some(), options.counters);
        }
        // A filter that keeps something else is noticed, and so is none.
        let other = expected(row.query, all, rays.len(), &|hit| keep(hit) && hit.instance_index != 2);
        assert_ne!(right, other, "{name} {} {}", row.walk, row.query);
        assert_ne!(right, expected(row.query, all, rays.len(), &|_| true));
        rows += 1;
        passed_over += all.hits.iter().filter(|hit| !keep(hit)).count();
    }
    assert!(rows >= 200 && passed_over > 10_000, "{rows} {passed_over}");
}

#[test]
fn filters_that_keep_all_and_nothing() {
    let (scene, rays) = (scene(), rays());
    for row in catalogue::rows().into_iter().filter(|row| row.device == DeviceKind::Cpu) {
        if row.walk != Walk::default() {
            continue;
        }
        let structure = row.structure.build(&scene, &NoMonitor).unwrap();
        let options = TraceOptions { counters: true };
        let plain = structure.trace(row.walk, row.query, &rays, options).unwrap();
        // Nothing is left out, so the walk goes the same way.
        let everything = structure.trace_filtered(row.walk, row.query, &rays, options, &|_| true).unwrap();
        assert_eq!(everything, plain, "{}", row.structure);
        let nothing = structure.trace_filtered(row.walk, row.query, &rays, options, &|_| false).unwrap();
        assert_eq!(nothing.answer.rays_that_hit(), 0);
    }
}

#[test]
fn what_the_catalogue_refuses_is_refused() {
    let structure = catalogue::rows()[0].structure.build(&scene(), &NoMonitor).unwrap();
    let options = TraceOptions::default();
    assert!(structure.trace_filtered(Walk::Ropes, Query::Closest, &rays(), options, &keep).is_err());
}
