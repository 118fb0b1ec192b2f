//! Heads that a device works out: the CPU's, every one.

use crate::damage::{Damage, notice_each};
use crate::machine::{Machine, on_every_adapter};
use crate::scenes::{Case, instances, lattice, soup};
use crate::starts::{cases, frustum, list};
use crate::{lists, rays};
use ropewalk::glam::Vec3;
use ropewalk::traversal_list::{
    Bounds, Clearance, Directions, Frustum, HeadTable, Heads, ListOptions, NO_HEAD, Source, Starts,
};
use ropewalk::{Query, Ray, Scene, TraceOptions, Walk};
use ropewalk_gpu::{GpuError, Tracer};

/// The first head in which two tables differ; where the device rounds otherwise, only how many there are.
fn compare_heads(cpu: &HeadTable, gpu: &HeadTable, exact: bool) -> Result<(), String> {
    if (cpu.width(), cpu.rows()) != (gpu.width(), gpu.rows()) {
        return Err(format!("{} rows of {}, {} of {}", cpu.rows(), cpu.width(), gpu.rows(), gpu.width()));
    }
    let differ = |place: &usize| cpu.heads()[*place] != gpu.heads()[*place];
    match (0..cpu.heads().len()).find(differ) {
        Some(place) if exact => Err(format!(
            "head {place}: CPU {}, device {} ({} of {} differ)",
            cpu.heads()[place],
            gpu.heads()[place],
            (0..cpu.heads().len()).filter(differ).count(),
            cpu.heads().len()
        )),
        _ => Ok(()),
    }
}

#[test]
fn heads_of_polygons_are_those_of_the_cpu() {
    on_every_adapter(|machine| {
        for case in cases().into_iter().chain(more()) {
            let own = list(&case).options().heads;
            let list = list(&case);
            let cpu = list.polygon_heads().unwrap();
            for tracer in [&machine.trusted, &machine.checked] {
                let uploaded = tracer.upload(&case.structure).unwrap();
                let gpu = tracer.polygon_heads(&uploaded, list, own).unwrap();
                assert_eq!(compare_heads(cpu, &gpu, machine.is_exact()), Ok(()), "{}", case.name);
            }
        }
    });
}

#[test]
fn heads_of_cells_are_those_of_the_cpu() {
    on_every_adapter(|machine| {
        for case in cases().into_iter().chain(more()) {
            let uploaded = machine.trusted.upload(&case.structure).unwrap();
            let flat = Frustum { right: Vec3::ZERO, ..frustum(3) };
            for frustum in [frustum(1), frustum(8), flat, frustum(0)] {
                let cpu = list(&case).frustum_heads(&frustum);
                let gpu = machine.trusted.frustum_heads(&uploaded, list(&case), &frustum).unwrap();
                assert_eq!(compare_heads(&cpu, &gpu, machine.is_exact()), Ok(()), "{}", case.name);
            }
        }
    });
}

/// On devices that round otherwise, too: rays that begin with the device's heads hit what they hit without.
#[test]
fn no_hit_is_lost_with_heads_of_a_device() {
    let case = cases().swap_remove(0);
    let list = list(&case);
    let mut random = rays::Random::new(8);
    let numbers: Vec<u32> = (0..4000).map(|_| random.below(list.identities().len()) as u32).collect();
    let from = |&number: &u32| {
        let [a, b, c] = list.triangle_at(number).triangle().vertices;
        Ray::new((a + b + c) / 3.0, random.vector()).window(1e-4, f32::INFINITY)
    };
    let rays: Vec<Ray> = numbers.iter().map(from).collect();
    on_every_adapter(|machine| {
        let uploaded = machine.trusted.upload(&case.structure).unwrap();
        let table = machine.trusted.polygon_heads(&uploaded, list, Heads::Regular).unwrap();
        let rows = list.polygon_starts(&rays, &numbers);
        let (query, plain) = (Query::Closest, TraceOptions::default());
        let starts = Starts { table: &table, rows: &rows };
        let with = machine.trusted.trace_from(&uploaded, query, &rays, starts, plain).unwrap();
        let without = machine.trusted.trace(&uploaded, Walk::List, query, &rays, plain).unwrap();
        assert_eq!(with.traced, without.traced);
    });
}

