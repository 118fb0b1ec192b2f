//! Rays that begin with heads: they hit what they hit from the first element on, and walk through less.

use super::support::{every, placed, rays};
use ropewalk::glam::Vec3;
use ropewalk::traversal_list::{
    Bounds, Clearance, Cull, Directions, Frustum, HeadTable, Heads, ListOptions, NO_HEAD, Starts,
};
use ropewalk::{Query, Ray, Scene, TraceOptions, TraversalList, Walk};
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;

const COUNTED: TraceOptions = TraceOptions { counters: true };

/// Rays from points of triangles to all sides, with the triangles' numbers: to the front, along the surface, to the back,
/// along axes.
fn rays_from(list: &TraversalList, count: usize) -> (Vec<Ray>, Vec<u32>) {
    let mut random = Random::new(31);
    let triangles = list.identities().len();
    let ray = |index: usize| {
        let number = random.below(triangles) as u32;
        let triangle = list.triangle_at(number);
        let [a, b, c] = triangle.triangle().vertices;
        let (u, v) = (random.unit() as f32, random.unit() as f32);
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let origin = match index % 4 {
            0 => a,
            1 => a.midpoint(b),
            _ => a + (b - a) * u + (c - a) * v,
        };
        let front = triangle.front().normalize_or_zero();
        let dir = match index % 7 {
            0 => b - c,
            1 => Vec3::AXES[index % 3] * if index.is_multiple_of(2) { 1.0 } else { -1.0 },
            2 => (c - a) + front * 1e-4,
            3 => random.direction().as_vec3(),
            _ => front + random.direction().as_vec3(),
        };
        (Ray::new(origin, dir), number)
    };
    (0..count).map(ray).filter(|(ray, _)| ray.is_valid()).unzip()
}

fn work(list: &TraversalList, rays: &[Ray], starts: Option<Starts<'_>>) -> u64 {
    let traced = match starts {
        Some(starts) => list.trace_from(Query::Closest, rays, starts, COUNTED).unwrap(),
        None => list.trace(Walk::List, Query::Closest, rays, COUNTED).unwrap(),
    };
    let totals = traced.totals().unwrap();
    totals.inner_visits + totals.primitive_tests
}

fn agree(list: &TraversalList, rays: &[Ray], starts: Starts<'_>, what: &str) {
    for query in Query::EVERY {
        let plain = list.trace(Walk::List, query, rays, TraceOptions::default()).unwrap();
        let from = list.trace_from(query, rays, starts, TraceOptions::default()).unwrap();
        assert_eq!(plain, from, "{query}, {what}");
    }
}

#[test]
fn rays_from_triangles_hit_the_same_and_walk_through_less() {
    let scene = placed();
    for options in every() {
        for cull in [Cull::None, Cull::Exact] {
            let mut before = f64::INFINITY;
            for heads in [Heads::Simple, Heads::Regular] {
                let options = ListOptions { heads, cull, moving: Some(2), ..options };
                let list = scene.build_list(&options).unwrap();
                let (rays, triangles) = rays_from(&list, 400);
                let rows = list.polygon_starts(&rays, &triangles);
                assert!(rows.contains(&Starts::FROM_THE_FIRST), "some go through the triangle");
                let starts = Starts { table: list.polygon_heads().unwrap(), rows: &rows };
                agree(&list, &rays, starts, &format!("{options:?}"));
                let ratio = work(&list, &rays, Some(starts)) as f64 / work(&list, &rays, None) as f64;
                // A head may lie below an ancestor that would have been missed.
                assert!(ratio < 1.1 && ratio < before + 1e-9, "{options:?}: {ratio}, then {before}");
                before = ratio;
            }
            if matches!(options.directions, Directions::Six | Directions::Eight) {
                assert!(before < 0.98, "{options:?}: {before}");
            }
        }
    }
}

