//! Every short stack, register and memory of the restart trail against the CPU's walk: the same words, counters too.

use crate::compare::compare;
use crate::machine::on_every_adapter;
use crate::scenes::{Case, lattice, soup};
use crate::trees::Leaves;
use crate::{rays, trees};
use ropewalk::catalogue::{StackMemory, TrailOptions, TrailRegister};
use ropewalk::wide_bvh::{WideOptions, Width};
use ropewalk::{
    Answer, BuildOptions, Counters, Hit, Query, Ray, Scene, Status, Structure, TraceError, TraceOptions, Walk,
};
use ropewalk_gpu::GpuError;

const COUNTED: TraceOptions = TraceOptions { counters: true };

/// The walk of the CPU that does the same. It has no workgroup memory, and the answer does not depend on it.
pub(crate) fn cpu_twin(walk: Walk) -> Walk {
    match walk {
        Walk::RestartTrail(options) => {
            Walk::RestartTrail(TrailOptions { memory: StackMemory::Private, ..options })
        }
        other => other,
    }
}

/// Every setting with one of these registers.
fn trails(registers: &[TrailRegister]) -> Vec<TrailOptions> {
    let mut trails = Vec::new();
    for &register in registers {
        for short_stack in 0..=TrailOptions::MAX_SHORT_STACK {
            for memory in [StackMemory::Private, StackMemory::Workgroup] {
                trails.push(TrailOptions { short_stack, register, memory });
            }
        }
    }
    trails
}

/// Closest hits by each trail, on each case that is no deeper than its register leads.
fn agree(cases: &[(Case, u32)], trails: &[TrailOptions], limit: impl Fn(TrailRegister) -> u32) {
    for (case, depth) in cases {
        assert_eq!(case.structure.report().depth, *depth, "{}", case.name);
    }
    on_every_adapter(|machine| {
        for (case, depth) in cases {
            let rays = few_rays(&case.structure);
            let uploaded = machine.trusted.upload(&case.structure).unwrap();
            for &options in trails {
                let walk = Walk::RestartTrail(options);
                let twin = cpu_twin(walk);
                let gpu = machine.trusted.trace(&uploaded, walk, Query::Closest, &rays, COUNTED);
                let cpu = case.structure.trace(twin, Query::Closest, &rays, COUNTED);
                let limit = limit(options.register);
                if *depth > limit {
                    assert_eq!(cpu, Err(TraceError::too_deep(twin, *depth, limit)), "{walk}, {}", case.name);
                    let refused = GpuError::Trace(TraceError::too_deep(walk, *depth, limit));
                    assert_eq!(gpu, Err(refused), "{walk}, {}", case.name);
                    continue;
                }
                let (cpu, gpu) = (cpu.unwrap(), gpu.unwrap().traced);
                if let Err(difference) = compare(&cpu, &gpu, machine.is_exact()) {
                    panic!("{walk}, {}: {difference}", case.name);
                }
                let totals = cpu.totals().unwrap();
                if options.short_stack == 0 {
                    assert!(
                        totals.restarts > 0 && totals.stack_depth == 0,
                        "{walk}, {}: {totals:?}",
                        case.name
                    );
                }
                assert!(totals.stack_depth <= options.short_stack);
            }
        }
    });
}

/// There are many settings, and each is compiled anew: some rays of each kind.
fn few_rays(structure: &Structure) -> Vec<Ray> {
    rays::against(structure).into_iter().step_by(5).collect()
}

#[test]
fn every_trail_agrees() {
    let case = |name, mesh, max_leaf, depth| {
        let options = BuildOptions { max_leaf, ..BuildOptions::default() };
        let structure = Structure::Bvh(Scene::from_mesh(mesh).build(&options).unwrap());
        assert!(structure.report().depth <= 31);
        let depth = if depth == 0 { structure.report().depth } else { depth };
        (Case { name, structure }, depth)
    };
    let mut cases = vec![case("soup", soup(400), 1, 0), case("lattice", lattice(), 2, 0)];
    cases.extend(trees::chains().into_iter().zip([31, 32, 63, 63, 64]));
    let trails = trails(&[TrailRegister::U32, TrailRegister::U64, TrailRegister::Array]);
    agree(&cases, &trails, |register| match register {
        TrailRegister::U32 => 31,
        TrailRegister::U64 => 63,
        _ => 64,
    });
}