#[test]
fn tiles_make_no_difference() {
    let case = cases().swap_remove(5);
    let list = list(&case);
    on_every_adapter(|machine| {
        for tile in [1, 100] {
            let tracer = machine.tracer(|options| options.tile_rays = Some(tile));
            let uploaded = tracer.upload(&case.structure).unwrap();
            let gpu = tracer.polygon_heads(&uploaded, list, Heads::Regular).unwrap();
            assert_eq!(compare_heads(list.polygon_heads().unwrap(), &gpu, machine.is_exact()), Ok(()));
        }
    });
}

#[test]
fn other_lists_and_no_heads_are_refused() {
    let cases = cases();
    on_every_adapter(|machine| {
        let (one, other) = (&cases[0], &cases[1]);
        let uploaded = machine.trusted.upload(&one.structure).unwrap();
        let heads = |of: &Case, heads| machine.trusted.polygon_heads(&uploaded, list(of), heads).unwrap_err();
        let refused = heads(other, Heads::Regular);
        assert!(
            matches!(&refused, GpuError::Catalogue(_)) && refused.to_string().contains("upload"),
            "{refused}"
        );
        let refused = heads(one, Heads::Disabled);
        assert!(refused.to_string().contains("simple"), "{refused}");
        // A search that does not come to its end gives no head.
        let hasty = machine.tracer(|options| options.step_budget = Some(1));
        let uploaded = hasty.upload(&one.structure).unwrap();
        let cut = hasty.polygon_heads(&uploaded, list(one), Heads::Regular).unwrap_err();
        assert!(matches!(cut, GpuError::NoHead { .. }) && cut.to_string().contains("heads=regular"), "{cut}");
    });
}

/// A comparison that sees one head among thousands.
#[test]
fn a_wrong_head_is_found() {
    let case = cases().swap_remove(0);
    let list = list(&case);
    let cpu = list.polygon_heads().unwrap();
    assert_eq!(compare_heads(cpu, cpu, true), Ok(()));
    let mut heads = cpu.heads().to_vec();
    heads[77] = if heads[77] == NO_HEAD { 0 } else { NO_HEAD };
    let wrong = HeadTable::from_heads(list, heads.clone()).unwrap();
    assert!(compare_heads(cpu, &wrong, true).unwrap_err().contains("head 77"));
    heads.truncate(8);
    let short = HeadTable::from_heads(list, heads).unwrap();
    assert!(compare_heads(cpu, &short, false).is_err());
}

const SPHERES: &[Damage] = &[
    ("shared/half_space", "* (share * largest)", "* (share * largest * 30.0)"),
    ("shared/half_space", "first - pad", "first + pad"),
    ("shared/half_space", "sphere.w * space.length", "sphere.w"),
    ("shared/half_space", "&& dot(space.normal, c) < space.offset", ""),
    ("shared/half_space", "min(min(dot(normal, a), dot(normal, b)), dot(normal, c))", "dot(normal, a)"),
    ("shared/heads_polygon", "abs(normal * (vec3<f32>(1.0) - abs(along)))", "abs(normal)"),
    ("shared/heads_polygon", "load_record_vector(at + 1u), -front", "load_record_vector(at + 1u), front"),
    ("shared/heads_polygon", "select(normal, -normal, mirrored)", "normal"),
    ("shared/heads_polygon", "let facets = records[at];", "let facets = 0u;"),
    ("kernel/heads", "head = place;", ""),
    ("kernel/heads", "head - first", "place - first"),
    ("kernel/heads", "layer += 1u;", ""),
    (
        "kernel/heads",
        "if #{INDEX}u < half_space_count && excludes_triangle",
        "if #{INDEX}u == 0u && excludes_triangle",
    ),
];
/// Of rays that begin above their triangle.
const FROM_ABOVE: &[Damage] =
    &[("shared/heads_polygon", "a, b, c, share, largest", "a, b, c, #{HEAD_PAD}, largest")];
