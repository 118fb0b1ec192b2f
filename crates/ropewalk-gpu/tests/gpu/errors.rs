//! What does not work is said, with the limit, the need and the way out; nothing panics and nothing is cut off.

use crate::machine::on_every_adapter;
use crate::{scenes, trees};
use ropewalk::bvh::StackOrder;
use ropewalk::catalogue::is_offered;
use ropewalk::wide_bvh::Width;
use ropewalk::{
    BuildOptions, CatalogueError, DeviceKind, KdOptions, ListOptions, Mesh, Query, Ray, Scene, Status,
    Structure, TraceError, TraceOptions, Walk, WideOptions, glam::Vec3,
};
use ropewalk_gpu::{Device, DeviceChoice, Gpu, GpuError, Tracer, adapters, wgpu};

fn structure() -> Structure {
    Structure::Bvh(Scene::from_mesh(scenes::sphere(20)).build(&BuildOptions::default()).unwrap())
}

fn wide_structure() -> Structure {
    Structure::WideBvh(Scene::from_mesh(scenes::sphere(20)).build_wide(&WideOptions::default()).unwrap())
}

fn list_structure() -> Structure {
    Structure::List(Scene::from_mesh(scenes::sphere(20)).build_list(&ListOptions::default()).unwrap())
}

fn kd_structure() -> Structure {
    Structure::KdTree(Scene::from_mesh(scenes::sphere(20)).build_kd(&KdOptions::default()).unwrap())
}

/// What the catalogue has for a structure on a device like these.
fn offered(structure: &Structure) -> Vec<(Walk, Query)> {
    let kind = structure.kind();
    let of = |walk| Query::EVERY.map(|query| (walk, query));
    let rows = Walk::EVERY.into_iter().flat_map(of);
    rows.filter(|&(walk, query)| is_offered(kind, walk, query, DeviceKind::Gpu)).collect()
}

fn rays() -> Vec<Ray> {
    (0..500).map(|i| Ray::new(Vec3::new(-2.0, 0.001 * i as f32, 0.3), Vec3::X)).collect()
}

/// A device whose limits were lowered, as a caller might bring one.
pub(crate) fn small_device(lower: impl Fn(&mut wgpu::Limits)) -> Option<Result<Gpu, GpuError>> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter =
        pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all())).into_iter().next()?;
    let mut limits = Gpu::required_limits(&adapter.limits());
    lower(&mut limits);
    let request = adapter.request_device(&wgpu::DeviceDescriptor {
        required_limits: limits,
        ..wgpu::DeviceDescriptor::default()
    });
    let (device, queue) = pollster::block_on(request).expect("lower limits are always granted");
    Some(Gpu::from_device(device, queue, adapter.get_info()))
}

#[test]
fn an_adapter_that_is_not_there_is_named_with_those_that_are() {
    on_every_adapter(|machine| {
        let error = Gpu::open(4711).unwrap_err();
        assert!(matches!(&error, GpuError::NoSuchAdapter { there, .. } if there.len() == adapters().len()));
        let text = error.to_string();
        assert!(text.contains("4711") && text.contains(&machine.gpu().info().name), "{text}");
        for choice in ["gpu:4711", "gpu:no such card"] {
            let error = Device::open(&choice.parse().unwrap()).unwrap_err().to_string();
            assert!(error.contains(&machine.gpu().info().name), "{error}");
        }
    });
}

#[test]
fn a_structure_over_a_limit_is_refused_with_the_numbers() {
    let structure = structure();
    let Structure::Bvh(bvh) = &structure else { return };
    let node_bytes = size_of_val(bvh.nodes()) as u64;
    let triangle_bytes = size_of_val(bvh.triangles()) as u64;
    assert!(node_bytes < triangle_bytes);
    on_every_adapter(|_| {
        // The nodes fit, the triangles do not. A binding's size is a multiple of 4.
        let between = (node_bytes + triangle_bytes) / 2 / 4 * 4;
        let Some(gpu) = small_device(|limits| limits.max_storage_buffer_binding_size = between) else {
            return;
        };
        let error = Tracer::new(gpu.unwrap()).upload(&structure).unwrap_err();
        let GpuError::TooLarge { what, needed, limit, limit_name, .. } = &error else { panic!("{error:?}") };
        assert_eq!((*what, *needed, *limit), ("triangles of the structure", triangle_bytes, between));
        assert_eq!(*limit_name, "max_storage_buffer_binding_size");
        let text = error.to_string();
        assert!(text.contains(&triangle_bytes.to_string()) && text.contains(&between.to_string()), "{text}");
        assert!(text.contains("CPU") && text.contains("max-leaf"), "{text}");

        let Some(gpu) = small_device(|limits| {
            limits.max_buffer_size = node_bytes - 4;
            limits.max_storage_buffer_binding_size = node_bytes - 4;
        }) else {
            return;
        };
        let error = Tracer::new(gpu.unwrap()).upload(&structure).unwrap_err();
        assert!(matches!(error, GpuError::TooLarge { what: "nodes of the structure", .. }), "{error:?}");
    });
}

