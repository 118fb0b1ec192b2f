//! Rays that begin with heads: the CPU's hits and counters, and errors where the heads are of something else.

use crate::compare::compare;
use crate::damage::{Damage, notice_each};
use crate::machine::{Machine, on_every_adapter};
use crate::scenes::{Case, instances, soup, sphere};
use crate::{lists, rays};
use ropewalk::glam::Vec3;
use ropewalk::traversal_list::{
    Bounds, Cull, Directions, Frustum, HeadTable, Heads, ListOptions, Source, Starts,
};
use ropewalk::{CatalogueError, Hit, Query, Ray, Scene, Structure, TraceOptions, TraversalList, Walk};
use ropewalk_gpu::{Device, GpuError};
use std::sync::Arc;

const COUNTED: TraceOptions = TraceOptions { counters: true };

/// Lists with heads for their triangles: every number of directions, both volumes, one layer and two, one side and two.
pub(crate) fn cases() -> Vec<Case> {
    let plain = ListOptions { heads: Heads::Regular, ..ListOptions::default() };
    let soup = || Scene::from_mesh(soup(300));
    let (aabb, one_sided) = (Bounds::Aabb, Cull::Exact);
    vec![
        lists::case("eight", soup(), plain),
        lists::case("six", soup(), ListOptions { directions: Directions::Six, bounds: aabb, ..plain }),
        lists::case(
            "two",
            soup(),
            ListOptions { directions: Directions::Two, heads: Heads::Simple, ..plain },
        ),
        lists::case(
            "one",
            Scene::from_mesh(sphere(12)),
            ListOptions { directions: Directions::One, ..plain },
        ),
        lists::case(
            "best",
            Scene::from_mesh(sphere(16)),
            ListOptions { source: Source::Sbvh, bounds: aabb, cull: one_sided, ..plain },
        ),
        lists::case("layers", instances(), ListOptions { moving: Some(9), bounds: aabb, ..plain }),
        lists::case(
            "layers of one side",
            instances(),
            ListOptions { moving: Some(12), cull: one_sided, directions: Directions::Six, ..plain },
        ),
        lists::case("nothing", Scene::default(), ListOptions { moving: Some(0), ..plain }),
    ]
}

pub(crate) fn list(case: &Case) -> &TraversalList {
    let Structure::List(list) = &case.structure else { panic!("lists were built") };
    list
}

/// Rays that leave triangles, and rows of the triangles' heads; some that are no rays, and some that have no triangle.
fn leaving(list: &TraversalList) -> (Vec<Ray>, Vec<u32>) {
    let mut random = rays::Random::new(3);
    let triangles = list.identities().len();
    let (mut rays, mut numbers) = (Vec::new(), Vec::new());
    for index in 0..triangles * 8 {
        let number = random.below(triangles) as u32;
        let [a, b, c] = list.triangle_at(number).triangle().vertices;
        let [u, v] = [random.number(), random.number()].map(|part| part.abs() * 0.5);
        let origin = a + (b - a) * u + (c - a) * v;
        let mut dir = random.vector();
        if index % 7 == 0 {
            dir[index % 3] = 0.0;
        }
        rays.push(Ray::new(origin, dir).window(1e-4, f32::INFINITY));
        numbers.push(if index % 50 == 0 { u32::MAX } else { number });
    }
    rays.extend(rays::invalid());
    numbers.resize(rays.len(), 0);
    let rows = list.polygon_starts(&rays, &numbers);
    (rays, rows)
}

/// Rays of a camera, and the cells that they go through.
fn primary(frustum: &Frustum) -> (Vec<Ray>, Vec<u32>) {
    let places = (0..61 * 61).map(|index| [index % 61, index / 61].map(|part| (part as f32 + 0.5) / 61.0));
    places
        .map(|[x, y]| {
            let dir = frustum.corner + frustum.right * x + frustum.down * y;
            (Ray::new(frustum.eye, dir), frustum.cell(x, y))
        })
        .unzip()
}