/// Of rays some begin clearly above their triangle, which pass by what touches its plane, and the others with the first
/// element, and so hit the triangle itself where they did.
#[test]
fn rays_from_above_and_others_hit_the_same() {
    let scene = placed();
    for options in every() {
        for cull in [Cull::None, Cull::Exact] {
            let build = |clearance| {
                let options = ListOptions { heads: Heads::Regular, cull, clearance, ..options };
                scene.build_list(&options).unwrap()
            };
            let [surface, above] = [Clearance::Surface, Clearance::Above].map(build);
            let (mut rays, triangles) = rays_from(&above, 600);
            for (index, (ray, &number)) in rays.iter_mut().zip(&triangles).enumerate() {
                // Every fourth stays where it is, and every fourth begins by its window.
                let up = above.triangle_at(number).front().normalize_or_zero();
                match index % 4 {
                    0 => {}
                    1 => ray.t_min = 2e-5 / ray.dir.dot(up).max(1e-30),
                    _ => ray.origin += up * 1.5e-5,
                }
            }
            for list in [&surface, &above] {
                let rows = list.polygon_starts(&rays, &triangles);
                let starts = Starts { table: list.polygon_heads().unwrap(), rows: &rows };
                agree(list, &rays, starts, &format!("{options:?}"));
                let begun = rows.iter().filter(|&&row| row != Starts::FROM_THE_FIRST).count();
                assert!(begun > 200 && begun < 450, "{begun}");
            }
        }
    }
}

/// On a sphere each triangle has a dozen neighbours below its plane: rays that all begin above it have less to do with heads
/// that know of it, in every list.
#[test]
fn neighbours_below_are_passed_by() {
    let scene = Scene::from_mesh(meshes::icosphere(3));
    for options in every() {
        let build = |clearance| {
            scene.build_list(&ListOptions { heads: Heads::Simple, clearance, ..options }).unwrap()
        };
        let [surface, above] = [Clearance::Surface, Clearance::Above].map(build);
        let (mut rays, triangles) = rays_from(&above, 600);
        for (ray, &number) in rays.iter_mut().zip(&triangles) {
            ray.origin += above.triangle_at(number).front().normalize_or_zero() * 8e-6;
        }
        let work_of = |list: &TraversalList| {
            let rows = list.polygon_starts(&rays, &triangles);
            assert!(rows.iter().filter(|&&row| row != Starts::FROM_THE_FIRST).count() > 300);
            let starts = Starts { table: list.polygon_heads().unwrap(), rows: &rows };
            agree(list, &rays, starts, &format!("{options:?}"));
            work(list, &rays, Some(starts))
        };
        let (surface, above) = (work_of(&surface), work_of(&above));
        assert!(above < surface, "{options:?}: {above} elements, {surface} from the surface");
    }
}

#[test]
fn primary_rays_of_a_cell_hit_the_same_and_walk_through_less() {
    let scene = placed();
    let eye = Vec3::new(2.0, 1.2, 3.0);
    let (forward, right) = (-eye, Vec3::new(3.0, 0.0, -2.0) * 0.7);
    let down = forward.cross(right).normalize() * 2.5;
    let (mut with, mut without) = (0, 0);
    for options in every() {
        let list = scene.build_list(&ListOptions { moving: Some(1), ..options }).unwrap();
        for cells in [1, 4, 16] {
            let frustum = Frustum { eye, corner: forward - right * 0.5 - down * 0.5, right, down, cells };
            let side = 40;
            let (rays, rows): (Vec<Ray>, Vec<u32>) = (0..side * side)
                .map(|index| {
                    let place = |index: usize| index as f32 / (side - 1) as f32;
                    let (x, y) = (place(index % side), place(index / side));
                    (Ray::new(eye, frustum.corner + right * x + down * y), frustum.cell(x, y))
                })
                .unzip();
            let table = list.frustum_heads(&frustum);
            assert_eq!(table.rows(), (cells * cells) as usize);
            assert!([frustum.cell(0.0, 0.0), frustum.cell(1.0, f32::NAN)].into_iter().all(|it| it < cells));
            let starts = Starts { table: &table, rows: &rows };
            agree(&list, &rays, starts, &format!("{cells} cells, {options:?}"));
            if cells == 16 {
                with += work(&list, &rays, Some(starts));
                without += work(&list, &rays, None);
            }
        }
    }
    // Of all lists together; of single ones a head may lie below an ancestor that would have been missed.
    assert!(with * 20 < without * 19, "{with} {without}");
}

