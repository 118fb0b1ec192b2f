//! What does not work is said, with the limit, the need and the way out; nothing is cut off silently.

use super::{COUNTED, PLAIN, asked, bvh};
use crate::errors::small_device;
use crate::machine::on_every_adapter;
use crate::scenes::{Case, sphere};
use crate::trees;
use ropewalk::wide_bvh::Width;
use ropewalk::{BuildOptions, Mesh, PointQuery, Scene, Status, Structure, TraceError, Walk, glam::Vec3};
use ropewalk_gpu::{Device, GpuError, Tracer};

fn scene() -> (Case, Vec<PointQuery>) {
    let bvh = Scene::from_mesh(sphere(16)).build(&BuildOptions::default()).unwrap();
    asked(Case { name: "sphere", structure: Structure::Bvh(bvh) })
}

#[test]
fn too_long_a_list_is_refused() {
    let (case, queries) = scene();
    assert_eq!(Tracer::MOST_NEAREST, 32);
    on_every_adapter(|machine| {
        let uploaded = machine.trusted.upload(&case.structure).unwrap();
        for k in [33, usize::MAX] {
            let error =
                machine.trusted.nearest_points(&uploaded, Walk::default(), k, &queries, PLAIN).unwrap_err();
            assert_eq!(error, GpuError::TooManyNearest { k, limit: 32 });
            let text = error.to_string();
            assert!(
                text.contains(&k.to_string()) && text.contains("32 at most") && text.contains("cpu"),
                "{text}"
            );
        }
    });
}

#[test]
fn what_is_not_in_the_catalogue_is_refused() {
    let (case, queries) = scene();
    let wide = Structure::WideBvh(trees::wide_chain(Width::Four, 3));
    let workgroup: Walk = "restart-trail:memory=workgroup".parse().unwrap();
    let refused = |error: GpuError| match error {
        GpuError::Catalogue(error) => error.to_string(),
        other => panic!("{other:?}"),
    };
    on_every_adapter(|machine| {
        let tracer = &machine.trusted;
        let uploaded = tracer.upload(&case.structure).unwrap();
        for walk in ["brute-force", "recursive", "stack:order=culled"].map(|text| text.parse().unwrap()) {
            let text = refused(tracer.closest_points(&uploaded, walk, &queries, PLAIN).unwrap_err());
            assert!(text.contains("gpu") && text.contains("memory=workgroup"), "{text}");
            let text = refused(tracer.nearest_points(&uploaded, walk, 3, &queries, PLAIN).unwrap_err());
            assert!(text.contains("k-nearest"), "{text}");
        }
        let uploaded = tracer.upload(&wide).unwrap();
        let text = refused(tracer.closest_points(&uploaded, Walk::default(), &queries, PLAIN).unwrap_err());
        assert!(text.contains("'bvh'"), "{text}");
    });
    // The processor refuses what it has not.
    let cpu = Device::Cpu.prepare(case.structure).unwrap();
    let text = refused(cpu.closest_points(workgroup, &queries, PLAIN).unwrap_err());
    assert!(text.contains("cpu") && text.contains("short-stack=4"), "{text}");
    let cpu = Device::Cpu.prepare(wide).unwrap();
    let text = refused(cpu.nearest_points(Walk::default(), 2, &queries, PLAIN).unwrap_err());
    assert!(text.contains("'bvh'"), "{text}");
}

#[test]
fn a_tree_too_deep_for_a_register_is_refused() {
    let structure = Structure::Bvh(trees::chain(64));
    on_every_adapter(|machine| {
        let uploaded = machine.trusted.upload(&structure).unwrap();
        for (register, limit) in [("u32", 31), ("u64", 63)] {
            let walk: Walk = format!("restart-trail:register={register}").parse().unwrap();
            let error = machine.trusted.closest_points(&uploaded, walk, &[], PLAIN).unwrap_err();
            assert_eq!(error, GpuError::Trace(TraceError::too_deep(walk, 64, limit)));
        }
    });
}

#[test]
fn a_structure_of_another_device_is_refused() {
    let (case, queries) = scene();
    on_every_adapter(|machine| {
        let Some(gpu) = small_device(|_| {}) else { return };
        let foreign = Tracer::new(gpu.unwrap()).upload(&case.structure).unwrap();
        let answer = machine.trusted.closest_points(&foreign, Walk::default(), &queries, PLAIN);
        assert_eq!(answer, Err(GpuError::OtherDevice));
    });
}

#[test]
fn a_budget_or_a_stack_that_is_used_up_is_reported() {
    let (case, queries) = scene();
    on_every_adapter(|machine| {
        let hasty = machine.tracer(|options| options.step_budget = Some(3));
        let uploaded = hasty.upload(&case.structure).unwrap();
        for walk in ["stack", "restart-trail:short-stack=0"].map(|text| text.parse().unwrap()) {
            let answers = hasty.nearest_points(&uploaded, walk, 4, &queries, COUNTED).unwrap().answers;
            let stopped = answers.status.iter().filter(|status| **status == Status::STEP_BUDGET).count();
            assert!(stopped > queries.len() / 2, "{walk}: {stopped}");
            assert!(answers.counters.unwrap().iter().all(|counters| counters.inner_visits <= 3));
        }
        let cramped = machine.tracer(|options| options.stack_entries = Some(1));
        let answers = cramped.closest_points(&uploaded, Walk::default(), &queries, COUNTED).unwrap().answers;
        assert!(answers.status.contains(&Status::STACK_OVERFLOW));
        assert!(answers.counters.unwrap().iter().all(|counters| counters.stack_depth <= 1));
    });
}

/// A scene of nothing answers nothing, to any number of triangles.
#[test]
fn nothing_is_found_in_an_empty_structure() {
    let nothing = Mesh::new(vec![Vec3::ZERO; 3], vec![[0, 7, 2]]);
    let structures = [Scene::default(), Scene::from_mesh(nothing)]
        .map(|scene| Structure::Bvh(scene.build(&BuildOptions::default()).unwrap()));
    let queries = [PointQuery::new(Vec3::ONE), PointQuery::new(Vec3::NAN)];
    on_every_adapter(|machine| {
        for structure in &structures {
            assert!(bvh(structure).triangles().is_empty());
            let uploaded = machine.trusted.upload(structure).unwrap();
            for walk in ["stack", "restart-trail"].map(|text| text.parse().unwrap()) {
                let nearest = machine.trusted.nearest_points(&uploaded, walk, 32, &queries, COUNTED).unwrap();
                assert_eq!(nearest.answers.points.offsets, [0, 0, 0]);
                assert_eq!(nearest.answers.status, [Status::COMPLETE, Status::INVALID_RAY]);
                let closest = machine.trusted.closest_points(&uploaded, walk, &queries, PLAIN).unwrap();
                assert!(closest.answers.points.iter().all(|point| !point.is_found()));
            }
        }
    });
}