pub(crate) fn frustum(cells: u32) -> Frustum {
    let corner = Vec3::new(-1.1, 1.0, -1.5);
    Frustum { eye: Vec3::new(0.1, -0.2, 2.5), corner, right: Vec3::X * 2.2, down: Vec3::NEG_Y * 2.0, cells }
}

fn agree(case: &Case, rays: &[Ray], starts: Starts<'_>) {
    let list = list(case);
    on_every_adapter(|machine| {
        let uploaded = machine.trusted.upload(&case.structure).unwrap();
        for query in Query::EVERY {
            let cpu = list.trace_from(query, rays, starts, COUNTED).unwrap();
            let gpu = machine.trusted.trace_from(&uploaded, query, rays, starts, COUNTED).unwrap().traced;
            assert_eq!(compare(&cpu, &gpu, machine.is_exact()), Ok(()), "{}, {query}", case.name);
            // Whatever the heads are, the hits are those from the first elements on.
            let whole = list.trace(Walk::List, query, rays, COUNTED).unwrap();
            assert_eq!(whole.answer, cpu.answer, "{}, {query}", case.name);
        }
        let plain = TraceOptions::default();
        let cpu = list.trace_from(Query::Closest, rays, starts, plain).unwrap();
        let checked = machine.checked.upload(&case.structure).unwrap();
        let gpu = machine.checked.trace_from(&checked, Query::Closest, rays, starts, plain).unwrap().traced;
        assert_eq!(compare(&cpu, &gpu, machine.is_exact()), Ok(()), "{}, checked", case.name);
    });
}

#[test]
fn rays_from_polygons_agree() {
    for case in cases() {
        let list = list(&case);
        let (rays, rows) = leaving(list);
        let table = list.polygon_heads().expect("heads were wanted");
        let begin = rows.iter().filter(|&&row| row != Starts::FROM_THE_FIRST).count();
        assert!(begin * 3 >= rows.len() || case.name == "nothing", "{}: {begin}", case.name);
        agree(&case, &rays, Starts { table, rows: &rows });
    }
}

#[test]
fn primary_rays_agree() {
    for case in cases() {
        let frustum = frustum(8);
        let (rays, rows) = primary(&frustum);
        let table = list(&case).frustum_heads(&frustum);
        agree(&case, &rays, Starts { table: &table, rows: &rows });
    }
}

/// Heads save visits, or the tests above would say nothing.
#[test]
fn heads_save_visits() {
    for case in cases().iter().filter(|case| ["eight", "six", "best", "layers"].contains(&case.name)) {
        let list = list(case);
        let (rays, rows) = leaving(list);
        let starts = Starts { table: list.polygon_heads().unwrap(), rows: &rows };
        let totals = |traced: ropewalk::Traced| {
            let totals = traced.totals().unwrap();
            totals.inner_visits + totals.primitive_tests
        };
        let with = totals(list.trace_from(Query::Any, &rays, starts, COUNTED).unwrap());
        let without = totals(list.trace(Walk::List, Query::Any, &rays, COUNTED).unwrap());
        assert!(with * 20 < without * 19, "{}: {with} of {without}", case.name);
    }
}

/// Both devices answer by the same function, and refuse what is no list.
#[test]
fn either_device_begins_with_heads() {
    let case = cases().swap_remove(5);
    let structure = Arc::new(case.structure.clone());
    let list = list(&case);
    let (rays, rows) = leaving(list);
    let starts = Starts { table: list.polygon_heads().unwrap(), rows: &rows };
    let no_list = Structure::Bvh(instances().build(&ropewalk::BuildOptions::default()).unwrap());
    on_every_adapter(|machine| {
        for device in [Device::Cpu, Device::Gpu(machine.trusted.clone())] {
            let traceable = device.prepare(structure.clone()).unwrap();
            let traced = traceable.trace_from(Query::Closest, &rays, starts, COUNTED).unwrap();
            let cpu = list.trace_from(Query::Closest, &rays, starts, COUNTED).unwrap();
            assert_eq!(compare(&cpu, &traced, machine.is_exact()), Ok(()));
            let other = device.prepare(no_list.clone()).unwrap();
            let refused = other.trace_from(Query::Closest, &rays, starts, COUNTED).unwrap_err();
            assert!(matches!(&refused, GpuError::Catalogue(_)), "{refused}");
        }
    });
}

