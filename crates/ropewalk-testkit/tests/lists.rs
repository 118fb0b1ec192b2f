//! Sound traversal lists pass the suite, however they are made: of one side and of two, of one layer and of two, with heads
//! of every kind; and heads save what they should.

#[path = "support/lists.rs"]
mod rows;

use ropewalk::traversal_list::{Bounds, ChildOrder, Cull, Directions, Heads, ListOptions, Source};
use ropewalk::{Counters, Query, TraceOptions, Walk};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::conformance::{Accuracy, Suite};
use rows::{list_rows, run_on_cpu};

/// Cases that strain sides, heads and layers; the catalogue's own settings are tried over all.
const CASES: [&str; 6] = ["soup", "diagonals", "placed", "boxes", "one-triangle", "empty-objects"];

#[test]
fn every_kind_of_list_conforms() {
    let mut options = Vec::new();
    for (index, &(_, directions)) in Directions::NAMES.iter().enumerate() {
        for (cull, all_heads) in
            [(Cull::None, [Heads::Disabled, Heads::Regular]), (Cull::Exact, [Heads::Simple, Heads::Regular])]
        {
            for heads in all_heads {
                // What is left takes turns.
                let turn = options.len() + index;
                options.push(ListOptions {
                    source: [Source::Octree, Source::Sah, Source::Sbvh][turn % 3],
                    bounds: [Bounds::Sphere, Bounds::Aabb][turn / 2 % 2],
                    directions,
                    order: [ChildOrder::EarliestFirst, ChildOrder::LatestLast][turn / 3 % 2],
                    cull,
                    heads,
                    frustum_grid: [0, 5][turn % 2],
                    moving: [None, Some(3), Some(0)][turn / 4 % 3],
                    ..ListOptions::default()
                });
            }
        }
    }
    options.push(ListOptions::BEST);
    let rows: Vec<_> = options.into_iter().flat_map(list_rows).collect();
    let report = run_on_cpu(&CASES, &rows);
    assert!(report.is_passed(), "{report}");
    for result in &report.rows {
        let ropewalk::StructureSpec::List(options) = result.row.structure else { panic!() };
        let has_heads = options.heads != Heads::Disabled || options.frustum_grid > 0;
        let tried = result.row.walk == Walk::List && has_heads;
        assert_eq!(result.from_heads > 1000, tried, "{}: {}", result.row.structure, result.from_heads);
    }
}

/// What heads of each kind visit of a closed sphere, seen from its own triangles: a head that passes by too little shows in
/// no answer.
#[test]
fn heads_pass_by_what_they_should() {
    let case = Case::named("sphere").unwrap();
    for (bounds, directions) in [
        (Bounds::Sphere, Directions::Six),
        (Bounds::Aabb, Directions::Six),
        (Bounds::Sphere, Directions::Eight),
        (Bounds::Aabb, Directions::Eight),
    ] {
        let work = |heads| {
            let options =
                ListOptions { bounds, directions, heads, cull: Cull::Exact, ..ListOptions::default() };
            let list = case.scene.build_list(&options).unwrap();
            let hits: Vec<_> = case.rays.iter().map(|ray| (ray, list.closest(ray))).collect();
            let seen = hits.into_iter().filter(|(_, hit)| hit.is_hit());
            let (rays, numbers): (Vec<_>, Vec<_>) = seen
                .filter_map(|(ray, hit)| {
                    let number = list.number_of(hit.id())?;
                    let [a, b, c] = list.triangle_at(number).triangle().vertices;
                    // Reflected, from the middle of the triangle.
                    let normal = (b - a).cross(c - a).normalize();
                    let dir = ray.dir.normalize();
                    let dir = dir - normal * (2.0 * dir.dot(normal));
                    Some((ropewalk::Ray::new((a + b + c) / 3.0, dir), number))
                })
                .unzip();
            let counted = TraceOptions { counters: true };
            let traced = match list.polygon_heads() {
                None => list.trace(Walk::List, Query::Closest, &rays, counted).unwrap(),
                Some(table) => {
                    let rows = list.polygon_starts(&rays, &numbers);
                    let starts = ropewalk::traversal_list::Starts { table, rows: &rows };
                    list.trace_from(Query::Closest, &rays, starts, counted).unwrap()
                }
            };
            let of_ray = |it: &Counters| u64::from(it.inner_visits) + u64::from(it.primitive_tests);
            traced.counters.unwrap().iter().map(of_ray).sum::<u64>() as f64 / rays.len() as f64
        };
        let [disabled, simple, regular] = [Heads::Disabled, Heads::Simple, Heads::Regular].map(work);
        println!("{bounds:?}, {directions:?}: {disabled:.1}, simple {simple:.1}, regular {regular:.1}");
        // A sphere lies below the planes of all its triangles, so that nothing is left to walk but what touches them.
        assert!(simple < 0.7 * disabled && regular < 0.7 * disabled, "{bounds:?}, {directions:?}");
    }
}

/// Where rows of one side stand alone there are none of two sides to compare them with.
#[test]
fn one_side_is_judged_alone_too() {
    let options = ListOptions { cull: Cull::Exact, ..ListOptions::default() };
    let suite = Suite::of(vec![Case::named("placed").unwrap()], Accuracy::Exact);
    let report = suite.run_on_cpu(&list_rows(options), &|_, _| {});
    assert!(report.is_passed(), "{report}");
    // And is compared with two sides, not taken for them.
    let both: Vec<_> = [Cull::None, Cull::Exact]
        .into_iter()
        .flat_map(|cull| list_rows(ListOptions { cull, ..options }))
        .collect();
    let report = suite.run_on_cpu(&both, &|_, _| {});
    assert!(report.is_passed(), "{report}");
    for result in [&report.rows[0], &report.rows[both.len() / 2]] {
        assert!(result.clear > 500, "{}: {}", result.row.structure, result.clear);
    }
}
