//! Every row, every short stack and every register against the CPU's walk of the same name.

use super::compare::{Agreement, compare_closest, compare_nearest};
use super::{COUNTED, PLAIN, asked, bvh};
use crate::machine::{Machine, on_every_adapter};
use crate::trails::cpu_twin;
use crate::{scenes, trees};
use ropewalk::bvh::Builder;
use ropewalk::catalogue::{StackMemory, TrailOptions, TrailRegister};
use ropewalk::point::catalogue;
use ropewalk::{
    BuildOptions, Bvh, DeviceKind, PointAnswers, PointQuery, Scene, Status, StructureSpec, TraceOptions, Walk,
};
use ropewalk_gpu::{GpuError, GpuStructure, Tracer};
use ropewalk_testkit::cases::Case;

/// The walks that the catalogue has for graphics adapters.
fn walks() -> Vec<Walk> {
    let mut walks: Vec<Walk> = Vec::new();
    for row in catalogue::rows() {
        if row.device == DeviceKind::Gpu && !walks.contains(&row.walk) {
            walks.push(row.walk);
        }
    }
    walks
}

/// A tree on a device, and who is asked about it.
struct Asked<'a> {
    machine: &'a Machine,
    tracer: &'a Tracer,
    uploaded: GpuStructure,
    bvh: &'a Bvh,
    name: String,
}

impl Asked<'_> {
    fn agreement(&self) -> Agreement {
        Agreement::new(self.machine.is_exact(), self.bvh)
    }

    /// The closest points by a walk, on both devices. A walk that the tree is too deep for is refused by both.
    fn closest(&self, walk: Walk, queries: &[PointQuery], options: TraceOptions) {
        let gpu = self.tracer.closest_points(&self.uploaded, walk, queries, options);
        let cpu = match self.bvh.closest_points(cpu_twin(walk), queries, options) {
            Ok(cpu) => cpu,
            Err(error) => return self.is_refused(walk, &error.to_string(), gpu.err()),
        };
        let gpu = gpu.unwrap_or_else(|error| panic!("{walk}, {}: {error}", self.name)).answers;
        if let Err(difference) = compare_closest(queries, &cpu, &gpu, self.agreement()) {
            panic!("{walk}, {}: {difference}", self.name);
        }
        if matches!(walk, Walk::RestartTrail(TrailOptions { short_stack: 0, .. }))
            && self.bvh.nodes().len() > 50
        {
            assert!(gpu.counters.is_none_or(|all| all.iter().any(|one| one.restarts > 0)), "{}", self.name);
        }
    }

    /// The same for the nearest triangles.
    fn nearest(&self, walk: Walk, k: usize, queries: &[PointQuery], options: TraceOptions) {
        let gpu = self.tracer.nearest_points(&self.uploaded, walk, k, queries, options);
        let cpu = match self.bvh.nearest_points(cpu_twin(walk), k, queries, options) {
            Ok(cpu) => cpu,
            Err(error) => return self.is_refused(walk, &error.to_string(), gpu.err()),
        };
        let gpu = gpu.unwrap_or_else(|error| panic!("{walk}, {}: {error}", self.name)).answers;
        if let Err(difference) = compare_nearest(queries, &cpu, &gpu, self.agreement()) {
            panic!("{walk}, k = {k}, {}: {difference}", self.name);
        }
    }

    fn is_refused(&self, walk: Walk, cpu: &str, gpu: Option<GpuError>) {
        let gpu = gpu.map(|error| error.to_string()).unwrap_or_default();
        // They name their own walks.
        let named = |text: &str| text.replace(&walk.to_string(), "").replace(&cpu_twin(walk).to_string(), "");
        assert_eq!(named(cpu), named(&gpu), "{walk}, {}", self.name);
        assert!(cpu.contains("max-depth"), "{walk}, {}: {cpu}", self.name);
    }
}

fn ask<'a>(machine: &'a Machine, tracer: &'a Tracer, case: &'a scenes::Case) -> Asked<'a> {
    let uploaded = tracer.upload(&case.structure).unwrap();
    Asked { machine, tracer, uploaded, bvh: bvh(&case.structure), name: case.name.into() }
}

/// Every row over every case of the conformance suite, over plain trees, spatial splits, depth caps and chains.
#[test]
fn every_row_agrees_on_every_case() {
    let split = BuildOptions { builder: Builder::Sbvh, max_leaf: 2, ..BuildOptions::default() };
    on_every_adapter(|machine| {
        let tracer = &machine.trusted;
        for case in Case::every() {
            let specs = [BuildOptions::default(), split].map(StructureSpec::Bvh);
            for tree in specs.into_iter().flat_map(|spec| case.trees(spec)) {
                let structure = tree.build(&case).unwrap();
                let uploaded = tracer.upload(&structure).unwrap();
                let bvh = bvh(&structure);
                let name = format!("{} ({tree})", case.name);
                let queries = super::queries::against(bvh);
                let asked = Asked { machine, tracer, uploaded, bvh, name };
                // There are many: each walk is asked other queries of each kind, and the first walk all of them.
                for (index, walk) in walks().into_iter().enumerate() {
                    let step = if index == 0 { 1 } else { 5 };
                    let queries: Vec<_> = queries.iter().skip(index % step).step_by(step).copied().collect();
                    asked.closest(walk, &queries, COUNTED);
                    asked.nearest(walk, 5, &queries, COUNTED);
                }
            }
        }
    });
}

