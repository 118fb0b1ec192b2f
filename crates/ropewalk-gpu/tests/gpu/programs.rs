//! Programs: a caller's kernel that traces several rays one after the other, through a filter.

use crate::errors::small_device;
use crate::machine::{Machine, on_every_adapter};
use crate::rays::Random;
use crate::scenes::soup;
use ropewalk::glam::Vec3;
use ropewalk::two_level::TwoLevelOptions;
use ropewalk::{
    Answer, BuildOptions, Counters, KdOptions, ListOptions, Query, Ray, Scene, Status, Structure,
    TraceOptions, Walk, WideOptions,
};
use ropewalk_gpu::shader::{Definitions, ProgramSource, ShaderLibrary};
use ropewalk_gpu::{GpuError, Program, ProgramOptions, Table, Tracer, TracerOptions};

/// Goes on behind each hit that the filter lets through, and counts them. Table A says of each triangle whether it is there;
/// table B what the numbers begin with.
const PEEL: &str = "
fn accepts(hit: Hit) -> bool {
    return table_a[hit.primitive] != 0u;
}

fn begin(index: u32) {
    scratch[scratch_at(index, 0u)] = 0u;
    results[result_at(index, 0u)] = table_b[0];
}

fn turn(index: u32) -> bool {
    let at = #{ITEM_WORDS}u * index;
    var ray: Ray;
    ray.origin = bitcast<vec3<f32>>(vec3<u32>(records[at], records[at + 1u], records[at + 2u]));
    ray.dir = bitcast<vec3<f32>>(vec3<u32>(records[at + 3u], records[at + 4u], records[at + 5u]));
    ray.t_min = bitcast<f32>(scratch[scratch_at(index, 0u)]);
    ray.t_max = batch.infinity;
    ray.mask = 0xffu;
    var collect = new_collect(batch.infinity);
    trace_ray(ray, &collect);
    if collect.hit.primitive == #{NONE} {
        return false;
    }
    results[result_at(index, 0u)] += 1u;
    results[result_at(index, 1u)] ^= collect.hit.primitive * 2654435761u + bitcast<u32>(collect.hit.t);
    scratch[scratch_at(index, 0u)] = bitcast<u32>(next_up(collect.hit.t));
    return true;
}
";

/// Takes turns for ever.
const UNENDING: &str = "
fn begin(index: u32) {}
fn turn(index: u32) -> bool { return true; }
";

fn peel() -> ProgramSource {
    let library = ShaderLibrary::shipped().with("test/peel", PEEL);
    let filtered = Definitions::new().text("COLLECT", "shared/collect_filtered");
    ProgramSource::new(library, "test/peel").with_words(6, 2, 1).define(&filtered)
}

fn options(tile_items: u32, turns: u32) -> ProgramOptions {
    let mut options = ProgramOptions::default();
    options.tile_items = Some(tile_items);
    options.turns = Some(turns);
    options
}

fn structures(scene: &Scene) -> Vec<(Structure, Walk)> {
    let walk = |text: &str| text.parse().unwrap();
    vec![
        (Structure::Bvh(scene.build(&BuildOptions::default()).unwrap()), Walk::default()),
        (
            Structure::Bvh(scene.build(&BuildOptions::default()).unwrap()),
            walk("restart-trail:short-stack=4,memory=workgroup"),
        ),
        (Structure::WideBvh(scene.build_wide(&WideOptions::default()).unwrap()), Walk::default()),
        (Structure::KdTree(scene.build_kd(&KdOptions::default()).unwrap()), Walk::default()),
        (Structure::List(scene.build_list(&ListOptions::default()).unwrap()), Walk::List),
        (Structure::TwoLevel(scene.build_two_level(&TwoLevelOptions::default()).unwrap()), Walk::default()),
    ]
}

fn rays() -> Vec<Ray> {
    let mut random = Random::new(71);
    let mut ray = || Ray::new(random.vector() * 2.0, random.vector());
    let mut rays: Vec<Ray> = (0..300).map(|_| ray()).collect();
    rays[7].dir = Vec3::ZERO;
    rays
}

fn items(rays: &[Ray]) -> Vec<u32> {
    rays.iter().flat_map(|ray| [ray.origin, ray.dir]).flat_map(|v| v.to_array()).map(f32::to_bits).collect()
}

/// What the program answers, on the CPU: of each t the hit that precedes the others.
fn peeled(structure: &Structure, rays: &[Ray], is_there: &[u32]) -> Vec<u32> {
    let traced = structure.trace(Walk::BruteForce, Query::All, rays, TraceOptions::default());
    let Ok(Answer::All(lists)) = traced.map(|traced| traced.answer) else { panic!("all hits are offered") };
    let mut words = Vec::new();
    for bounds in lists.offsets.windows(2) {
        let mut hits = lists.hits[bounds[0] as usize..bounds[1] as usize].to_vec();
        hits.retain(|hit| is_there[hit.primitive_index as usize] != 0);
        hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.primitive_index.cmp(&b.primitive_index)));
        hits.dedup_by_key(|hit| hit.t.to_bits());
        let mix = hits.iter().fold(0, |mix, hit| {
            mix ^ hit.primitive_index.wrapping_mul(2_654_435_761).wrapping_add(hit.t.to_bits())
        });
        words.extend([5 + hits.len() as u32, mix]);
    }
    words
}