/// Of a small scene the square of a normal's length is no number any more.
const TINY: &[Damage] = &[("shared/heads_polygon", "front / size", "front")];
const BOXES: &[Damage] = &[
    ("shared/half_space", "select(low, high, space.normal >= vec3<f32>(0.0))", "high"),
    ("shared/half_space", "select(low, high, space.normal >= vec3<f32>(0.0))", "(low + high) * 0.5"),
    ("shared/outside_boxes", "load_grid(layer)", "load_grid(0u)"),
    ("shared/heads_polygon", "return all(with_list >= vec3<f32>(0.0));", "return false;"),
];
const CELLS: &[Damage] = &[
    ("shared/heads_frustum", "side < 4u", "side < 3u"),
    ("shared/heads_frustum", "20u * row", "0u"),
    ("shared/heads_frustum", "at + 4u + 5u * facet", "at + 4u"),
];

#[test]
fn broken_heads_are_noticed() {
    let spheres: Vec<Case> = more().into_iter().filter(|case| case.name == "layers by spheres").collect();
    let boxes: Vec<Case> = cases().into_iter().filter(|case| case.name == "layers").collect();
    let polygons = |tracer: &Tracer, uploaded: &_, case: &Case| {
        let table = tracer.polygon_heads(uploaded, list(case), Heads::Regular);
        differs(list(case).polygon_heads().unwrap(), table)
    };
    let upload = |cases: &[Case]| {
        let structure = cases[0].structure.clone();
        move |machine: &Machine| vec![machine.trusted.upload(&structure).unwrap()]
    };
    notice_each("spheres", 8, SPHERES, upload(&spheres), |tracer, uploaded| {
        polygons(tracer, &uploaded[0], &spheres[0])
    });
    let tiny: Vec<Case> = more().into_iter().filter(|case| case.name == "tiny").collect();
    notice_each("tiny", 8, TINY, upload(&tiny), |tracer, uploaded| polygons(tracer, &uploaded[0], &tiny[0]));
    let above: Vec<Case> = more().into_iter().filter(|case| case.name == "from above").collect();
    notice_each("from above", 8, FROM_ABOVE, upload(&above), |tracer, uploaded| {
        polygons(tracer, &uploaded[0], &above[0])
    });
    notice_each("boxes", 8, BOXES, upload(&boxes), |tracer, uploaded| {
        polygons(tracer, &uploaded[0], &boxes[0])
    });
    let frustum = frustum(8);
    let cpu = list(&spheres[0]).frustum_heads(&frustum);
    notice_each("cells", 8, CELLS, upload(&spheres), |tracer, uploaded| {
        differs(&cpu, tracer.frustum_heads(&uploaded[0], list(&spheres[0]), &frustum))
    });
}

fn differs(cpu: &HeadTable, gpu: Result<HeadTable, GpuError>) -> Option<String> {
    match gpu {
        Ok(gpu) => compare_heads(cpu, &gpu, true).err(),
        // Of a head beyond its list, and of a search without an end.
        Err(error @ (GpuError::Refused { .. } | GpuError::NoHead { .. })) => Some(error.to_string()),
        Err(error) => panic!("{error}"),
    }
}

/// Lists of other kinds, for their heads.
fn more() -> Vec<Case> {
    let plain = ListOptions { heads: Heads::Regular, ..ListOptions::default() };
    let (six, eight) = (Directions::Six, Directions::Eight);
    let by = |source, bounds, directions| ListOptions { source, bounds, directions, ..plain };
    let lattice = || Scene::from_mesh(lattice());
    vec![
        lists::case("lattice of spheres", lattice(), by(Source::Octree, Bounds::Sphere, six)),
        lists::case("lattice of boxes", lattice(), by(Source::Sah, Bounds::Aabb, eight)),
        lists::case(
            "tiny",
            lists::placed(Vec3::splat(1e-12), Vec3::ZERO),
            by(Source::Sah, Bounds::Sphere, eight),
        ),
        lists::case("parts", Scene::from_mesh(soup(200)), by(Source::Sbvh, Bounds::Aabb, six)),
        lists::case(
            "from above",
            lattice(),
            ListOptions { clearance: Clearance::Above, ..by(Source::Octree, Bounds::Sphere, six) },
        ),
        lists::case(
            "simple",
            Scene::from_mesh(soup(200)),
            ListOptions { heads: Heads::Simple, ..by(Source::Sah, Bounds::Sphere, six) },
        ),
        lists::case(
            "layers by spheres",
            instances(),
            ListOptions { moving: Some(9), ..by(Source::Octree, Bounds::Sphere, six) },
        ),
    ]
}
