//! How a batch is cut up, who asks it and what ran before change nothing.

use super::compare::{Agreement, compare_closest, compare_nearest};
use super::{COUNTED, PLAIN, asked, bvh};
use crate::errors::small_device;
use crate::machine::on_every_adapter;
use crate::scenes::{Case, sphere};
use ropewalk::{BuildOptions, DeviceKind, PointQuery, Scene, Structure, Walk, glam::Vec3};
use ropewalk_gpu::{Device, Tracer};
use std::sync::Arc;

fn scene() -> (Case, Vec<PointQuery>) {
    let bvh = Scene::from_mesh(sphere(16)).build(&BuildOptions::default()).unwrap();
    asked(Case { name: "sphere", structure: Structure::Bvh(bvh) })
}

#[test]
fn tiles_change_nothing() {
    let (case, queries) = scene();
    let (bvh, walk) = (bvh(&case.structure), Walk::default());
    on_every_adapter(|machine| {
        let agreement = Agreement::new(machine.is_exact(), bvh);
        for tile in [1, 63, 64, 65, 1000] {
            let tracer = machine.tracer(|options| options.tile_rays = Some(tile));
            let uploaded = tracer.upload(&case.structure).unwrap();
            // A tile of one query is a submission a query: some are enough.
            let some = &queries[..queries.len().min(tile as usize * 20 + 3)];
            let closest = bvh.closest_points(walk, some, COUNTED).unwrap();
            let nearest = bvh.nearest_points(walk, 3, some, COUNTED).unwrap();
            for _ in 0..2 {
                // Different kinds of results in the same buffers.
                let gpu = tracer.nearest_points(&uploaded, walk, 3, some, COUNTED).unwrap();
                assert_eq!(
                    compare_nearest(some, &nearest, &gpu.answers, agreement),
                    Ok(()),
                    "tiles of {tile}"
                );
                let gpu = tracer.closest_points(&uploaded, walk, some, COUNTED).unwrap();
                assert_eq!(
                    compare_closest(some, &closest, &gpu.answers, agreement),
                    Ok(()),
                    "tiles of {tile}"
                );
                assert_eq!(gpu.device_time.is_some(), machine.gpu().has_timestamps());
            }
        }
    });
}

/// A device whose buffers hold the structure, and lists of some hundred queries.
#[test]
fn a_batch_is_cut_by_its_lists() {
    let (case, queries) = scene();
    let (bvh, walk) = (bvh(&case.structure), Walk::default());
    on_every_adapter(|machine| {
        let bytes = size_of_val(bvh.triangles()).max(size_of_val(bvh.nodes())) as u64;
        let Some(gpu) = small_device(|limits| limits.max_storage_buffer_binding_size = bytes) else { return };
        let tracer = Tracer::new(gpu.unwrap());
        let uploaded = tracer.upload(&case.structure).unwrap();
        let many: Vec<PointQuery> = queries.iter().copied().cycle().take(2000).collect();
        assert!(bytes < 2000 * 20 * 48);
        let cpu = bvh.nearest_points(walk, 20, &many, PLAIN).unwrap();
        let gpu = tracer.nearest_points(&uploaded, walk, 20, &many, PLAIN).unwrap().answers;
        assert_eq!(compare_nearest(&many, &cpu, &gpu, Agreement::new(machine.is_exact(), bvh)), Ok(()));
    });
}

#[test]
fn no_queries_are_an_answer_too() {
    let (case, _) = scene();
    on_every_adapter(|machine| {
        let uploaded = machine.trusted.upload(&case.structure).unwrap();
        let closest =
            machine.trusted.closest_points(&uploaded, Walk::default(), &[], COUNTED).unwrap().answers;
        assert!(closest.points.is_empty() && closest.status.is_empty());
        assert_eq!(closest.counters, Some(vec![]));
        let nearest =
            machine.trusted.nearest_points(&uploaded, Walk::default(), 4, &[], PLAIN).unwrap().answers;
        assert_eq!((nearest.points.offsets, nearest.counters), (vec![0], None));
    });
}

#[test]
fn either_device_is_asked_in_the_same_way() {
    let (case, queries) = scene();
    let structure = Arc::new(case.structure);
    let cpu = Device::Cpu.prepare(Arc::clone(&structure)).unwrap();
    let trail: Walk = "restart-trail:short-stack=2".parse().unwrap();
    let closest = cpu.closest_points(trail, &queries, COUNTED).unwrap();
    assert_eq!(closest, bvh(&structure).closest_points(trail, &queries, COUNTED).unwrap());
    let nearest = cpu.nearest_points(trail, 40, &queries[..50], PLAIN).unwrap();
    assert_eq!(nearest.points.of(0).len(), 40, "the CPU has no limit");
    let nearest = cpu.nearest_points_timed(trail, 6, &queries, COUNTED).unwrap();
    assert_eq!(nearest.device_time, None);
    on_every_adapter(|machine| {
        let gpu = Device::Gpu(machine.trusted.clone()).prepare(Arc::clone(&structure)).unwrap();
        assert_eq!(gpu.device().kind(), DeviceKind::Gpu);
        let agreement = Agreement::new(machine.is_exact(), bvh(&structure));
        let answers = gpu.closest_points(trail, &queries, COUNTED).unwrap();
        assert_eq!(compare_closest(&queries, &closest, &answers, agreement), Ok(()));
        let answers = gpu.nearest_points(trail, 6, &queries, COUNTED).unwrap();
        assert_eq!(compare_nearest(&queries, &nearest.answers, &answers, agreement), Ok(()));
        let timed = gpu.closest_points_timed(trail, &queries, PLAIN).unwrap();
        assert_eq!(timed.device_time.is_some(), machine.gpu().has_timestamps());
    });
}

#[test]
fn threads_may_ask_at_the_same_time() {
    let (case, queries) = scene();
    let bvh = bvh(&case.structure);
    let rays = [ropewalk::Ray::new(Vec3::new(0.1, 0.2, 5.0), -Vec3::Z); 300];
    let cpu = bvh.nearest_points(Walk::default(), 8, &queries, COUNTED).unwrap();
    on_every_adapter(|machine| {
        let tracer = machine.tracer(|options| options.tile_rays = Some(300));
        let uploaded = tracer.upload(&case.structure).unwrap();
        let agreement = Agreement::new(machine.is_exact(), bvh);
        std::thread::scope(|scope| {
            for thread in 0..4 {
                let (tracer, uploaded, queries, cpu) = (&tracer, &uploaded, &queries, &cpu);
                scope.spawn(move || {
                    for _ in 0..5 {
                        if thread == 0 {
                            let query = ropewalk::Query::Any;
                            let traced =
                                tracer.trace(uploaded, Walk::default(), query, &rays, PLAIN).unwrap();
                            assert_eq!(traced.traced.answer.rays_that_hit(), rays.len());
                        }
                        let gpu =
                            tracer.nearest_points(uploaded, Walk::default(), 8, queries, COUNTED).unwrap();
                        assert_eq!(compare_nearest(queries, cpu, &gpu.answers, agreement), Ok(()));
                    }
                });
            }
        });
    });
}