#[test]
fn a_program_traces_filtered_rays_one_after_the_other() {
    let scene = Scene::from_mesh(soup(3000));
    let is_there: Vec<u32> = (0..3000).map(|index| u32::from(index % 3 != 0)).collect();
    let rays = rays();
    let brute = Structure::Bvh(scene.build(&BuildOptions::default()).unwrap());
    let expected = peeled(&brute, &rays, &is_there);
    // A ray takes a turn for each hit, and one that finds none; a submission has 16 dispatches.
    let submissions = |rays: &[u32]| {
        let turns = rays.iter().step_by(2).max().map_or(0, |count| count - 5 + 1);
        u64::from(turns.div_ceil(16))
    };
    let submitted: u64 = expected.chunks(2 * 128).map(submissions).sum();
    assert!(submitted > 3, "no tile needs a second submission");
    // The filter and the table decide something.
    assert_ne!(expected, peeled(&brute, &rays, &[1; 3000]));
    on_every_adapter(|machine| {
        if !machine.is_exact() {
            return;
        }
        // One turn a dispatch and one for all; tiles that are not full, and more than two.
        let programs = [options(128, 1), options(4096, 100)]
            .map(|options| Program::new(&machine.trusted, peel(), options).unwrap());
        for (index, (structure, walk)) in structures(&scene).into_iter().enumerate() {
            let uploaded = machine.trusted.upload(&structure).unwrap();
            let program = &programs[index % 2];
            let tables = program.tables(&is_there, &[5]).unwrap();
            let answer =
                program.run(&uploaded, walk, &tables, &items(&rays), TraceOptions::default()).unwrap();
            let name = format!("{} {walk}", structure.kind());
            assert!(answer.words == expected, "{name}");
            let status = |index: usize| if index == 7 { Status::INVALID_RAY } else { Status::COMPLETE };
            assert!(answer.status.iter().enumerate().all(|(index, &one)| one == status(index)), "{name}");
            assert_eq!(answer.dispatches, 16 * [submitted, 1][index % 2], "{name}");
            assert_eq!(answer.counters, None);
        }
    });
}

#[test]
fn tables_are_written_in_ranges_and_counters_are_added_up() {
    let structure = Structure::Bvh(Scene::from_mesh(soup(60)).build(&BuildOptions::default()).unwrap());
    let rays = rays();
    on_every_adapter(|machine| {
        if !machine.is_exact() {
            return;
        }
        let program = Program::new(&machine.trusted, peel(), options(4096, 3)).unwrap();
        let uploaded = machine.trusted.upload(&structure).unwrap();
        let mut is_there = vec![1; 60];
        let tables = program.tables(&is_there, &[4]).unwrap();
        assert_eq!((tables.len(Table::A), tables.len(Table::B), tables.is_empty(Table::B)), (60, 1, false));
        let counted = TraceOptions { counters: true };
        let run = || program.run(&uploaded, Walk::default(), &tables, &items(&rays), counted).unwrap();
        tables.write(Table::B, 0, &[5]).unwrap();
        let answer = run();
        assert_eq!(answer.words, peeled(&structure, &rays, &is_there));
        assert_eq!(answer.counters, Some(peeling_counters(&structure, &rays)));
        tables.write(Table::A, 20, &[0; 15]).unwrap();
        is_there[20..35].fill(0);
        assert_eq!(run().words, peeled(&structure, &rays, &is_there));
        let error = tables.write(Table::A, 59, &[0, 0]).unwrap_err();
        assert_eq!(error, GpuError::OutsideTable { first: 59, end: 61, there: 60 });
        assert!(tables.write(Table::B, usize::MAX, &[0]).is_err());
    });
}

/// What the walks of a peeled ray count together.
fn peeling_counters(structure: &Structure, rays: &[Ray]) -> Vec<Counters> {
    let of = |ray: &Ray| {
        let mut sum = [0; 6];
        let mut ray = *ray;
        loop {
            let traced =
                structure.trace(Walk::default(), Query::Closest, &[ray], TraceOptions { counters: true });
            let traced = traced.unwrap();
            let (Some(counters), Answer::Closest(hits)) = (traced.counters, traced.answer) else { panic!() };
            let words: [u32; 6] = bytemuck::cast(counters[0]);
            for (index, (sum, word)) in sum.iter_mut().zip(words).enumerate() {
                *sum = if index == 4 { word.max(*sum) } else { *sum + word };
            }
            if !hits[0].is_hit() {
                return bytemuck::cast(sum);
            }
            ray.t_min = hits[0].t.next_up();
        }
    };
    rays.iter().map(of).collect()
}

