//! Twins: the same bytes in, and the CPU and every adapter give the same words out, counters included.

use crate::compare::compare;
use crate::machine::on_every_adapter;
use crate::scenes::Case;
use crate::trails::cpu_twin;
use crate::{kd_trees, lists, rays, scenes, trees};
use ropewalk::bvh::StackOrder;
use ropewalk::catalogue::is_offered;
use ropewalk::traversal_list::Bounds;
use ropewalk::wide_bvh::Width;
use ropewalk::{
    Answer, BuildOptions, DeviceKind, Query, Ray, Scene, Status, Structure, TraceOptions, Walk, glam::Vec3,
};

const COUNTED: TraceOptions = TraceOptions { counters: true };
const PLAIN: TraceOptions = TraceOptions { counters: false };

/// One walk against the CPU's walk of the same name: every case, every query that it answers, with and without wgpu's
/// checks, with and without counters.
fn agree(walk: Walk, cases: &[Case]) {
    on_every_adapter(|machine| {
        for case in cases {
            let rays = rays::against(&case.structure);
            let uploaded = machine.trusted.upload(&case.structure).unwrap();
            let kind = case.structure.kind();
            for query in
                Query::EVERY.into_iter().filter(|&query| is_offered(kind, walk, query, DeviceKind::Gpu))
            {
                let cpu = case.structure.trace(cpu_twin(walk), query, &rays, COUNTED).unwrap();
                let plain = ropewalk::Traced { counters: None, ..cpu.clone() };
                // Each is a kernel that is compiled: of the other queries, the checked one without counters says enough.
                let mut ways =
                    vec![("trusted", &machine.trusted, COUNTED), ("checked", &machine.checked, PLAIN)];
                if query == Query::Closest {
                    ways.push(("checked", &machine.checked, COUNTED));
                    ways.push(("trusted", &machine.trusted, PLAIN));
                }
                for (kind, tracer, options) in ways {
                    let cpu = if options.counters { &cpu } else { &plain };
                    let gpu = tracer.trace(&uploaded, walk, query, &rays, options).unwrap().traced;
                    if let Err(difference) = compare(cpu, &gpu, machine.is_exact()) {
                        panic!("{walk} {query}, {}, {kind}, {options:?}: {difference}", case.name);
                    }
                }
            }
        }
    });
}

#[test]
fn unordered_agrees() {
    agree(Walk::Stack(StackOrder::Unordered), &scenes::every());
}

#[test]
fn culled_agrees() {
    agree(Walk::Stack(StackOrder::Culled), &scenes::every());
}

#[test]
fn sorted_agrees() {
    agree(Walk::Stack(StackOrder::Sorted), &scenes::every());
}

#[test]
fn ordered_agrees() {
    let cases: Vec<Case> = scenes::every().into_iter().chain(trees::chains()).chain(trees::split()).collect();
    agree(Walk::Stack(StackOrder::Ordered), &cases);
}

#[test]
fn ordered_agrees_on_wide_trees() {
    agree(Walk::default(), &trees::wide(Width::Four));
    agree(Walk::default(), &trees::wide(Width::Eight));
}

/// The register of the default goes with the depth: all three of binary trees, both of wide ones.
#[test]
fn restart_trails_agree() {
    let cases: Vec<Case> = scenes::every().into_iter().chain(trees::chains()).chain(trees::split()).collect();
    for trail in ["short-stack=0", "short-stack=3", "short-stack=4,memory=workgroup"] {
        agree(format!("restart-trail:{trail}").parse().unwrap(), &cases);
    }
}

#[test]
fn restart_trails_agree_on_wide_trees() {
    for width in [Width::Four, Width::Eight] {
        let cases = trees::wide(width);
        for trail in ["short-stack=0", "short-stack=5", "short-stack=3,memory=workgroup"] {
            agree(format!("restart-trail:{trail}").parse().unwrap(), &cases);
        }
    }
}

#[test]
fn lists_agree() {
    for bounds in [Bounds::Sphere, Bounds::Aabb] {
        agree(Walk::List, &lists::every(bounds));
    }
}

#[test]
fn lists_of_one_side_agree() {
    for bounds in [Bounds::Sphere, Bounds::Aabb] {
        agree(Walk::List, &lists::one_sided(bounds));
    }
}

#[test]
fn lists_of_two_layers_agree() {
    for bounds in [Bounds::Sphere, Bounds::Aabb] {
        agree(Walk::List, &lists::layered(bounds));
    }
}

#[test]
fn stacks_agree_on_kd_trees() {
    agree(Walk::default(), &kd_trees::every());
}

#[test]
fn restart_trails_agree_on_kd_trees() {
    for entries in [0, 1, 4, 16] {
        agree(format!("restart-trail:short-stack={entries}").parse().unwrap(), &kd_trees::every());
    }
}

#[test]
fn kd_restart_agrees() {
    agree(Walk::KdRestart, &kd_trees::every());
}

#[test]
fn kd_backtrack_agrees() {
    agree(Walk::KdBacktrack, &kd_trees::every());
}

#[test]
fn short_stacks_agree() {
    for entries in [1, 3, 16] {
        agree(Walk::ShortStack { entries }, &kd_trees::every());
    }
}

#[test]
fn ropes_agree() {
    agree(Walk::Ropes, &kd_trees::every());
}