/// With and without wgpu's checks, with and without counters, and lists of every length.
#[test]
fn every_kind_of_kernel_agrees() {
    on_every_adapter(|machine| {
        let trail: Walk = "restart-trail:short-stack=3".parse().unwrap();
        for (case, queries) in scenes::every().into_iter().chain(trees::split()).map(asked) {
            for tracer in [&machine.trusted, &machine.checked] {
                let asked = ask(machine, tracer, &case);
                for walk in [Walk::default(), trail] {
                    for options in [COUNTED, PLAIN] {
                        asked.closest(walk, &queries, options);
                        for k in [8, 9] {
                            asked.nearest(walk, k, &queries, options);
                        }
                    }
                }
            }
            let asked = ask(machine, &machine.trusted, &case);
            for k in [0, 1, 2, 31, 32] {
                asked.nearest(Walk::default(), k, &queries, COUNTED);
            }
        }
    });
}

/// Every short stack, register and memory.
#[test]
fn every_trail_agrees() {
    let build = |name, mesh, max_leaf| {
        let options = BuildOptions { max_leaf, ..BuildOptions::default() };
        scenes::Case {
            name,
            structure: ropewalk::Structure::Bvh(Scene::from_mesh(mesh).build(&options).unwrap()),
        }
    };
    let mut cases = vec![build("soup", scenes::soup(400), 1), build("lattice", scenes::lattice(), 2)];
    cases.extend(trees::split());
    cases.extend(trees::chains());
    // There are many kernels: some queries of each kind.
    let cases: Vec<_> = cases
        .into_iter()
        .map(asked)
        .map(|(case, queries)| (case, queries.into_iter().step_by(5).collect::<Vec<_>>()))
        .collect();
    on_every_adapter(|machine| {
        for (case, queries) in &cases {
            let asked = ask(machine, &machine.trusted, case);
            for register in [TrailRegister::U32, TrailRegister::U64, TrailRegister::Array] {
                for short_stack in 0..=TrailOptions::MAX_SHORT_STACK {
                    for memory in [StackMemory::Private, StackMemory::Workgroup] {
                        let walk = Walk::RestartTrail(TrailOptions { short_stack, register, memory });
                        asked.closest(walk, queries, COUNTED);
                        // Which list is kept does not depend on the register: one of them has every stack.
                        if register == TrailRegister::U64 || short_stack == 2 {
                            asked.nearest(walk, 7, queries, COUNTED);
                        }
                    }
                }
            }
        }
    });
}

/// The scenes and queries are worth something only if they do what their names say.
#[test]
fn the_queries_find_miss_and_are_refused() {
    for (case, queries) in scenes::every().into_iter().chain(trees::split()).map(asked) {
        let bvh = bvh(&case.structure);
        let closest = bvh.closest_points(Walk::default(), &queries, COUNTED).unwrap();
        let refused = closest.status.iter().filter(|status| **status == Status::INVALID_RAY).count();
        assert!(refused > 20, "{}: {refused} are refused", case.name);
        let found = closest.points.iter().filter(|point| point.is_found()).count();
        let valid = queries.len() - refused;
        if bvh.triangles().is_empty() {
            assert_eq!(found, 0);
        } else {
            assert!(found * 2 > valid && found + 20 < valid, "{}: {found} of {valid}", case.name);
        }
        // Lists longer than the scene, and ties within a list.
        let PointAnswers { points: lists, .. } =
            bvh.nearest_points(Walk::default(), 32, &queries, PLAIN).unwrap();
        if bvh.triangles().len() < 30 {
            assert!((0..queries.len()).all(|query| lists.of(query).len() <= bvh.triangles().len()));
        } else {
            let has_tie = |query| lists.of(query).windows(2).any(|pair| pair[0].distance == pair[1].distance);
            assert!((0..queries.len()).filter(|&query| has_tie(query)).count() > 20, "{}", case.name);
        }
    }
}

/// A triangle that stands in several leaves is in a list once.
#[test]
fn a_triangle_in_several_leaves_is_told_once() {
    on_every_adapter(|machine| {
        for (case, queries) in trees::split().into_iter().map(asked) {
            let asked = ask(machine, &machine.trusted, &case);
            let answers = machine
                .trusted
                .nearest_points(&asked.uploaded, Walk::default(), 32, &queries, PLAIN)
                .unwrap()
                .answers;
            for query in 0..queries.len() {
                let list = answers.points.of(query);
                assert!(list.windows(2).all(|pair| pair[0].precedes(&pair[1])), "query {query}");
            }
        }
    });
}
