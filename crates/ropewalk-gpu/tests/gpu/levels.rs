//! Two levels: one loop on a device, two nested ones on the CPU, the same words.

use crate::compare::compare;
use crate::damage::{Damage, notice_each};
use crate::machine::{Machine, on_every_adapter};
use crate::rays;
use crate::rays::Random;
use crate::scenes::{instances, one_triangle, soup, sphere};
use ropewalk::bvh::Builder;
use ropewalk::glam::{Affine3A, Quat, Vec3};
use ropewalk::traversal_list::Bounds;
use ropewalk::two_level::{BottomSpec, Bottoms, Opening, TopUpdate, TwoLevelOptions};
use ropewalk::wide_bvh::Width;
use ropewalk::{
    BuildOptions, DeviceKind, Instance, KdOptions, LARGEST_DIRECTION, ListOptions, Query, Ray,
    SMALLEST_DIRECTION, Scene, Structure, TraceOptions, Transform, Walk, WideOptions,
};
use ropewalk_gpu::StructureVersions;
use std::sync::Arc;

const COUNTED: TraceOptions = TraceOptions { counters: true };
const PLAIN: TraceOptions = TraceOptions { counters: false };

struct Case {
    name: &'static str,
    structure: Structure,
    rays: Vec<Ray>,
}

fn case(name: &'static str, scene: &Scene, options: TwoLevelOptions) -> Case {
    let flat = Structure::Bvh(scene.build(&BuildOptions::default()).unwrap());
    let structure = Structure::TwoLevel(scene.build_two_level(&options).unwrap());
    Case { name, structure, rays: rays::against(&flat) }
}

/// Small parts everywhere, turned, stretched and mirrored.
fn assembly() -> Scene {
    let mut scene = Scene::default();
    let objects = [scene.add_object(sphere(4)), scene.add_object(soup(24)), scene.add_object(one_triangle())];
    let mut random = Random::new(31);
    for index in 0..45 {
        let turn = Quat::from_scaled_axis(random.vector() * 3.0);
        let scale = Vec3::new(0.3, 0.1, if index % 2 == 0 { 0.2 } else { -0.2 });
        let place = Affine3A::from_scale_rotation_translation(scale, turn, random.vector() * 2.0);
        scene.instances.push(Instance::new(objects[index % 3], Transform::new(place).unwrap()));
    }
    scene
}

/// One object for each kind of structure.
fn everything() -> Scene {
    let mut scene = Scene::default();
    let mut random = Random::new(37);
    for index in 0..5 {
        let object = scene.add_object(soup(30 + index));
        for _ in 0..4 {
            let place = Affine3A::from_scale_rotation_translation(
                Vec3::new(0.4, 0.3, -0.5),
                Quat::from_scaled_axis(random.vector() * 3.0),
                random.vector(),
            );
            scene.instances.push(Instance::new(object, Transform::new(place).unwrap()));
        }
    }
    scene
}

/// One object much smaller and much larger than it is: the longest and the shortest directions leave the range of rays there.
fn scaled() -> Scene {
    let mut scene = Scene::default();
    let object = scene.add_object(soup(60));
    for (scale, place) in [(1e-3, Vec3::X), (1e3, Vec3::NEG_X), (1.0, Vec3::Y)] {
        let place = Affine3A::from_translation(place * scale) * Affine3A::from_scale(Vec3::splat(scale));
        scene.instances.push(Instance::new(object, Transform::new(place).unwrap()));
    }
    scene
}

/// The same rays with the longest and the shortest directions that there may be.
fn of_every_length(case: Case) -> Case {
    let with_length = |ray: &Ray, length: f32| Ray {
        dir: ray.dir * (length / ray.dir.abs().max_element().max(1e-30)),
        t_max: f32::INFINITY,
        ..*ray
    };
    let valid = || case.rays.iter().filter(|ray| ray.is_valid());
    let longest = valid().map(|ray| with_length(ray, LARGEST_DIRECTION * 0.9));
    let shortest = valid().map(|ray| with_length(ray, SMALLEST_DIRECTION * 1.2));
    let rays = longest.chain(shortest).collect();
    Case { rays, ..case }
}

fn with(bottom: BottomSpec) -> TwoLevelOptions {
    TwoLevelOptions { bottoms: Bottoms::Each(bottom), ..TwoLevelOptions::default() }
}