#[test]
fn what_a_program_cannot_do_is_said() {
    let structure = Structure::Bvh(Scene::from_mesh(soup(60)).build(&BuildOptions::default()).unwrap());
    let own = |root: &str, text: &'static str| {
        ProgramSource::new(ShaderLibrary::shipped().with("test/own", text), root)
    };
    on_every_adapter(|machine| {
        let tracer = &machine.trusted;
        let uploaded = tracer.upload(&structure).unwrap();
        let run = |program: &Program, walk: Walk, items: &[u32]| {
            let tables = program.tables(&[1; 60], &[]).unwrap();
            program.run(&uploaded, walk, &tables, items, TraceOptions::default())
        };
        let program = Program::new(tracer, peel(), ProgramOptions::default()).unwrap();
        let none = run(&program, Walk::default(), &[]).unwrap();
        assert_eq!((none.words.len(), none.dispatches), (0, 0));
        let error = run(&program, Walk::default(), &[0; 7]).unwrap_err();
        assert_eq!(error, GpuError::BrokenItems { words: 7, item_words: 6 });
        let error = run(&program, Walk::Recursive, &[0; 6]).unwrap_err();
        assert!(matches!(error, GpuError::Catalogue(_)), "{error}");

        let mut few = options(64, 2);
        few.most_turns = 50;
        let unending = Program::new(tracer, own("test/own", UNENDING), few).unwrap();
        let error = run(&unending, Walk::default(), &[0; 6]).unwrap_err();
        assert_eq!(error, GpuError::Unfinished { item: 0, turns: 64 });

        let missing = Program::new(tracer, own("test/none", ""), ProgramOptions::default()).unwrap();
        let error = run(&missing, Walk::default(), &[0]).unwrap_err().to_string();
        assert!(error.contains("no shader 'test/none'"), "{error}");
        let wrong = Program::new(tracer, own("test/own", "fn begin("), ProgramOptions::default()).unwrap();
        let error = run(&wrong, Walk::default(), &[0]).unwrap_err();
        assert!(matches!(error, GpuError::Refused { what: "a program", .. }), "{error}");
        let other = machine.tracer(|_| ());
        let tables = program.tables(&[], &[]).unwrap();
        let same = Program::new(&other, peel(), ProgramOptions::default()).unwrap();
        assert!(same.run(&uploaded, Walk::default(), &tables, &[], TraceOptions::default()).is_ok());
    });
    let Some(strange) = small_device(|_| ()) else { return };
    on_every_adapter(|machine| {
        let own_tracer = Tracer::new(strange.clone().unwrap());
        let program = Program::new(&own_tracer, peel(), ProgramOptions::default()).unwrap();
        let elsewhere = Program::new(&machine.trusted, peel(), ProgramOptions::default()).unwrap();
        let uploaded = own_tracer.upload(&structure).unwrap();
        let tables = elsewhere.tables(&[], &[]).unwrap();
        let run = program.run(&uploaded, Walk::default(), &tables, &[], TraceOptions::default());
        assert_eq!(run.unwrap_err(), GpuError::OtherDevice);
        let run = elsewhere.run(&uploaded, Walk::default(), &tables, &[], TraceOptions::default());
        assert_eq!(run.unwrap_err(), GpuError::OtherDevice);
    });
    let few_buffers =
        small_device(|limits| limits.max_storage_buffers_per_shader_stage = 6).unwrap().unwrap();
    let error = Program::new(&Tracer::new(few_buffers), peel(), ProgramOptions::default()).unwrap_err();
    let limit = "max_storage_buffers_per_shader_stage";
    assert_eq!(error, GpuError::LimitTooLow { limit, needed: 7, there: 6 });
    let small = small_device(|limits| limits.max_storage_buffer_binding_size = 1 << 12).unwrap().unwrap();
    let program = Program::new(&Tracer::new(small), peel(), ProgramOptions::default()).unwrap();
    let error = program.tables(&[0; 1025], &[]).unwrap_err();
    assert!(matches!(error, GpuError::TooLarge { needed: 4100, limit: 4096, .. }), "{error}");
}

/// A walk that ends before its time ends the item, and says so.
#[test]
fn a_failed_walk_ends_its_item() {
    let structure = Structure::Bvh(Scene::from_mesh(soup(60)).build(&BuildOptions::default()).unwrap());
    on_every_adapter(|machine: &Machine| {
        let mut how = TracerOptions::default();
        how.step_budget = Some(1);
        let tracer = Tracer::with_options(machine.gpu().clone(), how);
        let program = Program::new(&tracer, peel(), options(64, 1)).unwrap();
        let uploaded = tracer.upload(&structure).unwrap();
        let tables = program.tables(&[1; 60], &[5]).unwrap();
        let hits =
            items(&[Ray::new(Vec3::splat(9.0), Vec3::splat(-1.0)), Ray::new(Vec3::splat(9.0), Vec3::ONE)]);
        let answer =
            program.run(&uploaded, Walk::default(), &tables, &hits, TraceOptions::default()).unwrap();
        assert_eq!(answer.status[0], Status::STEP_BUDGET);
        assert_eq!((answer.words[0], answer.dispatches), (5, 16));
    });
}