/// Heads that skip too much lose hits, which the comparison above would notice.
#[test]
fn a_head_too_far_loses_hits() {
    let scene = placed();
    let options = ListOptions { heads: Heads::Regular, bounds: Bounds::Aabb, ..ListOptions::default() };
    let list = scene.build_list(&options).unwrap();
    let good = list.polygon_heads().unwrap();
    let farther = good.heads().iter().enumerate().map(|(place, &head)| {
        let elements = list.list(place % good.width());
        match elements.get(head as usize).map(|element| element.escape) {
            // A node or a triangle on, where something follows.
            Some(escape) if escape > 0 => head + escape as u32,
            _ => head,
        }
    });
    let bad = HeadTable::from_heads(&list, farther.collect()).unwrap();
    let (rays, triangles) = rays_from(&list, 2000);
    let rows = list.polygon_starts(&rays, &triangles);
    let of = |table| {
        list.trace_from(Query::Closest, &rays, Starts { table, rows: &rows }, TraceOptions::default())
            .unwrap()
    };
    assert_ne!(of(good).answer, of(&bad).answer);
}

#[test]
fn rays_of_which_nothing_is_known_begin_with_the_first_element() {
    let list = placed().build_list(&ListOptions { heads: Heads::Simple, ..ListOptions::default() }).unwrap();
    let rays = rays(300);
    let rows = vec![Starts::FROM_THE_FIRST; rays.len()];
    let starts = Starts { table: list.polygon_heads().unwrap(), rows: &rows };
    let from = list.trace_from(Query::Closest, &rays, starts, COUNTED).unwrap();
    assert_eq!(from, list.trace(Walk::List, Query::Closest, &rays, COUNTED).unwrap());
    assert_eq!(list.polygon_starts(&rays[..1], &[u32::MAX]), [Starts::FROM_THE_FIRST]);
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let build =
        |scene: &Scene, heads| scene.build_list(&ListOptions { heads, ..ListOptions::default() }).unwrap();
    let (scene, other) = (placed(), Scene::from_mesh(meshes::soup(50, 0.3, 2)));
    let list = build(&scene, Heads::Simple);
    assert!(build(&scene, Heads::Disabled).polygon_heads().is_none());
    let rays = rays(3);
    let answer = |table, rows: &[u32]| {
        list.trace_from(Query::Any, &rays, Starts { table, rows }, COUNTED).unwrap_err().to_string()
    };
    let table = list.polygon_heads().unwrap();
    assert!(answer(table, &[0, 1]).contains("3 rays and rows of heads for 2"));
    assert!(answer(table, &[0, 1, 1_000_000]).contains("row 1000000"));
    let six = ListOptions { directions: Directions::Six, heads: Heads::Simple, ..ListOptions::default() };
    let six = scene.build_list(&six).unwrap();
    assert!(answer(six.polygon_heads().unwrap(), &[0; 3]).contains("6 lists, and there are 8"));
    let small = build(&other, Heads::Disabled);
    let none = HeadTable::from_heads(&small, vec![NO_HEAD; 16]).unwrap();
    assert!(answer(&none, &[0; 3]).contains("other lengths"));
    assert!(HeadTable::from_heads(&small, table.heads().to_vec()).is_err());
    assert!(HeadTable::from_heads(&small, vec![0; 9]).unwrap_err().to_string().contains("not whole"));
    assert_eq!(HeadTable::from_heads(&small, vec![NO_HEAD; 16]).unwrap().rows(), 2);
}