fn every() -> Vec<Case> {
    let kd = with(BottomSpec::KdTree(KdOptions::default()));
    let bvh = with(BottomSpec::Bvh(BuildOptions::default()));
    let sbvh = with(BottomSpec::Bvh(BuildOptions {
        builder: Builder::Sbvh,
        max_leaf: 2,
        ..BuildOptions::default()
    }));
    // Of the first three objects kd-trees, BVHs and SBVHs.
    let mixed = TwoLevelOptions { bottoms: Bottoms::Mixed, ..TwoLevelOptions::default() };
    let eight = WideOptions::default();
    let wide = with(BottomSpec::WideBvh(eight));
    let lists = ListOptions::default();
    let mut one = Scene::default();
    let object = one.add_object(soup(300));
    one.instances.push(Instance::new(object, Transform::from_translation(Vec3::new(0.3, -0.2, 0.1))));
    vec![
        case("nothing", &Scene::default(), kd),
        case("one object", &one, kd),
        case("instances of kd-trees", &instances(), kd),
        case("instances of kd-trees as they are", &instances(), TwoLevelOptions { oriented: false, ..kd }),
        case("instances of BVHs", &instances(), bvh),
        case("instances of SBVHs", &instances(), sbvh),
        case("instances of both", &instances(), mixed),
        case("assembly of kd-trees", &assembly(), kd),
        case("assembly of both", &assembly(), mixed),
        case("instances of wide BVHs", &instances(), wide),
        case(
            "instances of wide BVHs of 4",
            &instances(),
            with(BottomSpec::WideBvh(WideOptions { width: Width::Four, ..eight })),
        ),
        case(
            "instances of lists of boxes",
            &instances(),
            with(BottomSpec::List(ListOptions { bounds: Bounds::Aabb, ..lists })),
        ),
        case(
            "instances of lists of spheres",
            &instances(),
            with(BottomSpec::List(ListOptions { bounds: Bounds::Sphere, ..lists })),
        ),
        case(
            "instances of two layers",
            &instances(),
            with(BottomSpec::List(ListOptions { moving: Some(0), ..lists })),
        ),
        case("everything", &everything(), mixed),
        of_every_length(case("scaled", &scaled(), kd)),
        case("one object, opened", &one, TwoLevelOptions { opening: Opening::Blindly(8), ..kd }),
        case("assembly, opened", &assembly(), TwoLevelOptions { opening: Opening::ByCost(3), ..mixed }),
    ]
}

fn agree(walk: Walk, cases: &[Case]) {
    on_every_adapter(|machine| {
        for Case { name, structure, rays } in cases {
            let uploaded = machine.trusted.upload(structure).unwrap();
            for query in Query::EVERY {
                let cpu = structure.trace(walk, query, rays, COUNTED).unwrap();
                let gpu = machine.trusted.trace(&uploaded, walk, query, rays, COUNTED).unwrap().traced;
                if let Err(difference) = compare(&cpu, &gpu, machine.is_exact()) {
                    panic!("{walk} {query}, {name}: {difference}");
                }
            }
            let cpu = structure.trace(walk, Query::Closest, rays, PLAIN).unwrap();
            let gpu = machine.checked.trace(&uploaded, walk, Query::Closest, rays, PLAIN).unwrap().traced;
            if let Err(difference) = compare(&cpu, &gpu, machine.is_exact()) {
                panic!("{walk} checked, {name}: {difference}");
            }
        }
    });
}

#[test]
fn stacks_of_two_levels_agree() {
    agree(Walk::default(), &every());
}

#[test]
fn smart_stacks_agree() {
    // The smallest is the conformance suite's.
    agree(Walk::SmartStack { bytes: 256 }, &every());
}

/// Objects that only moved are not sent again, and every frame has the words of the CPU.
#[test]
fn a_frame_sends_what_moved() {
    let mut scene = Scene::default();
    let object = scene.add_object(sphere(20));
    let mut random = Random::new(41);
    for _ in 0..20 {
        scene.add_instance(object, Transform::from_translation(random.vector() * 4.0));
    }
    let first = case("balls", &scene, TwoLevelOptions::default());
    let Structure::TwoLevel(two_level) = first.structure else { panic!("it was built") };
    // Those from very far away are in all objects at once, and lavapipe counts their loops.
    let rays = &first.rays[..6000];
    on_every_adapter(|machine| {
        let mut scene = two_level.clone();
        let begin = Arc::new(Structure::TwoLevel(scene.clone()));
        let versions = StructureVersions::new(&machine.trusted, &begin).unwrap();
        let updates = [TopUpdate::Rebuild, TopUpdate::Refit, TopUpdate::Restructure];
        for frame in 0..6 {
            let place = Affine3A::from_translation(Vec3::new(0.3, 0.1, 0.2) * frame as f32);
            scene.set_transform(frame, place).unwrap();
            scene.commit(updates[frame as usize % 3]).unwrap();
            let structure = Arc::new(Structure::TwoLevel(scene.clone()));
            let report = versions.upload(&structure).unwrap();
            // The first one fills the second set of buffers.
            if frame > 0 {
                assert!(!report.is_new && report.bytes_written * 10 < report.bytes, "{report:?}");
            }
            let walk = Walk::default();
            let cpu = structure.trace(walk, Query::Closest, rays, COUNTED).unwrap();
            let gpu =
                machine.trusted.trace(&versions.current(), walk, Query::Closest, rays, COUNTED).unwrap();
            assert_eq!(compare(&cpu, &gpu.traced, machine.is_exact()), Ok(()), "frame {frame}");
        }
    });
}