/// Of lists, too, and the way out is another one: fewer of them.
#[test]
fn lists_over_a_limit_are_refused_with_the_numbers() {
    let structure = list_structure();
    let Structure::List(lists) = &structure else { return };
    let element_bytes = 320 + size_of_val(lists.elements()) as u64;
    let vertex_bytes = (size_of_val(lists.vertices()) + size_of_val(lists.identities())) as u64;
    assert!(vertex_bytes < element_bytes);
    on_every_adapter(|_| {
        let limit = element_bytes - 4;
        let Some(gpu) = small_device(|limits| limits.max_storage_buffer_binding_size = limit) else { return };
        let error = Tracer::new(gpu.unwrap()).upload(&structure).unwrap_err();
        let GpuError::TooLarge { what, needed, limit: told, .. } = &error else { panic!("{error:?}") };
        assert_eq!((*what, *needed, *told), ("elements of the lists", element_bytes, limit));
        let text = error.to_string();
        assert!(text.contains("CPU") && text.contains("directions=1"), "{text}");
        // As many as fit are taken.
        let Some(gpu) = small_device(|limits| limits.max_storage_buffer_binding_size = element_bytes) else {
            return;
        };
        let tracer = Tracer::new(gpu.unwrap());
        let uploaded = tracer.upload(&structure).unwrap();
        assert_eq!(uploaded.bytes(), element_bytes + vertex_bytes);
    });
}

/// Of a kd-tree the nodes alone are enough for most walks; those that go from leaf to leaf say what they miss.
#[test]
fn a_kd_tree_whose_places_do_not_fit_is_walked_without_them() {
    let structure = kd_structure();
    let Structure::KdTree(tree) = &structure else { return };
    let triangle_bytes = size_of_val(tree.triangles()) + 4 * tree.references().len();
    let all = 40 + 40 * tree.nodes().len() + 24 * tree.report().leaves;
    assert!(triangle_bytes.next_multiple_of(16) < all - 4);
    on_every_adapter(|_| {
        let limit = all as u64 - 4;
        let Some(gpu) = small_device(|limits| limits.max_storage_buffer_binding_size = limit) else { return };
        let tracer = Tracer::new(gpu.unwrap());
        let uploaded = tracer.upload(&structure).unwrap();
        for (walk, query) in offered(&structure) {
            let traced = tracer.trace(&uploaded, walk, query, &rays(), TraceOptions::default());
            if !matches!(walk, Walk::KdBacktrack | Walk::Ropes) {
                let cpu = structure.trace(walk, query, &rays(), TraceOptions::default()).unwrap();
                assert_eq!(traced.unwrap().traced.answer.rays_that_hit(), cpu.answer.rays_that_hit());
                continue;
            }
            let error = traced.unwrap_err();
            let GpuError::TooLarge { needed, limit: told, .. } = &error else { panic!("{error:?}") };
            assert_eq!((*needed, *told), (all as u64, limit));
            assert!(error.to_string().contains("short-stack"), "{error}");
        }
    });
}

/// Lists are walked as lists, trees as trees, and points are asked of trees alone.
#[test]
fn lists_have_one_walk() {
    on_every_adapter(|machine| {
        let options = TraceOptions::default();
        let tracer = &machine.trusted;
        let lists = tracer.upload(&list_structure()).unwrap();
        let trail = "restart-trail".parse().unwrap();
        for walk in [Walk::default(), trail, Walk::BruteForce, Walk::Recursive] {
            let refused = tracer.trace(&lists, walk, Query::Closest, &rays(), options).unwrap_err();
            assert!(matches!(&refused, GpuError::Catalogue(_)), "{refused}");
            assert!(refused.to_string().contains("these do: list"), "{refused}");
        }
        for tree in [structure(), wide_structure()] {
            let uploaded = tracer.upload(&tree).unwrap();
            let refused = tracer.trace(&uploaded, Walk::List, Query::Any, &rays(), options).unwrap_err();
            assert!(matches!(&refused, GpuError::Catalogue(_)), "{refused}");
        }
        for walk in [Walk::List, Walk::default()] {
            let refused = tracer.closest_points(&lists, walk, &[], options).unwrap_err();
            assert!(matches!(&refused, GpuError::Catalogue(_)), "{refused}");
        }
    });
}