/// The scenes and rays above are worth something only if they do what their names say.
#[test]
fn the_rays_hit_miss_and_are_refused() {
    for case in scenes::every() {
        let rays = rays::against(&case.structure);
        let traced = case.structure.trace(Walk::default(), Query::Closest, &rays, COUNTED).unwrap();
        let hits = traced.answer.rays_that_hit();
        assert!(traced.count_status(Status::INVALID_RAY) > 30, "{}", case.name);
        if case.name == "empty" {
            assert_eq!(hits, 0);
        } else {
            assert!(hits * 20 > rays.len() && hits < rays.len(), "{}: {hits} of {}", case.name, rays.len());
        }
        if case.name == "deep chain" {
            assert!(case.structure.report().depth > 16, "depth {}", case.structure.report().depth);
            let deepest = traced.totals().unwrap().stack_depth;
            assert!(deepest > 8, "the stack holds {deepest} entries at most");
        }
    }
}

#[test]
fn answers_do_not_depend_on_tiles_or_on_what_ran_before() {
    let structure = sphere();
    let rays = rays::against(&structure);
    let cpu = structure.trace(Walk::default(), Query::Closest, &rays, COUNTED).unwrap();
    on_every_adapter(|machine| {
        for tile in [1, 63, 64, 65, 1000] {
            let tracer = machine.tracer(|options| options.tile_rays = Some(tile));
            let uploaded = tracer.upload(&structure).unwrap();
            // A tile of one ray is a submission a ray: some are enough.
            let some = rays.len().min(tile as usize * 20 + 3);
            let whole = ropewalk::Traced {
                answer: match &cpu.answer {
                    Answer::Closest(hits) => Answer::Closest(hits[..some].to_vec()),
                    other => other.clone(),
                },
                status: cpu.status[..some].to_vec(),
                counters: cpu.counters.as_ref().map(|counters| counters[..some].to_vec()),
            };
            for _ in 0..2 {
                let gpu =
                    tracer.trace(&uploaded, Walk::default(), Query::Closest, &rays[..some], COUNTED).unwrap();
                assert_eq!(compare(&whole, &gpu.traced, machine.is_exact()), Ok(()), "tiles of {tile}");
                // Another kind of result in the same buffers.
                let any = tracer.trace(&uploaded, Walk::default(), Query::Any, &rays[..some], PLAIN).unwrap();
                assert_eq!(any.traced.answer.rays_that_hit(), whole.answer.rays_that_hit());
            }
        }
    });
}

#[test]
fn no_rays_are_an_answer_too() {
    let structure = sphere();
    on_every_adapter(|machine| {
        let uploaded = machine.trusted.upload(&structure).unwrap();
        for query in Query::EVERY {
            let gpu = machine.trusted.trace(&uploaded, Walk::default(), query, &[], COUNTED).unwrap().traced;
            let cpu = structure.trace(Walk::default(), query, &[], COUNTED).unwrap();
            assert_eq!(compare(&cpu, &gpu, true), Ok(()));
        }
    });
}

#[test]
fn threads_may_trace_at_the_same_time() {
    let structure = sphere();
    let rays = rays::against(&structure);
    let cpu = structure.trace(Walk::default(), Query::Closest, &rays, COUNTED).unwrap();
    on_every_adapter(|machine| {
        // Small tiles, so that the threads wait for the device all the time.
        let tracer = machine.tracer(|options| options.tile_rays = Some(1000));
        let uploaded = tracer.upload(&structure).unwrap();
        let trace = || {
            for _ in 0..10 {
                let gpu = tracer.trace(&uploaded, Walk::default(), Query::Closest, &rays, COUNTED).unwrap();
                assert_eq!(compare(&cpu, &gpu.traced, machine.is_exact()), Ok(()));
            }
        };
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(trace);
            }
        });
    });
}

/// A closed mesh keeps what is inside, at edges and vertices above all.
#[test]
fn nothing_leaves_a_closed_mesh() {
    let structure = sphere();
    let mut random = rays::Random::new(5);
    let mut rays = Vec::new();
    for triangle in structure.triangles().iter() {
        let [a, b, c] = triangle.triangle().vertices;
        for target in [a, b, c, a.midpoint(b), b.midpoint(c), a * 0.3 + c * 0.7] {
            let origin = random.vector() * 0.3;
            rays.push(Ray::new(origin, target - origin));
        }
    }
    on_every_adapter(|machine| {
        let uploaded = machine.trusted.upload(&structure).unwrap();
        let gpu = machine.trusted.trace(&uploaded, Walk::default(), Query::Any, &rays, PLAIN).unwrap().traced;
        assert_eq!(gpu.answer.rays_that_hit(), rays.len());
    });
}

#[test]
fn the_device_time_is_measured_where_it_can_be() {
    let structure = sphere();
    let rays = vec![Ray::new(Vec3::new(0.1, 0.2, 5.0), -Vec3::Z); 10_000];
    on_every_adapter(|machine| {
        let uploaded = machine.trusted.upload(&structure).unwrap();
        let traced = machine.trusted.trace(&uploaded, Walk::default(), Query::Closest, &rays, PLAIN).unwrap();
        assert_eq!(traced.device_time.is_some(), machine.gpu().has_timestamps());
        assert_eq!(traced.traced.answer.rays_that_hit(), rays.len());
    });
}

fn sphere() -> Structure {
    Structure::Bvh(Scene::from_mesh(scenes::sphere(20)).build(&BuildOptions::default()).unwrap())
}