/// One loop has one budget and one stack, and says when they are used up.
#[test]
fn what_runs_out_is_told() {
    use ropewalk::Status;
    let Case { structure, rays, .. } = case("instances", &instances(), TwoLevelOptions::default());
    on_every_adapter(|machine| {
        for walk in [Walk::default(), Walk::SmartStack { bytes: 24 }] {
            let short = machine.tracer(|options| options.step_budget = Some(3));
            let small = machine.tracer(|options| options.stack_entries = Some(1));
            for (tracer, status) in [(short, Status::STEP_BUDGET), (small, Status::STACK_OVERFLOW)] {
                let uploaded = tracer.upload(&structure).unwrap();
                let traced = tracer.trace(&uploaded, walk, Query::Closest, &rays, COUNTED).unwrap().traced;
                assert!(traced.count_status(status) > 100, "{walk}: {}", traced.count_status(status));
            }
        }
    });
}

const LEVELS: &[Damage] = &[
    ("shared/enter", "inside.span.entry), inside.span.exit)", "inside.span.entry), inside.span.entry)"),
    ("shared/enter", "hit.t * inside.scale", "hit.t"),
    ("shared/enter", "moved.instance = inside.instance;", ""),
    ("shared/enter", "if limit >= inside.span.exit {", "if false {"),
    ("shared/enter", "+ placed.origin", ""),
    ("shared/enter", "placed.axis_x.y, placed.axis_y.y", "placed.axis_y.x, placed.axis_y.y"),
    ("shared/enter", "(placed.instance_and_mask & seeker.ray.mask) == 0u", "false"),
    ("shared/level_cells", "(index & 1u) != 0u", "false"),
    ("shared/level_stack", "(*stack).floor = (*stack).held;", ""),
    ("walk/walk_two_level", "probe_object_entered();", ""),
    ("walk/walk_two_level", "waiting.entry <= limit_now", "waiting.entry < limit_now"),
    ("walk/walk_two_level", "b.entry < a.entry", "b.entry <= a.entry"),
    ("walk/walk_two_level", "current = nodes + entry.node;", "current = nodes;"),
    ("walk/walk_two_level", "current = entry.node;", "current = 0u;"),
    ("walk/walk_two_level", "min(waiting.exit, limit_now)", "waiting.exit"),
    ("shared/levels", "ray.origin_low + step", "ray.origin_low"),
    ("walk/walk_two_level", "record = load_link_and_count(waiting.node);", ""),
    ("walk/walk_two_level", "list = list_of(ray);", ""),
    ("walk/walk_two_level", "place + u32(next), next > 0", "place + 1u, next > 0"),
    ("shared/level_list", "list_base = 4u * object.nodes;", "list_base = 0u;"),
    ("shared/level_list", "shared_base = 12u * object.triangles;", "shared_base = 0u;"),
];
const SMART: &[Damage] = &[
    (
        "shared/smart_stack",
        "(*stack).swapped[(*stack).swapped_words + #{WORD}u];",
        "(*stack).swapped[(*stack).swapped_words];",
    ),
    ("shared/smart_stack", "(*stack).swapped_words -= words;", "(*stack).swapped_words -= min(words, 1u);"),
    ("shared/smart_stack", "let is_top = (*stack).top_in_ring > 0u;", "let is_top = false;"),
    ("shared/smart_stack", "+ local_index", ""),
    ("shared/smart_stack", "(*stack).top_in_swap += 1u;", ""),
    ("shared/smart_stack", "(*stack).bottom_in_swap += 1u;", ""),
    ("shared/smart_stack", "select(2u, 3u, has_cells)", "2u"),
];

fn notice(walk: Walk, names: &[&str], damages: &[Damage]) {
    let cases: Vec<Case> = every().into_iter().filter(|case| names.contains(&case.name)).collect();
    assert_eq!(cases.len(), names.len());
    let cpu: Vec<_> = cases
        .iter()
        .map(|case| case.structure.trace(walk, Query::Closest, &case.rays, COUNTED).unwrap())
        .collect();
    let upload = |machine: &Machine| {
        cases.iter().map(|case| machine.trusted.upload(&case.structure).unwrap()).collect()
    };
    notice_each(&walk.to_string(), 64, damages, upload, |tracer, uploaded| {
        cases.iter().zip(&cpu).zip(uploaded).find_map(|((case, cpu), uploaded)| {
            let gpu = tracer.trace(uploaded, walk, Query::Closest, &case.rays, COUNTED).unwrap();
            compare(cpu, &gpu.traced, true).err().map(|what| format!("{}: {what}", case.name))
        })
    });
}

#[test]
fn broken_levels_are_noticed() {
    let names = [
        "instances of both",
        "scaled",
        "assembly of both",
        "one object, opened",
        "assembly, opened",
        "everything",
    ];
    notice(Walk::default(), &names, LEVELS);
    notice(Walk::SmartStack { bytes: 24 }, &names, SMART);
}

/// The rows are in the catalogue.
#[test]
fn both_walks_are_offered() {
    for walk in [Walk::default(), Walk::SmartStack { bytes: 24 }] {
        for query in Query::EVERY {
            let kind = ropewalk::StructureKind::TwoLevel;
            assert!(ropewalk::catalogue::is_offered(kind, walk, query, DeviceKind::Gpu), "{walk} {query}");
        }
    }
}
