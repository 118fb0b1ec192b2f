//! Every shipped shader is in the list, and every shipped combination is portable WGSL.

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, Module, Scalar, ScalarKind, TypeInner};
use ropewalk::bvh::StackOrder;
use ropewalk::{Query, Walk};
use ropewalk_gpu::shader::{
    AssemblyError, Definitions, HeadKernel, Kernel, PointKernel, ProgramSource, ShaderLibrary, Tree,
};
use std::collections::{BTreeSet, HashSet};
use std::path::Path;

/// What a kernel may use: the limits of a plain WebGPU device.
const MOST_STORAGE_BUFFERS: usize = 4;
/// A program has two tables and a scratch besides.
const MOST_STORAGE_BUFFERS_OF_PROGRAMS: usize = 7;
const MOST_WORKGROUP_BYTES: u32 = 16 << 10;

#[test]
fn the_list_holds_every_file_of_the_folder() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let mut found = BTreeSet::new();
    for part in std::fs::read_dir(&folder).unwrap() {
        let part = part.unwrap().path();
        for file in std::fs::read_dir(&part).unwrap() {
            let file = file.unwrap().path();
            let name = file.strip_prefix(&folder).unwrap().to_str().unwrap().replace('\\', "/");
            found.insert(name.strip_suffix(".wgsl").expect("only WGSL lies here").to_string());
        }
    }
    let library = ShaderLibrary::shipped();
    assert_eq!(found, library.names().map(String::from).collect());
    for name in library.names() {
        let text = library.text(name).unwrap();
        for word in ["Source:", "Invariants:"] {
            let header: Vec<&str> = text.lines().take_while(|line| line.starts_with("//")).collect();
            assert!(header.iter().any(|line| line.contains(word)), "{name} does not say its {word}");
        }
    }
}

#[test]
fn every_kernel_is_portable() {
    let library = ShaderLibrary::shipped();
    let rays = Kernel::every().into_iter().map(|kernel| (kernel.label(), kernel.source(&library)));
    let points = PointKernel::every().into_iter().map(|kernel| (kernel.label(), kernel.source(&library)));
    let heads = HeadKernel::every().into_iter().map(|kernel| (kernel.label(), kernel.source(&library)));
    let kernels: Vec<_> = rays.chain(points).chain(heads).collect();
    let labels: HashSet<&str> = kernels.iter().map(|(label, _)| label.as_str()).collect();
    assert_eq!(labels.len(), kernels.len(), "two kernels are called the same");
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let check_some = |kernels: &[(String, Result<String, AssemblyError>)]| {
        for (label, source) in kernels {
            let source = source.as_ref().unwrap_or_else(|error| panic!("{label}: {error}"));
            if let Err(what) = check(source) {
                panic!("{label}: {what}");
            }
        }
    };
    std::thread::scope(|scope| {
        for part in kernels.chunks(kernels.len().div_ceil(threads)) {
            scope.spawn(|| check_some(part));
        }
    });
}

/// The check itself objects to what it must not let pass.
#[test]
fn the_check_finds_what_is_not_portable() {
    let main = "@compute @workgroup_size(64) fn trace() {}";
    assert_eq!(check(main), Ok(()));
    let storage = |index: usize| {
        format!("@group(0) @binding({index}) var<storage, read_write> b{index}: array<u32>;\n")
    };
    let five: String = (0..5).map(storage).collect();
    let used = "@compute @workgroup_size(64) fn trace() { b0[0] = b1[0] + b2[0] + b3[0] + b4[0]; }";
    assert!(check(&(five + used)).unwrap_err().contains("storage buffers"));
    let large = "var<workgroup> w: array<u32, 5000>; @compute @workgroup_size(64) fn trace() { w[0] = 1u; }";
    assert!(check(large).unwrap_err().contains("workgroup memory"));
    let subgroup = "@compute @workgroup_size(64) fn trace() { _ = subgroupAdd(1u); }";
    assert!(check(subgroup).is_err());
    let wide = "@compute @workgroup_size(64) fn trace() { var x: u64 = 1lu; }";
    assert!(check(wide).is_err());
    let half = "enable f16; @compute @workgroup_size(64) fn trace() { var x: f16 = 1h; }";
    assert!(check(half).is_err());
    assert!(check("fn trace( {").is_err());
}