#[test]
fn every_trail_agrees_on_wide_trees() {
    for width in [Width::Four, Width::Eight] {
        let case = |name, structure: Structure| {
            let depth = structure.report().depth;
            (Case { name, structure }, depth)
        };
        let build = BuildOptions { max_leaf: 1, ..BuildOptions::default() };
        let options = WideOptions { width, build, ..WideOptions::default() };
        let collapsed = |mesh| Structure::WideBvh(Scene::from_mesh(mesh).build_wide(&options).unwrap());
        let mut cases = vec![case("soup", collapsed(soup(400))), case("lattice", collapsed(lattice()))];
        let chains = trees::wide(width).into_iter().filter(|case| case.name.contains("chain"));
        cases.extend(chains.zip([16, 16, 17, 64]));
        let trails = trails(&[TrailRegister::U64, TrailRegister::Array]);
        agree(&cases, &trails, |register| if register == TrailRegister::U64 { 16 } else { 64 });
    }
}

/// The register and the memory change no word; a larger stack means fewer visits, down to those of the full stack.
#[test]
fn larger_stacks_visit_less() {
    let structure = Structure::Bvh(trees::chain(31));
    let rays = few_rays(&structure);
    on_every_adapter(|machine| {
        let uploaded = machine.trusted.upload(&structure).unwrap();
        let counters = |walk| -> Vec<Counters> {
            let traced = machine.trusted.trace(&uploaded, walk, Query::Closest, &rays, COUNTED).unwrap();
            traced.traced.counters.unwrap()
        };
        let full = counters(Walk::default());
        let mut before = u64::MAX;
        for short_stack in [0, 1, 2, 4, 8, 16] {
            let options = TrailOptions { short_stack, ..TrailOptions::default() };
            let by_default = counters(Walk::RestartTrail(options));
            for register in [TrailRegister::U32, TrailRegister::U64, TrailRegister::Array] {
                for memory in [StackMemory::Private, StackMemory::Workgroup] {
                    let walk = Walk::RestartTrail(TrailOptions { register, memory, ..options });
                    assert_eq!(counters(walk), by_default, "{walk}");
                }
            }
            let visits = by_default.iter().map(|counters| u64::from(counters.inner_visits)).sum();
            assert!(visits < before, "{visits} visits with {short_stack} entries, {before} with fewer");
            before = visits;
            for (ray, (short, full)) in by_default.iter().zip(&full).enumerate() {
                assert_eq!(
                    (short.leaf_visits, short.primitive_tests),
                    (full.leaf_visits, full.primitive_tests)
                );
                assert!(short.inner_visits >= full.inner_visits, "ray {ray}");
                if full.stack_depth <= short_stack {
                    assert_eq!(short, full, "ray {ray} with {short_stack} entries");
                }
            }
        }
    });
}

/// Lavapipe ends all loops of a shader after 65,535 iterations. A walk that is so long is not told as complete; every
/// ray that is has the right words.
#[test]
fn what_a_driver_cuts_off_is_told() {
    let structure = Structure::WideBvh(trees::wide_chain_with(Width::Eight, 64, Leaves::All));
    let rays = few_rays(&structure);
    let walk: Walk = "restart-trail:short-stack=0".parse().unwrap();
    let cpu = structure.trace(walk, Query::Closest, &rays, COUNTED).unwrap();
    on_every_adapter(|machine| {
        let uploaded = machine.trusted.upload(&structure).unwrap();
        for tracer in [&machine.trusted, &machine.checked] {
            let mut gpu = tracer.trace(&uploaded, walk, Query::Closest, &rays, COUNTED).unwrap().traced;
            let cut = gpu.count_status(Status::STEP_BUDGET);
            println!("{cut} of {} rays are cut off", rays.len());
            assert!(cut < rays.len());
            let mut cpu = cpu.clone();
            // Of those that are cut off nothing is demanded.
            let is_cut = |&ray: &usize| gpu.status[ray].contains(Status::STEP_BUDGET);
            for ray in (0..rays.len()).filter(is_cut).collect::<Vec<_>>() {
                for traced in [&mut cpu, &mut gpu] {
                    traced.status[ray] = Status::COMPLETE;
                    if let Answer::Closest(hits) = &mut traced.answer {
                        hits[ray] = Hit::MISS;
                    }
                    if let Some(counters) = &mut traced.counters {
                        counters[ray] = Counters::default();
                    }
                }
            }
            assert_eq!(compare(&cpu, &gpu, machine.is_exact()), Ok(()));
        }
    });
}