/// Limits that a batch must keep to are kept to by smaller tiles.
#[test]
fn a_batch_fits_any_device() {
    let (structure, rays) = (structure(), rays());
    let cpu = structure.trace(Walk::default(), Query::Closest, &rays, TraceOptions::default()).unwrap();
    on_every_adapter(|machine| {
        let bytes = structure.report().bytes as u64;
        let lowered: [fn(&mut wgpu::Limits, u64); 2] = [
            |limits, _| limits.max_compute_workgroups_per_dimension = 2,
            |limits, bytes| {
                limits.max_storage_buffer_binding_size = bytes;
                limits.max_buffer_size = bytes;
            },
        ];
        for lower in lowered {
            let Some(gpu) = small_device(|limits| lower(limits, bytes)) else { return };
            let tracer = Tracer::new(gpu.unwrap());
            let uploaded = tracer.upload(&structure).unwrap();
            let many: Vec<Ray> = rays.iter().copied().cycle().take(20_000).collect();
            let gpu = tracer
                .trace(&uploaded, Walk::default(), Query::Closest, &many, TraceOptions::default())
                .unwrap();
            assert_eq!(gpu.device_time, None, "the device was asked for without timestamps");
            assert_eq!(gpu.traced.answer.rays_that_hit(), cpu.answer.rays_that_hit() * 40);
        }
        // The shared device still works: nothing was done to it.
        machine.trusted.upload(&structure).unwrap();
    });
}

#[test]
fn a_device_that_is_too_small_is_refused() {
    on_every_adapter(|_| {
        let Some(gpu) = small_device(|limits| limits.max_storage_buffers_per_shader_stage = 3) else {
            return;
        };
        let error = gpu.unwrap_err();
        assert!(matches!(error, GpuError::LimitTooLow { needed: 4, there: 3, .. }), "{error:?}");
        assert!(error.to_string().contains("max_storage_buffers_per_shader_stage"), "{error}");
    });
}

#[test]
fn a_structure_of_another_device_is_refused() {
    on_every_adapter(|machine| {
        let Some(gpu) = small_device(|_| {}) else { return };
        let foreign = Tracer::new(gpu.unwrap()).upload(&structure()).unwrap();
        let answer = machine.trusted.trace(
            &foreign,
            Walk::default(),
            Query::Closest,
            &rays(),
            TraceOptions::default(),
        );
        assert_eq!(answer, Err(GpuError::OtherDevice));
    });
}

#[test]
fn what_is_not_in_the_catalogue_is_refused() {
    on_every_adapter(|machine| {
        let uploaded = machine.trusted.upload(&structure()).unwrap();
        for (walk, query) in [
            (Walk::BruteForce, Query::Closest),
            (Walk::Recursive, Query::Any),
            (Walk::Stack(StackOrder::Sorted), Query::All),
            (Walk::Stack(StackOrder::Unordered), Query::Count),
        ] {
            let answer = machine.trusted.trace(&uploaded, walk, query, &rays(), TraceOptions::default());
            let Err(GpuError::Catalogue(CatalogueError(text))) = answer else { panic!("{answer:?}") };
            assert!(text.contains("gpu"), "{text}");
        }
    });
}

#[test]
fn a_step_budget_that_is_used_up_is_reported() {
    let rays = rays();
    on_every_adapter(|machine| {
        let tracer = machine.tracer(|options| options.step_budget = Some(2));
        for structure in [structure(), wide_structure(), list_structure(), kd_structure()] {
            let uploaded = tracer.upload(&structure).unwrap();
            for (walk, query) in offered(&structure) {
                let traced = tracer
                    .trace(&uploaded, walk, query, &rays, TraceOptions { counters: true })
                    .unwrap()
                    .traced;
                let stopped = traced.count_status(Status::STEP_BUDGET);
                assert!(stopped > rays.len() / 2, "{walk} {query}: {stopped}");
                assert!(traced.answer.rays_that_hit() <= rays.len());
                for (status, counters) in traced.status.iter().zip(traced.counters.unwrap()) {
                    assert!(*status == Status::COMPLETE || *status == Status::STEP_BUDGET);
                    assert!(counters.inner_visits <= 2, "{walk} {query}: {counters:?}");
                }
            }
        }
    });
}

