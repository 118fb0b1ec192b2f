//! What culling, sorting and ordering save, on a scene with enough in it for the savings to show: a wood of many
//! small leaves over a ground, seen from outside, and by bounces from within. The counts are exact, so they are
//! compared as such; the relations are those of the table for the walks of the blog of 2022.

use glam::{DVec3, Vec3};
use ropewalk::bvh::StackOrder;
use ropewalk::{BuildOptions, Bvh, CounterTotals, Hit, Mesh, Query, Ray, Scene, TraceOptions, Walk, glam};
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;
use ropewalk_testkit::rays::{RayClass, RayMaker, View};

/// Trees of leaves: long ways past many half-empty boxes.
fn wood() -> Scene {
    let mut random = Random::new(12);
    let mut mesh = meshes::grid(1, 0.0, 20, 1.0);
    for _ in 0..80 {
        let root = DVec3::new(random.between(1.0, 19.0), 0.0, random.between(1.0, 19.0));
        for _ in 0..800 {
            let place = root + DVec3::Y * 2.0 + random.in_cube() * DVec3::new(0.9, 1.6, 0.9);
            let (along, across) = (random.direction() * 0.25, random.direction() * 0.1);
            meshes::push(&mut mesh, [place - across, place + across, place + along]);
        }
    }
    Scene::from_mesh(mesh)
}

struct Work {
    none: CounterTotals,
    culled: CounterTotals,
    sorted: CounterTotals,
    ordered: CounterTotals,
}

fn work(bvh: &Bvh, rays: &[Ray]) -> Work {
    let of = |order| {
        let options = TraceOptions { counters: true };
        bvh.trace(Walk::Stack(order), Query::Closest, rays, options).unwrap().totals().unwrap()
    };
    Work {
        none: of(StackOrder::Unordered),
        culled: of(StackOrder::Culled),
        sorted: of(StackOrder::Sorted),
        ordered: of(StackOrder::Ordered),
    }
}

/// How much less, in percent.
fn saved(than: u64, now: u64) -> f64 {
    100.0 * (1.0 - now as f64 / than as f64)
}

#[test]
fn culling_sorting_and_ordering_save_what_they_should() {
    let scene = wood();
    let bvh = scene.build(&BuildOptions::default()).unwrap();
    let flat = scene.flatten().unwrap();
    let closest = |rays: &[Ray]| rays.iter().map(|ray| bvh.closest(ray)).collect::<Vec<Hit>>();
    // Across the wood from all four sides: from one side alone the first child may happen to be the nearer one.
    let eyes = [(-3.0, 9.0), (23.0, 11.0), (9.0, -3.0), (11.0, 23.0)].map(|(x, z)| Vec3::new(x, 2.5, z));
    for class in [RayClass::Primary, RayClass::DiffuseBounce] {
        let mut rays = Vec::new();
        for eye in eyes {
            let view = View::look_at(eye, Vec3::new(10.0, 1.5, 10.0), 0.6);
            rays.extend(RayMaker::new(&flat, 2).with_view(view).make(class, 5000, &closest));
        }
        assert_eq!(rays.len(), 20_000);
        let work = work(&bvh, &rays);
        let table = [&work.none, &work.culled, &work.sorted, &work.ordered]
            .map(|totals| [totals.inner_visits, totals.leaf_visits, totals.primitive_tests]);
        println!("{class}: inner visits, leaf visits, tests a ray");
        for row in &table {
            println!("  {:?}", row.map(|count| count as f64 / 20_000.0));
        }
        // Each step does no more than the one before it, of anything.
        for pair in table.windows(2) {
            assert!((0..3).all(|i| pair[1][i] <= pair[0][i]), "{class}: {table:?}");
        }
        // At least what was measured on an interior, an atrium and a forest: culling alone 11 percent of the visits
        // and 21 of the tests, all together 19 and 42. This wood is dense and has more to save.
        let culling = (saved(table[0][0], table[1][0]), saved(table[0][2], table[1][2]));
        let all = (saved(table[0][0], table[3][0]), saved(table[0][2], table[3][2]));
        assert!(culling.0 > 11.0 && culling.1 > 21.0, "{class}: {culling:?}");
        assert!(all.0 > 19.0 && all.1 > 42.0, "{class}: {all:?}");
        assert!(work.ordered.stack_depth <= bvh.report().depth);
    }
}

/// Putting leaves first changes no count of a walk that neither culls nor sorts, and little of the others.
#[test]
fn leaves_first_change_little() {
    let scene = wood();
    let build = |leaf_order| scene.build(&BuildOptions { leaf_order, ..BuildOptions::default() }).unwrap();
    let (split, left) = (build(ropewalk::bvh::LeafOrder::Split), build(ropewalk::bvh::LeafOrder::Left));
    let flat = scene.flatten().unwrap();
    let rays = RayMaker::new(&flat, 2).make(RayClass::Primary, 10_000, &|_| vec![]);
    let (split, left) = (work(&split, &rays), work(&left, &rays));
    assert_eq!(
        (split.none.inner_visits, split.none.leaf_visits, split.none.primitive_tests),
        (left.none.inner_visits, left.none.leaf_visits, left.none.primitive_tests)
    );
    // Only the order at equal distance is left to it.
    let change = saved(split.ordered.inner_visits, left.ordered.inner_visits).abs();
    assert!(change < 2.0, "{change} percent");
}

/// The point of a hierarchy: work grows with the logarithm of the scene, not with the scene.
#[test]
fn the_work_of_a_ray_grows_with_the_logarithm_of_the_scene() {
    let visits = |subdivisions: u32| {
        let scene = Scene::from_mesh(meshes::icosphere(subdivisions));
        let bvh = scene.build(&BuildOptions::default()).unwrap();
        let rays = RayMaker::new(&scene.flatten().unwrap(), 3).make(RayClass::Primary, 5000, &|_| vec![]);
        let totals = work(&bvh, &rays).ordered;
        (totals.inner_visits + totals.primitive_tests) as f64 / 5000.0
    };
    let [small, middle, large] = [2, 4, 6].map(visits);
    println!("{small} {middle} {large} visits and tests a ray for 320, 5,120 and 81,920 triangles");
    // 16 times the triangles: four more levels each time, and nowhere near 16 times the work.
    assert!(large < 3.0 * small, "{small} {middle} {large}");
    assert!(large - middle < 3.0 * (middle - small).max(2.0), "{small} {middle} {large}");
    let mesh: Mesh = meshes::icosphere(2);
    assert_eq!(mesh.triangles.len(), 320);
}