#[test]
fn a_shader_of_ones_own_can_import_the_parts() {
    let own =
        "#import #{WALK}\n@compute @workgroup_size(1) fn trace() { _ = bvh_nodes[0]; _ = bvh_triangles[0]; }";
    let kernel = Kernel {
        tree: Tree::Binary,
        walk: Walk::Stack(StackOrder::Culled),
        query: Query::Closest,
        counters: false,
        stack_entries: 24,
        starts: 0,
    };
    let library = ShaderLibrary::shipped().with("own", own);
    let source = library.assemble("own", &kernel.definitions()).unwrap();
    assert!(source.contains("array<u32, 24>"), "the culled walk has a stack of words");
    assert_eq!(check(&source), Ok(()));
    let error = library.assemble("own", &Definitions::new()).unwrap_err();
    assert_eq!((error.file.as_str(), error.line), ("own", 1));
}

/// Every tree with one of its walks, with counters and without.
#[test]
fn a_program_is_portable_over_every_tree() {
    let root = "
        fn accepts(hit: Hit) -> bool { return table_b[hit.primitive] != 0u; }
        fn begin(index: u32) {}
        fn turn(index: u32) -> bool {
            var collect = new_collect(batch.infinity);
            collect.ends_early = records[index] != 0u;
            trace_ray(Ray(vec3<f32>(0.0), 0.0, vec3<f32>(1.0), batch.infinity, table_a[0]), &collect);
            scratch[scratch_at(index, 0u)] = 1u;
            results[result_at(index, 0u)] = collect.hit.primitive;
            return false;
        }";
    let program = ProgramSource::new(ShaderLibrary::shipped().with("own", root), "own")
        .define(&Definitions::new().text("COLLECT", "shared/collect_filtered"));
    let mut seen = HashSet::new();
    for kernel in Kernel::every() {
        if kernel.query == Query::Closest && seen.insert((kernel.tree, kernel.counters)) {
            let source = program.source(kernel).unwrap();
            assert_eq!(check_within(&source, MOST_STORAGE_BUFFERS_OF_PROGRAMS), Ok(()), "{}", kernel.label());
            assert!(check(&source).unwrap_err().contains("7 storage buffers"));
        }
    }
    assert_eq!(seen.len(), 2 * Tree::EVERY.len());
}

/// A kernel of this crate.
fn check(source: &str) -> Result<(), String> {
    check_within(source, MOST_STORAGE_BUFFERS)
}

/// Parses and validates a shader as a device without any optional feature would, and looks at what it uses.
fn check_within(source: &str, most_storage_buffers: usize) -> Result<(), String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|error| error.emit_to_string(source))?;
    for (_, ty) in module.types.iter() {
        if let TypeInner::Scalar(scalar) | TypeInner::Vector { scalar, .. } | TypeInner::Atomic(scalar) =
            ty.inner
            && !is_portable(scalar)
        {
            return Err(format!("the type {scalar:?} is not portable"));
        }
    }
    let [entry] = module.entry_points.as_slice() else {
        return Err(format!("{} entry points instead of one", module.entry_points.len()));
    };
    let info = info.get_entry_point(0);
    let used = |space: fn(&AddressSpace) -> bool| {
        module
            .global_variables
            .iter()
            .filter(move |(handle, variable)| !info[*handle].is_empty() && space(&variable.space))
    };
    let storage = used(|space| matches!(space, AddressSpace::Storage { .. })).count();
    if storage > most_storage_buffers {
        return Err(format!("{} uses {storage} storage buffers", entry.name));
    }
    let workgroup =
        used(|space| *space == AddressSpace::WorkGroup).map(|(_, variable)| size(&module, variable.ty));
    let workgroup: u32 = workgroup.sum();
    if workgroup > MOST_WORKGROUP_BYTES {
        return Err(format!("{} uses {workgroup} bytes of workgroup memory", entry.name));
    }
    Ok(())
}

fn is_portable(scalar: Scalar) -> bool {
    scalar.kind == ScalarKind::Bool
        || scalar.width == 4
        || matches!(scalar.kind, ScalarKind::AbstractInt | ScalarKind::AbstractFloat)
}

fn size(module: &Module, ty: naga::Handle<naga::Type>) -> u32 {
    module.types[ty].inner.size(module.to_ctx())
}