#[test]
fn a_stack_that_is_full_is_reported() {
    let (structure, rays) = (structure(), rays());
    on_every_adapter(|machine| {
        let tracer = machine.tracer(|options| options.stack_entries = Some(1));
        for structure in [structure.clone(), wide_structure(), kd_structure()] {
            let uploaded = tracer.upload(&structure).unwrap();
            let stacks = offered(&structure).into_iter().filter(|(walk, _)| matches!(walk, Walk::Stack(_)));
            for (walk, query) in stacks.filter(|(_, query)| *query != Query::Any) {
                let options = TraceOptions { counters: true };
                let traced = tracer.trace(&uploaded, walk, query, &rays, options).unwrap().traced;
                let full = traced.count_status(Status::STACK_OVERFLOW);
                assert!(full > 0, "{walk} {query}");
                assert!(traced.counters.unwrap().iter().all(|counters| counters.stack_depth <= 1));
            }
        }
    });
}

/// A tree that is too deep for a register is refused before anything is sent, with the depth that the register leads
/// to; the array goes through every tree.
#[test]
fn a_tree_that_is_too_deep_is_refused() {
    let rays = rays();
    let wide = |levels| Structure::WideBvh(trees::wide_chain(Width::Four, levels));
    let binary = |depth| Structure::Bvh(trees::chain(depth));
    on_every_adapter(|machine| {
        for (structure, register, depth, limit) in
            [(binary(32), "u32", 32, 31), (binary(64), "u64", 64, 63), (wide(17), "u64", 17, 16)]
        {
            let uploaded = machine.trusted.upload(&structure).unwrap();
            let walk: Walk = format!("restart-trail:short-stack=2,register={register}").parse().unwrap();
            for query in Query::EVERY {
                let answer = machine.trusted.trace(&uploaded, walk, query, &rays, TraceOptions::default());
                let error = GpuError::Trace(TraceError::TooDeep { walk: walk.to_string(), depth, limit });
                assert_eq!(answer, Err(error));
            }
            for register in ["auto", "array"] {
                let walk = format!("restart-trail:short-stack=2,register={register}").parse().unwrap();
                let traced =
                    machine.trusted.trace(&uploaded, walk, Query::Closest, &rays, TraceOptions::default());
                assert!(traced.unwrap().traced.status.iter().all(|status| status.is_complete()));
            }
        }
    });
}

/// A device that is destroyed gives errors from then on, no panic and no wrong answer. Of a device that was opened
/// here the loss is known; of a caller's own, wgpu tells what it refuses.
#[test]
fn a_lost_device_is_an_error() {
    let (structure, rays) = (structure(), rays());
    on_every_adapter(|_| {
        let Some(brought) = small_device(|_| {}) else { return };
        for (gpu, ours) in [(brought.unwrap(), false), (Gpu::open(0).unwrap(), true)] {
            let tracer = Tracer::new(gpu);
            let uploaded = tracer.upload(&structure).unwrap();
            let trace = |walk| tracer.trace(&uploaded, walk, Query::Closest, &rays, TraceOptions::default());
            trace(Walk::default()).unwrap();
            tracer.gpu().device().destroy();
            let known = trace(Walk::default()).unwrap_err();
            let new = trace("stack:order=culled".parse().unwrap()).unwrap_err();
            let upload = tracer.upload(&structure).unwrap_err();
            for error in [known, new, upload] {
                let lost = matches!(error, GpuError::DeviceLost(_));
                assert!(lost || !ours && matches!(error, GpuError::Refused { .. }), "{error:?}");
            }
        }
    });
}

/// The best-known text of a missing driver has the way out.
#[test]
fn errors_name_the_way_out() {
    assert!(GpuError::NoAdapter.to_string().contains("lavapipe"));
    let error = "vulkan".parse::<DeviceChoice>().unwrap_err().to_string();
    assert!(error.contains("gpu:NUMBER"), "{error}");
}

/// A mesh of one triangle that no ray can hit is an empty structure, which every device accepts.
#[test]
fn a_structure_of_nothing_is_accepted() {
    let nothing = Mesh::new(vec![Vec3::ZERO; 3], vec![[0, 1, 2]]);
    let structure = Structure::Bvh(Scene::from_mesh(nothing).build(&BuildOptions::default()).unwrap());
    on_every_adapter(|machine| {
        let uploaded = machine.trusted.upload(&structure).unwrap();
        assert!(uploaded.bytes() > 0);
        let traced =
            machine.trusted.trace(&uploaded, Walk::default(), Query::Any, &rays(), TraceOptions::default());
        assert_eq!(traced.unwrap().traced.answer.rays_that_hit(), 0);
    });
}