/// Heads of other lists would lead anywhere; they are refused before anything is sent.
#[test]
fn heads_of_something_else_are_refused() {
    let cases = cases();
    let named = |name| cases.iter().find(|case| case.name == name).unwrap();
    let (eight, six, one) = (named("eight"), named("six"), named("one"));
    let rays: Vec<Ray> =
        (0..40).map(|index| Ray::new(Vec3::ZERO, Vec3::new(1.0, index as f32, -0.5))).collect();
    let rows: Vec<u32> = (0..40).collect();
    on_every_adapter(|machine| {
        let uploaded = machine.trusted.upload(&eight.structure).unwrap();
        let refused = |table: &HeadTable, rows: &[u32], part: &str| {
            let starts = Starts { table, rows };
            let answer = machine.trusted.trace_from(&uploaded, Query::Any, &rays, starts, COUNTED);
            let Err(GpuError::Catalogue(CatalogueError(text))) = answer else { panic!("{part}: {answer:?}") };
            assert!(text.contains(part), "{text}");
        };
        refused(list(six).polygon_heads().unwrap(), &rows, "another structure");
        refused(list(one).polygon_heads().unwrap(), &rows, "another structure");
        let own = list(eight).polygon_heads().unwrap();
        refused(own, &rows[1..], "39");
        refused(own, &[&rows[1..], &[300]].concat(), "300 rows");
        // As wide, but of longer lists.
        let long = lists::case(
            "longer",
            Scene::from_mesh(soup(900)),
            ListOptions { heads: Heads::Regular, ..ListOptions::default() },
        );
        refused(
            list(&long).polygon_heads().unwrap(),
            &(0..40).map(|row| row + 500).collect::<Vec<_>>(),
            "beyond",
        );
        // A row that is not used may hold anything.
        let first = vec![Starts::FROM_THE_FIRST; rays.len()];
        let starts = Starts { table: list(&long).polygon_heads().unwrap(), rows: &first };
        let from_first =
            machine.trusted.trace_from(&uploaded, Query::Closest, &rays, starts, COUNTED).unwrap();
        let whole = machine.trusted.trace(&uploaded, Walk::List, Query::Closest, &rays, COUNTED).unwrap();
        assert_eq!(from_first.traced, whole.traced);
        assert!(whole.traced.answer != ropewalk::Answer::Closest(vec![Hit::MISS; rays.len()]));
    });
}

const BROKEN: &[Damage] = &[
    ("walk/walk_list", "place + head", "place"),
    ("walk/walk_list", "head == #{NO_HEAD}", "false"),
    ("kernel/rays", "records[starts_at + layer]", "records[starts_at]"),
    ("kernel/rays", "(index + 1u) - #{STARTS}u", "(index + 1u) - 1u"),
    ("kernel/rays", "(index + 1u) - #{STARTS}u", "index + 9u"),
];

#[test]
fn broken_starts_are_noticed() {
    let cases: Vec<Case> = cases().into_iter().filter(|case| case.name == "layers").collect();
    let asked: Vec<_> = cases.iter().map(|case| (list(case), leaving(list(case)))).collect();
    let upload = |machine: &Machine| vec![machine.trusted.upload(&cases[0].structure).unwrap()];
    notice_each("starts", 8, BROKEN, upload, |tracer, uploaded| {
        let (list, (rays, rows)) = &asked[0];
        let starts = Starts { table: list.polygon_heads()?, rows };
        let cpu = list.trace_from(Query::All, rays, starts, COUNTED).unwrap();
        match tracer.trace_from(&uploaded[0], Query::All, rays, starts, COUNTED) {
            Ok(gpu) => compare(&cpu, &gpu.traced, true).err(),
            Err(GpuError::Unanswered { ray }) => Some(format!("ray {ray} has no answer")),
            Err(error) => panic!("{error}"),
        }
    });
}
