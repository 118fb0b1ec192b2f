//! All hits and their number: how a batch is cut up changes nothing, and what fits nowhere is said.

use crate::compare::compare;
use crate::errors::small_device;
use crate::machine::on_every_adapter;
use crate::{rays, trees};
use ropewalk::{Answer, BuildOptions, Mesh, Query, Ray, Scene, Structure, TraceOptions, Walk, glam::Vec3};
use ropewalk_gpu::Tracer;

const COUNTED: TraceOptions = TraceOptions { counters: true };

/// Triangles behind each other: a ray along the axis hits all of them.
fn pile(triangles: u32) -> Structure {
    let mut mesh = Mesh::default();
    for index in 0..triangles {
        let corners = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(2.0, -1.0, 0.0), Vec3::new(-1.0, 2.0, 0.0)];
        mesh.positions.extend(corners.map(|corner| corner + Vec3::Z * index as f32));
        mesh.triangles.push([3 * index, 3 * index + 1, 3 * index + 2]);
    }
    Structure::Bvh(Scene::from_mesh(mesh).build(&BuildOptions::default()).unwrap())
}

/// Rays that hit all, some or nothing.
fn rays_at_the_pile(count: u32, height: f32) -> Vec<Ray> {
    (0..count)
        .map(|index| {
            let origin = Vec3::new(0.01, 0.02, -1.0) + Vec3::X * if index % 3 == 2 { 100.0 } else { 0.0 };
            Ray::new(origin, Vec3::Z).window(0.0, height * index as f32 / count as f32)
        })
        .collect()
}

#[test]
fn tiles_change_nothing() {
    let structure = pile(60);
    let rays = rays_at_the_pile(400, 61.0);
    on_every_adapter(|machine| {
        for walk in ["stack", "restart-trail:short-stack=1"] {
            let walk: Walk = walk.parse().unwrap();
            let cpu = structure.trace(walk, Query::All, &rays, COUNTED).unwrap();
            let Answer::All(lists) = &cpu.answer else { panic!("all were asked for") };
            assert!(lists.hits.len() > 7000 && lists.of(2).is_empty(), "{} hits", lists.hits.len());
            for tile in [1, 7, 64, 1000] {
                let tracer = machine.tracer(|options| options.tile_rays = Some(tile));
                let uploaded = tracer.upload(&structure).unwrap();
                let some = rays.len().min(tile as usize * 20);
                let cpu = structure.trace(walk, Query::All, &rays[..some], COUNTED).unwrap();
                let gpu = tracer.trace(&uploaded, walk, Query::All, &rays[..some], COUNTED).unwrap();
                assert_eq!(compare(&cpu, &gpu.traced, machine.is_exact()), Ok(()), "tiles of {tile}");
                assert_eq!(gpu.device_time.is_some(), machine.gpu().has_timestamps());
            }
        }
    });
}

/// A device whose buffers hold the structure and few hits more than one ray has.
#[test]
fn a_batch_is_cut_by_its_hits() {
    let structure = pile(200);
    let rays = rays_at_the_pile(300, 201.0);
    on_every_adapter(|machine| {
        // Some 300 hits of 32 bytes, where one ray has up to 200.
        let triangle_bytes = 200 * 48;
        let Some(gpu) = small_device(|limits| limits.max_storage_buffer_binding_size = triangle_bytes) else {
            return;
        };
        let tracer = Tracer::new(gpu.unwrap());
        let uploaded = tracer.upload(&structure).unwrap();
        let walk = Walk::default();
        for query in [Query::All, Query::Count] {
            let cpu = structure.trace(walk, query, &rays, COUNTED).unwrap();
            let gpu = tracer.trace(&uploaded, walk, query, &rays, COUNTED).unwrap().traced;
            assert_eq!(compare(&cpu, &gpu, machine.is_exact()), Ok(()), "{query}");
        }
    });
}

/// A triangle in several leaves is hit in each and told once, and counted once.
#[test]
fn a_triangle_in_several_leaves_is_told_once() {
    for case in trees::split() {
        let rays = rays::against(&case.structure);
        on_every_adapter(|machine| {
            let uploaded = machine.trusted.upload(&case.structure).unwrap();
            let trace = |query| {
                machine
                    .trusted
                    .trace(&uploaded, Walk::default(), query, &rays, COUNTED)
                    .unwrap()
                    .traced
                    .answer
            };
            let (Answer::All(lists), Answer::Count(counts)) = (trace(Query::All), trace(Query::Count)) else {
                panic!("they answer what is asked")
            };
            for (ray, &count) in counts.iter().enumerate() {
                let hits = lists.of(ray);
                assert_eq!(hits.len(), count as usize, "ray {ray}");
                assert!(hits.windows(2).all(|pair| pair[0].precedes(&pair[1])), "ray {ray}");
            }
        });
    }
}
